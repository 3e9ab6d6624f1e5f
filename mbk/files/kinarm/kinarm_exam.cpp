#include "mbk/files/kinarm/kinarm_exam.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/c3d/c3d.h"
#include "mbk/files/contents/memory.h"
#include "mbk/files/kinarm/exam_trial.h"
#include "mbk/files/kinarm/force_sign.h"
#include "mbk/files/kinarm/kinarm_records.h"

namespace mbk::recording {
namespace {

constexpr std::string_view kRaw = "raw/";
constexpr std::string_view kCommonFolder = "raw/common/", kCommonC3d = "raw/common.c3d";
constexpr std::string_view kC3d = ".c3d", kSignal = ".kinematics", kPosition = ".position";
constexpr std::uint64_t kBeginOfC3d = std::uint64_t{160} << 10;  ///< which parameters seldom exceed

/// A folder or C3D file of the archive: a trial, or a part of one that was split.
struct Part {
  std::string label;                   ///< "02_01_01"
  std::vector<std::string> members;    ///< of a folder; of a C3D file itself
  std::uint64_t size = 0;              ///< [bytes] of the members when they are unpacked
  std::optional<double> number, task;  ///< TRIAL:TRIAL_NUM, TRIAL:TP
  double break_id = 0.0;               ///< TRIAL:BREAK_ID
  double frames = 0.0, rate_hz = 0.0;
  std::int64_t events = -1;  ///< -1: not stated
};

struct Trial {
  TrialName name;
  std::vector<Part> parts;
  std::vector<std::string> notes;
};

/// Whether a signal of that name is taken.
using ArrayFilter = bool (*)(std::string_view);

bool everything(std::string_view /*name*/) {
  return true;
}

/// "raw/02_01_01/header.bin" → "02_01_01"; "" for other members.
std::string_view folder_of(std::string_view member) {
  if (!member.starts_with(kRaw)) return {};
  member.remove_prefix(kRaw.size());
  const auto slash = member.find('/');
  return slash == member.npos ? std::string_view() : member.substr(0, slash);
}

std::string number_text(double number) {
  return fmt::format("{:.15g}", number);
}

std::string counted(double n, std::string_view one) {
  return fmt::format("{:.15g} {}{}", n, one, n == 1.0 ? "" : "s");
}

void put(Contents& contents, std::string name, std::string unit, double rate_hz, Vector values,
         std::string means = "") {
  Array& array = contents.arrays.emplace_back();
  array.name = std::move(name);
  array.unit = std::move(unit);
  array.rate_hz = rate_hz;
  array.signal = true;
  array.means = std::move(means);
  array.values = SharedMatrix::of_column(std::move(values));
}

}  // namespace

struct KinarmExam::Open {
  std::shared_ptr<const Buffer> bytes_of_archive;
  ZipArchive archive;
  bool c3d = false;
  ExamParameters common;
  std::vector<Trial> trials;
  std::vector<TrialName> names;
  std::vector<std::string> notes;

  mutable std::mutex reading;  ///< the archive is read by one thread at a time
  mutable std::mutex inferring;
  mutable std::map<Arm, ForceSign> signs;

  explicit Open(ZipArchive opened) : archive(std::move(opened)) {}

  [[nodiscard]] Result<Buffer> read(const std::string& member) const {
    const std::lock_guard lock(reading);
    return archive.read(member);
  }

  // ---- what there is ----

