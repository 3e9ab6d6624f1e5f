#include "mbk/experiment/console/page.h"

#include <gtest/gtest.h>

namespace mbk::console {
namespace {

TEST(Page, NamesTheHashOfEachScriptAndStyle) {
  // made with another SHA-256 and base64 (Python's hashlib)
  EXPECT_EQ(inline_sources("<script type=\"module\" crossorigin>run()</script><p><style>a{}</style><script></script>"),
            "script-src 'sha256-AvyuiL0SD1mVY3NNxR+V2uo+lhk6RMFrytWmRt6CrJQ=' "
            "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='; "
            "style-src 'sha256-X1RutGBrXCt9KkSaXMK7tHftWiRscFHOhxsS8tv8hBk='");
}

TEST(Page, LetsNothingThroughWhereNothingStands) {
  EXPECT_EQ(inline_sources("<p style=\"color:red\">no script</p>"), "script-src 'none'; style-src 'none'");
  EXPECT_EQ(inline_sources("<script>not closed"), "script-src 'none'; style-src 'none'");
  EXPECT_EQ(inline_sources("<script"), "script-src 'none'; style-src 'none'");
}

TEST(Page, DataIsNoScript) {
  EXPECT_EQ(inline_sources(R"(<script type="application/json" id="report-data">{"a":"<style>"}</script>)"),
            "script-src 'none'; style-src 'none'");
}

}  // namespace
}  // namespace mbk::console
