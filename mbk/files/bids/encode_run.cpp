#include "mbk/files/bids/encode_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "mbk/base/core/version.h"
#include "mbk/files/bids/bids_words.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/contents/text_lines.h"

namespace mbk::recording {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr double kOldestAge = 89.0;
/// Metadata stored in participants.tsv, and their column names.
constexpr auto kOfParticipants = std::to_array<std::pair<std::string_view, std::string_view>>(
    {{"age", "age of the participant in years (89+ for 89 and above)"},
     {"sex", "sex of the participant"},
     {"handedness", "dominant hand of the participant"}});

bool is_figure(char c) {
  return c >= '0' && c <= '9';
}

std::string in_lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

bool is_withheld(const std::string& key, const std::string& value) {
  constexpr auto kPersonal = std::to_array<std::string_view>(
      {"name",          "first_name", "last_name", "surname", "participant_name", "subject_name", "patient",
       "patient_name",  "patient_id", "initials",  "birth",   "birthday",         "birth_date",   "birthdate",
       "date_of_birth", "dob",        "email",     "e_mail",  "address",          "phone",        "telephone"});
  const std::string lower = in_lower_case(key);
  if (std::ranges::find(kPersonal, lower) != kPersonal.end()) return true;
  // A number of a participant has a digit; a name has none.
  return (lower == "participant" || lower == "subject") && std::ranges::none_of(value, is_figure);
}

/// "89+" where the age is that or more.
std::string age(const std::string& said) {
  const auto value = general_number(said);
  return value && *value >= kOldestAge ? "89+" : said;
}

/// The metadata as they may be published.
std::map<std::string, std::string> published(const Recording& recording) {
  std::map<std::string, std::string> metadata;
  for (const auto& [key, value] : recording.metadata) {
    if (!is_withheld(key, value)) metadata[key] = in_lower_case(key) == "age" ? age(value) : value;
  }
  return metadata;
}

void append(std::string& text, double value) {
  if (!std::isfinite(value)) {
    text += std::isnan(value) ? kNotAvailable : value > 0.0 ? "Inf" : "-Inf";
    return;
  }
  std::array<char, 32> digits{};
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

/// Without the rounding error of a difference, which would have 17 digits.
double to_nanoseconds(double seconds) {
  return std::round(seconds * 1e9) / 1e9;
}

/// The description of a channel in channels.tsv.
struct Description {
  std::string type, component, point, units, description;
};

std::string bids_unit(const std::string& unit) {
  constexpr auto kUnits = std::to_array<std::pair<std::string_view, std::string_view>>(
      {{"", kNotAvailable}, {"N.m", "N·m"}, {"m/s2", "m/s^2"}, {"rad/s2", "rad/s^2"}});
  const auto found = std::ranges::find(kUnits, unit, [](const auto& one) { return one.first; });
  return found == kUnits.end() ? unit : std::string(found->second);
}

Description describe(const Channel& channel) {
  const std::string& name = channel.name;
  const auto is = [&](std::string_view begin) { return name.starts_with(begin); };
  Description one{"MISC", std::string(kNotAvailable), std::string(kNotAvailable), bids_unit(channel.unit), ""};
  if (name.ends_with("_x") || name.ends_with("_y")) one.component = name.substr(name.size() - 1);
  if (is("hand_") || is("force_") || is("acceleration") || is("position") || is("reaction")) one.point = "hand";
  if (is("joint_") || is("torque_")) one.point = "joint_" + name.substr(name.find('_') + 1);
  if (!channel.origin.joint.empty()) one.point = channel.origin.joint;
  const bool angle = channel.unit == "rad", length = channel.unit == "m";
  if (is("hand_")) one.type = "POS", one.description = "position of the hand";
  if (name == "position") {
    one.type = angle ? "JNTANG" : length ? "POS" : "MISC";
    one.description = "position of the limb";
  }
  if (is("joint_")) one.type = angle ? "JNTANG" : "MISC", one.description = angle ? "joint angle" : "joint position";
  if (is("acceleration")) {
    one.type = channel.unit == "m/s2" ? "ACCEL" : channel.unit == "rad/s2" ? "ANGACCEL" : "MISC";
    one.description = "acceleration";
  }
  if (is("force_")) one.description = "force that the hand exerts on the robot";
  if (is("reaction")) one.description = "force or torque that the limb exerts on the machine";
  if (is("torque_")) one.description = "motor torque";
  if (is("reference")) one.description = "perturbation reference";
  if (is("voltage")) one.description = "voltage of the force sensor";
  if (one.description.empty()) one.description = std::string(kNotAvailable);
  return one;
}

/// [Hz] that give back the time of a recording that was made of its rate; nothing where none does.
std::optional<double> exact_rate(const Recording& recording) {
  const Index samples = recording.samples();
  if (!recording.time_from_rate || samples < 2) return std::nullopt;
  const double mean = static_cast<double>(samples - 1) / recording.time[samples - 1];
  for (const double rate : {mean, std::round(mean), std::round(mean * 1e3) / 1e3, std::round(mean * 1e6) / 1e6}) {
    const Vector time = Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1)) / rate;
    if (time == recording.time) return rate;
  }
  return std::nullopt;
}

