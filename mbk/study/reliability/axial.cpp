#include "mbk/study/reliability/axial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mbk/base/core/nan.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/impedance_width.h"

namespace mbk::reliability {
namespace {

constexpr double kPi = std::numbers::pi;

Vector as_vector(const std::vector<double>& values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

}  // namespace

Result<AxialMean> axial_mean(const Vector& angles) {
  if (angles.size() == 0) return bad_data("there are no angles", "give one or more");
  if (const Index i = first_non_finite(angles); i >= 0) {
    return bad_data(fmt::format("angle {} is not a finite number", i + 1), "omit it");
  }
  AxialMean result;
  result.count = static_cast<int>(angles.size());
  const double C = (2.0 * angles.array()).cos().mean(), S = (2.0 * angles.array()).sin().mean();
  result.resultant = std::min(std::hypot(C, S), 1.0);
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon();
  if (result.resultant < rounding) {
    result.support = Support::no_variation;
    result.resultant = 0.0;
    result.mean = kNaN;
    result.standard_deviation = std::numeric_limits<double>::infinity();
    return result;
  }
  result.mean = 0.5 * std::atan2(S, C);
  if (result.mean < 0.0) result.mean += kPi;
  if (result.mean >= kPi) result.mean = 0.0;  // a tiny negative angle rounds to π
  // Near 1, ln R by 1 − R = mean of 2 sin²(θ − θ̄), which does not cancel.
  const double short_of_1 = 2.0 * (angles.array() - result.mean).sin().square().mean();
  const double logarithm = result.resultant > 0.5 ? std::log1p(-short_of_1) : std::log(result.resultant);
  result.standard_deviation = 0.5 * std::sqrt(-2.0 * logarithm);
  return result;
}

double axial_difference(double second, double first) {
  const double difference = std::remainder(second - first, kPi);  // within ±π/2
  return difference <= -0.5 * kPi ? difference + kPi : difference;
}

Unwrapped unwrapped_about(const Vector& angles, double about) {
  Unwrapped result;
  result.angles.resize(angles.size());
  for (Index i = 0; i < angles.size(); ++i) {
    const double difference = axial_difference(angles[i], about);
    result.angles[i] = about + difference;
    result.farthest = std::max(result.farthest, std::abs(difference));
  }
  result.trusted = result.farthest <= 0.25 * kPi;
  return result;
}

Result<WidthSpread> width_spread(const std::vector<std::vector<Matrix>>& matrices) {
  std::vector<double> within, between;
  std::vector<Matrix> means;
  for (std::size_t person = 0; person < matrices.size(); ++person) {
    const auto& sessions = matrices[person];
    if (sessions.empty()) continue;
    Matrix sum = sessions.front();
    for (std::size_t a = 0; a < sessions.size(); ++a) {
      if (a > 0) {
        if (sessions[a].rows() != sum.rows() || sessions[a].cols() != sum.cols()) {
          return bad_data(fmt::format("the matrices of person {} differ in size", person + 1),
                          "give matrices of one size");
        }
        sum += sessions[a];
      }
      for (std::size_t b = 0; b < a; ++b) {
        const auto width = impedance::impedance_width(sessions[b], sessions[a]);
        if (!width) return tl::unexpected(width.error().in(fmt::format("person {}", person + 1)));
        within.push_back(width->distance);
      }
    }
    const Matrix mean = sum / static_cast<double>(sessions.size());
    for (const Matrix& other : means) {
      const auto width = impedance::impedance_width(other, mean);
      if (!width) return tl::unexpected(width.error().in(fmt::format("person {}", person + 1)));
      between.push_back(width->distance);
    }
    means.push_back(mean);
  }
  WidthSpread result;
  result.within = as_vector(within);
  result.between = as_vector(between);
  if (within.empty()) result.support = Support::too_few_sessions;
  if (means.size() < static_cast<std::size_t>(kMinPeople)) result.support = Support::too_few_people;
  return result;
}

}  // namespace mbk::reliability
