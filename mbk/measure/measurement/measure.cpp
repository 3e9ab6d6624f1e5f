#include "mbk/measure/measurement/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/numeric/statistics.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/measure/analyse/absorbed_energy.h"
#include "mbk/measure/analyse/analyse_joint_domain.h"
#include "mbk/measure/analyse/bootstrap.h"
#include "mbk/measure/analyse/compare_forces.h"
#include "mbk/measure/analyse/diagnose.h"
#include "mbk/measure/analyse/ellipses.h"
#include "mbk/measure/analyse/energy_lines.h"
#include "mbk/measure/analyse/judge_passivity.h"
#include "mbk/measure/analyse/plausibility.h"
#include "mbk/measure/analyse/plausible_scale.h"
#include "mbk/measure/analyse/posture.h"
#include "mbk/measure/analyse/tremor.h"
#include "mbk/measure/identify/consistent_model.h"
#include "mbk/measure/preprocess/exclusions.h"
#include "mbk/measure/preprocess/force_delay.h"
#include "mbk/measure/preprocess/force_rotation.h"
#include "mbk/measure/preprocess/jittered_clock.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::measurement {
namespace {

/// Within the analysed interval; saturation outside it is harmless.
void warn_of_clipping(const Recording& recording, PreparedTrial& trial) {
  const Preparation& how = trial.preparation;
  for (const ChannelFacts& facts : recording::clipped_channels(recording, how.from_s, how.to_s)) {
    trial.warnings.push_back({WarningCode::clipping,
                              fmt::format("channel '{}' repeatedly stays at its extreme value ({:g} to {:g} {}): the "
                                          "sensor or converter was saturated",
                                          facts.name, facts.min, facts.max, facts.unit),
                              "perturb less, increase the range of the sensor, or choose a window without saturation"});
  }
}

/// Interpolation across a gap is reported as such.
void warn_of_resampling(const Inspection& recorded, Hertz rate, PreparedTrial& trial) {
  std::string message = fmt::format("the samples were interpolated linearly to a uniform clock of {:g} Hz", rate.value);
  if (!recorded.gaps.empty()) {
    const Gap& longest = *std::ranges::max_element(recorded.gaps, {}, &Gap::length);
    message +=
        fmt::format(", and {} gap{} filled by interpolation, the longest of {:.3g} s at {:.3f} s", recorded.gaps.size(),
                    recorded.gaps.size() == 1 ? " was" : "s were", longest.length, longest.time);
  }
  trial.warnings.push_back({WarningCode::resampled, std::move(message),
                            recorded.gaps.empty() ? "record with a steady clock"
                                                  : "choose a window without long gaps with --from and --to"});
}

/// An error, with the file in which it is.
tl::unexpected<Error> in_file(const Recording& recording, const Error& error) {
  return tl::unexpected<Error>(recording.sources.empty() ? error : error.in(recording.sources[0].label()));
}

/// A recording as it is analysed: on an even clock and with a computed force, where that was asked.
struct Source {
  const Recording* given = nullptr;
  Inspection recorded;            ///< of `given`
  std::optional<Recording> even;  ///< or with a force that was put where it belongs
  std::optional<Hertz> clock;     ///< of `even`, where one was chosen
  std::optional<Warning> jitter;  ///< of the recorded clock, where `even` is its cure
  std::optional<preprocess::VirtualForce> computed;
  std::optional<Recording> blanked;  ///< without what the operator excluded, where that is left out

