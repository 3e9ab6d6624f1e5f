#include "mbk/teleop/two_port.h"

#include <gmock/gmock.h>

#include "mbk/base/numeric/random.h"
#include "mbk/teleop/test_networks.h"

namespace mbk::teleop {
namespace {

TEST(Convert, GoesThereAndBackExactly) {
  numeric::Random random(1);
  for (int trial = 0; trial < 10; ++trial) {
    const TwoPort z = random_near_passive(random);
    for (const Form form : kForms) {
      const auto there = convert(z, form);
      ASSERT_TRUE(there) << trial << word_of(form) << there.error().line();
      EXPECT_EQ(convert(*there, Form::z)->matrix, z.matrix) << word_of(form);
    }
  }
}

TEST(Convert, KeepsTheVariablesThatMeetTheEquations) {
  numeric::Random random(2);
  const TwoPort z = random_passive(random);
  const RadPerSec omega(1.3);
  const Eigen::Vector2cd I(std::complex<double>(1.0, 0.3), std::complex<double>(-0.4, 2.0));
  const Eigen::Vector2cd V = z.matrix(omega) * I;
  const auto maps = [&](Form form, const Eigen::Vector2cd& from, const Eigen::Vector2cd& to) {
    const Eigen::Vector2cd mapped = convert(z, form)->matrix(omega) * from;
    EXPECT_LT((mapped - to).norm(), 1e-12 * V.norm()) << word_of(form);
  };
  maps(Form::y, V, I);
  maps(Form::h, {I[0], V[1]}, {V[0], I[1]});
  maps(Form::g, {V[0], I[1]}, {I[0], V[1]});
}

TEST(Convert, SaysThatAFormDoesNotExist) {
  const TwoPort ideal = two_port(Form::h, {{{{0}, {1}}, {{1}, {1}}, {{-1}, {1}}, {{0}, {1}}}});
  const auto z = convert(ideal, Form::z);
  ASSERT_FALSE(z);
  EXPECT_EQ(z.error().kind, ErrorKind::not_usable);
  EXPECT_THAT(z.error().message, testing::HasSubstr("z matrix"));
  EXPECT_TRUE(convert(ideal, Form::g));
}

TEST(Exchanged, TwiceIsTheNetworkItself) {
  const TwoPort h = two_port(Form::h, {{{{1}, {1, 2}}, {{3}, {1}}, {{4}, {1, 1}}, {{5}, {1}}}});
  EXPECT_EQ(exchanged(h).form, Form::g);
  EXPECT_EQ(exchanged(exchanged(h)).matrix, h.matrix);
  EXPECT_EQ(convert(exchanged(h), Form::z)->matrix(0, 0), convert(h, Form::z)->matrix(1, 1));
}

TEST(WithShortage, TakesAFromTheImpedanceOfThatPortAlone) {
  numeric::Random random(3);
  const TwoPort z = random_passive(random);
  const Rational a(7, 3);
  for (const Form form : {Form::z, Form::h, Form::g, Form::y}) {
    for (const Port port : {Port::one, Port::two}) {
      const auto less = convert(*with_shortage(*convert(z, form), port, a), Form::z);
      const Index i = port == Port::one ? 0 : 1;
      lti::RationalMatrix expected = z.matrix;
      expected(i, i) = expected(i, i) - lti::RationalFunction(Polynomial{a});
      EXPECT_EQ(less->matrix, expected);
      EXPECT_EQ(convert(*PortEquations::of(z).with_shortage(port, Polynomial{a}).at(0), Form::z)->matrix, expected);
    }
  }
}

TEST(Immittance, OfEquationsWithAParameterIsThatOfEachValue) {
  const Teleoperator t = position_force({1, 2});
  const auto parametric = immittance(t.equations("slave.k"));
  ASSERT_TRUE(parametric);
  for (const int k : {1, 7, 400}) {
    const auto at = t.equations("slave.k").at(k);
    ASSERT_EQ(at->form, parametric->form);
    for (const Index i : {0, 1}) {
      for (const Index j : {0, 1}) {
        const auto& numerator = parametric->numerator[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
        EXPECT_EQ(lti::RationalFunction::of(numerator.at(k), parametric->denominator.at(k)).value(), at->matrix(i, j));
      }
    }
  }
}

}  // namespace
}  // namespace mbk::teleop
