// The MEX file of mbk for MATLAB and Octave: one entry point to the C interface. Users call the functions of +mbk.
//
//   [result, text, warnings, exit_code, messages] =
//       mbk_mex('call', command, options, words, documents, signals, metadata, events)
//   [signals, metadata, events] = mbk_mex('read', file, options)
//   version = mbk_mex('version')
//
// options: cell row of names and values, all char; signals: struct array with the fields name, unit, values (double,
// real), or []; metadata: as options; events: struct array with the fields time, name, value, or []; words: cell of
// char; documents: cell of results as JSON. result: the JSON document as MATLAB's jsondecode returns it, in full
// precision.
#include <mex.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "mbk.h"

// Where the host records Ctrl-C. Each host has one of these, and acts only after the MEX file returns.
extern "C" {
extern volatile std::sig_atomic_t octave_interrupt_state __attribute__((weak));
bool utIsInterruptPending() __attribute__((weak));
}

namespace {

using Json = nlohmann::ordered_json;

/// Ends the call. MATLAB leaves a MEX file by a jump, so everything else must be destroyed before.
struct Failure {
  std::string identifier, text;
};

std::string text_of(const mxArray* array, const char* what) {
  if (array == nullptr || !mxIsChar(array)) throw Failure{"mbk:usage", std::string(what) + " must be text"};
  char* const text = mxArrayToString(array);
  if (text == nullptr) throw Failure{"mbk:usage", std::string(what) + " cannot be read"};
  std::string copy(text);
  mxFree(text);
  return copy;
}

std::vector<std::string> texts_of(const mxArray* cell, const char* what) {
  std::vector<std::string> texts;
  if (cell == nullptr || mxIsEmpty(cell)) return texts;
  if (!mxIsCell(cell)) throw Failure{"mbk:usage", std::string(what) + " must be a cell array of texts"};
  for (mwIndex k = 0; k < static_cast<mwIndex>(mxGetNumberOfElements(cell)); ++k)
    texts.push_back(text_of(mxGetCell(cell, k), what));
  return texts;
}

/// Names and values, which stay in `texts`.
std::vector<mbk_option> options_of(const std::vector<std::string>& texts) {
  if (texts.size() % 2 != 0) throw Failure{"mbk:usage", "an option has no value; give names and values in pairs"};
  std::vector<mbk_option> options;
  for (std::size_t k = 0; k < texts.size(); k += 2) options.push_back({texts[k].c_str(), texts[k + 1].c_str()});
  return options;
}

const char* identifier_of(int exit_code) {
  switch (exit_code) {
    case MBK_WRONG_USAGE:
      return "mbk:usage";
    case MBK_NOT_USABLE:
      return "mbk:not_usable";
    case MBK_STOPPED:
      return "mbk:stopped";
    default:
      return "mbk:data";
  }
}

[[noreturn]] void fail(mbk_error* error) {
  Failure failure{"mbk:data", "unknown error"};
  if (error != nullptr) {
    const int code = mbk_error_exit_code(error);
    failure.identifier = identifier_of(code);
    failure.text = code == MBK_STOPPED ? "stopped by Ctrl-C" : mbk_error_line(error);
    mbk_error_free(error);
  }
  throw failure;
}

/// Signals in the arrays of the caller, not copied. They must live as long as the call.
class Signals {
 public:
  Signals(const mxArray* given, const mxArray* metadata, const mxArray* events) {
    if (given == nullptr || mxIsEmpty(given)) return;
    if (!mxIsStruct(given)) throw Failure{"mbk:usage", "signals must be a struct"};
    const auto count = static_cast<std::size_t>(mxGetNumberOfElements(given));
    names_.reserve(2 * count);  // their texts stay where they are
    std::vector<mbk_signal> signals;
    for (std::size_t k = 0; k < count; ++k) signals.push_back(signal_of(given, static_cast<mwIndex>(k)));
    mbk_error* error = nullptr;
    const std::vector<std::string> entry_texts = texts_of(metadata, "metadata");
    const std::vector<mbk_option> entries = options_of(entry_texts);
    const std::vector<mbk_event> happened = events_of(events);
    mbk_facts facts{};
    facts.size = sizeof facts;
    facts.metadata = entries.data();
    facts.metadata_count = entries.size();
    facts.events = happened.data();
    facts.event_count = happened.size();
    facts.release = [](void*) {};
    if (mbk_recording_new(signals.data(), signals.size(), &facts, &recording_, &error) != MBK_FINE) {
      fail(error);
    }
  }
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  ~Signals() { mbk_recording_free(recording_); }

  [[nodiscard]] const mbk_recording* recording() const { return recording_; }