  Result<void> find_parts(std::vector<Part>& parts) {
    std::map<std::string, Part, std::less<>> found;
    for (const ZipMember& member : archive.members()) {
      if (c3d) {
        const std::string_view name = member.name;
        if (!name.starts_with(kRaw) || !name.ends_with(kC3d) || name == kCommonC3d) continue;
        const std::string label(name.substr(kRaw.size(), name.size() - kRaw.size() - kC3d.size()));
        if (label.find('/') != std::string::npos) continue;
        Part& part = found[label];
        part.label = label;
        part.members = {member.name};
        part.size = member.size;
      } else if (const std::string_view label = folder_of(member.name); !label.empty() && label != "common") {
        Part& part = found[std::string(label)];
        part.label = label;
        if (!member.name.ends_with('/')) part.members.push_back(member.name);
        part.size += member.size;
      }
    }
    for (auto& [label, part] : found) {
      if (part.members.empty()) continue;
      if (auto ok = c3d ? look_at_c3d(part) : look_at_folder(part); !ok) {
        return tl::unexpected(ok.error().in(fmt::format("{}{}", kRaw, label)));
      }
      parts.push_back(std::move(part));
    }
    if (parts.empty()) return bad_data("the exam contains no trial", "nothing was recorded, or it is damaged");
    return {};
  }

  static void take_numbers(Part& part, const ExamParameters& parameters) {
    part.number = parameters.number("TRIAL", "TRIAL_NUM");
    part.task = parameters.number("TRIAL", "TP");
    part.break_id = parameters.number("TRIAL", "BREAK_ID").value_or(0.0);
    if (part.number && !std::isfinite(*part.number)) part.number.reset();
    if (!std::isfinite(part.break_id)) part.break_id = 0.0;
  }

  Result<void> look_at_folder(Part& part) {
    auto header = MBK_TRY(header_of(part));
    auto parameters = MBK_TRY(parameters_of(part));
    take_numbers(part, parameters);
    part.frames = static_cast<double>(header.frames);
    part.events = header.events;
    part.rate_hz = rate_of(header, parameters);
    return {};
  }

  [[nodiscard]] double rate_of(const KinarmHeader& header, const ExamParameters& own) const {
    if (header.rate_hz > 0.0) return header.rate_hz;
    const auto said = own.number("ANALOG", "RATE");
    const double rate_hz = said ? *said : common.number("ANALOG", "RATE").value_or(0.0);
    return rate_hz > 0.0 && std::isfinite(rate_hz) ? rate_hz : 0.0;
  }

  [[nodiscard]] Result<KinarmHeader> header_of(const Part& part) const {
    const std::string name = fmt::format("{}{}/header.bin", kRaw, part.label);
    const auto bytes = MBK_TRY(read(name));
    auto header = read_kinarm_header(bytes.bytes());
    return header ? header : tl::unexpected(header.error().in("header.bin"));
  }

  [[nodiscard]] Result<ExamParameters> parameters_of(const Part& part) const {
    const std::string name = fmt::format("{}{}/parameters.bin", kRaw, part.label);
    if (!archive.has(name)) return ExamParameters();
    const auto bytes = MBK_TRY(read(name));
    auto parameters = read_kinarm_parameters(bytes.bytes());
    if (!parameters) return tl::unexpected(parameters.error().in("parameters.bin"));
    parameters->drop_unused();
    return parameters;
  }

  /// Its begin is unpacked, and all of it only where the parameters are longer.
  Result<void> look_at_c3d(Part& part) {
    Result<Buffer> bytes = archive.read_begin(part.members.front(), kBeginOfC3d);
    if (!bytes) return tl::unexpected(bytes.error());
    for (bool whole = part.size <= kBeginOfC3d;; whole = true) {
      if (!looks_like_c3d(bytes->bytes())) return bad_data("the file is not a C3D file");
      const auto parameters = decode_c3d_parameters(bytes->bytes());
      const auto length = decode_c3d_length(bytes->bytes(), part.size);
      if (parameters && length) {
        take_numbers(part, ExamParameters::of(*parameters));
        part.frames = static_cast<double>(length->frames);
        part.rate_hz = length->rate_hz;
        return {};
      }
      if (whole) return tl::unexpected(parameters ? length.error() : parameters.error());
      bytes = read(part.members.front());
      if (!bytes) return tl::unexpected(bytes.error());
    }
  }

