#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::console {

/// What the participant's page says, in one language: a sentence for each key of kTextKeys.
struct Texts {
  using Sentences = std::map<std::string, std::string>;
  std::string language;                     ///< as BCP 47 names it: "en", "de-AT"
  Sentences sentences;                      ///< of every trial
  std::map<std::string, Sentences> trials;  ///< in place of those, in the trial of that name
};

inline constexpr std::array<std::string_view, 13> kTextKeys = {"wait",   "old",   "start",  "move",   "settle",
                                                               "relax",  "hold",  "reach",  "return", "let_go",
                                                               "thanks", "again", "stopped"};

/// A file of texts that is part of the program: `examples/texts/<name>.toml` as it stood when it was built.
struct ReadyTexts {
  std::string_view name;
  std::string_view text;
};
[[nodiscard]] std::span<const ReadyTexts> ready_texts();

/// A TOML file with `language`, every one of kTextKeys, and some of them again in [trial.NAME].
/// @param file  how messages call it    @param trials  names that there are
/// @fails  data: with file, line and key: one that is missing, empty or not known; the name of no trial.
[[nodiscard]] Result<Texts> read_texts(std::string_view text, std::string_view file,
                                       const std::vector<std::string>& trials);

/// The ready ones of that name, or else those of that file.   @fails  data: there is neither; as read_texts
[[nodiscard]] Result<Texts> find_texts(const std::string& name_or_file, const std::vector<std::string>& trials);

}  // namespace mbk::console
