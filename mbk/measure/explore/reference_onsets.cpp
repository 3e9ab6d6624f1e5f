#include "mbk/measure/explore/reference_onsets.h"

#include <optional>

#include "mbk/base/numeric/least_squares.h"

namespace mbk::explore {

std::vector<Onset> reference_onsets(const Matrix& reference, Index rest) {
  std::vector<Onset> onsets;
  const Index rows = reference.rows();
  if (rows < 2) return onsets;
  constexpr double kSame = 1e-6;
  const Vector range = reference.colwise().maxCoeff() - reference.colwise().minCoeff();
  const double same = kSame * range.maxCoeff();
  const auto differs = [&](Index a, Index b) {
    return (reference.row(a) - reference.row(b)).cwiseAbs().maxCoeff() > same;
  };
  std::vector<numeric::RowRange> rests;
  for (Index begin = 0, i = 1; i <= rows; ++i) {
    if (i < rows && !differs(i, i - 1)) continue;
    if (i - begin >= rest) rests.push_back({begin, i});
    begin = i;
  }
  // A smooth reference comes to rest and leaves it slowly: in the middle it has its level.
  const auto middle = [](const numeric::RowRange& one) { return (one.begin + one.end) / 2; };
  std::optional<Index> before;  // a sample of the rest that the pulse left which is not over yet
  for (std::size_t k = 0; k < rests.size(); ++k) {
    if (rests[k].end == rows) break;
    const Index from = middle(rests[k]), to = k + 1 < rests.size() ? middle(rests[k + 1]) : rows - 1;
    if (before && !differs(to, *before)) {
      before.reset();
      continue;
    }
    before = from;
    onsets.push_back({rests[k].end, (reference.row(to) - reference.row(from)).transpose()});
  }
  return onsets;
}

}  // namespace mbk::explore
