#include "mbk/batch/value_bytes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/units.h"

namespace mbk::batch {
namespace {

enum class Colour { red, green };

struct Inner {
  std::optional<double> first;
  std::array<bool, 3> flags{};
  Hertz rate{50.0};
};

struct Outer {
  int count = 0;
  std::optional<Inner> perhaps;
  Inner always;
  std::vector<std::pair<std::string, bool>> named;
  Matrix matrix;
  Vector vector;
  std::optional<std::string> text;
  std::map<std::string, double> by_name;
  Colour colour = Colour::red;
  std::vector<bool> bits;
};

Outer an_outer() {
  Outer outer;
  outer.count = -7;
  outer.perhaps = Inner{0.1, {true, false, true}, Hertz(3.0)};
  outer.always.first = std::numeric_limits<double>::denorm_min();
  outer.named = {{"a", true}, {"", false}};
  outer.matrix = Matrix{{1.0, 2.0, 3.0}, {4.0, 5.0, std::numeric_limits<double>::infinity()}};
  outer.vector = Vector{{-0.0}};
  outer.by_name = {{"x", 1.0}, {"y", 2.0}};
  outer.colour = Colour::green;
  outer.bits = {true, false, true};
  return outer;
}

TEST(ValueBytes, EveryMemberComesBackToTheBit) {
  static_assert(value_detail::member_count<Inner>() == 3);
  static_assert(value_detail::member_count<Outer>() == 10);
  const Outer before = an_outer();
  const std::string bytes = to_bytes(before);
  Outer after;
  ASSERT_TRUE(from_bytes(bytes, after));
  EXPECT_EQ(after.count, -7);
  ASSERT_TRUE(after.perhaps);
  EXPECT_EQ(after.perhaps->first, 0.1);
  EXPECT_EQ(after.perhaps->flags, before.perhaps->flags);
  EXPECT_EQ(after.perhaps->rate, Hertz(3.0));
  EXPECT_EQ(after.always.first, before.always.first);
  EXPECT_EQ(after.named, before.named);
  EXPECT_EQ(after.matrix, before.matrix);
  EXPECT_TRUE(std::signbit(after.vector[0]));
  EXPECT_FALSE(after.text);
  EXPECT_EQ(after.by_name, before.by_name);
  EXPECT_EQ(after.colour, Colour::green);
  EXPECT_EQ(after.bits, before.bits);
  EXPECT_EQ(to_bytes(after), bytes);
}

TEST(ValueBytes, AMatrixHasAsManyNumbersAsItsSizeSays) {
  const Matrix empty(0, 2);
  Matrix after(1, 1);
  ASSERT_TRUE(from_bytes(to_bytes(empty), after));
  EXPECT_EQ(after.rows(), 0);
  EXPECT_EQ(after.cols(), 2);
  EXPECT_FALSE(from_bytes(to_bytes(std::vector<double>{0, 1, 5}), after)) << "a number that belongs nowhere";
  EXPECT_FALSE(from_bytes(to_bytes(std::vector<double>{2, 2, 1, 2, 3}), after)) << "a number is missing";
}

TEST(ValueBytes, EveryCutIsSeenAndAsksForNoMemory) {
  const std::string bytes = to_bytes(an_outer());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Outer after;
    EXPECT_FALSE(from_bytes(std::string_view(bytes).substr(0, size), after)) << size;
  }
  Outer after;
  EXPECT_FALSE(from_bytes(bytes + "x", after));
}

}  // namespace
}  // namespace mbk::batch
