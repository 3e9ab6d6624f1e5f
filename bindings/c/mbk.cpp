#include "bindings/c/mbk.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iterator>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <thread>
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
  std::shared_ptr<const mbk::Recording> meaning =
      nullptr;  ///< of mbk_recording_meaning; its channels stand in `signals`
};

struct mbk_answer {
  mbk::app::Answer answer;
  std::vector<std::pair<std::string, std::string>> warnings;
  std::vector<mbk_error> errors;
  std::vector<std::shared_ptr<const mbk::recording::InMemory>> recordings;
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

using mbk::app::Language;

/// Language that messages are written for, in the whole process.
std::atomic<Language> language = Language::c;

/// The language of a call.   @param stated  by its structure; 0: that of the process
Language language_of(int stated) {
  if (stated == MBK_FOR_PYTHON) return Language::python;
  return stated == MBK_FOR_MATLAB ? Language::matlab : language.load();
}

/// Where an error goes, and whom it is written for.
struct Reader {
  mbk_error** error;
  Language spoken = language;
};

mbk_error made_of(const Error& given, int exit_code, Language spoken) {
  Error error = mbk::app::in_language(spoken, given);
  std::string line = error.line();
  return {std::move(error), exit_code, std::move(line)};
}

int fail(const Error& error, Reader to, int exit_code) {
  if (to.error != nullptr) *to.error = new mbk_error(made_of(error, exit_code, to.spoken));
  return exit_code;
}

int fail(const Error& error, Reader to) {
  return fail(error, to, exit_code_of(error.kind));
}

/// Runs `work` and returns its exceptions as errors, because C has no exceptions.
template <class Work>
int guarded(Reader to, const Work& work) noexcept {
  if (to.error != nullptr) *to.error = nullptr;
  try {
    try {
      return work();
    } catch (const mbk::Stopped&) {
      return fail({ErrorKind::data, "stopped", "", ""}, to, MBK_STOPPED);
    } catch (const std::bad_alloc&) {
      return fail({ErrorKind::data, "not enough memory", "", ""}, to);
    } catch (const std::exception& thrown) {
      return fail({ErrorKind::data, thrown.what(), "", ""}, to);
    }
  } catch (...) {  // no memory for the error either
    return MBK_BAD_DATA;
  }
}

/// A structure of the caller as this version has it. What an older header does not have is 0.
/// @param first_size  [bytes] in version 1    @fails  usage: a size of no version
template <class Structure>
Result<Structure> as_of_now(const Structure& given, std::size_t first_size, const char* what, const char* type) {
  if (given.size != first_size && given.size != sizeof(Structure)) {
    return mbk::bad_usage(std::string("the size of the ") + what + " differs from the size in this version",
                          std::string("set 'size' to sizeof(") + type + ")");
  }
  Structure made{};
  std::memcpy(&made, &given, given.size);
  made.size = sizeof(Structure);
  return made;
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

constexpr const char* kPassAddress = "pass the address of a variable";

int null_argument(const char* name, Reader to) {
  return fail({ErrorKind::usage, std::string("'") + name + "' is NULL", kPassAddress, ""}, to);
}

std::string text_of(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

/// @param rests  what the values leave of 64-bit integers; NULL: nothing
Result<InMemory::Signal> signal_of(const mbk_signal& given, const std::shared_ptr<const void>& keeper,
                                   const short* rests) {
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
  for (std::size_t k = 0; rests != nullptr && k < given.count; ++k) signal.rests.put(k, rests[k], given.count);
  return signal;
}

/// As they were read, or as they were given.
const std::map<std::string, std::string>& metadata_of(const mbk_recording& recording) {
  return recording.meaning ? recording.meaning->metadata : recording.signals->metadata();
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

/// Asks the host on the thread of the call, not more often than it must.
class Interruption {
 public:
  explicit Interruption(const mbk_request& request) : ask_(request.interrupted), context_(request.context) {}
  bool operator()() {
    if (found_ || ask_ == nullptr) return found_;
    if (std::this_thread::get_id() != caller_ || Clock::now() - last_ < kPause) return false;
    last_ = Clock::now();
    found_ = ask_(context_) != 0;
    return found_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kPause{50};
  int (*ask_)(void*);
  void* context_;
  const std::thread::id caller_ = std::this_thread::get_id();
  Clock::time_point last_ = Clock::now();
  std::atomic<bool> found_ = false;
};

Result<mbk_request> request_of(const mbk_request& given) {
  const mbk_request request = MBK_TRY(as_of_now(given, offsetof(mbk_request, language), "request", "mbk_request"));
  for (const auto& [name, list, n, size] : {std::tuple<const char*, const void*, std::size_t, std::size_t>(
                                                "options", request.options, request.option_count, sizeof(mbk_option)),
                                            {"words", request.words, request.word_count, sizeof(char*)},
                                            {"recordings", request.recordings, request.recording_count, sizeof(void*)},
                                            {"documents", request.documents, request.document_count, sizeof(char*)}}) {
    MBK_TRY(check_list(name, list, n, size));
  }
  for (std::size_t k = 0; k < request.recording_count; ++k) {
    if (request.recordings[k] == nullptr) return mbk::bad_usage("'recordings[k]' is NULL", kPassAddress);
  }
  return request;
}

/// Both arguments are used as long as the call runs.
mbk::app::Call call_of(const mbk_request& request, Interruption& interruption) {
  mbk::app::Call call{.command = text_of(request.command),
                      .options = options_of(request.options, request.option_count),
                      .words = texts_of(request.words, request.word_count),
                      .recordings = {},
                      .documents = texts_of(request.documents, request.document_count)};
  for (std::size_t k = 0; k < request.recording_count; ++k) call.recordings.push_back(request.recordings[k]->signals);
  if (request.stop != nullptr || request.interrupted != nullptr) {
    call.stop = [&] { return (request.stop != nullptr && request.stop(request.context) != 0) || interruption(); };
  }
  if (request.progress != nullptr) {
    call.progress = [&request](std::string_view what, double fraction) {
      request.progress(request.context, std::string(what).c_str(), fraction);
    };
  }
  return call;
}

/// Answers a request.   @param work  gets the call, the answer to fill and the language; returns Result<void>
template <class Work>
int answered(const mbk_request* given, mbk_answer** answer, mbk_error** error, const Work& work) {
  if (answer == nullptr) return guarded({error}, [&] { return null_argument("answer", {error}); });
  *answer = nullptr;
  return guarded({error}, [&] {
    if (given == nullptr) return null_argument("request", {error});
    const auto request = request_of(*given);
    if (!request) return fail(request.error(), {error});
    const Reader reader{error, language_of(request->language)};
    Interruption interruption(*request);
    auto made = std::make_unique<mbk_answer>();
    if (auto done = work(call_of(*request, interruption), *made, reader.spoken); !done)
      return fail(done.error(), reader);
    *answer = made.release();
    return (*answer)->answer.exit_code;
  });
}

}  // namespace

int mbk_api_version(void) {
  return MBK_API_VERSION;
}

void mbk_set_language(int to) {
  language = to == MBK_FOR_C ? Language::c : language_of(to);
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
  if (recording == nullptr) return guarded({error}, [&] { return null_argument("recording", {error}); });
  *recording = nullptr;
  return guarded({error}, [&] {
    constexpr mbk_facts kNone = {.size = sizeof(mbk_facts)};
    const auto whole_facts =
        as_of_now(facts == nullptr ? kNone : *facts, offsetof(mbk_facts, language), "facts", "mbk_facts");
    if (!whole_facts) return fail(whole_facts.error(), {error});
    const mbk_facts& known = *whole_facts;
    const Reader reader{error, language_of(known.language)};
    std::shared_ptr<const void> keeper;
    if (known.release != nullptr) {
      keeper = std::shared_ptr<const void>(
          signals, [release = known.release, owner = known.owner](const void*) { release(owner); });
    }
    for (const auto& [name, list, n, size] :
         {std::tuple<const char*, const void*, std::size_t, std::size_t>("signals", signals, count, sizeof(mbk_signal)),
          {"metadata", known.metadata, known.metadata_count, sizeof(mbk_option)},
          {"events", known.events, known.event_count, sizeof(mbk_event)}}) {
      if (auto ok = check_list(name, list, n, size); !ok) return fail(ok.error(), reader);
    }
    std::vector<InMemory::Signal> made;
    for (std::size_t k = 0; k < count; ++k) {
      auto signal = signal_of(signals[k], keeper, known.rests == nullptr ? nullptr : known.rests[k]);
      if (!signal) return fail(signal.error(), reader);
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
    if (!whole) return fail(whole.error(), reader);
    *recording = new mbk_recording{std::make_shared<const InMemory>(std::move(*whole))};
    return static_cast<int>(MBK_FINE);
  });
}

int mbk_read(const char* file, const mbk_option* options, size_t count, mbk_recording** recording, mbk_error** error) {
  if (recording == nullptr) return guarded({error}, [&] { return null_argument("recording", {error}); });
  *recording = nullptr;
  return guarded({error}, [&] {
    if (file == nullptr) return null_argument("file", {error});
    if (auto ok = check_list("options", options, count, sizeof(mbk_option)); !ok) return fail(ok.error(), {error});
    const mbk::app::Call call{.command = "read",
                              .options = options_of(options, count),
                              .words = {text_of(file)},
                              .recordings = {},
                              .documents = {}};
    auto found = mbk::app::read(call);
    if (!found) return fail(found.error(), {error});
    if (found->size() != 1) {
      return fail({ErrorKind::usage, "holds " + std::to_string(found->size()) + " recordings",
                   "choose one with --trial", text_of(file)},
                  {error});
    }
    *recording = new mbk_recording{std::move(found->front())};
    return static_cast<int>(MBK_FINE);
  });
}

int mbk_recording_meaning(const mbk_recording* recording, int language_stated, mbk_recording** meaning,
                          mbk_error** error) {
  if (meaning == nullptr) return guarded({error}, [&] { return null_argument("meaning", {error}); });
  *meaning = nullptr;
  return guarded({error}, [&] {
    if (recording == nullptr) return null_argument("recording", {error});
    const Reader reader{error, language_of(language_stated)};
    auto read = recording->signals->read({});
    if (!read) return fail(read.error(), reader);
    for (std::string& note : read->notes) note = mbk::app::in_language(reader.spoken, note);
    auto signals = std::make_shared<const InMemory>(InMemory::of(std::move(*read)));
    std::shared_ptr<const mbk::Recording> whole = signals->recording();
    *meaning = new mbk_recording{std::move(signals), std::move(whole)};
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

const double* mbk_recording_values(const mbk_recording* recording, const char* name, size_t* count) {
  if (count != nullptr) *count = 0;
  if (recording == nullptr || name == nullptr) return nullptr;
  const InMemory::Signal* const signal = recording->signals->find(name);
  if (signal == nullptr) return nullptr;
  if (count != nullptr) *count = static_cast<size_t>(signal->values.size());
  return signal->values.data();
}

const char* mbk_recording_signal_frame(const mbk_recording* meaning, size_t k) {
  if (meaning == nullptr || !meaning->meaning || k == 0 || k > meaning->meaning->channels.size()) return "";
  return meaning->meaning->channels[k - 1].frame.c_str();  // the time comes first
}

size_t mbk_recording_note_count(const mbk_recording* meaning) {
  return meaning == nullptr || !meaning->meaning ? 0 : meaning->meaning->notes.size();
}

const char* mbk_recording_note(const mbk_recording* meaning, size_t k) {
  return k < mbk_recording_note_count(meaning) ? meaning->meaning->notes[k].c_str() : "";
}

size_t mbk_recording_source_count(const mbk_recording* meaning) {
  return meaning == nullptr || !meaning->meaning ? 0 : meaning->meaning->sources.size();
}

mbk_source mbk_recording_source(const mbk_recording* meaning, size_t k) {
  if (k >= mbk_recording_source_count(meaning)) return {"", "", "", ""};
  const mbk::SourceFile& source = meaning->meaning->sources[k];
  return {source.path.c_str(), source.format.c_str(), source.sha256.c_str(), source.trial.c_str()};
}

size_t mbk_recording_metadata_count(const mbk_recording* recording) {
  return recording == nullptr ? 0 : metadata_of(*recording).size();
}

mbk_option mbk_recording_metadata(const mbk_recording* recording, size_t k) {
  if (k >= mbk_recording_metadata_count(recording)) return {"", ""};
  const auto entry = std::next(metadata_of(*recording).begin(), static_cast<std::ptrdiff_t>(k));
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
  return answered(request, answer, error,
                  [](const mbk::app::Call& call, mbk_answer& made, Language to) -> Result<void> {
                    made.answer = MBK_TRY(mbk::app::call(call));
                    made.warnings = mbk::app::warnings_of(made.answer);
                    for (auto& [code, text] : made.warnings) text = mbk::app::in_language(to, text);
                    for (std::string& message : made.answer.messages) message = mbk::app::in_language(to, message);
                    for (const Error& one : made.answer.errors)
                      made.errors.push_back(made_of(one, exit_code_of(one.kind), to));
                    return {};
                  });
}

int mbk_read_all(const mbk_request* request, mbk_answer** answer, mbk_error** error) {
  return answered(request, answer, error, [](const mbk::app::Call& call, mbk_answer& made, Language) -> Result<void> {
    made.recordings = MBK_TRY(mbk::app::read(call));
    return {};
  });
}

size_t mbk_answer_recording_count(const mbk_answer* answer) {
  return answer == nullptr ? 0 : answer->recordings.size();
}

mbk_recording* mbk_answer_recording(const mbk_answer* answer, size_t k) {
  if (k >= mbk_answer_recording_count(answer)) return nullptr;
  return new (std::nothrow) mbk_recording{answer->recordings[k]};
}

int mbk_in_language(const char* text, int language_stated, mbk_answer** answer, mbk_error** error) {
  if (answer == nullptr) return guarded({error}, [&] { return null_argument("answer", {error}); });
  *answer = nullptr;
  return guarded({error}, [&] {
    auto made = std::make_unique<mbk_answer>();
    made->answer.text = mbk::app::in_language(language_of(language_stated), text_of(text));
    *answer = made.release();
    return static_cast<int>(MBK_FINE);
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
