#include "mbk/base/config/range.h"

#include <fmt/format.h>

namespace mbk::config {

bool Range::holds(double value) const {
  switch (kind) {
    case Kind::above:
      return value > low;
    case Kind::at_least:
      return value >= low;
    case Kind::between:
      return value >= low && value <= high;
    case Kind::within:
      return value > low && value < high;
    case Kind::any:
      break;
  }
  return true;
}

std::string Range::violation() const {
  switch (kind) {
    case Kind::above:
      return fmt::format("is not above {}", low);
    case Kind::at_least:
      return fmt::format("is below {}", low);
    case Kind::between:
      return fmt::format("is not from {} to {}", low, high);
    case Kind::within:
      return fmt::format("is not above {} and below {}", low, high);
    case Kind::any:
      break;
  }
  return "is not allowed";
}

}  // namespace mbk::config
