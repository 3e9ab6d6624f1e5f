#include "mbk/measure/analyse/plausible_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/files/recording/si_units.h"
#include "mbk/measure/analyse/channel_cure.h"
#include "mbk/model/trial/filtered_band.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::analyse {
namespace {

constexpr double kExplained =
    0.0;                        ///< [%] of the held-out force: at or below, the model is not usable whatever its size
constexpr double kKnown = 4.0;  ///< standard errors that the size of a matrix must have to count
constexpr double kImbalance = 3.0;    ///< ratio of m_xy to m_yx from which the axes have different scales
constexpr double kSameFactor = 3.0;   ///< within which M, B and K must be lopsided by the same
constexpr double kSignificant = 5.0;  ///< standard errors of what m_xy and m_yx differ by
constexpr double kAlsoLikely = 0.5;   ///< decades: explanations that far behind the likeliest are named beside it
constexpr double kPriceOfAxis = 0.5;  ///< decades: that one axis is wrong needs more evidence than that both are
constexpr double kPriceOfGain = 1.0;  ///< and that a gain is wrong more than a unit

/// A matrix of the model and its standard errors.
struct KnownPart {
  Matrix Z, error;

  /// (σ₁ + … + σₙ)/n, whatever the signs and the order of the axes.
  [[nodiscard]] double size() const { return numeric::singular_values(Z).mean(); }
  [[nodiscard]] double size_error() const { return error.norm() / std::sqrt(static_cast<double>(Z.rows())); }
  [[nodiscard]] bool known() const { return Z.size() > 0 && Z.allFinite() && size() > kKnown * size_error(); }
};

/// What is held against the ranges.
struct Numbers {
  Vector position, motion, speed, force;  ///< axis by axis
  double rate = 0.0;
  bool explained = false;    ///< the model explains enough of the force for its size to count
  double handle_mass = 0.0;  ///< [kg] subtracted from M, whatever its scale
  KnownPart M, B, K;
};

/// A number that lies outside its range.
struct Violation {
  const PlausibleRange* range;
  double value;
  Index axis;  ///< −1: of all
};

/// What may have been read wrongly: x = position·(x as read), and so on.
struct Explanation {
  Vector position, force;
  double time = 1.0;
  double price = 0.0;  ///< decades
  std::string what;
  ChannelCure cure;
  double rate = 0.0;  ///< --rate that is right, where the clock came from there
  double distance = 0.0;
};

/// What one value in a thousand exceeds.
double largest_but_glitches(const Vector& values) {
  Vector largest(values.size() / 1000 + 1);
  std::partial_sort_copy(values.begin(), values.end(), largest.begin(), largest.end(), std::greater());
  return largest[largest.size() - 1];
}

Numbers measure(const std::vector<PreparedTrial>& trials, const Identification& id) {
  const Index n = id.axes;
  Numbers numbers{
      Vector::Zero(n), Vector::Zero(n), Vector::Zero(n), Vector::Zero(n), 0.0, false, id.handle_mass, {}, {}, {}};
  for (const PreparedTrial& trial : trials) {
    numbers.rate = std::max(numbers.rate, trial.recording_rate);
    for (const Segment& segment : trial.segments) {
      for (Index axis = 0; axis < n; ++axis) {
        const auto rows = [&](const Matrix& all) {
          return Vector(all.col(axis).segment(segment.begin, segment.size()));
        };
        const auto larger = [axis](Vector& of, double value) { of[axis] = std::max(of[axis], value); };
        const Vector position = rows(trial.position);
        larger(numbers.position, std::abs(position.mean()));
        larger(numbers.speed, largest_but_glitches(rows(trial.velocity).cwiseAbs()));
        if (segment.size() < 2) continue;
        larger(numbers.motion, std::sqrt(numeric::variance(position)));
        larger(numbers.force, std::sqrt(numeric::variance(rows(trial.force_hand_on_robot))));
      }
    }
  }
  // A filter that hides the inertia leaves no model that could be held against anything, nor does a poor fit.
  numbers.explained = id.fit.vaf.size() > 0 && id.fit.vaf.minCoeff() > kExplained;
  if (std::ranges::any_of(id.preparations, cuts_into_band)) return numbers;
  numbers.M = {id.model.M, id.standard_error.M};
  numbers.B = {id.model.B, id.standard_error.B};
  numbers.K = {id.model.K, id.standard_error.K};
  if (id.structure == Structure::mass_spring) numbers.B = {};
  return numbers;
}

Numbers explained(Numbers n, const Explanation& by) {
  n.position = n.position.cwiseProduct(by.position);
  n.motion = n.motion.cwiseProduct(by.position);
  n.speed = n.speed.cwiseProduct(by.position) / by.time;
  n.force = n.force.cwiseProduct(by.force);
  n.rate /= by.time;
  const auto scale = [&](KnownPart& part, double time) {
    if (part.Z.size() == 0) return;
    for (Matrix* Z : {&part.Z, &part.error}) {
      *Z = time * (by.force.asDiagonal() * *Z * by.position.cwiseInverse().asDiagonal());
    }
  };
  const Matrix handle = n.handle_mass * Matrix::Identity(n.M.Z.rows(), n.M.Z.cols());
  n.M.Z += handle;
  scale(n.M, by.time * by.time);
  n.M.Z -= handle;
  scale(n.B, by.time);
  scale(n.K, 1.0);
  return n;
}

/// What of a range a number leaves, counting its standard error.
bool outside(const PlausibleRange& range, double value, double error) {
  return value + 2.0 * error < range.low || value - 2.0 * error > range.high;
}

const KnownPart& part_of(const Numbers& numbers, PlausibleQuantity quantity) {
  return quantity == PlausibleQuantity::inertia   ? numbers.M
         : quantity == PlausibleQuantity::damping ? numbers.B
                                                  : numbers.K;
}

/// √(K/M)/2π with its standard error; nothing where either is not known.
std::optional<std::pair<double, double>> frequency_of(const Numbers& n) {
  if (!n.M.known() || !n.K.known()) return std::nullopt;
  const double value = std::sqrt(n.K.size() / n.M.size()) / (2.0 * std::numbers::pi);
  const double relative = 0.5 * std::hypot(n.K.size_error() / n.K.size(), n.M.size_error() / n.M.size());
  return std::pair(value, relative * value);
}

const Vector& signal_of(const Numbers& n, PlausibleQuantity quantity) {
  switch (quantity) {
    case PlausibleQuantity::position:
      return n.position;
    case PlausibleQuantity::motion:
      return n.motion;
    case PlausibleQuantity::speed:
      return n.speed;
    default:
      return n.force;
  }
}

std::vector<Violation> violations(const Numbers& n, std::span<const PlausibleRange> ranges,
                                  const std::set<PlausibleQuantity>& ignored) {
  const bool limb = n.M.known() || n.B.known() || n.K.known();
  std::vector<Violation> found;
  for (const PlausibleRange& range : ranges) {
    using enum PlausibleQuantity;
    if (ignored.contains(range.quantity)) continue;
    switch (range.quantity) {
      case inertia:
      case damping:
      case stiffness: {
        // What is too small to be seen at all is too small, where the limb is seen in another way.
        const KnownPart& part = part_of(n, range.quantity);
        const bool counts = n.explained && (part.known() || (limb && part.Z.size() > 0));
        if (counts && outside(range, part.size(), part.size_error())) found.push_back({&range, part.size(), -1});
        break;
      }
      case frequency:
        if (const auto f = frequency_of(n); n.explained && f && outside(range, f->first, f->second)) {
          found.push_back({&range, f->first, -1});
        }
        break;
      case rate:
        if (outside(range, n.rate, 0.0)) found.push_back({&range, n.rate, -1});
        break;
      default: {
        // Too much in one axis is too much; too little it is only where the other one has no more, and where there is
        // a limb at all: a handle that nobody holds has no force.
        const Vector& values = signal_of(n, range.quantity);
        const bool seen = limb || range.quantity != force;
        if (seen && values.maxCoeff() < range.low) {
          found.push_back({&range, values.maxCoeff(), -1});
          break;
        }
        for (Index axis = 0; axis < values.size(); ++axis) {
          if (values[axis] > range.high) found.push_back({&range, values[axis], axis});
        }
      }
    }
  }
  return found;
}

/// log₁₀ of z_xy / z_yx, where the two surely differ; 0 otherwise.
double lopsided(const KnownPart& part) {
  if (part.Z.size() == 0 || !part.Z.allFinite()) return 0.0;
  const double xy = part.Z(0, 1), yx = part.Z(1, 0), error = std::hypot(part.error(0, 1), part.error(1, 0));
  if (!(std::abs(xy - yx) > kSignificant * error)) return 0.0;
  const auto at_least = [](double value, double its_error) { return std::max(std::abs(value), its_error); };
  return std::log10(at_least(xy, part.error(0, 1)) / at_least(yx, part.error(1, 0)));
}

/// log₁₀ of how many times more the force along x comes from y than the other way round; 0 where nothing shows that
/// the axes have different scales. A limb's inertia is symmetric, and its damping and stiffness nearly so: a wrong
/// scale of one axis makes all of them lopsided by the same factor, and what only biases them does not.
double imbalance(const Numbers& n) {
  if (n.M.Z.rows() != 2) return 0.0;
  const double least = std::log10(kImbalance), same = std::log10(kSameFactor), m = lopsided(n.M);
  if (!(std::abs(m) > least)) return 0.0;
  int confirmed = 0;
  for (const KnownPart* other : {&n.B, &n.K}) {
    const double r = lopsided(*other);
    if (r != 0.0 && std::abs(r - m) > same) return 0.0;
    confirmed += r != 0.0 ? 1 : 0;
  }
  return confirmed > 0 ? m : 0.0;
}

/// How far numbers are from the usual ones, in decades, axis by axis.
double distance(const Numbers& n, std::span<const PlausibleRange> ranges) {
  double sum = 0.0;
  int count = 0;
  const auto add = [&](double value, double typical) {
    if (!(value > 0.0)) return;
    sum += std::abs(std::log10(value / typical));
    ++count;
  };
  for (const PlausibleRange& range : ranges) {
    using enum PlausibleQuantity;
    switch (range.quantity) {
      case inertia:
      case damping:
      case stiffness:
        if (const KnownPart& part = part_of(n, range.quantity); part.known()) {
          for (const double value : part.Z.diagonal()) add(std::abs(value), range.typical);
        }
        break;
      case frequency:
        if (const auto f = frequency_of(n)) add(f->first, range.typical);
        break;
      case rate:
        add(n.rate, range.typical);
        break;
      case position:
        break;  // a place may be anywhere
      default:
        for (const double value : signal_of(n, range.quantity)) add(value, range.typical);
    }
  }
  return count > 0 ? sum / count : 0.0;
}

double si_per(std::string_view unit) {
  const recording::Unit* const known = recording::find_unit(unit);
  return known == nullptr ? 1.0 : known->to_si(1.0);
}

/// Everything that may have been read wrongly, one thing at a time.
class Explanations {
 public:
  Explanations(const Recording& recording, const std::vector<PreparedTrial>& trials, int axes)
      : recording_(recording), trial_(trials.front()), axes_(axes) {
    of_signal(kPositionChannels, true);
    of_signal(kForceChannels, false);
    of_clock();
  }
  std::vector<Explanation> take() { return std::move(all_); }