 private:
  std::vector<mbk_event> events_of(const mxArray* given) {
    std::vector<mbk_event> events;
    if (given == nullptr || mxIsEmpty(given)) return events;
    if (!mxIsStruct(given)) throw Failure{"mbk:usage", "events must be a struct"};
    const auto count = static_cast<std::size_t>(mxGetNumberOfElements(given));
    event_names_.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
      const auto at = static_cast<mwIndex>(k);
      const mxArray *const time = mxGetField(given, at, "time"), *const value = mxGetField(given, at, "value");
      if (time == nullptr || value == nullptr || mxIsEmpty(time) || mxIsEmpty(value)) {
        throw Failure{"mbk:usage", "an event must have the fields time, name and value"};
      }
      event_names_.push_back(text_of(mxGetField(given, at, "name"), "the name of an event"));
      events.push_back({mxGetScalar(time), event_names_.back().c_str(), mxGetScalar(value)});
    }
    return events;
  }

  mbk_signal signal_of(const mxArray* given, mwIndex k) {
    names_.push_back(text_of(mxGetField(given, k, "name"), "the name of a signal"));
    const std::string& name = names_.back();
    const mxArray* const unit = mxGetField(given, k, "unit");
    names_.push_back(unit == nullptr || mxIsEmpty(unit) ? "" : text_of(unit, "a unit"));
    const mxArray* const values = mxGetField(given, k, "values");
    if (values == nullptr || !mxIsDouble(values) || mxIsComplex(values) || mxIsSparse(values) ||
        mxGetNumberOfDimensions(values) != 2) {
      throw Failure{"mbk:usage", "'" + name + "' must be a full matrix or vector of real numbers (double)"};
    }
    const std::size_t rows = mxGetM(values), columns = mxGetN(values);
    const bool matrix = rows > 1 && columns > 1;
    return {name.c_str(), names_.back().c_str(), mxGetPr(values), rows * columns, matrix ? rows : 0, 1};
  }

  std::vector<std::string> names_, event_names_;
  mbk_recording* recording_ = nullptr;
};

// ---- JSON → MATLAB ----

mxArray* array_of(const Json& json);

/// The name as a valid field name.
std::string field_name(std::string name) {
  for (char& c : name) {
    if (std::strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_", c) == nullptr) c = '_';
  }
  if (name.empty() || std::strchr("0123456789_", name.front()) != nullptr) name.insert(0, "x");
  return name;
}

bool is_number(const Json& json) {
  return json.is_number() || json.is_null();
}

double number_of(const Json& json) {
  return json.is_null() ? mxGetNaN() : json.get<double>();
}

mxArray* column_of(const Json& numbers) {
  mxArray* const column = mxCreateDoubleMatrix(numbers.size(), 1, mxREAL);
  double* to = mxGetPr(column);
  for (const Json& one : numbers) *to++ = number_of(one);
  return column;
}

/// Rows of numbers of equal length; nullptr otherwise.
mxArray* matrix_of(const Json& rows) {
  const std::size_t columns = rows.front().is_array() ? rows.front().size() : 0;
  if (columns == 0) return nullptr;
  for (const Json& row : rows) {
    if (!row.is_array() || row.size() != columns) return nullptr;
    for (const Json& one : row) {
      if (!is_number(one)) return nullptr;
    }
  }
  mxArray* const matrix = mxCreateDoubleMatrix(rows.size(), columns, mxREAL);
  double* const to = mxGetPr(matrix);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < columns; ++c) to[c * rows.size() + r] = number_of(rows[r][c]);
  }
  return matrix;
}

