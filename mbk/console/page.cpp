#include "mbk/console/page.h"

#ifdef MBK_WEB
extern "C" const char kConsolePageBegin[], kConsolePageEnd[];  // page.S
#endif

namespace mbk::console {

Result<std::string_view> operator_page() {
#ifdef MBK_WEB
  return std::string_view(kConsolePageBegin, static_cast<std::size_t>(kConsolePageEnd - kConsolePageBegin));
#else
  return bad_usage("this mbk was built without the pages of its console",
                   "build it with -DMBK_WEB=ON, which needs Node.js, or take --no-console");
#endif
}

}  // namespace mbk::console
