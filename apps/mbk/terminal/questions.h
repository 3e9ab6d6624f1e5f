#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::app {

/// The error of an answer; "" if there is none.
using CheckAnswer = std::function<std::string(const std::string&)>;

/// Asks on standard error and reads answers from standard input, one a line: at a terminal, or from a pipe.
class Questions {
 public:
  /// @param defaults  ask nothing, and accept the defaults
  explicit Questions(bool defaults) : defaults_(defaults) {}

  /// "QUESTION [by_default]: ". An empty line accepts the default. At a terminal the question is repeated after a wrong
  /// answer.
  /// @fails  usage: there is no default and `defaults` is set; a wrong answer from a pipe; the input has ended.
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