 private:
  [[nodiscard]] Explanation nothing() const {
    return {Vector::Ones(axes_), Vector::Ones(axes_), 1.0, 0.0, "", {}, 0.0, 0.0};
  }

  /// "x", "Fy"; "x and y", "x, y and z" of all.
  [[nodiscard]] std::string names(const QuantityChannels& quantity, int axis) const {
    const auto name = [&](int of) { return name_of(recording_, quantity, axes_, of); };
    if (axis >= 0) return name(axis);
    std::string all = name(0);
    for (int k = 1; k < axes_; ++k) all += (k + 1 == axes_ ? " and " : ", ") + name(k);
    return all;
  }

  void of_signal(const QuantityChannels& quantity, bool position) {
    const Channel* const channel = recording_.find(quantity.name(axes_, 0));
    if (channel == nullptr) return;
    const std::string now = channel->origin.unit.empty() ? channel->unit : channel->origin.unit;
    const recording::Unit* const read_as = recording::find_unit(now);
    const auto possible = [&](const recording::Unit& unit) {
      using enum recording::Dimension;
      if (read_as != nullptr) return unit.dimension == read_as->dimension;
      return position ? unit.dimension == length || unit.dimension == angle
                      : unit.dimension == force || unit.dimension == torque;
    };
    std::vector<double> seen;
    for (const recording::Unit& unit : recording::units()) {
      const double factor = unit.to_si(1.0) / si_per(now);
      if (!possible(unit) || std::abs(std::log(factor)) < 1e-6 || std::ranges::find(seen, factor) != seen.end())
        continue;
      seen.push_back(factor);
      add(quantity, position, factor, 0.0, std::string(unit.name));
    }
    for (const double gain : {10.0, 100.0, 1000.0, 1e4}) {
      for (const double factor : {gain, 1.0 / gain}) {
        const bool said = std::ranges::any_of(seen, [&](double one) { return std::abs(std::log(one / factor)) < 0.1; });
        if (!said) add(quantity, position, factor, kPriceOfGain, "");
      }
    }
  }