  Result<void> read_common() {
    if (c3d) {
      const auto bytes = MBK_TRY(read(std::string(kCommonC3d)));
      if (!looks_like_c3d(bytes.bytes())) return bad_data("the file is not a C3D file", "", std::string(kCommonC3d));
      const auto parameters = decode_c3d_parameters(bytes.bytes());
      if (!parameters) return tl::unexpected(parameters.error().in(kCommonC3d));
      common = ExamParameters::of(*parameters);
      common.remove_signals();
      return {};
    }
    const auto parameters = parameters_of({"common", {}, 0, {}, {}, 0, 0, 0, 0});
    if (!parameters) return tl::unexpected(parameters.error().in("raw/common"));
    common = *parameters;
    return {};
  }

  void order(std::vector<Part> parts) {
    std::ranges::stable_sort(parts, {}, [](const Part& part) {
      return std::pair(part.number ? *part.number : std::numeric_limits<double>::infinity(), part.break_id);
    });
    std::set<std::string> taken;
    for (std::size_t k = 0; k < parts.size();) {
      Trial trial;
      trial.parts.push_back(std::move(parts[k++]));
      while (k < parts.size() && trial.parts.back().break_id != 0.0 &&
             trial.parts.back().break_id + 1.0 <= parts[k].break_id) {
        if (trial.parts.back().break_id + 1.0 < parts[k].break_id) {
          trial.notes.push_back(fmt::format("! parts of this trial are missing: BREAK_ID {} follows {}",
                                            parts[k].break_id, trial.parts.back().break_id));
        }
        trial.parts.push_back(std::move(parts[k++]));
      }
      name(trial, taken);
      names.push_back(trial.name);
      trials.push_back(std::move(trial));
    }
  }

  void name(Trial& trial, std::set<std::string>& taken) {
    const Part& first = trial.parts.front();
    const std::string filter = first.number ? number_text(*first.number) : printable(first.label);
    trial.name.name = filter;
    for (int copy = 2; !taken.insert(trial.name.name).second; ++copy) {
      trial.name.name = fmt::format("{}#{}", filter, copy);
    }
    if (trial.name.name != filter) {
      trial.notes.push_back(
          fmt::format("TRIAL:TRIAL_NUM {} occurs again; this trial was renamed {}", filter, trial.name.name));
    }
    double frames = 0.0, seconds = 0.0;
    std::int64_t events = 0;
    for (const Part& part : trial.parts) {
      frames += part.frames;
      seconds += part.rate_hz > 0.0 ? part.frames / part.rate_hz : 0.0;
      events = events < 0 || part.events < 0 ? -1 : events + part.events;
    }
    std::string& text = trial.name.description;
    if (first.task) text += fmt::format("TP {}, ", number_text(*first.task));
    text += fmt::format("{}, ", describe_label(first.label));
    if (seconds > 0.0) text += fmt::format("{:.3f} s, ", seconds);
    text += counted(frames, "frame");
    if (events >= 0) text += fmt::format(", {}", counted(static_cast<double>(events), "event"));
    if (trial.parts.size() > 1) text += fmt::format(", in {} parts", trial.parts.size());
  }

  /// "block 2, trial 1, repeat 1" of "02_01_01"; the label itself of any other.
  static std::string describe_label(const std::string& label) {
    std::vector<int> numbers = {0};
    for (const char c : label) {
      if (c == '_') {
        numbers.push_back(0);
      } else if (c >= '0' && c <= '9' && numbers.back() < 100'000) {
        numbers.back() = 10 * numbers.back() + (c - '0');
      } else {
        return printable(label);
      }
    }
    if (numbers.size() != 3) return printable(label);
    return fmt::format("block {}, trial {}, repeat {}", numbers[0], numbers[1], numbers[2]);
  }

  // ---- a trial ----

