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

std::string Range::remedy() const {
  switch (kind) {
    case Kind::above:
      return fmt::format("choose a value above {}", low);
    case Kind::at_least:
      return fmt::format("choose {} or more", low);
    case Kind::between:
      return fmt::format("choose {} to {}", low, high);
    case Kind::within:
      return fmt::format("choose a value above {} and below {}", low, high);
    case Kind::any:
      break;
  }
  return "choose another value";
}

}  // namespace mbk::config