double nominal_rate(const Recording& recording) {
  const Index samples = recording.samples();
  if (samples < 2) return 0.0;
  Vector intervals = recording.time.tail(samples - 1) - recording.time.head(samples - 1);
  double* const middle = intervals.data() + intervals.size() / 2;
  std::nth_element(intervals.data(), middle, intervals.data() + intervals.size());
  if (!(*middle > 0.0)) return 0.0;
  const double rate = 1.0 / *middle;
  const double step = std::pow(10.0, std::floor(std::log10(rate)) - 5.0);  // six digits
  return std::round(rate / step) * step;
}

class Encoder {
 public:
  Encoder(const Recording& recording, const BidsName& name,
          const std::function<std::optional<std::string>(const std::string&)>& existing, std::string_view title)
      : recording_(recording), name_(name), existing_(existing), title_(title), rate_(exact_rate(recording)) {}

  Result<std::vector<BidsFile>> run() {
    add_data_set();
    MBK_TRY(add_participant());
    MBK_TRY(add_scan());
    add_events();
    add_channels();
    add_sidecar();
    add_motion();
    return std::move(files_);
  }

 private:
  void add(std::string path, std::string text, bool of_run) {
    files_.push_back({std::move(path), std::move(text), of_run});
  }
  void add_json(std::string path, const OrderedJson& json, bool of_run) {
    add(std::move(path), json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n", of_run);
  }
  [[nodiscard]] std::string path(std::string_view end) const {
    return fmt::format("{}/motion/{}{}", name_.session_folder(), name_.text(), end);
  }
  /// Events are those of the task, whichever system recorded it.
  [[nodiscard]] std::string events_path(std::string_view end) const {
    BidsName name = name_;
    std::erase_if(name.entities, [](const auto& one) { return one.first == "tracksys"; });
    return fmt::format("{}/motion/{}{}", name_.session_folder(), name.text(), end);
  }

  void add_data_set() {
    if (!existing_("dataset_description.json")) {
      add_json("dataset_description.json",
               {{"Name", title_.empty() ? "Mechanical impedance of the human arm" : title_},
                {"BIDSVersion", "1.11.0"},
                {"DatasetType", "raw"},
                {"GeneratedBy", OrderedJson::array({{{"Name", "mbk"}, {"Version", std::string(version())}}})}},
               false);
    }
    if (!existing_("README") && !existing_("README.md")) {
      add("README",
          "Recordings of arms perturbed by a robot, made to measure the mechanical impedance of the arm (inertia, "
          "damping\nand stiffness), stored in the BIDS modality Motion.\n\nNumbers in the files _motion.tsv are in SI "
          "units and have enough digits to restore them exactly.\n_channels.tsv describes each column. The channel of "
          "type LATENCY holds the time stamps of the\nsamples; forces and torques are of type MISC, because the "
          "standard has no type for them; angles are in rad.\nMissing values are n/a.\n\nIn _channels.json, "
          "MbkMetadata holds the metadata of the recording; in _events.tsv, recorded_time is the\ntime of an event on "
          "the clock of the recording.\n\n'mbk info FOLDER' lists the recordings; 'mbk measure FOLDER --trial NAME' "
          "measures one of them.\n",
          false);
    }
  }

  /// A table with one row more, unless one begins with that key. Its empty columns are n/a.
  static Result<std::string> with_row(const std::optional<std::string>& table, const std::vector<std::string>& columns,
                                      const std::vector<std::string>& cells, const std::string& path) {
    if (!table) {
      return fmt::format("{}\n{}\n", fmt::join(columns, "\t"), fmt::join(cells, "\t"));
    }
    TextLines lines(*table);
    const auto header = lines.next();
    if (!header || split(header->text, '\t').front() != columns.front()) {
      return bad_data(fmt::format("the first column is not {}", columns.front()),
                      "correct it, or choose another folder", path);
    }
    for (auto line = lines.next(); line; line = lines.next()) {
      if (split(line->text, '\t').front() == cells.front()) return *table;
    }
    std::vector<std::string> row;
    for (const std::string_view column : split(header->text, '\t')) {
      const auto at = std::ranges::find(columns, column);
      row.push_back(at == columns.end() ? std::string(kNotAvailable)
                                        : cells[static_cast<std::size_t>(at - columns.begin())]);
    }
    return fmt::format("{}{}{}\n", *table, table->ends_with('\n') ? "" : "\n", fmt::join(row, "\t"));
  }

  Result<void> add_participant() {
    std::vector<std::string> columns = {"participant_id"};
    std::vector<std::string> cells = {fmt::format("sub-{}", name_.label("sub"))};
    OrderedJson described = {{"participant_id", {{"Description", "label of the participant"}}}};
    for (const auto& [key, what] : kOfParticipants) {
      const auto entry = recording_.metadata.find(std::string(key));
      if (entry == recording_.metadata.end()) continue;
      columns.emplace_back(key);
      cells.push_back(key == "age" ? age(entry->second) : entry->second);
      described[std::string(key)] = {{"Description", std::string(what)}};
    }
    if (described.contains("age")) described["age"]["Units"] = "year";
    const auto table = existing_("participants.tsv");
    auto text = MBK_TRY(with_row(table, columns, cells, "participants.tsv"));
    if (!table || text != *table) add("participants.tsv", std::move(text), false);
    if (!table && !existing_("participants.json")) add_json("participants.json", described, false);
    return {};
  }

  Result<void> add_scan() {
    const std::string path = fmt::format("{}/{}_scans.tsv", name_.session_folder(), name_.session());
    const auto table = existing_(path);
    auto text =
        MBK_TRY(with_row(table, {"filename", "acq_time"},
                         {fmt::format("motion/{}_motion.tsv", name_.text()), std::string(kNotAvailable)}, path));
    if (!table || text != *table) add(path, std::move(text), false);
    return {};
  }

  void add_events() {
    if (recording_.events.empty()) return;
    std::string text = fmt::format("onset\tduration\ttrial_type\tvalue\t{}\n", kRecordedTime);
    for (const Event& event : recording_.events) {
      append(text, to_nanoseconds(event.time - recording_.time[0]));
      text += fmt::format("\t{}\t{}\t", kNotAvailable, event.name.empty() ? std::string(kNotAvailable) : event.name);
      append(text, event.value);
      text += '\t';
      append(text, event.time);
      text += '\n';
    }
    add_json(events_path("_events.json"),
             {{"trial_type", {{"Description", "description of the event"}}},
              {"value", {{"Description", "value of the event, such as a direction"}}},
              {std::string(kRecordedTime),
               {{"Description", "time on the clock of the recording (see the LATENCY channel)"}, {"Units", "s"}}}},
             true);
    add(events_path("_events.tsv"), std::move(text), true);
  }

  void add_channels() {
    std::string text = "name\tcomponent\ttype\ttracked_point\tunits\tplacement\treference_frame\tdescription\n";
    const auto row = [&](std::string_view channel, const Description& one, std::string_view frame) {
      text += fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\n", channel, one.component, one.type, one.point, one.units,
                          kNotAvailable, frame.empty() ? kNotAvailable : frame, one.description);
      ++types_[one.type];
    };
    const std::string none(kNotAvailable);
    if (!rate_) row("time", {"LATENCY", none, none, "s", "time stamps of the samples"}, "");
    bool base = false;
    for (const Channel& channel : recording_.channels) {
      const Description one = describe(channel);
      if (one.point != none) points_[one.point] = true;
      base = base || channel.frame == "base";
      row(channel.name, one, channel.frame);
    }
    add(path("_channels.tsv"), std::move(text), true);
    OrderedJson levels = OrderedJson::object();
    if (base) {
      levels["base"] = {
          {"Description", "fixed at the base of the robot"}, {"SpatialAxes", "RA_"}, {"RotationRule", "right-hand"}};
    }
    levels["joint"] = {{"Description", "along each joint"}};
    OrderedJson metadata = published(recording_);
    if (metadata.is_null()) metadata = OrderedJson::object();
    add_json(path("_channels.json"),
             {{"reference_frame", {{"Description", "frame in which the channel is given"}, {"Levels", levels}}},
              {kMetadataKey, {{"Description", "metadata of the recording"}, {"Levels", metadata}}}},
             true);
  }