  [[nodiscard]] const Recording& recording() const {
    if (computed) return computed->recording;
    return even ? *even : *given;
  }
  /// What counts of it, sample by sample.
  [[nodiscard]] const Recording& counted() const { return blanked ? *blanked : recording(); }
  [[nodiscard]] tl::unexpected<Error> in_file(const Error& error) const { return measurement::in_file(*given, error); }
};

/// The even clock of a session that missed ticks, where a line across them is shorter than anything that the limb does.
std::optional<Hertz> clock_across_missed_ticks(const Recording& recording, const Inspection& inspection) {
  constexpr double kLongest = 0.1;    // [s], a third of the shortest period that is excited
  constexpr double kMaxShare = 0.05;  // of the time
  if (inspection.gaps.empty() || !inspection.missing.empty() || inspection.duplicated_times > 0 ||
      inspection.backward_times > 0) {
    return std::nullopt;
  }
  const auto rate = recording.metadata.find("rate_hz");
  if (rate == recording.metadata.end()) return std::nullopt;
  double hz = 0.0;
  const std::string& text = rate->second;
  if (std::from_chars(text.data(), text.data() + text.size(), hz).ec != std::errc() || !(hz > 0.0)) return std::nullopt;
  double bridged = 0.0;
  for (const Gap& gap : inspection.gaps) {
    if (!(gap.length <= kLongest)) return std::nullopt;
    bridged += gap.length;
  }
  return bridged <= kMaxShare * inspection.duration ? std::optional(Hertz(hz)) : std::nullopt;
}

Result<Source> make_ready(const Recording& recording, const Options& options) {
  Source source{&recording, recording::inspect(recording), {}, options.resample, {}, {}, {}};
  if (!source.clock && options.preprocess.mode == Mode::default_mode) {
    source.clock = clock_across_missed_ticks(recording, source.recorded);
  }
  if (source.clock || options.preprocess.mode == Mode::default_mode) {
    auto even = MBK_TRY(preprocess::reclocked(recording, source.recorded, source.clock));
    source.even = std::move(even.recording);
    source.jitter = std::move(even.warning);
  }
  if (options.force_delay != 0.0) {
    source.even = MBK_TRY(preprocess::undo_force_delay(source.recording(), options.force_delay));
  }
  if (options.force_rotation != preprocess::RotationVector{}) {
    source.even = MBK_TRY(preprocess::turn_force(source.recording(), options.force_rotation));
  }
  if (options.preprocess.force_source == ForceSource::sensor) return source;
  if (!options.preprocess.robot) return bad_usage("a computed force needs a robot model", "name it with --robot");
  const Inspection inspection = source.even ? recording::inspect(*source.even) : source.recorded;
  auto computed =
      MBK_TRY(preprocess::virtual_force(source.recording(), inspection, *options.preprocess.robot, options.preprocess));
  source.computed = std::move(computed);
  return source;
}

Result<std::vector<Source>> make_ready(std::span<const Recording> recordings, const Options& options) {
  std::vector<Source> sources;
  std::map<std::string, std::string> files;  // by hash and trial
  for (const Recording& recording : recordings) {
    for (const SourceFile& file : recording.sources) {
      const auto [twin, fresh] = files.emplace(file.sha256 + " " + file.trial, file.label());
      if (!fresh && !file.sha256.empty()) {
        return bad_data(fmt::format("this is the same file as {}", twin->second), "pool each trial once", file.label());
      }
    }
    if (auto ok = preprocess::check_consent(recording); !ok) return in_file(recording, ok.error());
    auto source = make_ready(recording, options);
    if (!source) return in_file(recording, source.error());
    const auto excluded = preprocess::excluded_windows(recording);  // what cannot be read is said by the preparation
    if (options.preprocess.mode == Mode::default_mode && excluded && !excluded->empty()) {
      source->blanked = preprocess::blanked(source->recording(), *excluded);
    }
    sources.push_back(std::move(*source));
  }
  return sources;
}

Result<PreparedTrial> prepare_one(const Source& source, const Options& options) {
  const Recording& recording = source.recording();
  const bool same = &recording == source.given;
  auto trial = preprocess::prepare(recording, same ? source.recorded : recording::inspect(recording),
                                   options.preprocess, source.computed ? &*source.computed : nullptr);
  if (!trial) {
    return tl::unexpected<Error>(
        analyse::explain_clock(trial.error(), recording, source.recorded, options.preprocess.axes));
  }
  warn_of_clipping(*source.given, *trial);
  if (options.force_delay != 0.0) {
    trial->notes.push_back(
        fmt::format("the force was shifted {:g} ms earlier, as requested", 1e3 * options.force_delay));
  }
  if (options.force_rotation != preprocess::RotationVector{}) {
    const auto& [x, y, z] = options.force_rotation;
    trial->notes.push_back(
        x == 0.0 && y == 0.0
            ? fmt::format("the force was rotated by {:g}° from x to y, as requested", kDegrees * z)
            : fmt::format("the force was rotated by the rotation vector ({:g}, {:g}, {:g})°, as requested",
                          kDegrees * x, kDegrees * y, kDegrees * z));
  }
  if (source.clock) warn_of_resampling(source.recorded, *source.clock, *trial);
  if (source.jitter) trial->warnings.push_back(*source.jitter);
  return trial;
}

/// The computed force beside the sensor's, on one segment that counts: both filtered alike.
analyse::ForcePair force_pair(const Source& source, const PreparedTrial& computed, const PreparedTrial& sensed,
                              const Segment& segment) {
  analyse::ForcePair pair{computed.force_hand_on_robot.middleRows(segment.begin, segment.size()),
                          sensed.force_hand_on_robot.middleRows(segment.begin, segment.size()),
                          Matrix(segment.size(), source.computed->joint_velocity.cols())};
  for (Index i = 0; i < segment.size(); ++i) {
    pair.joint_velocity.row(i) =
        source.computed->joint_velocity.row(segment.first_sample + i * computed.preparation.every);
  }
  return pair;
}

/// Each recording prepared, its reference too; where several are pooled, their rows weigh alike.
Result<std::vector<PreparedTrial>> prepare_all(const std::vector<Source>& sources, Options options) {
  options.preprocess.instruments = true;
  std::vector<PreparedTrial> trials;
  for (const Source& source : sources) {
    auto trial = prepare_one(source, options);
    if (!trial) return source.in_file(trial.error());
    trials.push_back(std::move(*trial));
  }
  // Where each trial by itself would be decimated differently, the finest will do for all.
  Index finest = std::numeric_limits<Index>::max();
  for (const PreparedTrial& trial : trials) finest = std::min(finest, trial.preparation.every);
  options.preprocess.every = finest;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    if (trials[k].preparation.every == finest) continue;
    auto trial = prepare_one(sources[k], options);
    if (!trial) return sources[k].in_file(trial.error());
    trials[k] = std::move(*trial);
  }
  return trials;
}

