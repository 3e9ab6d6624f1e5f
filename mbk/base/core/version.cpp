#include "mbk/base/core/version.h"

namespace mbk {

std::string_view version() {
  return MBK_VERSION;
}

}  // namespace mbk