  /// @param unit  that it may be in; "" for a gain
  void add(const QuantityChannels& quantity, bool position, double factor, double price, const std::string& unit) {
    for (int axis = -1; axis < (axes_ == 1 ? 0 : axes_); ++axis) {
      Explanation one = nothing();
      one.price = price + (axis < 0 ? 0.0 : kPriceOfAxis);
      for (int k = 0; k < axes_; ++k) {
        if (axis >= 0 && k != axis) continue;
        (position ? one.position : one.force)[k] = factor;
        AxisCure& cure = (position ? one.cure.position : one.cure.force)[static_cast<std::size_t>(k)];
        if (unit.empty()) {
          cure.gain = factor;
        } else {
          cure.unit = unit;
        }
      }
      const bool several = axis < 0 && axes_ > 1;
      one.what = unit.empty() ? fmt::format("{} {} {:g} times too {}", names(quantity, axis), several ? "are" : "is",
                                            std::max(factor, 1.0 / factor), factor > 1.0 ? "small" : "large")
                              : fmt::format("{} {} in {}", names(quantity, axis), several ? "are" : "is", unit);
      if (position && axis < 0 && !unit.empty() && reference_moves_alike()) one.cure.reference_unit = unit;
      all_.push_back(std::move(one));
    }
  }