  [[nodiscard]] Result<ExamTrial> load(const Trial& trial, ArrayFilter filter) const {
    std::uint64_t size = 0;
    for (const Part& part : trial.parts) size += part.size;
    MBK_TRY(check_memory(3 * size));
    std::vector<ExamTrial> parts;
    for (const Part& part : trial.parts) {
      auto one = c3d ? load_c3d(part, filter) : load_folder(part, filter);
      if (!one) return tl::unexpected(one.error().in(fmt::format("{}{}", kRaw, part.label)));
      parts.push_back(std::move(*one));
    }
    auto whole = join_parts(std::move(parts));
    if (!whole) return whole;
    whole->parameters.add(common);
    correct(*whole);
    std::ranges::stable_sort(whole->events, {}, &Event::time);
    return whole;
  }

  [[nodiscard]] Result<ExamTrial> load_folder(const Part& part, ArrayFilter filter) const {
    ExamTrial trial;
    auto header = MBK_TRY(header_of(part));
    auto parameters = MBK_TRY(parameters_of(part));
    trial.parameters = std::move(parameters);
    trial.frames = static_cast<double>(header.frames);
    trial.rate_hz = rate_of(header, trial.parameters);
    if (trial.rate_hz == 0.0) return bad_data("neither header.bin nor ANALOG:RATE states a rate");
    const auto said = trial.parameters.number("ANALOG", "RATE");
    const double analog_hz = said ? *said : common.number("ANALOG", "RATE").value_or(trial.rate_hz);
    if (!(std::abs(analog_hz - trial.rate_hz) <= kRateTolerance * trial.rate_hz)) {
      return bad_data(fmt::format("header.bin states {} Hz, ANALOG:RATE {} Hz", trial.rate_hz, analog_hz));
    }
    if (trial.frames == 0.0) return bad_data("the trial states 0 frames", "nothing was recorded, or it is damaged");
    for (const std::string& member : part.members) {
      const std::string_view file = std::string_view(member).substr(member.rfind('/') + 1);
      if (auto ok = load_member(member, file, filter, header, trial); !ok) {
        return tl::unexpected(ok.error().in(printable(std::string(file))));
      }
    }
    if (filter == everything) compare_with_header(header, trial);
    return trial;
  }

  [[nodiscard]] Result<void> load_member(const std::string& member, std::string_view file, ArrayFilter filter,
                                         const KinarmHeader& header, ExamTrial& trial) const {
    const bool signal = file.ends_with(kSignal), position = file.ends_with(kPosition);
    const bool all = filter == everything;
    const bool events = all && file == "examevents.bin", video = all && file == "videoack.bin";
    if ((signal || position) && !filter(file.substr(0, file.rfind('.')))) return {};
    if (!signal && !position && !events && !video) return {};
    const auto bytes = MBK_TRY(read(member));
    if (signal) {
      auto one = MBK_TRY(read_kinarm_signal(bytes.bytes()));
      take(trial, std::move(one.label), std::move(one.unit), std::move(one.values));
    } else if (position) {
      auto one = MBK_TRY(read_kinarm_position(bytes.bytes()));
      take(trial, one.label + ".x", "m", std::move(one.x));
      take(trial, one.label + ".y", "m", std::move(one.y));
    } else if (events) {
      auto read_events = MBK_TRY(read_kinarm_events(bytes.bytes()));
      if (header.events != std::ssize(read_events)) {
        trial.notes.push_back(
            fmt::format("header.bin states {} events, examevents.bin contains {}", header.events, read_events.size()));
      }
      std::size_t no_time = 0;
      for (Event& event : read_events) {
        if (std::isfinite(event.time)) {
          trial.events.push_back(std::move(event));
        } else {
          ++no_time;
        }
      }
      if (no_time > 0) trial.notes.push_back(fmt::format("{} events have no time and were ignored", no_time));
    } else {
      const auto delays = MBK_TRY(read_kinarm_video_delays(bytes.bytes()));
      if (delays.size() > 0) {
        Vector sorted = delays;
        std::ranges::sort(sorted);
        trial.notes.push_back(fmt::format("{} video frames were acknowledged {:.3g} ms after they were sent (median)",
                                          sorted.size(), 1e3 * sorted[sorted.size() / 2]));
      }
    }
    return {};
  }

