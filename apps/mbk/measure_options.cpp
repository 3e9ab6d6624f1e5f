#include "apps/mbk/measure_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>

#include "apps/mbk/option_checks.h"
#include "apps/mbk/robot_file.h"
#include "mbk/files/journal/journal.h"
#include "mbk/files/recording/channel_map.h"
#include "mbk/measure/preprocess/perturbation_only.h"
#include "mbk/present/report/html.h"

namespace mbk::app {
namespace {

constexpr const char* kWindow = "What counts";
constexpr const char* kFilters = "Filters";

/// One of a few words, named in the message when it is none of them.
CLI::Option* add_choice(CLI::App& command, const char* name, std::string& target,
                        const std::vector<std::string>& choices, const std::string& help) {
  std::string joined;
  for (const std::string& choice : choices) joined += (joined.empty() ? "" : "|") + choice;
  return command.add_option(name, target, help)->type_name(joined)->check(one_of(choices));
}

/// Limits of time must be in order; whether they lie in the recording is seen when it is read.
Result<void> check_order(const MeasureArguments& a) {
  const auto before = [](const char* first, std::optional<double> begin, const char* second,
                         std::optional<double> end) -> Result<void> {
    if (!begin || !end || *begin < *end) return {};
    return bad_usage(fmt::format("{} {:g} s is not before {} {:g} s", first, *begin, second, *end));
  };
  if (auto ok = before("--from", a.from_s, "--to", a.to_s); !ok) return ok;
  if (auto ok = before("--from", a.from_s, "--split", a.split_s); !ok) return ok;
  return before("--split", a.split_s, "--to", a.to_s);
}

/// X,Y,UPPER,FORE[,left|right] as the metadata that a recording would hold; nothing where it is none.
std::optional<std::map<std::string, std::string>> arm_metadata(const std::string& given) {
  constexpr std::array kKeys = {"shoulder_x_m", "shoulder_y_m", "upper_arm_m", "forearm_m", "elbow"};
  std::map<std::string, std::string> metadata = {{"elbow", "right"}};
  std::size_t begin = 0;
  for (std::size_t k = 0; k < kKeys.size(); ++k) {
    const std::size_t end = std::min(given.find(',', begin), given.size());
    const std::string word = given.substr(begin, end - begin);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool number = error == std::errc() && stop == word.data() + word.size() && std::isfinite(value);
    if (k < 2 ? !number : (k < 4 ? !number || !(value > 0.0) : word != "left" && word != "right")) return std::nullopt;
    metadata[kKeys[k]] = word;
    if (end == given.size()) return k >= 3 ? std::optional(metadata) : std::nullopt;
    begin = end + 1;
  }
  return std::nullopt;
}

}  // namespace

void add_reading_options(CLI::App& command, MeasureArguments& arguments) {
  command.add_option("FILE", arguments.files, "recordings: .mat (v4 to v7.3), .h5 or .csv")->required();
  command
      .add_option("--channels", arguments.channels,
                  "where the channels stand, where the file does not say it itself: x=2,y=3,Fx=10,Fy=11 names columns "
                  "(or rows of a wide matrix, or names in the file); x=2:mm converts, Fx=-10 flips. Channels: time, "
                  "x, y, Fx, Fy, xr, yr, q1 to q8, tau1 to tau8, qr1 to qr8, ax, ay, Vx, Vy; one axis: time, x, F, xr, "
                  "a; for mbk tf: input, output")
      ->type_name("MAP")
      ->check(not_empty());
  command.add_option("--variable", arguments.variable, "which variable of a MAT file, where several could be meant")
      ->type_name("NAME")
      ->check(not_empty());
  command.add_option("--rate", arguments.rate_hz, "sample rate, where the file holds no time")
      ->type_name("HZ")
      ->check(positive());
  command.add_option("--axes", arguments.axes, "1 or 2; otherwise by the channels that are there")
      ->type_name("N")
      ->check([](const std::string& n) {
        return n == "1" || n == "2" ? "" : fmt::format("{} is neither 1 nor 2", quoted(n));
      });
  command.add_flag("--parts", arguments.parts, "the FILEs are numbered parts of one record: join them");
}

void add_window_options(CLI::App& command, MeasureArguments& a) {
  command.add_option("--from", a.from_s, "first second that counts, from the start of the recording")
      ->type_name("S")
      ->check(not_negative())
      ->group(kWindow);
  command.add_option("--split", a.split_s, "data before it identify, data after it are held back")
      ->type_name("S")
      ->check(positive())
      ->group(kWindow);
  command.add_option("--to", a.to_s, "last second that counts")->type_name("S")->check(positive())->group(kWindow);
}

void add_filter_options(CLI::App& command, MeasureArguments& a) {
  command.add_option("--sg-window", a.sg_window, "Savitzky–Golay window W in samples, odd")
      ->type_name("W")
      ->check(odd_number(3, 1'000'001))
      ->group(kFilters);
  command.add_option("--sg-order", a.sg_order, "Savitzky–Golay order N (6)")
      ->type_name("N")
      ->check(whole_number(1, 1000))
      ->group(kFilters);
  command.add_option("--cutoff", a.cutoff, "zero-phase Butterworth low-pass; otherwise by the excited band")
      ->type_name("HZ|none")
      ->check([](const std::string& given) -> std::string {
        const bool good = given == "none" || positive()(given).empty();
        return good ? "" : fmt::format("{} is neither a positive number nor 'none'", quoted(given));
      })
      ->group(kFilters);
  add_choice(command, "--extension", a.extension, {"odd", "even", "constant"},
             "how signals are continued at their ends for the zero-phase filter (odd)")
      ->group(kFilters);
  command.add_option("--padding", a.padding, "by how many samples (15)")
      ->type_name("N")
      ->check(whole_number(0, 1'000'000))
      ->group(kFilters);
  command
      .add_option(
          "--every", a.every,
          "the fit takes every so many of the filtered samples; otherwise ten for each period of the cutoff, and "
          "all in reference mode")
      ->type_name("N")
      ->check(whole_number(1, 1'000'000))
      ->group(kFilters);
  command
      .add_option("--resample", a.resample_hz, "put an uneven clock right first, by straight lines; never done unasked")
      ->type_name("HZ")
      ->check(positive())
      ->group(kFilters);
}

void add_measuring_options(CLI::App& command, MeasureArguments& a) {
  add_choice(command, "--mode", a.mode, {"default", "reference"},
             "reference: the published procedure, sample for sample")
      ->group(kWindow);
  add_choice(command, "--procedure", a.procedure, {"chapter3", "chapter5"},
             "in reference mode: W 101, 5 Hz, ẍ from the position (this one unless said) | W 151, 4.5 Hz, ẍ from "
             "the accelerometer")
      ->group(kWindow);
  add_choice(command, "--protocol", a.protocol, {"auto", "sinusoidal", "underdamped", "free"},
             "how the limb was perturbed; auto looks at the reference and says what it saw")
      ->group(kWindow);
  add_window_options(command, a);
  command.add_flag("--pool", a.pool, "one fit over all FILEs; otherwise one result each and a summary")->group(kWindow);

  add_filter_options(command, a);
  add_choice(command, "--acceleration", a.acceleration, {"sensor", "derivative"}, "where ẍ comes from")
      ->group(kFilters);

  add_choice(command, "--force-source", a.force_source, {"sensor", "virtual", "observer"},
             "virtual: without a force sensor, from motion, motor torques and the robot's dynamics; observer: the same "
             "as it could be had while the robot runs, for comparison")
      ->group(kFilters);
  command
      .add_option("--robot", a.robot,
                  "the robot's dynamics, from 'mbk robot identify --json'; without it those of the thesis's robot")
      ->type_name("FILE")
      ->check(not_empty())
      ->group(kFilters);

  const char* const model = "Model";
  add_choice(command, "--method", a.method, {"ls", "iv"},
             "ls: least squares; iv: instrumental variables, which need the reference and hold in closed loop too")
      ->group(model);
  add_choice(command, "--structure", a.structure, {"full", "symmetric", "mass-spring"},
             "full; symmetric: M and K symmetric; mass-spring: M = m I, no damping, K symmetric")
      ->group(model);
  add_choice(command, "--parameters-from", a.parameters_from, {"identification", "all"},
             "all: parameters from every window, fit judged on the held-back half (default for underdamped)")
      ->group(model);
  command.add_option("--handle-mass", a.handle_mass, "mass between sensor and hand, taken off the inertia (0)")
      ->type_name("KG")
      ->check(not_negative())
      ->group(model);
  command.add_option("--hac-lag", a.hac_lag_s, "reach of the residual's correlation in the standard errors (1)")
      ->type_name("S")
      ->check(positive())
      ->group(model);
  command
      .add_option("--bootstrap", a.bootstrap,
                  "so many fits to data drawn anew from blocks of 2.5 s, for intervals of every parameter, ellipse, "
                  "eigenvalue and the excess of passivity that rest on no formula (0: none; 1000 take a moment)")
      ->type_name("N")
      ->check(whole_number(0, 1'000'000))
      ->group(model);
  command.add_option("--seed", a.seed, "of the bootstrap (1)")
      ->type_name("N")
      ->check(whole_number(0, 2'000'000'000))
      ->group(model);
  command.add_flag("--decimate-check", a.decimate_check, "fit again at 100 Hz and say what changes")->group(model);
  command.add_option("--threads", a.threads, "files measured at a time (as many as there are cores)")
      ->type_name("N")
      ->check(whole_number(1, 1024))
      ->group(model);
}

void add_output_options(CLI::App& command, MeasureArguments& arguments, const std::string& schema) {
  command.add_flag("--json", arguments.json, fmt::format("for machines: schema {}, SI units, every digit", schema));
  arguments.output.add_options(command);
  command.add_flag("--quiet", arguments.quiet, "no progress on standard error");
}

void add_domain_options(CLI::App& command, MeasureArguments& arguments) {
  add_choice(
      command, "--domain", arguments.domain, {"hand", "joint"},
      "joint: M, B and K at shoulder and elbow too (or at the joints of the robot, where the arm is not known), in "
      "the posture of the recording")
      ->group("Model");
  command
      .add_option("--arm", arguments.arm,
                  "the person's arm, where the recording does not hold it: place of the shoulder in the robot's frame, "
                  "lengths of upper arm and forearm (to the grip), in metres; the elbow is to the right unless ',left' "
                  "follows")
      ->type_name("X,Y,UPPER,FORE")
      ->check([](const std::string& given) {
        return arm_metadata(given) ? "" : fmt::format("{} is not X,Y,UPPER,FORE in metres", quoted(given));
      })
      ->group("Model");
}

void add_report_options(CLI::App& command, MeasureArguments& arguments) {
  CLI::Option* const report =
      command
          .add_option("--report", arguments.report,
                      "also write everything, with plots, as one HTML file to read, print or pass on")
          ->type_name("FILE")
          ->check(not_empty());
  command
      .add_option(
          "--report-note", arguments.report_note,
          "a line below the report's title, such as a date and a name; mbk adds no date of its own, so that the "
          "same inputs give the same report")
      ->type_name("TEXT")
      ->check(not_empty())
      ->needs(report);
  CLI::Option* const overwrite = command.get_option("--overwrite");
  overwrite->remove_needs(command.get_option("--out"));
  overwrite->description("replace the files of --out and --report where they are there");
}

Result<void> check_files(const MeasureArguments& arguments) {
  const Output& output = arguments.output;
  if (output.overwrite && !output.file && !arguments.report) {
    return bad_usage("--overwrite requires --out or --report", "name a file to write");
  }
  if (auto ok = output.check(arguments.files); !ok || !arguments.report) return ok;
  if (auto page = report::page(""); !page) return tl::unexpected(page.error());
  std::error_code error;
  if (output.file && std::filesystem::weakly_canonical(*output.file, error) ==
                         std::filesystem::weakly_canonical(*arguments.report, error)) {
    return bad_usage("--out and --report name the same file", "choose another name for one of them");
  }
  return check_new_file(*arguments.report, "--report", output.overwrite, arguments.files);
}

Result<recording::ReadOptions> read_options(const MeasureArguments& arguments) {
  recording::ReadOptions options;
  if (!arguments.channels.empty()) {
    auto map = recording::parse_channel_map(arguments.channels);
    if (!map) return tl::unexpected(map.error());
    options.channels = std::move(*map);
  }
  if (arguments.rate_hz) options.rate = Hertz(*arguments.rate_hz);
  options.axes = arguments.axes;
  options.untimed = arguments.untimed;
  options.variable = arguments.variable;
  options.wanted = arguments.wanted;
  return options;
}

/// Filters and window, which every command that fits a model has.
Result<preprocess::Options> signal_options(const MeasureArguments& a) {
  if (auto ok = check_order(a); !ok) return tl::unexpected(ok.error());
  preprocess::Options p;
  p.smoothing_order = a.sg_order;
  p.smoothing_window = a.sg_window;
  p.no_lowpass = a.cutoff == "none";
  if (!a.cutoff.empty() && !p.no_lowpass) {
    double hz = 0.0;
    std::from_chars(a.cutoff.data(), a.cutoff.data() + a.cutoff.size(), hz);
    p.cutoff = Hertz(hz);
  }
  p.window = {a.from_s, a.split_s, a.to_s};
  p.padding.samples = a.padding;
  p.every = a.every;
  p.padding.extension = a.extension == "even"       ? dsp::Extension::even
                        : a.extension == "constant" ? dsp::Extension::constant
                                                    : dsp::Extension::odd;
  return p;
}

Result<measurement::Options> measurement_options(const MeasureArguments& a) {
  const auto signals = signal_options(a);
  if (!signals) return tl::unexpected(signals.error());
  if (!a.procedure.empty() && a.mode != "reference") {
    return bad_usage(fmt::format("--procedure {} belongs to --mode reference", a.procedure),
                     "add that, or leave --procedure out");
  }
  if (!a.arm.empty() && a.domain != "joint" && !a.report) {
    return bad_usage("--arm belongs to --domain joint, or to --report, which draws it", "add one, or leave --arm out");
  }
  measurement::Options options;
  options.joint_domain = a.domain == "joint";
  options.preprocess = *signals;
  preprocess::Options& p = options.preprocess;
  p.mode = a.mode == "reference" ? Mode::reference : Mode::improved;
  p.procedure = a.procedure == "chapter5" ? Procedure::chapter5 : Procedure::chapter3;
  if (a.protocol == "sinusoidal") p.protocol = Protocol::sinusoidal;
  if (a.protocol == "underdamped") p.protocol = Protocol::underdamped;
  if (a.protocol == "free") p.protocol = Protocol::free;
  p.axes = a.axes;
  if (a.acceleration == "sensor") p.acceleration = preprocess::AccelerationSource::sensor;
  if (a.acceleration == "derivative") p.acceleration = preprocess::AccelerationSource::derivative;
  if (a.force_source == "virtual") p.force_source = ForceSource::virtual_sensor;
  if (a.force_source == "observer") p.force_source = ForceSource::observer;
  if (p.force_source != ForceSource::sensor) {
    auto robot = robot_of(a.robot);
    if (!robot) return tl::unexpected(robot.error());
    p.robot = std::make_shared<const robot::DynamicModel>(std::move(*robot));
  } else if (a.robot) {
    return bad_usage("--robot belongs to --force-source virtual or observer", "add that, or leave --robot out");
  }
  identify::Options& i = options.identify;
  if (a.method == "iv") i.method = Method::instrumental_variables;
  if (a.structure == "symmetric") i.structure = Structure::symmetric;
  if (a.structure == "mass-spring") i.structure = Structure::mass_spring;
  if (a.parameters_from == "all") i.parameters_from = identify::ParametersFrom::all;
  if (a.parameters_from == "identification") i.parameters_from = identify::ParametersFrom::identification;
  i.handle_mass = a.handle_mass;
  i.hac_lag_s = a.hac_lag_s;
  i.decimate_check = a.decimate_check;
  i.bootstrap = a.bootstrap;
  i.seed = a.seed;
  if (a.resample_hz) options.resample = Hertz(*a.resample_hz);
  return options;
}

Result<std::vector<Recording>> read_recordings(const MeasureArguments& arguments) {
  const auto options = read_options(arguments);
  if (!options) return tl::unexpected(options.error());
  const auto sensor = sensor_use(arguments.sensor);
  if (!sensor) return tl::unexpected(sensor.error());
  std::vector<Recording> recordings;
  const auto add = [&](Result<Recording> one, const std::filesystem::path& file) -> Result<void> {
    if (!one) return tl::unexpected(one.error());
    if (*sensor) {
      one = calibration::force_from_voltage(std::move(*one), **sensor);
      if (!one) return tl::unexpected(one.error().in(file.string()));
    }
    recordings.push_back(std::move(*one));
    return {};
  };
  if (arguments.parts) {
    if (auto ok = add(recording::read_parts(arguments.files, *options), arguments.files.front()); !ok) {
      return tl::unexpected(ok.error());
    }
    return recordings;
  }
  for (const std::filesystem::path& file : arguments.files) {
    if (journal::is_journal(file)) {
      return bad_data("is the journal of a session that was cut off, or still runs",
                      fmt::format("'mbk recover {}' makes a recording of it", file.string()), file.string());
    }
    if (auto ok = add(recording::read(file, *options), file); !ok) return tl::unexpected(ok.error());
  }
  return recordings;
}

Result<std::vector<Recording>> read_perturbations(const MeasureArguments& arguments) {
  auto recordings = read_recordings(arguments);
  if (!recordings) return recordings;
  for (Recording& recording : *recordings) {
    const auto withdrawn = recording.metadata.find("withdrawn");
    if (withdrawn != recording.metadata.end() && withdrawn->second == "yes") {
      return bad_data("the person has withdrawn: these data must not be used", "leave the file out, and remove it",
                      recording.sources.empty() ? "" : recording.sources.front().path);
    }
    recording = preprocess::perturbation_only(std::move(recording));
    for (const auto& [key, value] : arm_metadata(arguments.arm).value_or(std::map<std::string, std::string>{})) {
      recording.metadata[key] = value;
    }
  }
  return recordings;
}

}  // namespace mbk::app