  void add_sidecar() {
    const Index samples = recording_.samples();
    const double duration = recording_.time[samples - 1] - recording_.time[0];
    OrderedJson json = {{"TaskName", std::string(name_.label("task"))}};
    const double nominal = rate_ ? *rate_ : nominal_rate(recording_);
    json["SamplingFrequency"] = nominal > 0.0 ? OrderedJson(nominal) : OrderedJson(std::string(kNotAvailable));
    const double effective = static_cast<double>(samples - 1) / duration;
    if (rate_) {
      json["SamplingFrequencyEffective"] = *rate_;
    } else if (samples > 1 && effective > 0.0 && std::isfinite(effective)) {
      json["SamplingFrequencyEffective"] = effective;
    }
    json["TaskDescription"] = fmt::format("A robot perturbs the arm; condition: {}", condition());
    json["MotionChannelCount"] = recording_.channels.size() + (rate_ ? 0 : 1);
    for (const auto& [type, count] : types_) {
      json[type + "ChannelCount"] = count;
    }
    json["TrackedPointsCount"] = points_.size();
    json["TrackingSystemName"] = std::string(name_.label("tracksys"));
    json["RecordingType"] = "continuous";
    if (duration >= 0.0 && std::isfinite(duration)) json["RecordingDuration"] = duration;
    json["MissingValues"] = std::string(kNotAvailable);
    json["SoftwareVersions"] = fmt::format("mbk {}", version());
    add_json(path("_motion.json"), json, true);
  }