  /// A reference that moves as far as the position has the same unit.
  [[nodiscard]] bool reference_moves_alike() const {
    if (trial_.reference_quantity != ReferenceQuantity::position || trial_.reference.size() == 0) return false;
    const auto moves = [](const Matrix& columns) {
      return std::sqrt((columns.rowwise() - columns.colwise().mean()).squaredNorm());
    };
    const double ratio = moves(trial_.reference) / moves(trial_.position);
    return ratio > 0.1 && ratio < 10.0;
  }

  void of_clock() {
    if (recording_.time_from_rate) {
      for (const double factor : {0.01, 0.1, 10.0, 100.0, 1e3, 1e-3}) {
        Explanation one = nothing();
        one.time = factor;
        one.rate = trial_.recording_rate / factor;
        one.what = fmt::format("the sampling rate is {:g} Hz", one.rate);
        all_.push_back(std::move(one));
      }
      return;
    }
    const std::string now = recording_.time_origin.unit.empty() ? "s" : recording_.time_origin.unit;
    for (const recording::Unit& unit : recording::units()) {
      if (unit.dimension != recording::Dimension::time || unit.name == now) continue;
      Explanation one = nothing();
      one.time = unit.to_si(1.0) / si_per(now);
      one.what = fmt::format("time is in {}", unit.name);
      one.cure.time_unit = unit.name;
      all_.push_back(std::move(one));
    }
  }

