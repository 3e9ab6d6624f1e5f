#include "mbk/measure/identify/base_parameters.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mbk/model/robot/serial_chain.h"
#include "mbk/model/robot/single_joint.h"

namespace mbk::identify {
namespace base_parameters_test {

/// A number modulo the prime 2⁶¹ − 1: exact, so that a rank is one.
class Exact {
 public:
  Exact(std::int64_t value = 0) : value_(value >= 0 ? static_cast<Word>(value) : kPrime - static_cast<Word>(-value)) {}
  static Exact of(std::uint64_t bits) { return Exact(static_cast<std::int64_t>(bits % kPrime)); }

  [[nodiscard]] bool zero() const { return value_ == 0; }
  [[nodiscard]] Exact inverse() const {
    Exact power = *this, result = 1;
    for (Word exponent = kPrime - 2; exponent != 0; exponent >>= 1U, power = power * power) {
      if ((exponent & 1U) != 0) result = result * power;
    }
    return result;
  }
  friend Exact operator+(Exact a, Exact b) { return of((a.value_ + b.value_) % kPrime); }
  friend Exact operator-(Exact a, Exact b) { return of((a.value_ + kPrime - b.value_) % kPrime); }
  friend Exact operator*(Exact a, Exact b) {
    __extension__ using Wide = unsigned __int128;
    return of(static_cast<Word>(static_cast<Wide>(a.value_) * b.value_ % kPrime));
  }

