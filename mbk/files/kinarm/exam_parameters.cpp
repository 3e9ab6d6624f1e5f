#include "mbk/files/kinarm/exam_parameters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace mbk::recording {
namespace {

constexpr std::size_t kMaxValues = 64;   ///< of one parameter that are copied; tables of stimuli are longer
constexpr std::size_t kLongestKey = 63;  ///< the longest name that a field of MATLAB can have

/// Words of groups and names that speak of a person or of a file, whose name often does.
constexpr auto kPersonal = std::to_array<std::string_view>(
    {"SUBJECT",   "PATIENT",   "PARTICIPANT", "PERSON", "NAME",   "BIRTH",   "DOB",     "OPERATOR", "EXAMINER",
     "THERAPIST", "CLINICIAN", "COMMENT",     "NOTES",  "FILE",   "ADDRESS", "PHONE",   "MAIL",     "MRN",
     "GENDER",    "SEX",       "AGE",         "HANDED", "HEIGHT", "WEIGHT",  "DIAGNOS", "STUDY",    "USER"});
/// Groups whose texts are copied.
constexpr auto kTechnical =
    std::to_array<std::string_view>({"TRIAL", "ANALOG", "POINT", "CALIBRATION", "RIGHT_KINARM", "LEFT_KINARM",
                                     "TARGET_TABLE", "TP_TABLE", "LOAD_TABLE", "EVENTS"});
/// Texts of EXPERIMENT that are taken.
constexpr auto kOfExperiment =
    std::to_array<std::string_view>({"START_DATE_TIME", "TASK_PROTOCOL", "TASK_PROGRAM", "TASK_VERSION",
                                     "TASK_PROGRAM_VERSION", "TASK_PROGRAM_BUILD_TDK", "DEX_VERSION"});

std::string capitals(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return result;
}

/// AGE is a word of SUBJECT_AGE and not of STAGE; SUBJECT is also found in SUBJECTS.
bool speaks_of(std::string_view name, std::string_view word) {
  for (std::size_t at = name.find(word); at != name.npos; at = name.find(word, at + 1)) {
    const auto is_letter = [&](std::size_t k) { return k < name.size() && name[k] >= 'A' && name[k] <= 'Z'; };
    const bool begins = at == 0 || !is_letter(at - 1);
    const bool ends = !is_letter(at + word.size());
    if (word.size() > 4 || (begins && ends) || (word == "NAME" && ends)) return true;
  }
  return false;
}

bool is_personal(std::string_view group, std::string_view name) {
  return std::ranges::any_of(kPersonal,
                             [&](std::string_view word) { return speaks_of(group, word) || speaks_of(name, word); });
}

bool is_copied(std::string_view group, std::string_view name, const ExamValue& value) {
  if (is_personal(group, name)) return false;
  if (!value.is_text) return true;
  if (group == "EXPERIMENT") return std::ranges::find(kOfExperiment, name) != kOfExperiment.end();
  return std::ranges::find(kTechnical, group) != kTechnical.end();
}

/// GROUP_NAME as a name that MATLAB can have; "" where none can be made.
std::string key_of(std::string_view group, std::string_view name) {
  std::string key = fmt::format("{}_{}", group, name);
  for (char& c : key) {
    const bool letter = (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    if (!letter && (c < '0' || c > '9')) c = '_';
  }
  const bool begins = !key.empty() && ((key[0] >= 'A' && key[0] <= 'Z') || (key[0] >= 'a' && key[0] <= 'z'));
  return begins && key.size() <= kLongestKey ? key : std::string();
}

std::string value_text(const ExamValue& value) {
  if (value.is_text) return fmt::format("{}", fmt::join(value.texts, "; "));
  std::string text;
  for (const double number : value.numbers) {
    const auto real = static_cast<float>(number);  // the shortest text that represents the stored value
    text += text.empty() ? "" : " ";
    text += static_cast<double>(real) == number ? fmt::format("{}", real) : fmt::format("{:.15g}", number);
  }
  return text;
}

}  // namespace

ExamParameters ExamParameters::of(const C3dParameters& parameters) {
  ExamParameters all;
  for (const std::string_view group : parameters.groups()) {
    for (const std::string_view name : parameters.names(group)) {
      ExamValue value;
      value.is_text = parameters.find(group, name)->type == C3dParameter::Type::text;
      if (value.is_text) {
        value.texts = parameters.texts(group, name);
      } else {
        value.numbers = parameters.numbers(group, name);
      }
      all.add(group, name, std::move(value));
    }
  }
  all.drop_unused();
  return all;
}

void ExamParameters::add(std::string_view group, std::string_view name, ExamValue value) {
  groups_[capitals(group)].try_emplace(capitals(name), std::move(value));
}

void ExamParameters::add(const ExamParameters& others) {
  for (const auto& [group, values] : others.groups_) {
    auto& mine = groups_[group];
    for (const auto& [name, value] : values) mine.try_emplace(name, value);
  }
}

void ExamParameters::drop_unused() {
  std::erase_if(groups_, [&](const auto& group) { return number(group.first, "USED") == 0.0; });
}

void ExamParameters::remove_signals() {
  for (const char* group : {"RIGHT_HANDX", "RIGHT_HANDY", "LEFT_HANDX", "LEFT_HANDY", "FILE_NAME"})
    groups_.erase(group);
  // Its statements on points and analog channels refer to its own, which do not exist.
  groups_.erase("POINT");
  const auto analog = groups_.find("ANALOG");
  if (analog != groups_.end()) std::erase_if(analog->second, [](const auto& value) { return value.first != "RATE"; });
}

const ExamValue* ExamParameters::find(std::string_view group, std::string_view name) const {
  const auto values = groups_.find(group);
  if (values == groups_.end()) return nullptr;
  const auto value = values->second.find(name);
  return value == values->second.end() ? nullptr : &value->second;
}

std::optional<double> ExamParameters::number(std::string_view group, std::string_view name) const {
  const ExamValue* value = find(group, name);
  if (value == nullptr || value->numbers.empty()) return std::nullopt;
  return value->numbers.front();
}

std::string ExamParameters::text(std::string_view group, std::string_view name) const {
  const ExamValue* value = find(group, name);
  return value == nullptr || value->texts.empty() ? std::string() : value->texts.front();
}

std::vector<std::string> ExamParameters::personal_texts() const {
  std::vector<std::string> found;
  for (const auto& [group, values] : groups_) {
    for (const auto& [name, value] : values) {
      const bool says = std::ranges::any_of(
          value.texts, [](const std::string& text) { return text.find_first_not_of(" \t") != std::string::npos; });
      if (value.is_text && says && is_personal(group, name)) found.push_back(group + ":" + name);
    }
  }
  return found;
}

void ExamParameters::describe(std::map<std::string, std::string>& metadata, std::vector<std::string>& notes) const {
  std::vector<std::string> stays, long_ones;
  for (const auto& [group, values] : groups_) {
    if (group == "POINT" || group == "EVENTS" || group == "EVENT") continue;  // of the arrays and events themselves
    std::size_t left = 0;
    for (const auto& [name, value] : values) {
      if (group == "ANALOG" && name != "RATE") continue;
      const std::string key = key_of(group, name);
      if (!is_copied(group, name, value) || key.empty()) {
        ++left;
        if (!is_personal(group, "")) stays.push_back(fmt::format("{}:{}", group, name));
      } else if (std::max(value.texts.size(), value.numbers.size()) > kMaxValues) {
        long_ones.push_back(fmt::format("{}:{}", group, name));
      } else {
        metadata[key] = value_text(value);
      }
    }
    if (left > 0 && is_personal(group, "")) stays.push_back(fmt::format("all of {}", group));
  }
  if (!stays.empty()) {
    notes.push_back(
        fmt::format("not copied because it may identify the participant; it remains in the exam: {}, and the name of "
                    "the file it was saved as",
                    fmt::join(stays, ", ")));
  } else {
    notes.emplace_back("not copied because it may identify the participant: the name of the file it was saved as");
  }
  if (!long_ones.empty()) {
    notes.push_back(
        fmt::format("not copied because they have more than {} values: {}", kMaxValues, fmt::join(long_ones, ", ")));
  }
}

}  // namespace mbk::recording