  const Recording& recording_;
  const PreparedTrial& trial_;
  int axes_;
  std::vector<Explanation> all_;
};

/// The option for that reading: "--channels …", "--rate 1000"; "" if there is none.
std::string option_of(const Explanation& one, const Recording& recording, int axes) {
  if (one.rate > 0.0) return fmt::format("--rate {:g}", one.rate);
  return cured_channels(recording, axes, one.cure).value_or("");
}

constexpr const char* kCheck = "check the column, the unit and the gain of every channel with 'mbk info'";

/// "if x is in mm: --channels …; or, …"; "" where nothing is likely.
std::string cures_of(std::span<const Explanation> likely, const Recording& recording, int axes) {
  std::string text;
  constexpr std::size_t kNamed = 2;
  for (const Explanation& one : likely.first(std::min(likely.size(), kNamed))) {
    const std::string option = option_of(one, recording, axes);
    text += fmt::format("{}if {}: {}", text.empty() ? "" : "; or, ", one.what,
                        option.empty() ? "state the unit with --channels, as in x=2:mm" : option);
  }
  return text;
}

std::string remedy_of(std::span<const Explanation> likely, const Recording& recording, int axes) {
  if (likely.empty()) {
    return fmt::format("{} and state them with --channels, as in x=2:mm; --ranges lists the plausible ranges", kCheck);
  }
  return fmt::format("{}; otherwise {}; --ranges lists the plausible ranges", cures_of(likely, recording, axes),
                     kCheck);
}

std::string message_of(const std::vector<Violation>& found, const Recording& recording, int axes, bool joint) {
  constexpr std::size_t kShown = 4;
  std::string text = joint ? "outside the plausible range of a joint:" : "outside the plausible range of a hand:";
  for (std::size_t k = 0; k < std::min(found.size(), kShown); ++k) {
    const Violation& one = found[k];
    const QuantityChannels& channels =
        one.range->quantity == PlausibleQuantity::force ? kForceChannels : kPositionChannels;
    const Channel* const channel = one.axis < 0 ? nullptr : recording.find(channels.name(axes, one.axis));
    const std::string of = channel == nullptr || axes == 1 ? "" : fmt::format(" of {}", name_of(*channel));
    text += fmt::format("{} {}{} {:.3g} {} ({:g} to {:g})", k == 0 ? "" : ",", word_of(one.range->quantity), of,
                        one.value, one.range->unit, one.range->low, one.range->high);
  }
  return text;
}

using Families = std::vector<std::span<const PlausibleRange>>;

/// Those that make all plausible, the likeliest first.
template <class Plausible>
std::vector<Explanation> likeliest(std::vector<Explanation> all, const Numbers& numbers, const Families& families,
                                   const Plausible& plausible) {
  std::vector<Explanation> likely;
  for (Explanation& one : all) {
    const Numbers then = explained(numbers, one);
    if (!plausible(then)) continue;
    one.distance = std::numeric_limits<double>::infinity();
    for (const auto& ranges : families) one.distance = std::min(one.distance, distance(then, ranges));
    one.distance += one.price;
    likely.push_back(std::move(one));
  }
  std::ranges::stable_sort(likely, {}, &Explanation::distance);
  std::erase_if(likely, [&](const Explanation& one) { return one.distance > likely.front().distance + kAlsoLikely; });
  return likely;
}

/// Mean and standard deviation of the numbers of a channel; zeros where there is none.
std::pair<double, double> mean_and_deviation(const Channel* channel) {
  double sum = 0.0, squares = 0.0;
  Index n = 0;
  const auto each = [&](const auto& use) {
    for (Index i = 0; channel != nullptr && i < channel->values.size(); ++i) {
      if (std::isfinite(channel->values[i])) use(channel->values[i]);
    }
  };
  each([&](double value) { sum += value, ++n; });
  const double mean = n > 0 ? sum / static_cast<double>(n) : 0.0;
  each([&](double value) { squares += (value - mean) * (value - mean); });
  return {mean, n > 0 ? std::sqrt(squares / static_cast<double>(n)) : 0.0};
}

/// How to read a clock that runs at no plausible rate.
std::vector<Explanation> of_clock_alone(std::vector<Explanation> all, double rate, const PlausibleRange& range) {
  std::erase_if(all, [&](const Explanation& one) { return one.time == 1.0 || outside(range, rate / one.time, 0.0); });
  const auto far = [&](const Explanation& one) { return std::abs(std::log10(rate / one.time / range.typical)); };
  std::ranges::stable_sort(all, {}, far);
  return all;
}

}  // namespace

Error explain_clock(Error error, const Recording& recording, const Inspection& inspection, int axes) {
  const PlausibleRange& range = *std::ranges::find(kHandRanges, PlausibleQuantity::rate, &PlausibleRange::quantity);
  if (!(inspection.rate_hz > 0.0) || !outside(range, inspection.rate_hz, 0.0)) return error;
  const int n = axes != 0 ? axes : (recording.find(kPositionChannels.one_axis) != nullptr ? 1 : 2);
  PreparedTrial trial;
  trial.axes = n;
  trial.recording_rate = inspection.rate_hz;
  const auto likely = of_clock_alone(Explanations(recording, {trial}, n).take(), inspection.rate_hz, range);
  error.message = fmt::format("the sample rate is {:.3g} Hz, but {:g} to {:g} Hz are plausible; {}", inspection.rate_hz,
                              range.low, range.high, error.message);
  error.kind = ErrorKind::data;  // an option that does not fit is no mistake then
  error.remedy = remedy_of(std::span(likely).first(std::min<std::size_t>(likely.size(), 1)), recording, n);
  return error;
}