  [[nodiscard]] std::string condition() const {
    const auto entry = recording_.metadata.find("condition");
    return entry == recording_.metadata.end() ? std::string("not stated") : entry->second;
  }

  void add_motion() {
    std::string text;
    for (Index k = 0; k < recording_.samples(); ++k) {
      if (!rate_) append(text, recording_.time[k]);
      for (const Channel& channel : recording_.channels) {
        if (!rate_ || &channel != recording_.channels.data()) text += '\t';
        append(text, channel.values[k]);
      }
      text += '\n';
    }
    add(path("_motion.tsv"), std::move(text), true);
  }

  const Recording& recording_;
  const BidsName& name_;
  const std::function<std::optional<std::string>(const std::string&)>& existing_;
  std::string title_;
  std::optional<double> rate_;  ///< [Hz] that defines the time; nothing if it is a channel
  std::vector<BidsFile> files_;
  std::map<std::string, int> types_;    ///< channels of each
  std::map<std::string, bool> points_;  ///< that are tracked
};

}  // namespace

std::vector<std::string> withheld_from_bids(const Recording& recording) {
  std::vector<std::string> withheld;
  for (const auto& [key, value] : recording.metadata) {
    if (is_withheld(key, value)) {
      withheld.push_back(fmt::format("metadata '{}', which may identify the participant", key));
    } else if (in_lower_case(key) == "age" && age(value) != value) {
      withheld.emplace_back("the exact age, written as 89+ for 89 and above");
    }
  }
  return withheld;
}

Result<std::vector<BidsFile>> encode_bids(
    const Recording& recording, const BidsName& name,
    const std::function<std::optional<std::string>(const std::string& path)>& existing, std::string_view title) {
  return Encoder(recording, name, existing, title).run();
}

}  // namespace mbk::recording
