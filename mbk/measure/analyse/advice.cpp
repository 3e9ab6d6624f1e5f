#include "mbk/measure/analyse/advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/analyse/channel_cure.h"
#include "mbk/model/impedance/passivity_index.h"
#include "mbk/model/trial/filtered_band.h"

namespace mbk::analyse {
namespace {

constexpr const char* kCheckColumns =
    "check with 'mbk info' that force and position are what their channels say, of one instant and in one frame";

constexpr const char* kFilter =
    "leave --cutoff out, or raise it: the filter cuts into the excited band; --mode reference has a filter of its own";

constexpr const char* kInstruments =
    "use --method iv; the limb's own force moves the robot too, which biases least squares towards the negative robot "
    "impedance";

/// The matrix that such a warning is about: 0 M, 1 B, 2 K.
int matrix_of(WarningCode code) {
  return code == WarningCode::inertia_not_positive ? 0 : (code == WarningCode::stiffness_not_positive ? 2 : 1);
}

double smallest(const impedance::Model& model, WarningCode code) {
  return impedance::smallest_eigenvalue(model, matrix_of(code)).value;
}

class Advisor {
 public:
  Advisor(const std::vector<const Recording*>& recordings, const std::vector<PreparedTrial>& trials,
          const Measurement& measured)
      : recordings_(recordings), trials_(trials), measured_(measured), id_(measured.identification) {}

  /// What is likelier to help than what the warning says; nothing where that is right.
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
  /// Instrumental variables find a model that may be used, and of it this matrix positive.
  [[nodiscard]] bool instruments_find(WarningCode code) const {
    const auto& other = measured_.alternative;
    return other && other->method == Method::instrumental_variables && other->usable && other->model.M.allFinite() &&
           smallest(other->model, code) > 0.0;
  }

  [[nodiscard]] std::optional<std::string> of_sign(WarningCode code) const {
    if (instruments_find(code)) return kInstruments;
    // What is negative by more than chance and bias is not a limb's.
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
    return better ? std::optional<std::string>(kInstruments) : std::nullopt;
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
