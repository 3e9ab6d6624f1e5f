#include "mbk/base/core/version.h"

namespace mbk {

std::string_view version() {
  return MBK_VERSION;
}

std::string_view release_date() {
  return MBK_RELEASE_DATE;
}

}  // namespace mbk