 private:
  using Word = std::uint64_t;
  static constexpr Word kPrime = (Word{1} << 61U) - 1;
  Word value_;
};

using Exact3 = std::array<Exact, 3>;
using Exact33 = std::array<Exact3, 3>;  // rows

Exact3 operator+(const Exact3& a, const Exact3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Exact3 operator-(const Exact3& a, const Exact3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Exact3 operator*(Exact s, const Exact3& v) {
  return {s * v[0], s * v[1], s * v[2]};
}
Exact dot(const Exact3& a, const Exact3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Exact3 cross(const Exact3& a, const Exact3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Exact3 operator*(const Exact33& A, const Exact3& v) {
  return {dot(A[0], v), dot(A[1], v), dot(A[2], v)};
}
Exact33 transposed(const Exact33& A) {
  Exact33 T;
  for (std::size_t i = 0; i < 3; ++i) T[i] = {A[0][i], A[1][i], A[2][i]};
  return T;
}
Exact33 operator*(const Exact33& A, const Exact33& B) {
  const Exact33 columns = transposed(B);
  Exact33 C;
  for (std::size_t i = 0; i < 3; ++i) C[i] = {dot(A[i], columns[0]), dot(A[i], columns[1]), dot(A[i], columns[2])};
  return C;
}

/// About a unit axis, by cosine and sine (Rodrigues).
Exact33 turned(const Exact3& axis, Exact cosine, Exact sine) {
  Exact33 R;
  const Exact rest = Exact(1) - cosine;
  for (std::size_t i = 0; i < 3; ++i) {
    Exact3 unit{};
    unit[i] = 1;
    const Exact3 column = cosine * unit + sine * cross(axis, unit) + (rest * axis[i]) * axis;
    for (std::size_t k = 0; k < 3; ++k) R[k][i] = column[k];
  }
  return R;
}

/// An angle with a rational cosine and sine, `over` as denominator.
struct Angle {
  double radians;
  int cosine, sine, over;
};
const Angle k0{0.0, 1, 0, 1}, kRight{std::numbers::pi / 2.0, 0, 1, 1}, kBack{-std::numbers::pi / 2.0, 0, -1, 1},
    kHalf{std::numbers::pi, -1, 0, 1}, kOblique{std::atan2(3.0, 4.0), 4, 3, 5};

/// An axis of length 1, `over` as denominator.
struct Axis {
  int x, y, z, over;
};
constexpr Axis kX{1, 0, 0, 1}, kY{0, 1, 0, 1}, kZ{0, 0, 1, 1}, kTilted{3, 0, 4, 5}, kSkew{2, -1, 2, 3};

struct TestJoint {
  Axis axis = kZ;
  std::array<int, 3> place_mm = {0, 0, 0};
  std::array<Angle, 3> turn = {k0, k0, k0};  // roll, pitch, yaw
  bool slides = false;
};

struct TestRobot {
  std::string name;
  std::vector<TestJoint> joints;
  std::array<int, 3> gravity = {0, 0, -981};  // [cm/s²]
};

Exact ratio(int numerator, int denominator) {
  return Exact(numerator) * Exact(denominator).inverse();
}
Exact3 vector_of(const std::array<int, 3>& v, int over) {
  return {ratio(v[0], over), ratio(v[1], over), ratio(v[2], over)};
}

/// The regressor of one random state in the base frame, by Newton and Euler body by body, added to `rows`: n of them,
/// 10 n numbers each.
void add_state(const TestRobot& robot, std::mt19937_64& random, std::vector<std::vector<Exact>>& rows) {
  const auto any = [&] { return Exact::of(random()); };
  const std::size_t n = robot.joints.size(), top = rows.size();
  rows.resize(top + n, std::vector<Exact>(10 * n));
  Exact33 R{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Exact3 origin{}, omega{}, alpha{}, c = Exact(-1) * vector_of(robot.gravity, 100);  // c: acceleration less gravity
  std::vector<Exact3> axes, origins;
  for (std::size_t i = 0; i < n; ++i) {
    const TestJoint& joint = robot.joints[i];
    const Exact rate = any(), rate2 = any();
    Exact3 step = R * vector_of(joint.place_mm, 1000);
    const std::array<Exact3, 3> unit = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (const std::size_t k : {2U, 1U, 0U}) {
      const Angle& a = joint.turn[k];
      R = R * turned(unit[k], ratio(a.cosine, a.over), ratio(a.sine, a.over));
    }
    const Exact3 local = vector_of({joint.axis.x, joint.axis.y, joint.axis.z}, joint.axis.over), z = R * local;
    const Exact t = any(), scale = (Exact(1) + t * t).inverse();
    if (joint.slides) {
      step = step + t * z;
    } else {
      R = R * turned(local, (Exact(1) - t * t) * scale, Exact(2) * t * scale);
    }
    origin = origin + step;
    c = c + cross(alpha, step) + cross(omega, cross(omega, step));
    if (joint.slides) {
      c = c + Exact(2) * rate * cross(omega, z) + rate2 * z;
    } else {
      alpha = alpha + rate2 * z + rate * cross(omega, z);
      omega = omega + rate * z;
    }
    axes.push_back(z);
    origins.push_back(origin);
    for (std::size_t k = 0; k < 10; ++k) {
      const Exact mass = k == 0 ? 1 : 0;
      Exact3 moment{};
      Exact33 inertia{};
      if (k >= 1 && k <= 3) moment[k - 1] = 1;
      constexpr std::array<std::array<std::size_t, 2>, 6> kPlaces{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};
      if (k >= 4) inertia[kPlaces[k - 4][0]][kPlaces[k - 4][1]] = inertia[kPlaces[k - 4][1]][kPlaces[k - 4][0]] = 1;
      const Exact3 h = R * moment;
      const Exact33 I = R * inertia * transposed(R);
      const Exact3 f = mass * c + cross(alpha, h) + cross(omega, cross(omega, h));
      const Exact3 torque = I * alpha + cross(omega, I * omega) + cross(h, c);
      for (std::size_t j = 0; j <= i; ++j) {
        const Exact3 about = torque + cross(origin - origins[j], f);
        rows[top + j][10 * i + k] = robot.joints[j].slides ? dot(axes[j], f) : dot(axes[j], about);
      }
    }
  }
}

std::size_t rank_of(std::vector<std::vector<Exact>> rows) {
  std::size_t rank = 0;
  for (std::size_t column = 0; column < rows.front().size() && rank < rows.size(); ++column) {
    std::size_t pivot = rank;
    while (pivot < rows.size() && rows[pivot][column].zero()) ++pivot;
    if (pivot == rows.size()) continue;
    std::swap(rows[rank], rows[pivot]);
    const Exact inverse = rows[rank][column].inverse();
    for (std::size_t i = rank + 1; i < rows.size(); ++i) {
      if (rows[i][column].zero()) continue;
      const Exact share = rows[i][column] * inverse;
      for (std::size_t k = column; k < rows[i].size(); ++k) rows[i][k] = rows[i][k] - share * rows[rank][k];
    }
    ++rank;
  }
  return rank;
}

/// Of the regressors of twice as many random states as there could be base parameters.
std::size_t exact_rank(const TestRobot& robot) {
  std::mt19937_64 random(1);
  std::vector<std::vector<Exact>> rows;
  for (int state = 0; state < 20; ++state) add_state(robot, random, rows);
  return rank_of(std::move(rows));
}

/// With angles of so many digits.
std::string urdf_of(const TestRobot& robot, int digits) {
  std::string text = R"(<robot name="test"><link name="base"/>)", before = "base";
  for (std::size_t k = 0; k < robot.joints.size(); ++k) {
    const TestJoint& joint = robot.joints[k];
    const std::string name = fmt::format("link_{}", k + 1);
    text += fmt::format(R"(<link name="{}"><inertial><origin xyz="0.1 0.02 0.03"/><mass value="1"/>)"
                        R"(<inertia ixx="0.01" iyy="0.02" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>)",
                        name);
    text +=
        fmt::format(R"(<joint name="joint_{}" type="{}"><origin xyz="{} {} {}" rpy="{:.{}g} {:.{}g} {:.{}g}"/>)"
                    R"(<axis xyz="{} {} {}"/><limit lower="-0.4" upper="0.3" effort="1" velocity="1"/>)"
                    R"(<parent link="{}"/><child link="{}"/></joint>)",
                    k + 1, joint.slides ? "prismatic" : "revolute", joint.place_mm[0] / 1e3, joint.place_mm[1] / 1e3,
                    joint.place_mm[2] / 1e3, joint.turn[0].radians, digits, joint.turn[1].radians, digits,
                    joint.turn[2].radians, digits, joint.axis.x, joint.axis.y, joint.axis.z, before, name);
    before = name;
  }
  return text + "</robot>";
}

robot::DynamicModel model_of(const TestRobot& robot, int digits) {
  robot::SerialChain::Options options;
  for (Index k = 0; k < 3; ++k) options.gravity[k] = robot.gravity[static_cast<std::size_t>(k)] / 100.0;
  const auto chain = robot::SerialChain::from_urdf(urdf_of(robot, digits), options);
  EXPECT_TRUE(chain) << chain.error().line();
  return {*chain, {.viscous = false, .coulomb = false, .offset = false}, (*chain)->stated_coefficients(), {}};
}

using Turn = std::array<Angle, 3>;
const Turn kRollRight{kRight, k0, k0}, kRollBack{kBack, k0, k0};
constexpr std::array<int, 3> kNoGravity{0, 0, 0}, kSideways{0, -981, 0}, kTiltedGravity{300, 0, -900};

const std::vector<TestRobot>& robots() {
  static const std::vector<TestRobot> all = {
      {"one joint across gravity", {{kY}}},
      {"one joint along gravity", {{kZ}}},
      {"one slide", {{kZ, {}, {k0, k0, k0}, true}}},
      {"planar, horizontal", {{kZ}, {kZ, {250, 0, 0}}}},
      {"planar, vertical", {{kZ}, {kZ, {250, 0, 0}}}, kSideways},
      {"planar of three, horizontal", {{kZ}, {kZ, {300, 0, 0}}, {kZ, {200, 0, 50}}}},
      {"planar of three, vertical", {{kY}, {kY, {0, 0, 300}}, {kY, {0, 0, 200}}}},
      {"pan-tilt, intersecting", {{kZ}, {kZ, {0, 0, 100}, kRollRight}}},
      {"pan-tilt, offset", {{kZ}, {kZ, {50, 0, 100}, kRollRight}}},
      {"pan-tilt without gravity", {{kZ}, {kY, {0, 0, 100}}}, kNoGravity},
      {"pan-tilt, mounted obliquely", {{kZ}, {kY, {50, 0, 100}}}, kTiltedGravity},
      {"spherical wrist", {{kZ}, {kZ, {}, kRollRight}, {kZ, {}, kRollBack}}},
      {"SCARA", {{kZ}, {kZ, {300, 0, 0}}, {kZ, {200, 0, 0}, {k0, k0, k0}, true}, {kZ}}},
      {"cylindrical", {{kZ}, {kZ, {0, 0, 200}, {k0, k0, k0}, true}, {kX, {50, 0, 0}, {k0, k0, k0}, true}}},
      {"anthropomorphic arm", {{kZ}, {kZ, {0, 0, 300}, kRollRight}, {kZ, {250, 0, 0}}}},
      {"oblique axes", {{kZ}, {kTilted, {100, 0, 50}, {kOblique, k0, k0}}, {kSkew, {20, 150, 0}, {k0, kOblique, k0}}}},
      {"four axes, half turns", {{kZ}, {kX, {}, {kHalf, k0, k0}}, {kX, {0, 200, 0}}, {kY, {0, 100, 30}}}, kSideways},
      {"five axes", {{kZ}, {kY, {0, 0, 200}}, {kY, {0, 0, 250}}, {kX, {100, 0, 0}}, {kY, {80, 0, 0}}}},
      {"six axes, wrist",
       {{kZ},
        {kZ, {70, 0, 350}, kRollBack},
        {kZ, {360, 0, 0}},
        {kZ, {40, 380, 0}, kRollBack},
        {kZ, {}, kRollRight},
        {kZ, {}, kRollBack}}},
      {"seven axes",
       {{kZ, {0, 0, 330}},
        {kZ, {}, kRollBack},
        {kZ, {0, -316, 0}, kRollRight},
        {kZ, {82, 0, 0}, kRollRight},
        {kZ, {-82, 384, 0}, kRollBack},
        {kZ, {}, kRollRight},
        {kZ, {88, 0, 0}, kRollRight}}},
  };
  return all;
}

/// Angles to rounding, and as people write them.
constexpr std::array kDigits = {17, 5};

TEST(BaseParameters, AreAsManyAsTheExactRankOnTwentyRobots) {
  ASSERT_EQ(robots().size(), 20U);
  for (const TestRobot& robot : robots()) {
    const std::size_t expected = exact_rank(robot);
    for (const int digits : kDigits) {
      EXPECT_EQ(structural_columns(model_of(robot, digits)).kept.size(), expected) << robot.name << ", " << digits;
    }
  }
}

TEST(BaseParameters, ExactRankIsThatOfTheLiterature) {
  const auto rank = [](const char* name) { return exact_rank(*std::ranges::find(robots(), name, &TestRobot::name)); };
  EXPECT_EQ(rank("one joint across gravity"), 3U);  // Ī, two first moments
  EXPECT_EQ(rank("one joint along gravity"), 1U);
  EXPECT_EQ(rank("planar, horizontal"), 4U);  // Khosla & Kanade 1985
  EXPECT_EQ(rank("planar, vertical"), 6U);
  EXPECT_EQ(rank("pan-tilt, intersecting"), 8U);  // with viscous, Coulomb and offset of both drives 14
}

TEST(BaseParameters, OfAPanTiltWithItsDrivesAreFourteen) {
  for (const int digits : kDigits) {
    robot::DynamicModel model = model_of(robots()[7], digits);
    model.drive = {};
    EXPECT_EQ(structural_columns(model).kept.size(), 14U);
  }
}

TEST(BaseParameters, OfADriveWhoseMotorMovesWithItsBodyAreOneLess) {
  const robot::DynamicModel model{std::make_shared<robot::SingleJoint>(robot::SingleJoint::Options{}),
                                  {.motor_inertia = true},
                                  Vector::Zero(5),
                                  {}};
  const numeric::IndependentColumns columns = structural_columns(model);
  EXPECT_EQ(columns.kept, (std::vector<Index>{0, 2, 3, 4}));  // mass, viscous, coulomb, offset
  EXPECT_NEAR(columns.combination(0, 1), 1.0, 1e-12);
  EXPECT_EQ(structural_columns(model, {0}).kept, (std::vector<Index>{0, 1, 2, 3}));  // counted without the mass
}

}  // namespace base_parameters_test
}  // namespace mbk::identify