  static void take(ExamTrial& trial, std::string label, std::string unit, Vector values) {
    if (label.empty()) label = "unnamed";
    if (static_cast<double>(values.size()) != trial.frames) {
      trial.notes.push_back(fmt::format("! {} was omitted: it has {} samples in {}", label, values.size(),
                                        counted(trial.frames, "frame")));
      return;
    }
    if (trial.find(label) != nullptr) {
      trial.notes.push_back(fmt::format("! a second signal {} was omitted", label));
      return;
    }
    trial.signals.push_back({std::move(label), std::move(unit), trial.rate_hz, std::move(values)});
  }

  static void compare_with_header(const KinarmHeader& header, ExamTrial& trial) {
    std::vector<std::string> missing;
    for (const std::string& label : header.kinematics) {
      if (trial.find(label) == nullptr) missing.push_back(label);
    }
    for (const std::string& label : header.positions) {
      if (trial.find(label + ".x") == nullptr) missing.push_back(label);
    }
    if (!missing.empty()) {
      trial.notes.push_back(fmt::format("! header.bin names signals that do not exist: {}", fmt::join(missing, ", ")));
    }
  }

  [[nodiscard]] Result<ExamTrial> load_c3d(const Part& part, ArrayFilter filter) const {
    const auto bytes = MBK_TRY(read(part.members.front()));
    if (!looks_like_c3d(bytes.bytes())) return bad_data("the file is not a C3D file");
    const auto parameters = MBK_TRY(decode_c3d_parameters(bytes.bytes()));
    auto contents = MBK_TRY(decode_c3d(bytes.bytes()));
    ExamTrial trial;
    trial.parameters = ExamParameters::of(parameters);
    trial.frames = part.frames;
    trial.rate_hz = part.rate_hz;
    trial.events = std::move(contents.events);
    trial.notes = std::move(contents.notes);
    for (Array& array : contents.arrays) {
      const bool needed = filter == everything || filter(array.name) || array.name.find("_Hand") != std::string::npos;
      if (!needed || array.obstacle) continue;  // the notes say so
      ExamSignal& signal = trial.signals.emplace_back();
      signal.name = std::move(array.name);
      signal.unit = std::move(array.unit);
      signal.rate_hz = array.rate_hz;
      signal.values = array.values.take();
      if (is_status(signal.name)) take_bits(signal, trial.notes);
    }
    // A frame holds one sample of each point and one or several of each signal.
    if (!trial.signals.empty() && trial.signals.back().rate_hz > 0.0) {
      trial.frames = static_cast<double>(trial.signals.back().values.size());
      trial.rate_hz = trial.signals.back().rate_hz;
    }
    if (trial.rate_hz == 0.0) return bad_data("neither POINT:RATE nor ANALOG:RATE states a rate");
    return trial;
  }

  /// The bits of the 32-bit reals that a status was stored as.
  static void take_bits(ExamSignal& signal, std::vector<std::string>& notes) {
    Index lost = 0;
    for (double& value : signal.values) {
      const auto real = static_cast<float>(value);
      if (static_cast<double>(real) == value) {
        value = std::bit_cast<std::uint32_t>(real);
      } else {
        value = std::numeric_limits<double>::quiet_NaN();
        ++lost;
      }
    }
    signal.unit.clear();
    if (lost > 0)
      notes.push_back(fmt::format("{} is not a valid status in {} samples; it is NaN there", signal.name, lost));
  }

  // ---- the sign of the force ----

