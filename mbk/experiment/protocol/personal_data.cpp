#include "mbk/experiment/protocol/personal_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

#include "mbk/base/core/printable.h"

namespace mbk::protocol {
namespace {

/// With its title they make a person.
constexpr std::array<std::string_view, 12> kTitles = {"Mr",  "Mrs",  "Ms",   "Dr",   "Prof",     "Professor",
                                                      "Mme", "Mlle", "Herr", "Frau", "Monsieur", "Madame"};

/// In small letters, whole words.
constexpr std::array<std::string_view, 12> kBirth = {"born",       "birth", "birthday", "birthdate",
                                                     "dob",        "geb",   "geboren",  "geburtsdatum",
                                                     "geburtstag", "né",    "née",      "naissance"};

/// How words begin that name documents, offices and dates, in small letters.
constexpr std::array<std::string_view, 73> kOfDocuments = {
    "form",      "consent", "inform", "ethic",  "ethik",   "committ", "board",    "stud",    "protocol",
    "protokoll", "version", "approv", "review", "institu", "refer",   "number",   "nummer",  "participa",
    "patient",   "subject", "person", "volunt", "proband", "univers", "hospital", "clinic",  "klinik",
    "spital",    "depart",  "facult", "school", "laborat", "lab",     "researc",  "sheet",   "document",
    "dokument",  "paper",   "folder", "ordner", "binder",  "archiv",  "cabinet",  "drawer",  "shelf",
    "page",      "part",    "append", "annex",  "sign",    "written", "oral",     "electro", "digital",
    "english",   "german",  "french", "adult",  "minor",   "parent",  "guardian", "group",   "pilot",
    "trial",     "project", "code",   "file",   "letter",  "agree",   "declara",  "einwill", "erklär",
    "kantonal"};
constexpr std::array<std::string_view, 5> kEndsOfDocuments = {"kommission", "ausschuss", "formular", "erklärung",
                                                              "bogen"};
constexpr std::array<std::string_view, 12> kMonths = {"January",   "February", "March",    "April",
                                                      "May",       "June",     "July",     "August",
                                                      "September", "October",  "November", "December"};

bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80U;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// The first letter of a word in small, and whether it was a capital; of ASCII, Latin-1 and Latin Extended-A.
struct FirstLetter {
  std::string small;
  std::size_t bytes = 1;
  bool capital = false;
};

FirstLetter first_letter(std::string_view word) {
  const auto byte = static_cast<unsigned char>(word[0]);
  if (byte < 0x80U || word.size() < 2) {
    return {std::string(1, static_cast<char>(std::tolower(byte))), 1, std::isupper(byte) != 0};
  }
  std::uint32_t code = ((byte & 0x1FU) << 6U) | (static_cast<unsigned char>(word[1]) & 0x3FU);
  const bool latin1 = code >= 0xC0U && code <= 0xDEU && code != 0xD7U;
  const bool odd_capitals = (code >= 0x139U && code <= 0x148U) || (code >= 0x179U && code <= 0x17EU);
  const bool extended = code >= 0x100U && code <= 0x17FU && ((code % 2U == 0U) != odd_capitals);
  const bool capital = (byte & 0xE0U) == 0xC0U && (latin1 || extended);
  if (capital) code += latin1 ? 0x20U : 1U;
  return {{static_cast<char>(0xC0U | (code >> 6U)), static_cast<char>(0x80U | (code & 0x3FU))}, 2, capital};
}

struct Word {
  std::string_view text;
  std::size_t begin = 0;
  std::string small;     ///< the first letter in small
  bool capital = false;  ///< it alone is a capital, as in names
  bool initial = false;  ///< one capital with a full stop: "J."

