#include "mbk/base/core/result.h"

#include <utility>

#include "mbk/base/core/printable.h"

namespace mbk {

Error Error::in(std::string_view place) const {
  Error outer = *this;
  outer.where = printable(where.empty() ? std::string(place) : std::string(place) + ", " + where);
  return outer;
}

std::string Error::line() const {
  std::string text = where.empty() ? message : where + ": " + message;
  if (!remedy.empty()) text += "; " + remedy;
  return text;
}

tl::unexpected<Error> fail(ErrorKind kind, std::string message, std::string remedy, std::string where) {
  return tl::unexpected<Error>(
      Error{kind, printable(std::move(message)), printable(std::move(remedy)), printable(std::move(where))});
}

tl::unexpected<Error> bad_data(std::string message, std::string remedy, std::string where) {
  return fail(ErrorKind::data, std::move(message), std::move(remedy), std::move(where));
}

tl::unexpected<Error> bad_usage(std::string message, std::string remedy) {
  return fail(ErrorKind::usage, std::move(message), std::move(remedy));
}

tl::unexpected<Error> with_code(std::string_view code, tl::unexpected<Error> error) {
  error.value().code = code;
  return error;
}

}  // namespace mbk