/// The method of the result if none was requested, and why.
std::pair<Method, std::string> recommended(const std::vector<PreparedTrial>& trials, const identify::Comparison& both) {
  const auto by_force = [](const PreparedTrial& trial) { return trial.reference_quantity == ReferenceQuantity::force; };
  if (trials.front().preparation.mode == Mode::reference) return {Method::least_squares, "the published procedure"};
  const Identification& instrumental = both.instrumental_variables;
  if (!instrumental.instrument || !instrumental.instrument->strong()) {
    return {Method::least_squares,
            "the recorded reference explains too little of the motion for instrumental variables"};
  }
  if (!instrumental.usable) return {Method::least_squares, "instrumental variables are not usable"};
  if (std::ranges::all_of(trials, by_force)) {
    return {Method::instrumental_variables, "the reference is a force: limb and robot form a closed loop"};
  }
  return {Method::instrumental_variables, "the recorded reference explains the motion"};
}

/// With the requested or recommended method and, if a reference was recorded, also with the other one.
Result<Measurement> identify_by_both(const std::vector<PreparedTrial>& trials, const identify::Options& options) {
  const bool by_instruments = options.method == Method::instrumental_variables;
  const bool known =
      std::ranges::all_of(trials, [](const PreparedTrial& trial) { return trial.reference_motion.size() > 0; });
  if (known || by_instruments) {
    auto both = identify::compare_methods(trials, options);
    if (both) {
      auto &first = both->least_squares, &other = both->instrumental_variables;
      const auto [method, rule] = recommended(trials, *both);
      if (!options.method) first.method_rule = other.method_rule = rule;
      if (options.method.value_or(method) == Method::instrumental_variables) std::swap(first, other);
      Measurement measured;
      measured.identification = std::move(first);
      measured.alternative = std::move(other);
      measured.disagreement = both->disagreement;
      return measured;
    }
    if (by_instruments) return tl::unexpected(both.error());
  }
  auto alone = MBK_TRY(identify::identify_impedance(trials, options));
  if (trials.front().preparation.mode == Mode::default_mode && !known) {
    alone.warnings.push_back({WarningCode::no_reference,
                              "no reference was recorded, so it cannot be checked whether the limb itself moved the "
                              "robot, which would bias least squares",
                              "record the commanded position or force of the robot (xr, yr); the measured energy of "
                              "the trial remains valid"});
  }
  Measurement measured;
  measured.identification = std::move(alone);
  return measured;
}

