#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::app {

/// What is wrong with an answer; "" where nothing is.
using CheckAnswer = std::function<std::string(const std::string&)>;

/// Asks on standard error and takes answers from standard input, a line each: at a terminal, or out of a pipe.
class Questions {
 public:
  /// @param defaults  ask nothing, and take what stands in brackets
  explicit Questions(bool defaults) : defaults_(defaults) {}

  /// "QUESTION [by_default]: ". An empty line takes the default. At a terminal a wrong answer is asked for again.
  /// @fails  usage: no default, and none may be asked for; a wrong answer out of a pipe; the answers have ended.
  [[nodiscard]] Result<std::string> ask(const std::string& question, const std::string& by_default,
                                        const CheckAnswer& check) const;

 private:
  bool defaults_;
};

/// One of a few words.
[[nodiscard]] CheckAnswer word_of_these(std::vector<std::string> words);
/// A number > 0.
[[nodiscard]] CheckAnswer positive_number();
/// So many numbers with commas between them.
[[nodiscard]] CheckAnswer numbers_with_commas(std::size_t count);

}  // namespace mbk::app
