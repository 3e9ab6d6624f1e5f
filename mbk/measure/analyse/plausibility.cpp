#include "mbk/measure/analyse/plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/analyse/advice.h"
#include "mbk/measure/analyse/axis_maps.h"
#include "mbk/measure/analyse/channel_cure.h"
#include "mbk/measure/analyse/plausible_scale.h"
#include "mbk/model/impedance/passivity_index.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::analyse {
namespace {

/// A channel, or the clock, as it is compared with the others.
struct Column {
  std::string name;
  const ChannelOrigin* origin;
  const Vector* values;
  const QuantityChannels* quantity;  ///< nullptr: time
};

constexpr std::array kCompared = {kPositionChannels, kForceChannels, kReferenceChannels, kAccelerationChannels};

std::vector<Column> columns_of(const Recording& recording, int axes) {
  std::vector<Column> columns;
  for (const QuantityChannels& quantity : kCompared) {
    for (int axis = 0; axis < axes; ++axis) {
      const Channel* const channel = recording.find(quantity.name(axes, axis));
      if (channel == nullptr) continue;
      columns.push_back({name_of(*channel), &channel->origin, &channel->values, &quantity});
    }
  }
  columns.push_back({"time", &recording.time_origin, &recording.time, nullptr});
  return columns;
}

/// Σ (x − x̄)², Σ (y − ȳ)² and Σ (x − x̄)(y − ȳ).
struct Moments {
  double xx = 0, yy = 0, xy = 0;
};

Moments moments_of(const Eigen::Ref<const Vector>& x, const Eigen::Ref<const Vector>& y) {
  constexpr Index kBlock = 1 << 14;
  const double x_mean = x.mean(), y_mean = y.mean();
  Moments sum;
  for (Index begin = 0; begin < x.size(); begin += kBlock) {
    const Index count = std::min(kBlock, x.size() - begin);
    const Vector dx = x.segment(begin, count).array() - x_mean, dy = y.segment(begin, count).array() - y_mean;
    sum.xx += dx.squaredNorm();
    sum.yy += dy.squaredNorm();
    sum.xy += dx.dot(dy);
  }
  return sum;
}

/// Whether one is a multiple of the other but for a constant and rounding.   @param largest Σ (b − b̄)²
bool proportional(const Vector& a, const Vector& b, double largest) {
  constexpr double kRounding = 1e-14;  // of the squares
  constexpr Index kEnough = 4096;
  if (a.size() > 2 * kEnough) {
    // What the best line leaves of some samples is no more than what it leaves of all.
    const Moments part = moments_of(a.head(kEnough), b.head(kEnough));
    const double left = part.xx > 0.0 ? part.yy - part.xy * part.xy / part.xx : part.yy;
    if (left > 2.0 * kRounding * largest) return false;
  }
  if (!a.allFinite() || !b.allFinite()) return false;
  const auto [xx, yy, xy] = moments_of(a, b);
  return xx > 0.0 && yy > 0.0 && xx * yy - xy * xy <= kRounding * xx * yy;
}

/// The column's name or number, without sign, gain and offset.
std::string_view bare(std::string_view source) {
  if (source.starts_with('-')) source.remove_prefix(1);
  return source.substr(0, source.find('*'));
}

bool is(const Column& column, const QuantityChannels& quantity) {
  return column.quantity != nullptr && std::string_view(column.quantity->one_axis) == quantity.one_axis;
}

/// Two channels that are one: by where they stand in the file or, where that is not known, by their values. A reference
/// is compared by its place alone: a stiff robot follows it to the last digit. Two axes that move on one line have no
/// model by either way.
std::optional<Warning> check_columns(const Recording& recording, int axes) {
  const std::vector<Column> columns = columns_of(recording, axes);
  std::vector<double> squares;  // Σ (x − x̄)²
  for (const Column& column : columns) {
    squares.push_back(numeric::variance(*column.values) * static_cast<double>(column.values->size() - 1));
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t k = i + 1; k < columns.size(); ++k) {
      const Column &a = columns[i], &b = columns[k];
      const bool same_place = !a.origin->source.empty() && bare(a.origin->source) == bare(b.origin->source);
      const bool by_value =
          !is(a, kReferenceChannels) && !is(b, kReferenceChannels) && proportional(*a.values, *b.values, squares[k]);
      if (!same_place && !by_value) continue;
      return Warning{
          WarningCode::same_column,
          fmt::format("{} and {} are the same column{}", a.name, b.name,
                      a.origin->source.empty() || !same_place ? " except for a factor and an offset"
                                                              : fmt::format(", '{}'", bare(a.origin->source))),
          fmt::format("name the right column of {} or {} with --channels; 'mbk info' lists the contents of each",
                      a.name, b.name)};
    }
  }
  return std::nullopt;
}

