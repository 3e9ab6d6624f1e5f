#include "mbk/measure/analyse/advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "mbk/base/dsp/cross_spectrum.h"
#include "mbk/base/dsp/spectrum.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/analyse/channel_cure.h"
#include "mbk/model/impedance/passivity_index.h"
#include "mbk/model/trial/filtered_band.h"

namespace mbk::analyse {
namespace {

constexpr const char* kCheckColumns =
    "check with 'mbk info' that the channels contain force and position, synchronised and in the same frame";

constexpr const char* kFilter =
    "omit --cutoff or raise it: the filter cuts into the excited band (--mode reference uses its own filter)";

/// [%] of the force in the excited band above which the part not explained by M, B and K is not noise.
constexpr double kHighCoherence = 70.0;

constexpr const char* kInstruments =
    "use --method iv; the force of the limb also moves the robot, which biases least squares towards the negative "
    "robot impedance";

/// The matrix that such a warning is about: 0 M, 1 B, 2 K.
int matrix_of(WarningCode code) {
  return code == WarningCode::inertia_not_positive ? 0 : (code == WarningCode::stiffness_not_positive ? 2 : 1);
}

double smallest(const impedance::Model& model, WarningCode code) {
  return impedance::smallest_eigenvalue(model, matrix_of(code)).value;
}

/// Of the force of one axis, the share [%] that follows the motion linearly within the excited band of the trial: the
/// multiple coherence, weighted with the power of the force. Absent if there are too few segments.
std::optional<double> linear_share(const PreparedTrial& trial, Index axis) {
  constexpr double kSegment = 2.0;  // [s]
  const Index n = trial.axes;
  const Hertz rate(1.0 / trial.sample_time);
  std::vector<Matrix> pieces;
  Index longest = 0;
  for (const Segment& one : trial.segments) {
    Matrix piece(one.size(), n + 1);
    piece << trial.position.middleRows(one.begin, one.size()),
        trial.force_hand_on_robot.col(axis).segment(one.begin, one.size());
    longest = std::max(longest, one.size());
    pieces.push_back(std::move(piece));
  }
  constexpr Index kShortest = 8;
  if (longest < kShortest) return std::nullopt;
  const auto spectra = dsp::cross_spectra(pieces, rate, dsp::segment_length(rate, Hertz(1.0 / kSegment), longest));
  constexpr double kMin = 5.0;  // segments for each input
  if (!spectra || spectra->independent_segments < kMin * static_cast<double>(n)) return std::nullopt;
  const Vector coherence = dsp::multiple_coherence(*spectra, n).col(0);
  double explained = 0.0, all = 0.0;
  for (Index k = 0; k < spectra->frequency.size(); ++k) {
    const double f = spectra->frequency[k];
    if (f < trial.preparation.band_low.value || f > trial.preparation.band_high.value) continue;
    if (!std::isfinite(coherence[k])) continue;
    const double power = spectra->density[static_cast<std::size_t>(k)](n, n).real();
    explained += coherence[k] * power;
    all += power;
  }
  return all > 0.0 ? std::optional(100.0 * explained / all) : std::nullopt;
}

class Advisor {
 public:
  Advisor(const std::vector<const Recording*>& recordings, const std::vector<PreparedTrial>& trials,
          const Measurement& measured)
      : recordings_(recordings), trials_(trials), measured_(measured), id_(measured.identification) {}

  /// A better remedy than that of the warning; absent if the latter is right.
  [[nodiscard]] std::optional<std::string> remedy(const Warning& warning) const {
    const bool filtered = std::ranges::any_of(id_.preparations, cuts_into_band);
    switch (warning.code) {
      case WarningCode::inertia_not_positive:
      case WarningCode::stiffness_not_positive:
      case WarningCode::damping_not_positive:
        return filtered ? kFilter : of_sign(warning.code);
      case WarningCode::fit_poor:
        return filtered ? kFilter : of_fit();
      case WarningCode::held_out_fit_poor:
        return filtered ? std::optional<std::string>(kFilter) : std::nullopt;
      case WarningCode::motion_on_one_line:
        return of_line();
      default:
        return std::nullopt;
    }
  }

 private:
  /// Instrumental variables give a usable model in which this matrix is positive.
  [[nodiscard]] bool instruments_find(WarningCode code) const {
    const auto& other = measured_.alternative;
    return other && other->method == Method::instrumental_variables && other->usable && other->model.M.allFinite() &&
           smallest(other->model, code) > 0.0;
  }

  [[nodiscard]] std::optional<std::string> of_sign(WarningCode code) const {
    if (instruments_find(code)) return kInstruments;
    // Clearly negative values are not those of a limb.
    const std::array<const Matrix*, 3> errors = {&id_.standard_error.M, &id_.standard_error.B, &id_.standard_error.K};
    const double error = 2.0 * numeric::kNormal95 * errors[static_cast<std::size_t>(matrix_of(code))]->norm();
    const bool sure = smallest(id_.model, code) < -error;
    return sure && code != WarningCode::damping_not_positive ? std::optional<std::string>(kCheckColumns) : std::nullopt;
  }

  [[nodiscard]] std::optional<std::string> of_fit() const {
    const auto& other = measured_.alternative;
    const auto& difference = measured_.disagreement;
    const bool better = other && other->method == Method::instrumental_variables && other->usable && difference &&
                        difference->significant;
    if (better) return kInstruments;
    Index axis = 0;
    const double vaf = id_.fit.vaf.cwiseMin(id_.fit.vaf_in_sample).minCoeff(&axis);
    if (!std::isfinite(vaf) || trials_.empty()) return std::nullopt;
    const auto share = linear_share(trials_.front(), axis);
    if (!share) return std::nullopt;
    constexpr double kMore = 10.0;  // points of VAF that M, B and K lack
    if (*share > vaf + kMore && *share > kHighCoherence) {
      return fmt::format(
          "use 'mbk explore' to find the missing dynamics (memory, reflexes, resonances): a linear response to the "
          "motion could explain {:.0f} % of that force, M, B and K explain {:.0f} %; do not interpret M, B and K as "
          "those of a passive limb",
          *share, vaf);
    }
    return fmt::format(
        "use 'mbk explore' to distinguish noise from a nonlinear limb and 'mbk passivity' to see whether the limb "
        "absorbed energy (no linear response to the motion could explain more than {:.0f} % of that force); do not "
        "interpret M, B and K as those of a passive limb",
        *share);
  }

  [[nodiscard]] std::optional<std::string> of_line() const {
    if (id_.axes != 2 || recordings_.size() != 1) return std::nullopt;
    const Matrix& position = trials_.front().position;
    const Index axis = numeric::variance(position.col(1)) > numeric::variance(position.col(0)) ? 1 : 0;
    const auto option = channels_of_axis(*recordings_.front(), static_cast<int>(axis));
    if (!option) return std::nullopt;
    return fmt::format("perturb both axes independently, or measure the one axis that moved: {}", *option);
  }

  const std::vector<const Recording*>& recordings_;
  const std::vector<PreparedTrial>& trials_;
  const Measurement& measured_;
  const Identification& id_;
};

}  // namespace

void advise(const std::vector<const Recording*>& recordings, const std::vector<PreparedTrial>& trials,
            Measurement& measured) {
  const Advisor advisor(recordings, trials, measured);
  for (Warning& warning : measured.identification.warnings) {
    if (auto better = advisor.remedy(warning)) warning.remedy = std::move(*better);
  }
}

}  // namespace mbk::analyse
