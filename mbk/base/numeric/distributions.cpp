#include "mbk/base/numeric/distributions.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/complement.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/policies/policy.hpp>
#include <cmath>
#include <limits>

#include "mbk/base/numeric/statistics.h"

namespace mbk::numeric {
namespace {

namespace policies = boost::math::policies;
template <bool kLongDouble>
using Quiet =
    policies::policy<policies::domain_error<policies::ignore_error>, policies::pole_error<policies::ignore_error>,
                     policies::overflow_error<policies::ignore_error>,
                     policies::underflow_error<policies::ignore_error>,
                     policies::evaluation_error<policies::ignore_error>,
                     policies::rounding_error<policies::ignore_error>, policies::promote_double<kLongDouble>>;

using StudentsT = boost::math::students_t_distribution<double, Quiet<true>>;
using FisherF = boost::math::fisher_f_distribution<double, Quiet<true>>;
using ChiSquared = boost::math::chi_squared_distribution<double, Quiet<true>>;
using NoncentralT = boost::math::non_central_t_distribution<double, Quiet<false>>;  // whose series are long

}  // namespace

double student_quantile(double p, double degrees_of_freedom) {
  if (std::isinf(degrees_of_freedom)) return normal_quantile(p);
  return boost::math::quantile(StudentsT(degrees_of_freedom), p);
}

double student_two_sided(double t, double degrees_of_freedom) {
  if (std::isnan(t)) return t;
  if (std::isinf(t)) return 0.0;
  if (std::isinf(degrees_of_freedom)) return 2.0 * normal_probability(-std::abs(t));
  return 2.0 * boost::math::cdf(StudentsT(degrees_of_freedom), -std::abs(t));
}

double f_quantile(double p, double numerator, double denominator) {
  return boost::math::quantile(FisherF(numerator, denominator), p);
}

double f_probability_above(double x, double numerator, double denominator) {
  if (!(x > 0.0)) return 1.0;
  if (std::isinf(x)) return 0.0;
  return boost::math::cdf(boost::math::complement(FisherF(numerator, denominator), x));
}

double chi_square_quantile(double p, double degrees_of_freedom) {
  return boost::math::quantile(ChiSquared(degrees_of_freedom), p);
}

double chi_square_above(double x, double degrees_of_freedom) {
  return boost::math::cdf(boost::math::complement(ChiSquared(degrees_of_freedom), x));
}

double noncentral_t_below(double t, double degrees_of_freedom, double noncentrality) {
  return boost::math::cdf(NoncentralT(degrees_of_freedom, noncentrality), t);
}

double noncentral_t_above(double t, double degrees_of_freedom, double noncentrality) {
  return boost::math::cdf(boost::math::complement(NoncentralT(degrees_of_freedom, noncentrality), t));
}

double noncentral_t_quantile(double p, double degrees_of_freedom, double noncentrality) {
  return boost::math::quantile(NoncentralT(degrees_of_freedom, noncentrality), p);
}

double noncentrality_of(double t, double degrees_of_freedom, double p) {
  if (!std::isfinite(t)) return std::numeric_limits<double>::quiet_NaN();
  double low = t - 1.0, high = t + 1.0;
  const auto lower_than_p = [&](double delta) { return noncentral_t_below(t, degrees_of_freedom, delta) < p; };
  while (lower_than_p(low) && t - low < 1e8) low = t - 2.0 * (t - low);
  while (!lower_than_p(high) && high - t < 1e8) high = t + 2.0 * (high - t);
  constexpr int kHalvings = 200;
  for (int i = 0; i < kHalvings && high - low > 1e-13 * std::max(1.0, std::abs(t)); ++i) {
    const double middle = 0.5 * (low + high);
    (lower_than_p(middle) ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace mbk::numeric