  [[nodiscard]] std::size_t end() const { return begin + text.size() + (initial ? 1 : 0); }
};

std::vector<Word> words_of(std::string_view text) {
  std::vector<Word> words;
  for (std::size_t i = 0; i < text.size();) {
    if (!is_letter(text[i])) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < text.size() && (is_letter(text[end]) || (text[end] == '\'' && end + 1 < text.size()))) ++end;
    Word word{text.substr(i, end - i), i, {}, false, false};
    const FirstLetter first = first_letter(word.text);
    const std::string_view rest = word.text.substr(first.bytes);
    word.small = first.small + std::string(rest);
    const bool after_digit = i > 0 && is_digit(text[i - 1]);
    const bool before_digit = end < text.size() && is_digit(text[end]);
    word.initial = first.capital && rest.empty() && end < text.size() && text[end] == '.';
    word.capital = first.capital && !rest.empty() && !after_digit && !before_digit &&
                   std::ranges::any_of(rest, [](char c) { return std::islower(static_cast<unsigned char>(c)) != 0; });
    words.push_back(std::move(word));
    i = end;
  }
  return words;
}

std::string in_small(std::string_view text) {
  std::string small(text);
  std::ranges::transform(small, small.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return small;
}

bool holds_email(std::string_view text) {
  const auto part = [](char c) { return is_letter(c) || is_digit(c) || c == '.' || c == '-' || c == '_' || c == '+'; };
  for (std::size_t at = text.find('@'); at != std::string_view::npos; at = text.find('@', at + 1)) {
    if (at == 0 || !part(text[at - 1])) continue;
    std::size_t end = at + 1;
    while (end < text.size() && part(text[end])) ++end;
    const std::string_view domain = text.substr(at + 1, end - at - 1);
    const std::size_t dot = domain.find('.');
    if (dot != std::string_view::npos && dot > 0 && dot + 2 < domain.size() && is_letter(domain[dot + 1])) return true;
  }
  return false;
}

/// "1.2.1984", "01/02/84", "1984-02-01", or a year from 1900 to 2099.
bool holds_date_or_year(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    std::vector<int> numbers;
    char between = 0;
    std::size_t at = i;
    while (at < text.size() && is_digit(text[at]) && numbers.size() < 3) {
      int number = 0;
      for (int digits = 0; at < text.size() && is_digit(text[at]); ++at, ++digits) {
        number = digits < 4 ? 10 * number + (text[at] - '0') : -1;
      }
      numbers.push_back(number);
      if (number >= 1900 && number <= 2099) return true;
      if (at + 1 >= text.size() || (text[at] != '.' && text[at] != '/' && text[at] != '-')) break;
      if (between != 0 && text[at] != between) break;
      between = text[at++];
    }
    if (numbers.size() == 3 && std::ranges::all_of(numbers, [](int n) { return n >= 0 && n < 100; })) return true;
    i = std::max(at, i + 1);
  }
  return false;
}

bool tells_birth(std::string_view text, const std::vector<Word>& words) {
  const bool word = std::ranges::any_of(
      words, [](const Word& one) { return std::ranges::find(kBirth, in_small(one.text)) != kBirth.end(); });
  return (word || in_small(text).find("d.o.b") != std::string::npos) && holds_date_or_year(text);
}

/// Nothing but a space, a full stop or a comma between them.
bool adjoin(std::string_view text, const Word& one, const Word& next) {
  const std::string_view between = text.substr(one.end(), next.begin - one.end());
  return between == " " || between == ", " || between == "," || between == ". " || (between.empty() && one.initial);
}

bool of_documents(const Word& word) {
  return std::ranges::any_of(kOfDocuments, [&](std::string_view begin) { return word.small.starts_with(begin); }) ||
         std::ranges::any_of(kEndsOfDocuments, [&](std::string_view end) { return word.small.ends_with(end); }) ||
         std::ranges::find(kMonths, word.text) != kMonths.end();
}

}  // namespace

PersonalDetail personal_detail(std::string_view text, bool reference) {
  if (holds_email(text)) return PersonalDetail::email;
  const std::vector<Word> words = words_of(text);
  if (tells_birth(text, words)) return PersonalDetail::birth;
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const Word& one = words[i];
    const Word& next = words[i + 1];
    if (!adjoin(text, one, next)) continue;
    const bool names = next.capital || next.initial;
    if (names && std::ranges::find(kTitles, one.text) != kTitles.end()) return PersonalDetail::title;
    if (!reference || (one.initial && next.initial) || of_documents(one) || of_documents(next)) continue;
    if (names && (one.capital || one.initial)) return PersonalDetail::person;
  }
  return PersonalDetail::none;
}

std::string personal_warning(std::string_view where, std::string_view text, bool reference) {
  const char* what = nullptr;
  switch (personal_detail(text, reference)) {
    case PersonalDetail::none:
      return {};
    case PersonalDetail::email:
      what = "an e-mail address";
      break;
    case PersonalDetail::title:
      what = "a title with a name";
      break;
    case PersonalDetail::birth:
      what = "a date of birth";
      break;
    case PersonalDetail::person:
      what = "a person's name";
      break;
  }
  return fmt::format(
      "{} '{}' looks like {} and is stored in every recording; write a number or a code, and keep the list of names "
      "locked away elsewhere",
      where, printable(std::string(text)), what);
}

std::vector<std::string> personal_warnings(const std::vector<Trial>& trials) {
  std::vector<std::string> warnings;
  const auto look = [&](const char* where, const std::string& text, bool reference = false) {
    std::string warning = personal_warning(where, text, reference);
    if (!warning.empty() && std::ranges::find(warnings, warning) == warnings.end()) {
      warnings.push_back(std::move(warning));
    }
  };
  for (const Trial& trial : trials) {
    look("[person] consent", trial.person.consent, true);
    look("[recording] condition", trial.condition);
    look("the [[trial]] name", trial.name);
    look("the name of the experiment", trial.protocol);
  }
  return warnings;
}

}  // namespace mbk::protocol