std::vector<const Recording*> recordings_of(const std::vector<Source>& sources) {
  std::vector<const Recording*> recordings;
  for (const Source& source : sources) recordings.push_back(&source.counted());
  return recordings;
}

/// The energy of each recording, and of all together.
Result<EnergyAccount> account_for_energy(const std::vector<Source>& sources, const std::vector<PreparedTrial>& trials,
                                         Measurement& measured) {
  const impedance::Model& model = measured.identification.model;
  const bool known = model.axes() == 2 && model.K.allFinite();
  for (std::size_t k = 0; k < sources.size(); ++k) {
    auto energy = MBK_TRY(analyse::absorbed_energy(sources[k].counted(), trials[k], {}, known ? &model : nullptr));
    measured.energies.push_back(std::move(energy));
  }
  if (sources.size() == 1) return measured.energies.front().account;
  return analyse::pooled_energy(recordings_of(sources), trials);
}

/// Results of both methods, the second one possibly null; first the one to rely on.
std::pair<const Identification*, const Identification*> both_methods(const Measurement& measured) {
  const Identification* first = &measured.identification;
  const Identification* other = measured.alternative ? &*measured.alternative : nullptr;
  const bool by_instruments = first->method == Method::instrumental_variables;
  if (!by_instruments && other != nullptr && analyse::prefer_instruments(*other, measured.disagreement)) {
    std::swap(first, other);
  }
  return {first, other};
}

/// The nearest model that a passive limb can have.
Result<void> add_consistent_model(const std::vector<PreparedTrial>& trials, Measurement& measured) {
  auto consistent = identify::consistent_model(trials, *both_methods(measured).first);
  if (consistent) {
    measured.consistent = std::move(*consistent);
  } else if (consistent.error().kind != ErrorKind::not_usable) {  // there is a model, but none that it could be near
    return tl::unexpected(consistent.error());
  }
  return {};
}

/// What happened in the trial, and what the model predicts.
Result<Passivity> judge_passivity(const std::vector<Source>& sources, const std::vector<PreparedTrial>& trials,
                                  const analyse::LineSpectra& spectra, const Options& options, Measurement& measured) {
  const auto [first, other] = both_methods(measured);
  auto energy = MBK_TRY(account_for_energy(sources, trials, measured));
  Passivity passivity;
  passivity.band = analyse::coherent_band(trials);
  PassivityBand band = passivity.band.value_or(analyse::excited_band(trials));
  if (options.band) band = analyse::asked_band(options.band->first, options.band->second, passivity.band);
  auto models = MBK_TRY(analyse::model_passivities({first, other}, band));
  passivity.models = std::move(models);
  passivity.trial =
      analyse::trial_passivity(measured.identification, std::move(energy), analyse::energy_lines(spectra));
  if (!passivity.trial) {
    for (Energy& one : measured.energies) {
      one.account.verdict = Verdict::undecided;
      one.account.reason = "force or motion is not plausible: see the warnings";
    }
  }
  passivity.prediction =
      analyse::predict_passivity(passivity.models, measured.identification.usable, passivity.band,
                                 passivity.trial ? passivity.trial->lines : std::vector<EnergyLine>());
  return passivity;
}

/// Where a sensor recorded the force that was computed: how far both are apart, and what the sensor's force gives.
Result<void> compare_with_sensor(const std::vector<Source>& sources, const std::vector<PreparedTrial>& trials,
                                 Options options, Measurement& measured) {
  const auto both = [](const Source& source) { return source.computed && source.computed->sensor_force.size() > 0; };
  if (!std::ranges::all_of(sources, both)) return {};
  options.preprocess.every = trials.front().preparation.every;
  std::vector<PreparedTrial> by_sensor;
  std::vector<analyse::ForcePair> pairs;
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const Source& source = sources[k];
    Recording sensed = source.computed->recording;
    for (Index axis = 0; axis < trials[k].axes; ++axis) {
      const char* const name = kForceChannels.name(trials[k].axes, axis);
      for (Channel& channel : sensed.channels) {
        if (channel.name == name) channel.values = source.computed->sensor_force.col(axis);
      }
    }
    preprocess::Options how = options.preprocess;
    how.force_source = ForceSource::sensor;
    how.instruments = true;
    auto trial = preprocess::prepare(sensed, recording::inspect(sensed), how);
    if (!trial || trial->time.size() != trials[k].time.size()) return {};  // a sensor that did not work
    for (const Segment& segment : trial->segments) pairs.push_back(force_pair(source, trials[k], *trial, segment));
    by_sensor.push_back(std::move(*trial));
  }
  measured.force_comparison = MBK_TRY(analyse::compare_forces(pairs, trials.front().sample_time));
  identify::Options how = options.identify;
  how.bootstrap = 0;
  how.method = measured.identification.method;
  measured.by_sensor = MBK_TRY(identify::identify_impedance(by_sensor, how));
  return {};
}

