#include "fuzz/fuzz.h"

namespace mbk::fuzz {

std::vector<std::string> seeds() {
  return {""};
}

}  // namespace mbk::fuzz
