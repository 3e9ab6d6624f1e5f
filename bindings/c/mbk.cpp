#include "bindings/c/mbk.h"

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "apps/mbk/call.h"
#include "apps/mbk/wording.h"
#include "mbk/base/core/requester.h"
#include "mbk/base/core/version.h"
#include "mbk/files/recording/in_memory.h"

// The opaque types of the header.
struct mbk_error {
  mbk::Error error;
  int exit_code;
  std::string line;
};

struct mbk_recording {
  std::shared_ptr<const mbk::recording::InMemory> signals;
};

struct mbk_answer {
  mbk::app::Answer answer;
  std::vector<std::pair<std::string, std::string>> warnings;
  std::vector<mbk_error> errors;
};

namespace {

using mbk::Error;
using mbk::ErrorKind;
using mbk::Index;
using mbk::Result;
using mbk::Samples;
using mbk::recording::InMemory;

int exit_code_of(ErrorKind kind) {
  if (kind == ErrorKind::usage) return MBK_WRONG_USAGE;
  return kind == ErrorKind::data ? MBK_BAD_DATA : MBK_NOT_USABLE;
}

/// Language that messages are written for, in the whole process.
std::atomic<mbk::app::Language> language = mbk::app::Language::c;

mbk_error made_of(const Error& given, int exit_code) {
  Error error = mbk::app::in_language(language, given);
  std::string line = error.line();
  return {std::move(error), exit_code, std::move(line)};
}

int fail(const Error& error, mbk_error** to, int exit_code) {
  if (to != nullptr) *to = new mbk_error(made_of(error, exit_code));
  return exit_code;
}

int fail(const Error& error, mbk_error** to) {
  return fail(error, to, exit_code_of(error.kind));
}

/// Runs `work` and returns its exceptions as errors, because C has no exceptions.
template <class Work>
int guarded(mbk_error** error, const Work& work) noexcept {
  if (error != nullptr) *error = nullptr;
  try {
    try {
      return work();
    } catch (const mbk::Stopped&) {
      return fail({ErrorKind::data, "stopped", "", ""}, error, MBK_STOPPED);
    } catch (const std::bad_alloc&) {
      return fail({ErrorKind::data, "not enough memory", "", ""}, error);
    } catch (const std::exception& thrown) {
      return fail({ErrorKind::data, thrown.what(), "", ""}, error);
    }
  } catch (...) {  // no memory for the error either
    return MBK_BAD_DATA;
  }
}

int wrong_size(const std::string& what, const std::string& type, mbk_error** error) {
  return fail({ErrorKind::usage, "the size of the " + what + " differs from the size in this version",
               "set 'size' to sizeof(" + type + ")", ""},
              error);
}

/// Mistakes that C does not notice: a missing list, a negative length.
/// @param size  [bytes] of one element
Result<void> check_list(const std::string& name, const void* list, std::size_t count, std::size_t size) {
  if (count > 0 && list == nullptr) return mbk::bad_usage("'" + name + "' is NULL, but its count is not 0");
  if (count > static_cast<std::size_t>(PTRDIFF_MAX) / size) {
    return mbk::bad_usage("'" + name + "' cannot have " + std::to_string(count) + " elements",
                          "check its count: a negative number becomes a huge one");
  }
  return {};
}

int null_argument(const char* name, mbk_error** error) {
  return fail({ErrorKind::usage, std::string("'") + name + "' is NULL", "pass the address of a variable", ""}, error);
}

std::string text_of(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

Result<InMemory::Signal> signal_of(const mbk_signal& given, const std::shared_ptr<const void>& keeper) {
  InMemory::Signal signal{text_of(given.name), text_of(given.unit), {}, static_cast<Index>(given.rows)};
  const std::size_t step = given.stride == 0 ? 1 : static_cast<std::size_t>(std::abs(given.stride));
  if (step > static_cast<std::size_t>(PTRDIFF_MAX) / sizeof(double)) return mbk::bad_usage("a stride is too large");
  MBK_TRY(check_list(signal.name, given.values, given.count, step * sizeof(double)));
  if (given.rows > static_cast<std::size_t>(PTRDIFF_MAX)) {
    return mbk::bad_usage("'" + signal.name + "' cannot have " + std::to_string(given.rows) + " rows");
  }
  if (given.rows > 0 && given.count % given.rows != 0) {
    return mbk::bad_usage("'" + signal.name + "' does not form a matrix of " + std::to_string(given.rows) + " rows",
                          "set 'count' to a multiple of 'rows'");
  }
  const auto count = static_cast<Index>(given.count);
  if (given.stride != 0 && given.stride != 1) {
    using Stride = Eigen::InnerStride<>;
    signal.values = mbk::Vector(Eigen::Map<const mbk::Vector, 0, Stride>(given.values, count, Stride(given.stride)));
  } else if (keeper) {
    signal.values = Samples(given.values, count, keeper);
  } else {
    signal.values = mbk::Vector(Eigen::Map<const mbk::Vector>(given.values, count));
  }
  return signal;
}

/// Consecutive options of the same name become one with several values.
std::vector<mbk::app::CallOption> options_of(const mbk_option* options, std::size_t count) {
  std::vector<mbk::app::CallOption> made;
  for (std::size_t k = 0; k < count; ++k) {
    std::string name = text_of(options[k].name);
    if (made.empty() || made.back().name != name) made.push_back({std::move(name), {}});
    if (options[k].value != nullptr) made.back().values.emplace_back(options[k].value);
  }
  return made;
}

std::vector<std::string> texts_of(const char* const* texts, std::size_t count) {
  std::vector<std::string> made;
  for (std::size_t k = 0; k < count; ++k) made.push_back(text_of(texts[k]));
  return made;
}

mbk::app::Call call_of(const mbk_request& request) {
  mbk::app::Call call{.command = text_of(request.command),
                      .options = options_of(request.options, request.option_count),
                      .words = texts_of(request.words, request.word_count),
                      .recordings = {},
                      .documents = texts_of(request.documents, request.document_count)};
  for (std::size_t k = 0; k < request.recording_count; ++k) call.recordings.push_back(request.recordings[k]->signals);
  if (request.stop != nullptr) call.stop = [&request] { return request.stop(request.context) != 0; };
  if (request.progress != nullptr) {
    call.progress = [&request](std::string_view what, double fraction) {
      request.progress(request.context, std::string(what).c_str(), fraction);
    };
  }
  return call;
}

}  // namespace

int mbk_api_version(void) {
  return MBK_API_VERSION;
}

void mbk_set_language(int to) {
  language = to == MBK_FOR_MATLAB ? mbk::app::Language::matlab : mbk::app::Language::c;
}

const char* mbk_version(void) {
  static const std::string kVersion(mbk::version());
  return kVersion.c_str();
}

const char* mbk_error_what(const mbk_error* error) {
  return error == nullptr ? "" : error->error.message.c_str();
}

const char* mbk_error_where(const mbk_error* error) {
  return error == nullptr ? "" : error->error.where.c_str();
}

const char* mbk_error_hint(const mbk_error* error) {
  return error == nullptr ? "" : error->error.remedy.c_str();
}

const char* mbk_error_line(const mbk_error* error) {
  return error == nullptr ? "" : error->line.c_str();
}

int mbk_error_exit_code(const mbk_error* error) {
  return error == nullptr ? MBK_FINE : error->exit_code;
}

void mbk_error_free(mbk_error* error) {
  delete error;
}

int mbk_recording_new(const mbk_signal* signals, size_t count, const mbk_facts* facts, mbk_recording** recording,
                      mbk_error** error) {
  if (recording == nullptr) return guarded(error, [&] { return null_argument("recording", error); });
  *recording = nullptr;
  return guarded(error, [&] {
    constexpr mbk_facts kNone = {.size = sizeof(mbk_facts)};
    const mbk_facts& known = facts == nullptr ? kNone : *facts;
    if (known.size != sizeof(mbk_facts)) return wrong_size("facts", "mbk_facts", error);
    std::shared_ptr<const void> keeper;
    if (known.release != nullptr) {
      keeper = std::shared_ptr<const void>(
          signals, [release = known.release, owner = known.owner](const void*) { release(owner); });
    }
    for (const auto& [name, list, n, size] :
         {std::tuple<const char*, const void*, std::size_t, std::size_t>("signals", signals, count, sizeof(mbk_signal)),
          {"metadata", known.metadata, known.metadata_count, sizeof(mbk_option)},
          {"events", known.events, known.event_count, sizeof(mbk_event)}}) {
      if (auto ok = check_list(name, list, n, size); !ok) return fail(ok.error(), error);
    }
    std::vector<InMemory::Signal> made;
    for (std::size_t k = 0; k < count; ++k) {
      auto signal = signal_of(signals[k], keeper);
      if (!signal) return fail(signal.error(), error);
      made.push_back(std::move(*signal));
    }
    std::map<std::string, std::string> metadata;
    for (std::size_t k = 0; k < known.metadata_count; ++k) {
      metadata[text_of(known.metadata[k].name)] = text_of(known.metadata[k].value);
    }
    std::vector<mbk::Event> events;
    for (std::size_t k = 0; k < known.event_count; ++k) {
      events.push_back({known.events[k].time, text_of(known.events[k].name), known.events[k].value});
    }
    auto whole = InMemory::of(std::move(made), known.rate_hz, std::move(metadata), std::move(events));
    if (!whole) return fail(whole.error(), error);
    *recording = new mbk_recording{std::make_shared<const InMemory>(std::move(*whole))};
    return static_cast<int>(MBK_FINE);
  });
}

int mbk_read(const char* file, const mbk_option* options, size_t count, mbk_recording** recording, mbk_error** error) {
  if (recording == nullptr) return guarded(error, [&] { return null_argument("recording", error); });
  *recording = nullptr;
  return guarded(error, [&] {
    if (file == nullptr) return null_argument("file", error);
    if (auto ok = check_list("options", options, count, sizeof(mbk_option)); !ok) return fail(ok.error(), error);
    const mbk::app::Call call{.command = "read",
                              .options = options_of(options, count),
                              .words = {text_of(file)},
                              .recordings = {},
                              .documents = {}};
    auto found = mbk::app::read(call);
    if (!found) return fail(found.error(), error);
    if (found->size() != 1) {
      return fail({ErrorKind::usage, "holds " + std::to_string(found->size()) + " recordings",
                   "choose one with --trial", text_of(file)},
                  error);
    }
    *recording = new mbk_recording{std::move(found->front())};
    return static_cast<int>(MBK_FINE);
  });
}

size_t mbk_recording_signal_count(const mbk_recording* recording) {
  return recording == nullptr ? 0 : recording->signals->signals().size();
}

const char* mbk_recording_signal_name(const mbk_recording* recording, size_t k) {
  return k < mbk_recording_signal_count(recording) ? recording->signals->signals()[k].name.c_str() : "";
}

const char* mbk_recording_signal_unit(const mbk_recording* recording, size_t k) {
  return k < mbk_recording_signal_count(recording) ? recording->signals->signals()[k].unit.c_str() : "";
}

const double* mbk_recording_signal_values(const mbk_recording* recording, size_t k, size_t* count) {
  if (count != nullptr) *count = 0;
  if (k >= mbk_recording_signal_count(recording)) return nullptr;
  const Samples& values = recording->signals->signals()[k].values;
  if (count != nullptr) *count = static_cast<size_t>(values.size());
  return values.data();
}

size_t mbk_recording_metadata_count(const mbk_recording* recording) {
  return recording == nullptr ? 0 : recording->signals->metadata().size();
}

mbk_option mbk_recording_metadata(const mbk_recording* recording, size_t k) {
  if (k >= mbk_recording_metadata_count(recording)) return {"", ""};
  const auto entry = std::next(recording->signals->metadata().begin(), static_cast<std::ptrdiff_t>(k));
  return {entry->first.c_str(), entry->second.c_str()};
}

size_t mbk_recording_event_count(const mbk_recording* recording) {
  return recording == nullptr ? 0 : recording->signals->events().size();
}

mbk_event mbk_recording_event(const mbk_recording* recording, size_t k) {
  if (k >= mbk_recording_event_count(recording)) return {0.0, "", 0.0};
  const mbk::Event& event = recording->signals->events()[k];
  return {event.time, event.name.c_str(), event.value};
}

void mbk_recording_free(mbk_recording* recording) {
  delete recording;
}

int mbk_call(const mbk_request* request, mbk_answer** answer, mbk_error** error) {
  if (answer == nullptr) return guarded(error, [&] { return null_argument("answer", error); });
  *answer = nullptr;
  return guarded(error, [&] {
    if (request == nullptr) return null_argument("request", error);
    if (request->size != sizeof(mbk_request)) return wrong_size("request", "mbk_request", error);
    for (const auto& [name, list, n, size] :
         {std::tuple<const char*, const void*, std::size_t, std::size_t>("options", request->options,
                                                                         request->option_count, sizeof(mbk_option)),
          {"words", request->words, request->word_count, sizeof(char*)},
          {"recordings", request->recordings, request->recording_count, sizeof(void*)},
          {"documents", request->documents, request->document_count, sizeof(char*)}}) {
      if (auto ok = check_list(name, list, n, size); !ok) return fail(ok.error(), error);
    }
    for (std::size_t k = 0; k < request->recording_count; ++k) {
      if (request->recordings[k] == nullptr) return null_argument("recordings[k]", error);
    }
    auto found = mbk::app::call(call_of(*request));
    if (!found) return fail(found.error(), error);
    auto made = std::make_unique<mbk_answer>();
    made->warnings = mbk::app::warnings_of(*found);
    for (auto& [code, text] : made->warnings) text = mbk::app::in_language(language, text);
    made->answer = std::move(*found);
    for (std::string& message : made->answer.messages) message = mbk::app::in_language(language, message);
    for (const Error& one : made->answer.errors) made->errors.push_back(made_of(one, exit_code_of(one.kind)));
    *answer = made.release();
    return (*answer)->answer.exit_code;
  });
}

const char* mbk_answer_text(const mbk_answer* answer) {
  return answer == nullptr ? "" : answer->answer.text.c_str();
}

int mbk_answer_is_json(const mbk_answer* answer) {
  return answer != nullptr && answer->answer.json ? 1 : 0;
}

int mbk_answer_exit_code(const mbk_answer* answer) {
  return answer == nullptr ? MBK_WRONG_USAGE : answer->answer.exit_code;
}

size_t mbk_answer_warning_count(const mbk_answer* answer) {
  return answer == nullptr ? 0 : answer->warnings.size();
}

const char* mbk_answer_warning_code(const mbk_answer* answer, size_t k) {
  return k < mbk_answer_warning_count(answer) ? answer->warnings[k].first.c_str() : "";
}

const char* mbk_answer_warning_text(const mbk_answer* answer, size_t k) {
  return k < mbk_answer_warning_count(answer) ? answer->warnings[k].second.c_str() : "";
}

size_t mbk_answer_message_count(const mbk_answer* answer) {
  return answer == nullptr ? 0 : answer->answer.messages.size();
}

const char* mbk_answer_message(const mbk_answer* answer, size_t k) {
  return k < mbk_answer_message_count(answer) ? answer->answer.messages[k].c_str() : "";
}

size_t mbk_answer_error_count(const mbk_answer* answer) {
  return answer == nullptr ? 0 : answer->errors.size();
}

const mbk_error* mbk_answer_error(const mbk_answer* answer, size_t k) {
  return k < mbk_answer_error_count(answer) ? &answer->errors[k] : nullptr;
}

void mbk_answer_free(mbk_answer* answer) {
  delete answer;
}

const char* mbk_commands(void) {
  try {
    static const std::string kCommands = mbk::app::describe_commands();
    return kCommands.c_str();
  } catch (...) {  // no memory
    return nullptr;
  }
}