  [[nodiscard]] ForceSign sign_of(Arm arm) const {
    const std::lock_guard lock(inferring);
    if (const auto known = signs.find(arm); known != signs.end()) return known->second;
    ForceSignTest test;
    const std::size_t count = std::min(trials.size(), kSignTrials);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t index = count > 1 ? k * (trials.size() - 1) / (count - 1) : 0;
      const auto trial = load(trials[index], tells_of_force);
      if (!trial) continue;  // errors of a trial are reported when it is read
      std::vector<std::string> unsaid;
      const HandOfArm hand = hand_of(arm, *trial, unsaid);
      test.add(evidence_of(arm, *trial, hand));
    }
    return signs[arm] = test.result();
  }

  // ---- what it means ----

  [[nodiscard]] Result<const Trial*> chosen(const std::string& name) const {
    if (name.empty() && trials.size() == 1) return &trials.front();
    for (const Trial& trial : trials) {
      if (trial.name.name == name) return &trial;
    }
    const std::string range = fmt::format("there are {} trials, {} to {}; 'mbk info' lists them", trials.size(),
                                          names.front().name, names.back().name);
    if (name.empty())
      return bad_usage("the exam contains several trials, and none was selected", "select one with --trial; " + range);
    return bad_usage(fmt::format("there is no trial '{}'", name), range);
  }

  static Result<std::optional<Arm>> chosen_arm(const std::vector<Arm>& arms, const ExamChoice& choice) {
    if (choice.arm) {
      if (std::ranges::find(arms, *choice.arm) != arms.end()) return choice.arm;
      if (!choice.needs_arm) return std::optional<Arm>();
      return bad_usage(
          fmt::format("--side {}: that arm was not recorded", *choice.arm == Arm::right ? "right" : "left"),
          arms.empty() ? "no arm's joints were recorded; name the channels with --channels" : "omit --side");
    }
    if (arms.size() == 1) return std::optional(arms.front());
    if (arms.size() > 1 && choice.needs_arm) {
      return bad_usage("both arms were recorded, and none was selected", "pass --side right or --side left");
    }
    return std::optional<Arm>();
  }

  void take_arm(Arm arm, bool meant, ExamTrial& trial, Contents& contents) const {
    const HandOfArm hand = hand_of(arm, trial, contents.notes);
    const ExamSignal* const joint = trial.find(fmt::format("{}_L1Ang", name_of(arm)));
    if (joint == nullptr) return;
    const double rate_hz = joint->rate_hz;
    const std::string side(name_of(arm));
    const auto add = [&](const HandSignal& signal, const std::string& name, const char* unit,
                         std::string_view channel) {
      if (signal.x.size() == 0) return;
      const bool is_channel = meant && !channel.empty();
      put(contents, fmt::format("{}_{}_x", side, name), unit, rate_hz, signal.x,
          is_channel ? fmt::format("{}_x", channel) : "");
      put(contents, fmt::format("{}_{}_y", side, name), unit, rate_hz, signal.y,
          is_channel ? fmt::format("{}_y", channel) : "");
    };
    add(hand.position, "hand", "m", hand.trusted ? "hand" : "");
    add(hand.velocity, "hand_velocity", "m/s", "");
    add(hand.acceleration, "hand_acceleration", "m/s2", hand.trusted ? "acceleration" : "");
    add(hand.commanded, "commanded_force", "N", "");
    if (!has_force(arm, trial)) return;
    const ForceSign sign = sign_of(arm);
    HandSignal force{trial.find(side + "_FS_ForceX")->values, trial.find(side + "_FS_ForceY")->values};
    if (sign.verdict == ForceSign::Verdict::turned) {
      force.x = -force.x;
      force.y = -force.y;
    }
    add(force, "force", "N", "force");
    contents.notes.push_back(force_sign_note(sign, fmt::format("{0}_FS_ForceX and {0}_FS_ForceY", side)));
  }