/// Channels that have another name in the file.
std::optional<Warning> check_names(const Recording& recording, int axes) {
  std::string contradictions, channels;
  for (const Column& column : columns_of(recording, axes)) {
    if (column.origin->called.empty()) continue;
    contradictions += fmt::format("{}{} is read from '{}', which the file names {}", contradictions.empty() ? "" : ", ",
                                  column.name, bare(column.origin->source), column.origin->called);
    channels += (channels.empty() ? "" : " and ") + column.name;
  }
  if (contradictions.empty()) return std::nullopt;
  return Warning{WarningCode::other_column, contradictions,
                 fmt::format("check {} in --channels, or omit --channels to use the names in the file", channels)};
}

/// A handle that weighs more than what was measured in one direction.
std::optional<Warning> check_handle(const Identification& id) {
  if (!(id.handle_mass > 0.0) || !id.model.M.allFinite()) return std::nullopt;
  const double left = impedance::smallest_eigenvalue(id.model, 0).value, measured = left + id.handle_mass;
  const double error = 2.0 * id.standard_error.M.norm();
  if (!(left < -error && measured > error)) return std::nullopt;
  return Warning{
      WarningCode::handle_mass_too_large,
      fmt::format(
          "a handle mass of {:.3g} kg is subtracted, but only {:.3g} kg were measured in the lightest direction",
          id.handle_mass, measured),
      fmt::format("correct --handle-mass: it is the mass between force sensor and hand, here less than {:.3g} kg; omit "
                  "it if the handle is on the robot's side of the sensor",
                  measured)};
}

constexpr std::array kConsequences = {WarningCode::force_sign_reversed, WarningCode::inertia_not_positive,
                                      WarningCode::stiffness_not_positive, WarningCode::damping_not_positive,
                                      WarningCode::band_too_narrow};

/// Causes come first; what only follows from them goes, and its code stays as what the last version said.
void put_causes(std::vector<Warning> causes, std::vector<Warning>& warnings) {
  const auto follows = [](const Warning& warning) {
    return std::ranges::find(kConsequences, warning.code) != kConsequences.end();
  };
  if (const auto first = std::ranges::find_if(warnings, follows);
      first != warnings.end() && first->code != causes.front().code) {
    causes.front().was = word_of(first->code);
  }
  std::erase_if(warnings, follows);
  warnings.insert(warnings.begin(), std::make_move_iterator(causes.begin()), std::make_move_iterator(causes.end()));
}

}  // namespace

void judge_plausibility(const std::vector<const Recording*>& recordings, const std::vector<PreparedTrial>& trials,
                        const std::set<PlausibleQuantity>& ignored, Measurement& measured) {
  Identification& id = measured.identification;
  const std::optional<Warning> names = check_names(*recordings.front(), id.axes);
  std::optional<Warning> columns;
  for (const Recording* recording : recordings) {
    if (!columns) columns = check_columns(*recording, id.axes);
  }
  std::vector<Warning> causes;
  const auto lost = std::ranges::find(id.warnings, WarningCode::contact_lost, &Warning::code);
  if (columns) {
    causes.push_back(*columns);
  } else if (lost != id.warnings.end()) {
    causes.push_back(std::move(*lost));
    id.warnings.erase(lost);
  } else {
    for (auto found : {check_scale(recordings, trials, measured, ignored), check_axes(recordings, trials, measured),
                       check_handle(id)}) {
      if (found) causes.push_back(std::move(*found));
    }
  }
  const bool plausible = causes.empty();
  if (!plausible) {
    id.usable = false;
    if (measured.alternative) measured.alternative->usable = false;
    if (names) causes.insert(causes.begin(), *names);
    put_causes(std::move(causes), id.warnings);
  } else if (names) {
    id.warnings.insert(id.warnings.begin(), *names);
  }
  if (plausible) {
    if (auto found = check_symmetry(measured)) id.warnings.push_back(std::move(*found));
  }
  if (!ignored.empty()) {
    std::string switched_off;
    for (const PlausibleQuantity quantity : ignored) {
      switched_off += (switched_off.empty() ? "" : ", ") + std::string(word_of(quantity));
    }
    id.notes.push_back(fmt::format("plausible ranges not checked, as requested: {}", switched_off));
  }
  if (plausible) advise(recordings, trials, measured);
}

}  // namespace mbk::analyse
