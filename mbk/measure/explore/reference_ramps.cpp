#include "mbk/measure/explore/reference_ramps.h"

#include <algorithm>
#include <cmath>

namespace mbk::explore {
namespace {

constexpr double kSamePlace = 1e-5;  // of the range of the reference

/// Rows [begin, end) in which the reference keeps its value.
struct ReferenceRest {
  Index begin = 0, end = 0;
  Vector place;
};

std::vector<ReferenceRest> rests_of(const Matrix& reference, double tolerance, Index shortest) {
  std::vector<ReferenceRest> rests;
  for (Index begin = 0; begin < reference.rows();) {
    Index end = begin + 1;
    while (end < reference.rows() && (reference.row(end) - reference.row(begin)).cwiseAbs().maxCoeff() <= tolerance) {
      ++end;
    }
    if (end - begin >= shortest) rests.push_back({begin, end, reference.row(begin + (end - begin) / 2).transpose()});
    begin = end;
  }
  return rests;
}

}  // namespace

std::vector<ReferenceRamp> find_ramps(const Matrix& reference, double sample_time, double shortest_ramp,
                                      double shortest_rest) {
  std::vector<ReferenceRamp> ramps;
  if (reference.rows() < 2) return ramps;
  const double range = (reference.colwise().maxCoeff() - reference.colwise().minCoeff()).maxCoeff();
  if (!(range > 0.0)) return ramps;
  const double tolerance = kSamePlace * range;
  const auto shortest = std::max<Index>(2, static_cast<Index>(std::ceil(shortest_rest / sample_time)));
  const std::vector<ReferenceRest> rests = rests_of(reference, tolerance, shortest);
  const auto same = [&](const Vector& a, const Vector& b) { return (a - b).cwiseAbs().maxCoeff() <= 4.0 * tolerance; };

  const ReferenceRest* home = nullptr;
  std::ptrdiff_t visits = 0;
  for (const ReferenceRest& rest : rests) {
    const auto times = std::ranges::count_if(rests, [&](const auto& other) { return same(rest.place, other.place); });
    if (times <= visits) continue;
    home = &rest;
    visits = times;
  }
  for (std::size_t k = 0; k + 1 < rests.size(); ++k) {
    const ReferenceRest &before = rests[k], &after = rests[k + 1];
    if (!same(before.place, home->place) || same(after.place, home->place)) continue;
    const Index onset = before.end - 1;
    if (static_cast<double>(after.begin - onset) * sample_time < shortest_ramp) continue;
    ramps.push_back({before.begin, onset, after.begin, after.end, after.place - before.place});
  }
  return ramps;
}

}  // namespace mbk::explore
