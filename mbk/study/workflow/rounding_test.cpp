#include "mbk/study/workflow/rounding.h"

#include <gtest/gtest.h>

namespace mbk::workflow {
namespace {

TEST(SameButForRounding, LooksAtNumbersAndAtNothingElse) {
  const std::string stored = R"({"K": [[46.0, -28.9], [1e-12, 0]], "code": "none", "passive": true, "n": null})";
  EXPECT_TRUE(same_but_for_rounding(stored, stored));
  EXPECT_TRUE(same_but_for_rounding(
      stored, R"({"K": [[46.00001, -28.9], [0, 3e-13]], "code": "none", "passive": true, "n": null})"));
  for (const char* other : {R"({"K": [[46.001, -28.9], [0, 0]], "code": "none", "passive": true, "n": null})",
                            R"({"K": [[46.0, -28.9], [1e-8, 0]], "code": "none", "passive": true, "n": null})",
                            R"({"K": [[46.0, -28.9]], "code": "none", "passive": true, "n": null})",
                            R"({"K": [[46.0, -28.9], [0, 0]], "code": "some", "passive": true, "n": null})",
                            R"({"K": [[46.0, -28.9], [0, 0]], "code": "none", "passive": false, "n": null})",
                            R"({"K": [[46.0, -28.9], [0, 0]], "code": "none", "passive": true, "n": 0})",
                            R"({"K": [[46.0, -28.9], [0, 0]], "code": "none", "passive": true})", "damaged"}) {
    EXPECT_FALSE(same_but_for_rounding(stored, other)) << other;
  }
  EXPECT_TRUE(same_but_for_rounding("[57074, -2.33]", "[57074, -2.34]"));  // of a row, the largest counts
  EXPECT_FALSE(same_but_for_rounding("[57074, -2.3]", "[57074, -2.5]"));
  EXPECT_FALSE(same_but_for_rounding("damaged", "damaged"));
}

}  // namespace
}  // namespace mbk::workflow