  [[nodiscard]] Result<Contents> decode(const ExamChoice& choice) const {
    const auto trial = MBK_TRY(chosen(choice.trial));
    auto loaded = MBK_TRY(load(*trial, everything));
    if (loaded.signals.empty()) {
      std::string why = "the trial contains no signal";
      for (const std::string& note : loaded.notes) why += "; " + note;
      return bad_data(std::move(why), "nothing was recorded, or it is damaged");
    }
    const std::vector<Arm> arms = arms_of(loaded);
    const auto arm = MBK_TRY(chosen_arm(arms, choice));

    Contents contents;
    contents.format = c3d ? "KINARM exam (C3D)" : "KINARM exam";
    contents.table = true;
    contents.notes = notes;
    contents.notes.insert(contents.notes.end(), trial->notes.begin(), trial->notes.end());
    for (std::string& note : loaded.notes) contents.notes.push_back(std::move(note));
    if (arms.empty()) {
      contents.notes.emplace_back(
          "no arm's joints were recorded, so the hand is not computed; a resampled hand position is unsuitable for "
          "velocity");
    } else if (arms.size() == 2) {
      contents.notes.push_back(
          arm ? fmt::format("both arms were recorded; the {} arm was selected", *arm == Arm::right ? "right" : "left")
              : "both arms were recorded, and none was selected; select one with --side right or --side left");
    }
    for (const Arm one : arms) {
      if (!arm || one == *arm) take_arm(one, arm == one, loaded, contents);
    }
    std::vector<Array> computed = std::exchange(contents.arrays, {});
    for (ExamSignal& signal : loaded.signals) {
      std::string means = arm ? channel_of(signal.name, *arm) : std::string();
      put(contents, std::move(signal.name), std::move(signal.unit), signal.rate_hz, std::move(signal.values),
          std::move(means));
    }
    for (Array& array : computed) contents.arrays.push_back(std::move(array));
    contents.events = std::move(loaded.events);
    contents.metadata["trial"] = trial->name.name;
    loaded.parameters.describe(contents.metadata, contents.notes);
    return contents;
  }

  static std::string channel_of(std::string_view name, Arm arm) {
    const std::string side(name_of(arm));
    if (name == side + "_L1Ang") return "joint_1";
    if (name == side + "_L2Ang") return "joint_2";
    if (name == side + "_M1TorCMD") return "torque_1";
    if (name == side + "_M2TorCMD") return "torque_2";
    return {};
  }
};

KinarmExam::KinarmExam(std::unique_ptr<Open> open) : open_(std::move(open)) {}
KinarmExam::KinarmExam(KinarmExam&& other) noexcept = default;
KinarmExam& KinarmExam::operator=(KinarmExam&& other) noexcept = default;
KinarmExam::~KinarmExam() = default;

bool KinarmExam::is_exam(const ZipArchive& archive) {
  return archive.has(kCommonC3d) || std::ranges::any_of(archive.members(), [](const ZipMember& member) {
           return member.name.starts_with(kCommonFolder);
         });
}

Result<KinarmExam> KinarmExam::open(std::shared_ptr<const Buffer> file) {
  auto archive = MBK_TRY(ZipArchive::open(file->bytes()));
  if (!is_exam(archive)) return bad_data("the zip archive is not a KINARM exam: it does not contain raw/common");
  auto open = std::make_unique<Open>(std::move(archive));
  open->bytes_of_archive = std::move(file);
  open->c3d = open->archive.has(kCommonC3d);
  MBK_TRY(open->read_common());
  std::vector<Part> parts;
  MBK_TRY(open->find_parts(parts));
  open->order(std::move(parts));
  return KinarmExam(std::move(open));
}

const std::vector<TrialName>& KinarmExam::trials() const {
  return open_->names;
}

Result<Contents> KinarmExam::decode(const ExamChoice& choice) const {
  return open_->decode(choice);
}

}  // namespace mbk::recording