std::optional<Warning> check_size(const Recording& recording, const Inspection& inspection) {
  constexpr double kLong = 3600.0;  // [s] a low rate is that of a slow log, unless it lasts for hours
  const bool one_axis =
      recording.find(kPositionChannels.one_axis) != nullptr || recording.find(kForceChannels.one_axis) != nullptr;
  const int axes = one_axis ? 1 : 2;
  const PlausibleRange& rates = *std::ranges::find(kHandRanges, PlausibleQuantity::rate, &PlausibleRange::quantity);
  Numbers numbers{Vector::Zero(axes),
                  Vector::Zero(axes),
                  Vector::Zero(axes),
                  Vector::Zero(axes),
                  rates.typical,
                  false,
                  0.0,
                  {},
                  {},
                  {}};
  for (Index axis = 0; axis < axes; ++axis) {
    const auto [place, motion] = mean_and_deviation(recording.find(kPositionChannels.name(axes, axis)));
    numbers.position[axis] = std::abs(place);
    numbers.motion[axis] = motion;
    numbers.force[axis] = mean_and_deviation(recording.find(kForceChannels.name(axes, axis))).second;
  }
  if (inspection.rate_hz < rates.low && inspection.duration > kLong) numbers.rate = inspection.rate_hz;

  const Channel* const position = recording.find(kPositionChannels.one_axis);
  const std::string_view unit = position == nullptr ? std::string_view("m") : std::string_view(position->unit);
  Families families;
  if (unit != "rad") families.emplace_back(kHandRanges);
  if (unit != "m") families.emplace_back(kJointRanges);
  // Nothing need move or be pushed, so that only what is too large counts.
  const auto too_large = [](const Numbers& n, std::span<const PlausibleRange> ranges) {
    auto found = violations(n, ranges, {PlausibleQuantity::speed});
    std::erase_if(found, [](const Violation& one) {
      return one.value < one.range->low && one.range->quantity != PlausibleQuantity::rate;
    });
    return found;
  };
  const auto plausible = [&](const Numbers& n) {
    return std::ranges::any_of(families, [&](const auto& ranges) { return too_large(n, ranges).empty(); });
  };
  if (plausible(numbers)) return std::nullopt;
  PreparedTrial trial;
  trial.axes = axes;
  trial.recording_rate = inspection.rate_hz;
  // Of half a plane no --channels can be written.
  const bool whole = channels_of(recording, kPositionChannels, axes).cols() > 0 &&
                     channels_of(recording, kForceChannels, axes).cols() > 0;
  const auto likely = whole ? likeliest(Explanations(recording, {trial}, axes).take(), numbers, families, plausible)
                            : std::vector<Explanation>();
  const auto found = too_large(numbers, families.front());
  return Warning{
      WarningCode::implausible_scale, message_of(found, recording, axes, unit == "rad"),
      likely.empty() ? "check the column, the unit and the gain of every channel" : cures_of(likely, recording, axes)};
}

std::optional<Warning> check_scale(const std::vector<const Recording*>& recordings,
                                   const std::vector<PreparedTrial>& trials, const Measurement& measured,
                                   const std::set<PlausibleQuantity>& ignored) {
  const Identification& identification = measured.identification;
  const Recording& recording = *recordings.front();
  const int axes = identification.axes;
  const Numbers numbers = measure(trials, identification);
  // In a closed loop one of the methods may be lopsided by its bias.
  const bool same_scale =
      imbalance(numbers) == 0.0 || (measured.alternative && imbalance(measure(trials, *measured.alternative)) == 0.0);
  const std::span<const PlausibleRange> hand = kHandRanges, joint = kJointRanges;
  // Where the file does not say what moves, either may be meant.
  Families families;
  if (identification.motion != Motion::rotation) families.push_back(hand);
  if (identification.motion != Motion::translation) families.push_back(joint);
  const auto plausible = [&](const Numbers& n) {
    return (same_scale || imbalance(n) == 0.0) &&
           std::ranges::any_of(families, [&](const auto& ranges) { return violations(n, ranges, ignored).empty(); });
  };
  if (plausible(numbers)) return std::nullopt;

  const auto likely = likeliest(Explanations(recording, trials, axes).take(), numbers, families, plausible);

  const auto& ranges = families.front();
  const auto found = violations(numbers, ranges, ignored);
  const std::string remedy = remedy_of(likely, recording, axes);
  if (!found.empty()) {
    return Warning{WarningCode::implausible_scale, message_of(found, recording, axes, ranges.data() == joint.data()),
                   remedy};
  }
  const double times = std::pow(10.0, std::abs(imbalance(numbers)));
  return Warning{WarningCode::axes_scaled_differently,
                 fmt::format("inertia and stiffness couple {:.2g} times more from {} than in the other direction, "
                             "which is impossible for a limb: the axes have different scales",
                             times, imbalance(numbers) > 0.0 ? "y on x" : "x on y"),
                 remedy};
}

}  // namespace mbk::analyse
