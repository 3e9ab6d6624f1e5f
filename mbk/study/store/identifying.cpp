#include "mbk/study/store/identifying.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "mbk/study/store/trial_names.h"

namespace mbk::store {
namespace {

/// "PatientName", "patient_name", "PATIENT NAME" → patient, name
std::vector<std::string> words_of(const std::string& key) {
  const auto is_upper = [](char c) { return c >= 'A' && c <= 'Z'; };
  const auto is_lower = [](char c) { return c >= 'a' && c <= 'z'; };
  std::vector<std::string> words;
  std::string word;
  const auto end_word = [&] {
    if (!word.empty()) words.push_back(std::exchange(word, ""));
  };
  for (std::size_t k = 0; k < key.size(); ++k) {
    const char c = key[k];
    if (!is_upper(c) && !is_lower(c)) {
      end_word();
      continue;
    }
    if (is_upper(c) && k > 0 && is_lower(key[k - 1])) end_word();
    word += is_upper(c) ? static_cast<char>(c - 'A' + 'a') : c;
  }
  end_word();
  return words;
}

template <std::size_t Size>
bool any_of(const std::vector<std::string>& words, const std::array<std::string_view, Size>& among) {
  return std::ranges::any_of(words,
                             [&](const std::string& word) { return std::ranges::find(among, word) != among.end(); });
}

bool is_identifying(const std::string& key) {
  constexpr std::array<std::string_view, 19> kAlone = {
      "surname", "forename", "firstname", "lastname", "fullname", "initials", "birth", "birthday",  "birthdate", "dob",
      "ssn",     "mrn",      "insurance", "address",  "email",    "mail",     "phone", "telephone", "passport"};
  constexpr std::array<std::string_view, 3> kOf = {"name", "id", "identifier"};
  constexpr std::array<std::string_view, 15> kPeople = {"patient", "subject",  "person",   "participant", "first",
                                                        "last",    "family",   "given",    "full",        "middle",
                                                        "sur",     "operator", "examiner", "rater",       "user"};
  const std::vector<std::string> words = words_of(key);
  if (any_of(words, kAlone)) return true;
  if (words == std::vector<std::string>{"name"} || words == std::vector<std::string>{"patient"}) return true;
  return any_of(words, kOf) && any_of(words, kPeople);
}

}  // namespace

std::vector<std::string> identifying_entries(const std::map<std::string, std::string>& metadata) {
  std::vector<std::string> found;
  for (const auto& [key, value] : metadata) {
    const bool named = key == "rater" && !rater_code(value);
    if (!value.empty() && (named || is_identifying(key))) found.push_back(key);
  }
  return found;
}

}  // namespace mbk::store
