#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <type_traits>
#include <utility>

namespace mbk {

/// The kind of a failure, which determines the exit code of the command line.
enum class ErrorKind {
  usage,       ///< an option or argument is wrong: exit code 2
  data,        ///< the input is bad, missing or unreadable: exit code 3
  not_usable,  ///< computed, but the result must not be used: exit code 4
};

/// A failure as a value: what is wrong, where, and what to do. Bad data never throws, prints or aborts.
struct Error {
  ErrorKind kind = ErrorKind::data;
  std::string message;    ///< quantity, value and limit: "cutoff 600 Hz is not below Nyquist 500 Hz"
  std::string remedy;     ///< what to do next; may be empty
  std::string where;      ///< file and position in it: "log.mat, variable 'logs'"; may be empty
  std::string code = {};  ///< for errors that a caller handles: "nothing-recognised"; otherwise empty

  /// The same error with an outer place before the inner one.
  [[nodiscard]] Error in(std::string_view place) const;

  /// One line: "where: message; remedy".
  [[nodiscard]] std::string line() const;
};

/// Either a value or an Error.
template <class Value>
using Result = tl::expected<Value, Error>;

/// An Error to return from a function that returns `Result<…>`. Its texts are made printable, so that an error is one
/// line.
[[nodiscard]] tl::unexpected<Error> fail(ErrorKind kind, std::string message, std::string remedy = "",
                                         std::string where = "");

[[nodiscard]] tl::unexpected<Error> bad_data(std::string message, std::string remedy = "", std::string where = "");

[[nodiscard]] tl::unexpected<Error> bad_usage(std::string message, std::string remedy = "");

/// The error with a code.
[[nodiscard]] tl::unexpected<Error> with_code(std::string_view code, tl::unexpected<Error> error);

/// The value that MBK_TRY takes out of a result.
template <class Value>
Value taken(tl::expected<Value, Error>&& result) {
  if constexpr (!std::is_void_v<Value>) return *std::move(result);
}

}  // namespace mbk

/// The value of a `Result`; if it holds an Error, the function around it returns that error:
///
///     const auto recording = MBK_TRY(read(file));
///     MBK_TRY(check(recording));
///
/// A statement expression, which GCC and Clang know; write it only as a whole statement or a whole initialiser.
#define MBK_TRY(...) MBK_TRY_NUMBERED(__COUNTER__, __VA_ARGS__)
#define MBK_TRY_NUMBERED(number, ...) MBK_TRY_AS(number, __VA_ARGS__)
#define MBK_TRY_AS(number, ...)                                                      \
  __extension__({                                                                    \
    auto mbk_result_##number = (__VA_ARGS__);                                        \
    if (!mbk_result_##number) [[unlikely]]                                           \
      return ::tl::unexpected<::mbk::Error>(std::move(mbk_result_##number).error()); \
    ::mbk::taken(std::move(mbk_result_##number));                                    \
  })