std::vector<std::string> keys_of(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

mxArray* structs_of(const Json& objects) {
  const std::vector<std::string> keys = keys_of(objects.front());
  std::vector<std::string> names;
  for (const std::string& key : keys) names.push_back(field_name(key));
  std::vector<const char*> fields;
  for (const std::string& name : names) fields.push_back(name.c_str());
  mxArray* const made = mxCreateStructMatrix(objects.size(), 1, static_cast<int>(fields.size()), fields.data());
  for (std::size_t k = 0; k < objects.size(); ++k) {
    for (std::size_t f = 0; f < keys.size(); ++f) {
      mxSetFieldByNumber(made, k, static_cast<int>(f), array_of(objects[k].at(keys[f])));
    }
  }
  return made;
}

bool are_alike(const Json& objects) {
  const std::vector<std::string> keys = keys_of(objects.front());
  for (const Json& one : objects) {
    if (!one.is_object() || keys_of(one) != keys) return false;
  }
  return true;
}

mxArray* list_of(const Json& list) {
  if (list.empty()) return mxCreateDoubleMatrix(0, 0, mxREAL);
  bool numbers = true, flags = true, any = false;
  for (const Json& one : list) {
    numbers = numbers && is_number(one);
    any = any || one.is_number();
    flags = flags && one.is_boolean();
  }
  if (numbers && any) return column_of(list);
  if (flags) {
    mxArray* const column = mxCreateLogicalMatrix(list.size(), 1);
    for (std::size_t k = 0; k < list.size(); ++k) mxGetLogicals(column)[k] = list[k].get<bool>();
    return column;
  }
  if (mxArray* const matrix = matrix_of(list); matrix != nullptr) return matrix;
  if (list.front().is_object() && are_alike(list)) return structs_of(list);
  mxArray* const cell = mxCreateCellMatrix(list.size(), 1);
  for (std::size_t k = 0; k < list.size(); ++k) mxSetCell(cell, k, array_of(list[k]));
  return cell;
}

mxArray* array_of(const Json& json) {
  switch (json.type()) {
    case Json::value_t::object:
      return structs_of(Json::array({json}));
    case Json::value_t::array:
      return list_of(json);
    case Json::value_t::string:
      return mxCreateString(json.get_ref<const std::string&>().c_str());
    case Json::value_t::boolean:
      return mxCreateLogicalScalar(json.get<bool>());
    case Json::value_t::null:
      return mxCreateDoubleMatrix(0, 0, mxREAL);
    default:
      return mxCreateDoubleScalar(json.get<double>());
  }
}

// ---- Ctrl-C ----

/// Asks the host, on its own thread, whether Ctrl-C was pressed. The host acts on it when the call has ended.
class Interruption {
 public:
  /// As mbk_request::stop; from any thread.   @param context  an Interruption
  static int pressed(void* context) {
    auto& self = *static_cast<Interruption*>(context);
    if (!self.pressed_ && std::this_thread::get_id() == self.host_ && is_pending()) self.pressed_ = true;
    return self.pressed_ ? 1 : 0;
  }

 private:
  static bool is_pending() {
    if (&octave_interrupt_state != nullptr) return octave_interrupt_state > 0;
    return utIsInterruptPending != nullptr && utIsInterruptPending();
  }

  const std::thread::id host_ = std::this_thread::get_id();
  std::atomic<bool> pressed_ = false;
};

// ---- commands ----

mxArray* warnings_of(const mbk_answer* answer) {
  const char* fields[] = {"code", "message"};
  const std::size_t count = mbk_answer_warning_count(answer);
  mxArray* const warnings = mxCreateStructMatrix(count, 1, 2, fields);
  for (std::size_t k = 0; k < count; ++k) {
    mxSetFieldByNumber(warnings, k, 0, mxCreateString(mbk_answer_warning_code(answer, k)));
    mxSetFieldByNumber(warnings, k, 1, mxCreateString(mbk_answer_warning_text(answer, k)));
  }
  return warnings;
}

/// Errors of files that failed while others succeeded, then messages.
mxArray* messages_of(const mbk_answer* answer) {
  const std::size_t errors = mbk_answer_error_count(answer), said = mbk_answer_message_count(answer);
  mxArray* const messages = mxCreateCellMatrix(errors + said, 1);
  for (std::size_t k = 0; k < errors; ++k) {
    mxSetCell(messages, k, mxCreateString(mbk_error_line(mbk_answer_error(answer, k))));
  }
  for (std::size_t k = 0; k < said; ++k) mxSetCell(messages, errors + k, mxCreateString(mbk_answer_message(answer, k)));
  return messages;
}

void call(int results, mxArray* result[], int count, const mxArray* given[]) {
  if (count != 8) throw Failure{"mbk:usage", "mbk_mex('call', command, options, words, documents, signals, …)"};
  const std::string command = text_of(given[1], "the command");
  const std::vector<std::string> option_texts = texts_of(given[2], "options"), words = texts_of(given[3], "words");
  const std::vector<std::string> documents = texts_of(given[4], "documents");
  const std::vector<mbk_option> options = options_of(option_texts);
  const Signals signals(given[5], given[6], given[7]);
  const mbk_recording* const recording = signals.recording();
  std::vector<const char*> word_texts, document_texts;
  for (const std::string& word : words) word_texts.push_back(word.c_str());
  for (const std::string& document : documents) document_texts.push_back(document.c_str());

  mbk_request request{};
  request.size = sizeof request;
  request.command = command.c_str();
  request.options = options.data();
  request.option_count = options.size();
  request.words = word_texts.data();
  request.word_count = word_texts.size();
  request.documents = document_texts.data();
  request.document_count = document_texts.size();
  request.recordings = &recording;
  request.recording_count = recording == nullptr ? 0 : 1;
  Interruption interruption;
  request.stop = &Interruption::pressed;
  request.context = &interruption;
  mbk_answer* answer = nullptr;
  mbk_error* error = nullptr;
  mbk_call(&request, &answer, &error);
  if (answer == nullptr) fail(error);
  const std::string text = mbk_answer_text(answer);
  const bool json = mbk_answer_is_json(answer) != 0;
  result[0] = json ? array_of(Json::parse(text, nullptr, false)) : mxCreateString(text.c_str());
  if (results > 1) result[1] = mxCreateString(text.c_str());
  if (results > 2) result[2] = warnings_of(answer);
  if (results > 3) result[3] = mxCreateDoubleScalar(mbk_answer_exit_code(answer));
  if (results > 4) result[4] = messages_of(answer);
  mbk_answer_free(answer);
}

mxArray* metadata_of(const mbk_recording* recording) {
  const std::size_t count = mbk_recording_metadata_count(recording);
  mxArray* const entries = mxCreateCellMatrix(count, 2);
  for (std::size_t k = 0; k < count; ++k) {
    const mbk_option entry = mbk_recording_metadata(recording, k);
    mxSetCell(entries, k, mxCreateString(entry.name));
    mxSetCell(entries, count + k, mxCreateString(entry.value));
  }
  return entries;
}

mxArray* events_of(const mbk_recording* recording) {
  const char* fields[] = {"time", "name", "value"};
  const std::size_t count = mbk_recording_event_count(recording);
  mxArray* const events = mxCreateStructMatrix(count, 1, 3, fields);
  for (std::size_t k = 0; k < count; ++k) {
    const mbk_event event = mbk_recording_event(recording, k);
    mxSetFieldByNumber(events, k, 0, mxCreateDoubleScalar(event.time));
    mxSetFieldByNumber(events, k, 1, mxCreateString(event.name));
    mxSetFieldByNumber(events, k, 2, mxCreateDoubleScalar(event.value));
  }
  return events;
}

void read(int results, mxArray* result[], int count, const mxArray* given[]) {
  if (count != 3) throw Failure{"mbk:usage", "mbk_mex('read', file, options)"};
  const std::string file = text_of(given[1], "the name of the file");
  const std::vector<std::string> option_texts = texts_of(given[2], "options");
  const std::vector<mbk_option> options = options_of(option_texts);
  mbk_recording* recording = nullptr;
  mbk_error* error = nullptr;
  if (mbk_read(file.c_str(), options.data(), options.size(), &recording, &error) != MBK_FINE) fail(error);
  const char* fields[] = {"name", "unit", "values"};
  const std::size_t signals = mbk_recording_signal_count(recording);
  result[0] = mxCreateStructMatrix(signals, 1, 3, fields);
  for (std::size_t k = 0; k < signals; ++k) {
    std::size_t samples = 0;
    const double* const values = mbk_recording_signal_values(recording, k, &samples);
    mxArray* const column = mxCreateDoubleMatrix(samples, 1, mxREAL);
    std::memcpy(mxGetPr(column), values, samples * sizeof(double));
    mxSetFieldByNumber(result[0], k, 0, mxCreateString(mbk_recording_signal_name(recording, k)));
    mxSetFieldByNumber(result[0], k, 1, mxCreateString(mbk_recording_signal_unit(recording, k)));
    mxSetFieldByNumber(result[0], k, 2, column);
  }
  if (results > 1) result[1] = metadata_of(recording);
  if (results > 2) result[2] = events_of(recording);
  mbk_recording_free(recording);
}

void run(int results, mxArray* result[], int count, const mxArray* given[]) {
  const std::string what = count > 0 ? text_of(given[0], "what to do") : std::string();
  if (what == "call") {
    call(results, result, count, given);
  } else if (what == "read") {
    read(results, result, count, given);
  } else if (what == "version") {
    result[0] = mxCreateString(mbk_version());
  } else {
    throw Failure{"mbk:usage", "mbk_mex is internal; call the functions of +mbk (see 'help mbk.measure')"};
  }
}

}  // namespace

void mexFunction(int results, mxArray* result[], int count, const mxArray* given[]) {
  static char identifier[32], text[4096];
  identifier[0] = '\0';
  mbk_set_language(MBK_FOR_MATLAB);
  try {
    run(results, result, count, given);
  } catch (const Failure& failure) {
    std::snprintf(identifier, sizeof identifier, "%s", failure.identifier.c_str());
    std::snprintf(text, sizeof text, "%s", failure.text.c_str());
  } catch (const std::exception& error) {
    std::snprintf(identifier, sizeof identifier, "mbk:data");
    std::snprintf(text, sizeof text, "%s", error.what());
  }
  if (identifier[0] != '\0') mexErrMsgIdAndTxt(identifier, "%s", text);
}
