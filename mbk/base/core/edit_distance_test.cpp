#include "mbk/base/core/edit_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace mbk {
namespace {

/// By its definition: the last characters are kept or replaced, or one of them goes.
std::size_t slow_distance(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  const auto shorter_a = a.substr(1), shorter_b = b.substr(1);
  if (a[0] == b[0]) return slow_distance(shorter_a, shorter_b);
  return 1 + std::min({slow_distance(shorter_a, b), slow_distance(a, shorter_b), slow_distance(shorter_a, shorter_b)});
}

TEST(EditDistance, CountsInsertionsDeletionsAndReplacements) {
  EXPECT_EQ(edit_distance("", ""), 0U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("hnad_x", "hand_x"), 2U);
}

TEST(EditDistance, IsThatOfItsDefinition) {
  std::mt19937 random(1);
  const auto word = [&] {
    std::string text(random() % 7, ' ');
    for (char& c : text) c = static_cast<char>('a' + random() % 3);
    return text;
  };
  for (int i = 0; i < 300; ++i) {
    const std::string a = word(), b = word();
    EXPECT_EQ(edit_distance(a, b), slow_distance(a, b)) << a << " " << b;
    EXPECT_EQ(edit_distance(a, b), edit_distance(b, a));
  }
}

TEST(MeantWord, IsTheNearestThatIsNearEnough) {
  const std::vector<std::string> known{"--from", "--form", "--cutoff", "--to"};
  EXPECT_EQ(meant_word("--cutof", known), "--cutoff");
  EXPECT_EQ(meant_word("--frmo", known), "--from");  // as near as --form, and before it
  EXPECT_EQ(meant_word("--nonsense", known), "");
  EXPECT_EQ(meant_word(std::string(101, 'x'), {{std::string(101, 'x')}}), "");
  EXPECT_EQ(meant_word("ab", {{"cd"}}), "");  // nothing of it would be left
}

}  // namespace
}  // namespace mbk