/// A parameter of M, B or K that differs significantly between sensor and computed force; "" if none does.
std::string contradicted_by_sensor(const Identification& computed, const Identification& sensed) {
  const Vector of_computed = stacked(computed.model), of_sensed = stacked(sensed.model);
  const Vector error = stacked(computed.standard_error), sensed_error = stacked(sensed.standard_error);
  const Index count = 3 * computed.axes * computed.axes;
  double most = 1.0;
  std::string which;
  for (Index k = 0; k < count; ++k) {
    const double half = numeric::kNormal95 * std::hypot(error[k], sensed_error[k]);
    const double apart = std::abs(of_computed[k] - of_sensed[k]) / half;
    if (!(apart > most)) continue;
    most = apart;
    const std::string& name = computed.parameters[static_cast<std::size_t>(k)];
    which = fmt::format("{} is {:.3g} ± {:.2g} {unit} with the computed force and {:.3g} with the force sensor", name,
                        of_computed[k], numeric::kNormal95 * error[k], of_sensed[k],
                        fmt::arg("unit", unit_of_parameter(name, computed.motion)));
  }
  return which;
}

/// A computed force is not usable if the recording shows that the robot has changed since its identification: a force
/// sensor contradicts it, or the force contains friction or negative damping, which changed friction of the robot
/// leaves in it. A sensor contradicts the force of a momentum observer in any case, because that force is delayed.
void warn_of_changed_robot(Measurement& measured) {
  Identification& id = measured.identification;
  std::string message;
  if (measured.by_sensor) {
    message = contradicted_by_sensor(id, *measured.by_sensor);
  } else {
    for (const auto& [code, what] :
         {std::pair(WarningCode::dry_friction, "the computed force contains dry friction, which a limb does not have"),
          std::pair(WarningCode::damping_not_positive, "the damping from the computed force is negative")}) {
      if (std::ranges::find(id.warnings, code, &Warning::code) != id.warnings.end()) message = what;
    }
  }
  if (message.empty()) return;
  id.usable = false;
  if (measured.alternative) measured.alternative->usable = false;
  id.warnings.insert(
      id.warnings.begin(),
      {WarningCode::robot_changed,
       message + ": the robot has changed since it was identified, for example its temperature",
       "identify the robot again, with the temperature, load and gains of the measurement, or use a force sensor"});
}

/// The result at the joints of the posture in which it was measured.
Result<JointDomain> at_joints(const std::vector<Source>& sources, const std::vector<PreparedTrial>& trials,
                              const Identification& identification) {
  constexpr double kSamePosture = 0.01;  // [m]: within it J changes by a few percent
  const auto posture_of = [&](std::size_t k) {
    const Preparation& how = trials[k].preparation;
    return analyse::posture(sources[k].counted(), how.from_s, how.to_s).value_or(ArmPosture{});
  };
  const ArmPosture first = posture_of(0);
  for (std::size_t k = 1; k < sources.size(); ++k) {
    const ArmPosture other = posture_of(k);
    double apart = other.of == first.of && other.points.size() == first.points.size()
                       ? 0.0
                       : std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < std::min(first.points.size(), other.points.size()); ++i) {
      apart = std::max(apart, (first.points[i] - other.points[i]).norm());
    }
    if (!(apart <= kSamePosture)) {
      return sources[k].in_file({ErrorKind::data,
                                 fmt::format("the pooled recordings were made in different postures, {:.3g} m apart "
                                             "(at most {:g} m share one J)",
                                             apart, kSamePosture),
                                 "measure them one by one", ""});
    }
  }
  auto found = analyse::analyse_joint_domain(identification, first);
  if (!found) return sources[0].in_file(found.error());
  return found;
}

Result<Measurement> measure_prepared(const std::vector<Source>& sources, const std::vector<PreparedTrial>& trials,
                                     const Options& options) {
  auto identified = identify_by_both(trials, options.identify);
  if (!identified) {
    return sources.size() == 1 ? sources[0].in_file(identified.error()) : tl::unexpected(identified.error());
  }
  Measurement measured = std::move(*identified);
  analyse::judge_plausibility(recordings_of(sources), trials, options.ignored_ranges, measured);
  if (const auto tremor = analyse::test_tremor(recordings_of(sources), trials)) {
    analyse::warn_of_tremor(*tremor, measured.identification);
    if (measured.alternative) analyse::warn_of_tremor(*tremor, *measured.alternative);
  }
  const analyse::LineSpectra spectra = analyse::line_spectra(recordings_of(sources), trials);
  for (Identification* id : {&measured.identification, measured.alternative ? &*measured.alternative : nullptr}) {
    if (id == nullptr) continue;
    if (const auto fit = analyse::test_lines(spectra, trials, *id)) analyse::warn_of_lines(*fit, *id);
  }
  if (measured.identification.axes > 1 && measured.identification.model.M.allFinite()) {
    MBK_TRY(analyse::add_ellipses(measured));
  }
  if (measured.identification.replicates) {
    auto bootstrap = MBK_TRY(analyse::bootstrap_findings(measured.identification));
    measured.bootstrap = std::move(bootstrap);
  }
  MBK_TRY(compare_with_sensor(sources, trials, options, measured));
  if (options.preprocess.force_source == ForceSource::virtual_sensor) warn_of_changed_robot(measured);
  if (options.joint_domain) {
    auto joints = MBK_TRY(at_joints(sources, trials, measured.identification));
    measured.joints = std::move(joints);
  }
  if (auto ok = add_consistent_model(trials, measured); !ok) return sources[0].in_file(ok.error());
  if (options.passivity) {
    auto passivity = judge_passivity(sources, trials, spectra, options, measured);
    if (!passivity) {
      return sources[0].in_file(passivity.error());
    }
    measured.passivity = std::move(*passivity);
  }
  return measured;
}

/// The same trial with ẍ from the other source; absent where the recording holds no accelerometer that could be used.
std::optional<PreparedTrial> with_other_acceleration(const Source& source, const PreparedTrial& trial,
                                                     Options options) {
  const bool sensor = trial.preparation.acceleration_from_sensor;
  if (!sensor && source.recording().find(kAccelerationChannels.name(trial.axes, 0)) == nullptr) {
    return std::nullopt;
  }
  options.preprocess.acceleration = sensor ? AccelerationSource::derivative : AccelerationSource::sensor;
  options.preprocess.every = trial.preparation.every;
  auto other = prepare_one(source, options);
  if (!other || other->time.size() != trial.time.size()) return std::nullopt;
  return std::move(*other);
}

Result<Diagnostics> diagnose(const Source& source, const PreparedTrial& trial, const Identification& identification,
                             const Options& options) {
  const auto other = with_other_acceleration(source, trial, options);
  return analyse::diagnose(source.counted(), trial, identification, other ? &*other : nullptr);
}

}  // namespace

Result<Measurement> measure(std::span<const Recording> recordings, const Options& options) {
  const auto sources = MBK_TRY(make_ready(recordings, options));
  const auto trials = MBK_TRY(prepare_all(sources, options));
  return measure_prepared(sources, trials, options);
}

Result<Examined> examine(std::span<const Recording> recordings, const Options& options) {
  const auto sources = MBK_TRY(make_ready(recordings, options));
  const auto trials = MBK_TRY(prepare_all(sources, options));
  auto measured = MBK_TRY(measure_prepared(sources, trials, options));
  Examined examined{std::move(measured), {}};
  for (std::size_t k = 0; k < sources.size(); ++k) {
    auto diagnostics = diagnose(sources[k], trials[k], examined.measured.identification, options);
    if (!diagnostics) return sources[k].in_file(diagnostics.error());
    examined.diagnostics.push_back(std::move(*diagnostics));
  }
  return examined;
}

}  // namespace mbk::measurement
