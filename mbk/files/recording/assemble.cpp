#include "mbk/files/recording/assemble.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include "mbk/base/core/ordinal.h"
#include "mbk/base/core/printable.h"
#include "mbk/files/contents/disk_pages.h"
#include "mbk/files/contents/whole_numbers.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/believable_time.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/files/recording/joint_names.h"
#include "mbk/files/recording/one_clock.h"
#include "mbk/files/recording/own_samples.h"
#include "mbk/files/recording/robot_logs.h"
#include "mbk/files/recording/sensor_orientation.h"
#include "mbk/files/recording/slices.h"
#include "mbk/files/recording/time_names.h"

namespace mbk::recording {
namespace {

constexpr double kRateTolerance = 1e-3;  ///< relative: what clocks of two machines differ by at most
constexpr std::size_t kMaxListed = 12;

/// One row or column of an array.
struct Line {
  const Array* array = nullptr;
  Index index = 0;
  bool row = false;
  Index step = 1;                   ///< every step-th sample, from the first on
  std::optional<Slice> slice = {};  ///< in place of row and index

  [[nodiscard]] Slice whole() const {
    if (slice) return *slice;
    const Index rows = array->values.rows(), columns = array->values.cols();
    return row ? Slice{index, rows, columns} : Slice{index * rows, 1, rows};
  }
  [[nodiscard]] Index size() const { return (whole().length + step - 1) / step; }
  /// Position of a sample in the array.
  [[nodiscard]] Index at(Index sample) const { return whole().begin + sample * step * whole().stride; }
  [[nodiscard]] auto samples(Index begin, Index count) const {
    return Eigen::Map<const Vector, 0, Eigen::InnerStride<>>(array->values.data() + at(begin), count,
                                                             Eigen::InnerStride<>(whole().stride * step));
  }
  /// [Hz]; 0 if the file does not state it
  [[nodiscard]] double rate_hz() const { return array->rate_hz / static_cast<double>(step); }
};

/// A channel and its source in the file.
struct Signal {
  const ChannelKind* kind = nullptr;
  Line line;
  const Unit* unit = nullptr;  ///< of the file; nullptr: SI, or unknown where the kind measures several things
  bool negate = false;
  std::string source;  ///< for messages
  std::string entry;   ///< the same as --channels would say it
  double gain = 1.0;
  double offset = 0.0;     ///< in `unit`
  bool is_scaled = false;  ///< the map states a gain or offset, if only *1
  bool mapped = false;     ///< by --channels
  std::string joint = {};  ///< name of its joint in the file; "" where it says none
  std::string emg = {};    ///< the channel: "emg_biceps"; "" of other kinds

  [[nodiscard]] std::string_view channel() const { return emg.empty() ? kind->name : std::string_view(emg); }
  [[nodiscard]] std::string_view alias() const { return emg.empty() ? kind->alias : std::string_view(emg); }
  [[nodiscard]] bool is_plain() const { return gain == 1.0 && offset == 0.0; }
};

/// Channels whose names begin alike measure the same.
constexpr auto kQuantities = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"time", "time"},
    {"hand_", "position"},
    {"position", "position"},
    {"joint_", "angle"},
    {"force_", "force"},
    {"reaction", "force"},
    {"torque_", "torque"},
    {"reference", "reference"},
    {"acceleration", "acceleration"},
});

bool same_rate(double a_hz, double b_hz) {
  return std::abs(a_hz - b_hz) <= kRateTolerance * b_hz;
}

/// The ratio `fast`/`slow`; 0 if it is not an integer.
Index whole_ratio(double fast_hz, double slow_hz) {
  const double ratio = slow_hz > 0.0 ? fast_hz / slow_hz : 0.0;
  return ratio >= 0.5 && ratio < 1e6 && same_rate(std::round(ratio) * slow_hz, fast_hz)
             ? static_cast<Index>(std::round(ratio))
             : 0;
}

bool is_vector(const Array& array) {
  return !array.is_block() && std::min(array.values.rows(), array.values.cols()) == 1 &&
         (array.values.size() > 1 || array.signal);
}

/// The signals run along the longer side: whether they are the rows.
bool is_wide(const Array& array) {
  return array.values.cols() >= array.values.rows();
}

bool is_matrix(const Array& array) {
  return !array.is_block() && std::min(array.values.rows(), array.values.cols()) > 1;
}

/// Those of some rows that are NaN throughout, checked column by column in memory order.
std::vector<Index> not_recorded_of(std::vector<Index> rows, const SharedMatrix& values) {
  for (Index column = 0; column < values.cols() && !rows.empty(); ++column) {
    std::erase_if(rows, [&](Index row) { return !std::isnan(values(row, column)); });
  }
  return rows;
}

Line vector_of(const Array& array) {
  return {&array, 0, array.values.rows() == 1 && array.values.cols() > 1};
}

std::string shape(const Array& array) {
  return array.is_block() ? shape_text(array) : fmt::format("{}×{}", array.values.rows(), array.values.cols());
}

std::string quoted(std::vector<std::string> names) {
  const std::size_t more = names.size() > kMaxListed ? names.size() - kMaxListed : 0;
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

/// "it has 3 columns: time_s, position_rad, torque_Nm".
std::string inventory(const Contents& contents) {
  std::vector<std::string> names;
  for (const Array& array : contents.arrays) {
    if (!contents.table) {
      names.push_back(fmt::format("{} ({})", array.name, shape(array)));
    } else if (!array.name.empty()) {
      names.push_back(array.name);
    }
  }
  if (!contents.table) {
    std::string text = names.empty() ? "it has no numeric variable" : "it has the variables " + quoted(names);
    const auto why = std::ranges::find_if(
        contents.notes, [](const std::string& note) { return note.find("was not used") != note.npos; });
    if (!contents.notes.empty()) text += "; " + (why == contents.notes.end() ? contents.notes.front() : *why);
    if (contents.notes.size() > 1) text += fmt::format(" (and {} more)", contents.notes.size() - 1);
    return text;
  }
  const std::string count =
      fmt::format("it has {} column{}", contents.arrays.size(), contents.arrays.size() == 1 ? "" : "s");
  return names.empty() ? count + " without names" : count + ": " + quoted(names);
}

/// "trial.force", "trial/force" and "/trial/force" name the same: fields in MAT files, paths in HDF5.
std::string with_dots(std::string_view name) {
  std::string dotted(name.substr(name.starts_with('/') ? 1 : 0));
  std::ranges::replace(dotted, '/', '.');
  return dotted;
}

/// The array of that name; otherwise the only one that is a channel of that name; or the only one whose name
/// differs in dots and slashes alone.
const Array* find(const Contents& contents, std::string_view name) {
  const auto exact = std::ranges::find(contents.arrays, name, &Array::name);
  if (exact != contents.arrays.end()) return &*exact;
  if (std::ranges::count(contents.arrays, name, &Array::means) == 1 && !name.empty()) {
    return &*std::ranges::find(contents.arrays, name, &Array::means);
  }
  if (contents.table) return nullptr;
  const auto dotted = [](const Array& array) { return with_dots(array.name); };
  const std::string requested = with_dots(name);
  if (std::ranges::count(contents.arrays, requested, dotted) != 1) return nullptr;
  return &*std::ranges::find(contents.arrays, requested, dotted);
}

/// The last part of a variable's name: "force" of "trial.force" and of "trial/force".
std::string_view leaf(std::string_view name) {
  return name.substr(name.find_last_of("./") + 1);
}

class Assembler {
 public:
  Assembler(Contents contents, const ReadOptions& options) : contents_(std::move(contents)), options_(options) {}

  Result<Recording> run() {
    name_robot_log(contents_, options_.axes);
    MBK_TRY(maps_time() ? Result<void>() : name_time(contents_));
    recording_.notes = contents_.notes;
    recording_.metadata = contents_.metadata;
    recording_.events = contents_.events;
    if (options_.axes < 0 || options_.axes > 3) {
      return bad_usage(fmt::format("a recording cannot have {} axes", options_.axes), "pass --axes 1, 2 or 3");
    }
    if (contents_.table && !options_.variable.empty()) {
      return bad_usage(
          fmt::format("--variable {} selects a variable of a MAT file, but this file is a table", options_.variable),
          "name its columns with --channels");
    }
    auto emg = MBK_TRY(emg_by_name());
    has_emg_ = !emg.empty();
    if (leaves_names(options_)) {
      MBK_TRY(recognise());
      if (maps_time()) std::erase_if(signals_, [](const Signal& signal) { return is_time(signal.kind); });
    }
    if (!options_.channels.empty()) {
      MBK_TRY(follow_map());
    }
    add_emg(std::move(emg));
    note_aside();
    MBK_TRY(choose_clock());
    MBK_TRY(check());
    MBK_TRY(name_joints());
    note_times();
    follow_metadata();
    extract();
    if (clock_ != nullptr && recording_.time.size() == 0) {
      MBK_TRY(settle_clock());
    }
    if (clock_ == nullptr) unwrap_time(recording_);
    MBK_TRY(settle_time());
    if (clock_ == nullptr) {
      MBK_TRY(check_unit_of_time(recording_, options_.rate || states_time_));
    }
    find_updates(recording_);
    MBK_TRY(turn_force_to_base(recording_));
    return options_.own_samples ? at_own_samples(std::move(recording_), options_.commands) : std::move(recording_);
  }

 private:
  static bool is_time(const ChannelKind* kind) { return kind->name == "time"; }

  [[nodiscard]] bool maps_time() const {
    return std::ranges::any_of(options_.channels, [](const ChannelSource& entry) {
      const auto kinds = kinds_called(entry.channel);
      return !kinds.empty() && is_time(kinds.front());
    });
  }

  // ---- which signals ----

  Result<void> recognise() {
    auto matched = MBK_TRY(match_joints(contents_, options_.joints, options_.clock));
    if (!matched.empty()) recording_.notes.push_back(std::move(matched));
    const auto logs = MBK_TRY(find_logs());
    if (logs != nullptr) return take_logs(*logs);
    MBK_TRY(take_names());
    if (has_emg_ || std::ranges::any_of(signals_, [](const Signal& s) { return s.kind->name != "time"; })) return {};
    if (!options_.channels.empty()) return {};  // the map names them
    for (const Array& array : contents_.arrays) {
      if (!contents_.table && array.values.cols() == kLogsRows && array.values.rows() > kLogsRows) return tall(array);
    }
    const bool time = !signals_.empty();
    const std::string or_guess = "; 'mbk new channels FILE' guesses them";
    const std::string remedy =
        !contents_.clocks.empty() && !contents_.arrays.empty()
            ? fmt::format("assign the columns or variables, as in --channels x={},Fx=STREAM.LABEL",
                          contents_.arrays.front().name)
        : !contents_.table ? "assign the columns or variables, as in --channels " + example_map() + or_guess
        : !contents_.arrays.empty() && contents_.arrays.front().rate_hz > 0.0
            ? "assign the columns by number or name, as in --channels x=1,y=2,Fx=-LABEL" + or_guess
            : fmt::format("assign the columns or variables, as in --channels time=1,x=2,{}=3{}",
                          options_.axes == 1 ? "F" : "Fx", or_guess);
    return with_code(kNothingRecognised, bad_data(fmt::format("no channel {}was recognised in the file; {}",
                                                              time ? "except time " : "", inventory(contents_)),
                                                  remedy));
  }

  /// An example map with existing variable names: "\"time=NAME,x=pos[1],Fx=force[1]\"".
  [[nodiscard]] std::string example_map() const {
    std::vector<std::string> matrices, vectors;
    for (const Array& array : contents_.arrays) {
      if (is_matrix(array)) matrices.push_back(array.name);
      if (is_vector(array)) vectors.push_back(array.name);
    }
    const auto block = std::ranges::find_if(contents_.arrays, &Array::is_block);
    if (matrices.empty() && block == contents_.arrays.end()) return "time=NAME,x=NAME,Fx=NAME";
    if (matrices.empty()) {
      return fmt::format("\"x={},Fx={}\" (one slice of each)", example_slice(*block, 1), example_slice(*block, 2));
    }
    const bool two = matrices.size() > 1;
    return fmt::format("\"time={},x={}[{}],Fx={}[{}]\" (row or column of a matrix)",
                       vectors.empty() ? matrices.front() + "[1]" : "NAME", matrices.front(), vectors.empty() ? 2 : 1,
                       matrices[two ? 1 : 0],
                       two               ? 1
                       : vectors.empty() ? 3
                                         : 2);
  }

  static tl::unexpected<Error> tall(const Array& array) {
    return bad_data(
        fmt::format("the matrix is {}, but a logs matrix has {} rows", shape(array), kLogsRows),
        fmt::format("if its columns are the signals, name them: --channels "
                    "\"time={0}[1],x={0}[2],y={0}[3],Fx={0}[10],Fy={0}[11]\"; it is not transposed automatically",
                    array.name),
        fmt::format("variable '{}'", array.name));
  }

  /// The logs matrix, or nullptr if there is none.
  Result<const Array*> find_logs() const {
    if (contents_.table) return nullptr;
    const std::string requested = options_.variable.empty() ? "logs" : options_.variable;
    MBK_TRY(refuse_damaged_source("--variable", requested));
    const Array* named = find(contents_, requested);
    if (!options_.variable.empty() && named == nullptr && !names_structure()) {
      return bad_data(fmt::format("variable '{}' does not exist; {}", options_.variable, inventory(contents_)));
    }
    if (named != nullptr && named->is_block()) {  // one such matrix per trial; its slices are signals
      if (options_.variable.empty()) return nullptr;
      return bad_data(fmt::format("--variable {} is {}", requested, shape(*named)),
                      fmt::format("name slices, as in --channels \"x={},Fx={}\"", example_slice(*named, 2),
                                  example_slice(*named, 10)));
    }
    if (named != nullptr) {
      if (named->values.size() == 0) {
        return bad_data(fmt::format("the matrix is {} and contains no samples", shape(*named)),
                        "copy it again from where it was recorded", fmt::format("variable '{}'", named->name));
      }
      if (named->values.rows() == kLogsRows) return named;
      if (named->values.cols() == kLogsRows) return tall(*named);
      return bad_data(
          fmt::format("the matrix is {}, but a logs matrix has {} rows", shape(*named), kLogsRows),
          fmt::format("name its rows or columns, as in --channels \"x={0}[2],y={0}[3],Fx={0}[10]\"", named->name),
          fmt::format("variable '{}'", named->name));
    }
    std::vector<std::string> names;
    const Array* found = nullptr;
    for (const Array& array : contents_.arrays) {
      if (array.values.rows() != kLogsRows || array.values.cols() < 2 || !within_variable(array)) continue;
      names.push_back(array.name);
      found = &array;
    }
    if (names.size() > 1) {
      return bad_usage(
          fmt::format("several matrices have {} rows: {}", kLogsRows, quoted(names)),
          fmt::format("select one with --variable NAME, or name the rows, as in --channels \"x={0}[2],Fx={0}[10]\"",
                      names.front()));
    }
    return found;
  }

  Result<void> take_logs(const Array& logs) {
    std::vector<std::string> absent;
    std::vector<const ChannelKind*> kinds;
    std::vector<Index> rows;
    for (const ChannelKind& kind : channel_kinds()) {
      if (kind.logs_row == 0 || !is_requested(kind)) continue;
      kinds.push_back(&kind);
      if (!is_time(&kind)) rows.push_back(kind.logs_row - 1);
    }
    const std::vector<Index> not_recorded = not_recorded_of(std::move(rows), logs.values);
    for (const ChannelKind* kind : kinds) {
      const Line line{&logs, kind->logs_row - 1, true};
      if (std::ranges::find(not_recorded, line.index) != not_recorded.end()) {
        absent.emplace_back(kind->name);
      } else {
        signals_.push_back(
            {kind, line, nullptr, false, fmt::format("row {}", kind->logs_row), fmt::format("{}", kind->logs_row)});
      }
    }
    recording_.notes.push_back(fmt::format(
        "variable '{}' ({}) was read as a logs matrix; rows 4, 5, 8, 9, 16 and 17 are undefined and were ignored",
        logs.name, shape(logs)));
    if (!absent.empty()) {
      recording_.notes.push_back(fmt::format("not recorded (NaN throughout): {}", quoted(absent)));
    }
    return {};
  }

  /// Whether such a channel is requested; otherwise its problems are ignored.
  [[nodiscard]] bool is_requested(const ChannelKind& kind) const {
    if (kind.name == "time" || options_.requested.empty()) return !kind.only_if_asked;
    return std::ranges::any_of(options_.requested, [&](const std::string& name) {
      const auto kinds = kinds_called(name);
      return std::ranges::find(kinds, &kind) != kinds.end();
    });
  }

  /// Whether a channel belongs to a third axis that was not asked for. Its column may be anything of that name.
  [[nodiscard]] bool is_spare(const ChannelKind& kind) const {
    return kind.axes == 3 && options_.axes != 3 && (options_.requested.empty() || !is_requested(kind));
  }

  /// 1 where the file says that the array is the negative of a channel, else 0.
  static std::size_t turned(const Array& array) { return array.means.starts_with('-') ? 1 : 0; }

  /// An array whose name is that of a channel.
  struct Candidate {
    const Array* array;
    ColumnName name;
  };

  Result<void> take_names() {
    std::vector<Candidate> candidates, spare;
    std::vector<std::vector<const ChannelKind*>> meanings;
    for (const Array& array : contents_.arrays) {
      ColumnName name = parse_column_name(!array.means.empty() ? std::string_view(array.means).substr(turned(array))
                                          : contents_.table    ? std::string_view(array.name)
                                                               : leaf(array.name));
      std::erase_if(name.kinds, [&](const ChannelKind* kind) {
        const bool stamped = kind->name == "time" && array.clock >= 0;  // its time is that of its stream
        return stamped || (kind->only_if_asked && !is_requested(*kind));
      });
      if (name.kinds.empty() || !within_variable(array) || (!contents_.table && !is_vector(array) && !array.obstacle)) {
        if (const std::string unknown = unknown_unit_of(array); !unknown.empty()) {
          recording_.notes.push_back(unknown);
        } else {
          aside_.push_back(array.name);
        }
        continue;
      }
      meanings.push_back(name.kinds);
      candidates.push_back({&array, std::move(name)});
    }
    MBK_TRY(refuse_damaged());
    const int axes = options_.axes != 0 ? options_.axes : axes_of(meanings);
    for (const Candidate& candidate : candidates) {
      const ChannelKind* kind = kind_for_axes(candidate.name.kinds, axes);
      if (kind == nullptr || is_spare(*kind)) {
        aside_.push_back(candidate.array->name);
        if (kind != nullptr && options_.axes == 0 && options_.requested.empty()) spare.push_back(candidate);
      } else if (is_requested(*kind)) {
        const auto unit = MBK_TRY(unit_said(*kind, *candidate.array, candidate.name.unit));
        const Array& array = *candidate.array;
        const bool negate = turned(array) == 1;
        signals_.push_back({kind, vector_of(array), unit, negate, array.name, (negate ? "-" : "") + array.name});
      }
    }
    drop_second_names();
    take_third_axis(spare);
    return {};
  }

  /// Takes a third axis that the file has in full: its names are those that mbk writes, and hand_z and force_z fit
  /// hand_x and force_x. Otherwise these columns remain ignored, whatever they contain.
  void take_third_axis(std::span<const Candidate> spare) {
    std::vector<Signal> third;
    const auto has = [&](const std::vector<Signal>& signals, std::string_view name) {
      return std::ranges::any_of(signals, [&](const Signal& signal) { return signal.kind->name == name; });
    };
    for (const Candidate& candidate : spare) {
      const ChannelKind& kind = *candidate.name.kinds.front();
      const Array& array = *candidate.array;
      std::string of_x(kind.name);
      of_x.back() = 'x';
      const auto x = std::ranges::find(signals_, of_x, [](const Signal& signal) { return signal.kind->name; });
      const Unit* const unit = array.unit.empty() ? candidate.name.unit : find_unit(array.unit);
      const bool fits =
          x != signals_.end() && (array.name.starts_with(kind.name) || leaf(array.name).starts_with(kind.name)) &&
          array.means.empty() && !array.obstacle && array.unapplied.empty() && array.clock == x->line.array->clock &&
          array.rate_hz == x->line.array->rate_hz && vector_of(array).size() == x->line.size() &&
          (unit != nullptr ? kind.accepts(*unit) : array.unit.empty()) &&
          std::ranges::count(spare, &kind, [](const Candidate& c) { return c.name.kinds.front(); }) == 1;
      if (fits) third.push_back({&kind, vector_of(array), unit, false, array.name, array.name});
    }
    if (!has(third, "hand_z") || !has(third, "force_z")) return;
    for (Signal& signal : third) {
      if (signal.unit == nullptr) {
        const auto unit = unit_for_all(*signal.kind, *signal.line.array);
        if (!unit) continue;
        signal.unit = *unit;
      }
      signals_.push_back(std::move(signal));
    }
  }

  /// Columns, variables, and rows or columns of matrices whose names contain the word EMG.
  Result<std::vector<Signal>> emg_by_name() {
    std::vector<Signal> found;
    if (options_.emg == EmgReading::none) return found;
    const ChannelKind* const kind = kinds_called("emg").front();
    for (const Array& array : contents_.arrays) {
      std::string channel = emg_of(array.name);
      if (channel.empty() && is_microvolts(array)) channel = emg_channel("EMG " + array.name);
      if (channel.empty() || array.obstacle || array.is_block() || array.values.size() == 0) continue;
      const auto unit = MBK_TRY(unit_said(
          *kind, array, parse_column_name(contents_.table ? std::string_view(array.name) : leaf(array.name)).unit));
      const bool whole = contents_.table || is_vector(array);
      const Index lines = whole ? 1 : is_wide(array) ? array.values.rows() : array.values.cols();
      for (Index k = 0; k < lines; ++k) {
        const std::string source = whole ? array.name : fmt::format("{}[{}]", array.name, k + 1);
        Signal signal{kind, whole ? vector_of(array) : Line{&array, k, is_wide(array)}, unit, false, source, source};
        signal.emg = whole ? channel : fmt::format("{}_{}", channel, k + 1);
        found.push_back(std::move(signal));
      }
    }
    return found;
  }

  /// Of signals of a limb, only muscles are measured in microvolts: "Vastus medialis" in C3D.
  [[nodiscard]] bool is_microvolts(const Array& array) const {
    const Unit* const unit = find_unit(array.unit);
    return options_.emg == EmgReading::all && unit != nullptr && unit->name == "uV" &&
           parse_column_name(array.name).kinds.empty();
  }

  /// The EMG channel that an array's name says, or the path to it: "emg_ch_1" of the label Ch1 of the stream EMG.
  [[nodiscard]] std::string emg_of(std::string_view name) const {
    std::string channel = contents_.table ? std::string() : emg_channel(leaf(name));
    return channel.empty() ? emg_channel(name) : channel;
  }

  /// Adds the EMG that was found by name, but what the map names already or what has another clock and was not asked
  /// for.
  void add_emg(std::vector<Signal> found) {
    const auto other =
        std::ranges::find_if(signals_, [](const Signal& s) { return s.emg.empty() && !is_time(s.kind); });
    std::vector<Signal> added;
    for (Signal& signal : found) {
      const Signal& first = other != signals_.end() ? *other : added.empty() ? signal : added.front();
      const bool same = clock_of(signal) == clock_of(first) && signal.line.rate_hz() == first.line.rate_hz() &&
                        signal.line.size() == first.line.size();
      const bool named = std::ranges::any_of(signals_, [&](const Signal& one) {
        return one.line.array == signal.line.array && one.line.index == signal.line.index;
      });
      if (named || (options_.emg == EmgReading::same_clock && !same)) continue;
      const auto twice = [&](const Signal& one) { return one.emg == signal.emg; };
      const std::string stem = signal.emg;
      for (int k = 2; std::ranges::any_of(signals_, twice) || std::ranges::any_of(added, twice); ++k) {
        signal.emg = fmt::format("{}_{}", stem, k);
      }
      added.push_back(std::move(signal));
    }
    for (Signal& signal : added) signals_.push_back(std::move(signal));
    if (options_.emg == EmgReading::all) give_clocks();
  }

  /// Rates of a file without clocks become clocks, where the EMG has another rate than the other channels.
  void give_clocks() {
    const auto differs = [&](const Signal& signal) {
      return signal.line.array->clock < 0 && signal.line.rate_hz() > 0.0 && !is_time(signal.kind);
    };
    std::vector<double> rates;
    for (const Signal& signal : signals_) {
      if (!differs(signal)) return;
      if (std::ranges::find(rates, signal.line.rate_hz()) == rates.end()) rates.push_back(signal.line.rate_hz());
    }
    if (rates.size() < 2 || !contents_.clocks.empty()) return;
    for (const double rate : rates) {
      Index samples = 0;
      for (const Signal& signal : signals_) {
        if (signal.line.rate_hz() == rate) samples = std::max(samples, signal.line.size());
      }
      contents_.clocks.push_back(
          {fmt::format("{:g} Hz", rate), Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1)) / rate});
    }
    for (const Signal& signal : signals_) {
      const auto array = std::ranges::find(contents_.arrays, signal.line.array, [](Array& one) { return &one; });
      array->clock = static_cast<int>(std::ranges::find(rates, signal.line.rate_hz()) - rates.begin());
    }
  }

  /// Notes arrays that neither name nor map assign to a channel.
  void note_aside() {
    std::erase_if(aside_, [&](const std::string& name) {
      return name.empty() || std::ranges::any_of(signals_, [&](const Signal& s) { return s.line.array->name == name; });
    });
    std::vector<std::string> emg;
    std::erase_if(aside_, [&](const std::string& name) {
      const bool is = !emg_of(name).empty();
      if (is) emg.push_back(name);
      return is;
    });
    if (!emg.empty()) {
      recording_.notes.push_back(
          fmt::format("EMG was found but not read: {}; 'mbk explore --only emg' analyses it", quoted(emg)));
    }
    if (aside_.empty()) return;
    const bool third = std::ranges::any_of(aside_, [](const std::string& name) {
      const auto kinds = parse_column_name(name).kinds;
      return kinds.size() == 1 && kinds.front()->name == "force_z";
    });
    recording_.notes.push_back(fmt::format("ignored (names are not channel names): {}{}", quoted(aside_),
                                           third ? "; --axes 3 reads z and Fz" : ""));
  }

  /// A note on "reaction (dyn)": a channel with a unit in brackets that it cannot have; "" of any other.
  [[nodiscard]] std::string unknown_unit_of(const Array& array) const {
    const auto open = array.name.find_last_of("[(");
    if (!array.means.empty() || open == array.name.npos || !ends_in_brackets(array.name)) return {};
    if (!emg_of(array.name).empty()) return {};
    const std::vector<const ChannelKind*> kinds = parse_column_name(leaf(array.name.substr(0, open))).kinds;
    if (kinds.empty() || is_spare(*kinds.front())) return {};
    return fmt::format("'{}' was ignored: {} cannot have the unit '{}'; state its unit, as in --channels \"{}={}:{}\"",
                       array.name, kinds.front()->name, in_last_brackets(array.name), kinds.front()->alias, array.name,
                       kinds.front()->measures.empty() ? "UNIT" : si_unit(kinds.front()->measures.front()));
  }

  /// A channel that is there and damaged is not left out as if there were none.
  Result<void> refuse_damaged() const {
    for (const auto& [name, why] : contents_.damaged) {
      const std::vector<const ChannelKind*> kinds = parse_column_name(leaf(name)).kinds;
      const bool matters = std::ranges::any_of(kinds, [&](const ChannelKind* kind) {
        return !kind->only_if_asked && is_requested(*kind) && !is_spare(*kind);
      });
      if (!matters) continue;
      return bad_data(
          fmt::format("'{}' is damaged: {}", name, why),
          "copy the file again from where it was recorded, or select the channels that you need with --channels");
    }
    return {};
  }

  static bool same_numbers(const Array& a, const Array& b) {
    const SharedMatrix &one = a.values, &other = b.values;
    return a.clock == b.clock && a.rate_hz == b.rate_hz && one.size() == other.size() && one.size() > 0 &&
           std::memcmp(one.data(), other.data(), static_cast<std::size_t>(one.size()) * sizeof(double)) == 0;
  }

  /// A channel that a file has under two names, by a link or a copy, is taken once.
  void drop_second_names() {
    const auto same = [](const Signal& a, const Signal& b) {
      return a.kind == b.kind && a.unit == b.unit && same_numbers(*a.line.array, *b.line.array);
    };
    for (std::size_t i = 1; i < signals_.size(); ++i) {
      const auto first = std::find_if(signals_.begin(), signals_.begin() + static_cast<std::ptrdiff_t>(i),
                                      [&](const Signal& earlier) { return same(earlier, signals_[i]); });
      if (first == signals_.begin() + static_cast<std::ptrdiff_t>(i)) continue;
      recording_.notes.push_back(fmt::format("'{}' is identical to '{}', which was read as {}", signals_[i].source,
                                             first->source, first->kind->name));
      signals_.erase(signals_.begin() + static_cast<std::ptrdiff_t>(i--));
    }
  }

  /// The unit that the file says beside the name of an array, or else the one that its name says.
  Result<const Unit*> unit_said(const ChannelKind& kind, const Array& array, const Unit* in_name) {
    if (array.unit.empty()) return in_name != nullptr ? Result<const Unit*>(in_name) : unit_for_all(kind, array);
    const Unit* const unit = find_unit(array.unit);
    if (kind.measures.empty() || (unit != nullptr && kind.accepts(*unit))) return unit;
    return bad_data(fmt::format("the file states '{}' in '{}', which is not a unit of channel {}", array.name,
                                array.unit, kind.name),
                    fmt::format("state the unit with --channels {}={}:UNIT; one of {}", kind.name, array.name,
                                unit_names(kind.measures)));
  }

  /// The unit that the file says for all columns of what the channel measures.
  Result<const Unit*> unit_for_all(const ChannelKind& kind, const Array& array) {
    for (const std::string& name : contents_.units) {
      const Unit* const unit = find_unit(name);
      if (unit == nullptr || kind.measures.empty() || !kind.accepts(*unit)) continue;
      if (kind.first_unless_said && unit->dimension != kind.measures.front()) continue;
      const std::string_view quantity = dimension_name(unit->dimension);
      if (!kind.first_unless_said && kind.measures.size() > 1) {
        return bad_data(
            fmt::format("the file gives the unit of its {} as {} but does not state whether '{}' is one of them",
                        quantity, unit->name, array.name),
            fmt::format("state its unit, as in --channels {}={}:{}", kind.alias, array.name, unit->name));
      }
      recording_.notes.push_back(
          fmt::format("{} was read in {}, the unit that the file states for its {}", kind.name, unit->name, quantity));
      return unit;
    }
    return nullptr;
  }

  Result<void> follow_map() {
    std::vector<std::vector<const ChannelKind*>> meanings;
    for (const ChannelSource& entry : options_.channels) meanings.push_back(kinds_called(entry.channel));
    const int axes = options_.axes != 0 ? options_.axes : axes_of(meanings);
    for (std::size_t i = 0; i < options_.channels.size(); ++i) {
      ChannelSource entry = options_.channels[i];
      // "Arm:m" is a name where the file has it, and else Arm in metres.
      if (const std::string whole = entry.source + ":" + entry.unit; find(contents_, whole) != nullptr) {
        entry.source = whole;
        entry.unit.clear();
      }
      // An unambiguous name is used directly, whatever the number of axes.
      const ChannelKind* kind = meanings[i].size() == 1 ? meanings[i].front() : kind_for_axes(meanings[i], axes);
      if (kind == nullptr) {
        return bad_usage(fmt::format("unknown channel '{}'", entry.channel),
                         fmt::format("did you mean '{}'?", nearest_channel_name(entry.channel)));
      }
      const auto found = MBK_TRY(resolve(entry));
      const Line* const line = &found.line;
      Signal signal{kind,         *line,        nullptr,
                    entry.negate, entry.source, (entry.negate ? "-" : "") + entry.source,
                    found.gain,   found.offset, found.is_scaled,
                    true};
      if (kind->name == "emg") signal.emg = entry.channel;
      states_time_ = states_time_ || (is_time(kind) && !entry.unit.empty());
      if (!entry.unit.empty()) {
        signal.unit = find_unit(entry.unit);
        if (signal.unit == nullptr || !kind->accepts(*signal.unit)) {
          return bad_data(fmt::format("channel {} cannot have the unit '{}'", kind->name, entry.unit),
                          fmt::format("use one of {}", unit_names(kind->measures)));
        }
      } else if (!line->array->unit.empty() && (signal.is_plain() || in_unit_of(*kind, *line->array))) {
        const auto unit = MBK_TRY(unit_said(*kind, *line->array, nullptr));
        signal.unit = unit;
      } else if (const ColumnName name = parse_column_name(line->array->name);
                 (is_named(*line) || counted_source(entry.source)) && name.unit != nullptr &&
                 kind->accepts(*name.unit)) {
        signal.unit = name.unit;
        recording_.notes.push_back(fmt::format("{} was read in {}, the unit in its name '{}'", kind->name,
                                               name.unit->name, line->array->name));
      } else if (signal.is_plain() && is_load(*kind) && names_a_current(line->array->name)) {
        return a_current(*kind, line->array->name);
      } else if (is_named(*line) && signal.is_plain() && !kind->measures.empty() &&
                 ends_in_brackets(line->array->name)) {
        recording_.notes.push_back(
            fmt::format("the name of '{}' contains {}, which is not a unit of {}; it was read in {}", line->array->name,
                        in_last_brackets(line->array->name), kind->name,
                        kind->default_unit().empty() ? "no unit" : kind->default_unit()));
      } else if (signal.is_plain()) {
        const auto unit = MBK_TRY(unit_for_all(*kind, *line->array));
        signal.unit = unit;
      }
      if (!signal.is_plain()) note_arithmetic(signal);
      signals_.push_back(std::move(signal));
    }
    note_half_of_third_axis();
    return find_time();
  }

  /// The third axis needs its position and its force; with one of them, the plane is measured.
  void note_half_of_third_axis() {
    const auto names = [&](const char* name) {
      return std::ranges::any_of(signals_, [&](const Signal& signal) { return signal.kind->name == name; });
    };
    const bool z = names("hand_z");
    if (z == names("force_z") || options_.axes == 2 || names("sensor_qw")) return;
    recording_.notes.push_back(fmt::format("{} alone is no third axis: --channels names no {}; the plane xy is read",
                                           z ? "z" : "Fz", z ? "Fz" : "z"));
  }

  /// A force or a torque.
  static bool is_load(const ChannelKind& kind) {
    return std::ranges::any_of(kind.measures,
                               [](Dimension one) { return one == Dimension::force || one == Dimension::torque; });
  }
  static tl::unexpected<Error> a_current(const ChannelKind& kind, const std::string& name) {
    const std::string_view unit = si_unit(kind.measures.front());
    return bad_data(
        fmt::format("channel '{}' cannot be a current, but the name '{}' denotes one", kind.name, name),
        fmt::format("give the torque constant at the gear output [{unit}/A], as in --channels "
                    "\"{alias}={name}*0.12:{unit}\", or state that it is in {unit}: \"{alias}={name}:{unit}\"",
                    fmt::arg("unit", unit), fmt::arg("alias", kind.alias), fmt::arg("name", name)));
  }

  /// "V" of "cell [V]".
  static std::string_view in_last_brackets(std::string_view name) {
    const auto open = name.find_last_of("[(");
    return open == name.npos ? std::string_view() : name.substr(open + 1, name.size() - open - 2);
  }
  /// As a unit, and not as a number: "cell [V]".
  static bool ends_in_brackets(std::string_view name) {
    return (name.ends_with(']') || name.ends_with(')')) &&
           in_last_brackets(name).find_first_not_of("0123456789:,; ") == 0;
  }

  /// Whether the file says a unit of the array that the channel can be in: a gain then keeps it, and else changes it.
  static bool in_unit_of(const ChannelKind& kind, const Array& array) {
    const Unit* const unit = find_unit(array.unit);
    return unit != nullptr && kind.accepts(*unit);
  }

  void note_arithmetic(const Signal& signal) {
    const std::string_view unit = signal.unit != nullptr ? signal.unit->name : signal.kind->default_unit();
    recording_.notes.push_back(fmt::format("{} is {}{}, as requested{}", signal.kind->name, signal.negate ? "-" : "",
                                           printable(signal.source), unit.empty() ? "" : fmt::format(", in {}", unit)));
  }

  struct Found {
    Line line;
    double gain, offset;
    bool is_scaled;
  };

  /// The longest name in `entry` that the file has, and the arithmetic for its numbers.
  Result<Found> resolve(const ChannelSource& entry) {
    const std::vector<SourceReading> ways = readings(entry.source);
    for (const SourceReading& way : ways) {
      const auto line = source({entry.channel, std::string(way.name), "", false}, entry.source);
      if (!line && &way != &ways.back()) continue;
      if (!line) return without_unit(entry, line.error());
      if (way.gain == 0.0) {
        return bad_usage(fmt::format("channel {}: the gain of '{}' is 0", entry.channel, way.name),
                         "give a gain other than 0");
      }
      return Found{*line, way.gain, way.offset, way.name.size() < entry.source.size()};
    }
    return bad_usage(fmt::format("channel {} has no source", entry.channel));
  }

  /// `error`, or an unknown-unit error if the source before the last colon exists.
  Result<Found> without_unit(const ChannelSource& entry, const Error& error) {
    const auto colon = entry.source.rfind(':');
    if (colon == entry.source.npos) return tl::unexpected(error);
    if (!resolve({entry.channel, entry.source.substr(0, colon), "", false})) return tl::unexpected(error);
    return unknown_unit(entry, entry.source.substr(colon + 1));
  }

  /// A map that does not name the time leaves it to its own name, or to row 1 of a logs matrix.
  Result<void> find_time() {
    if (std::ranges::any_of(signals_, [&](const Signal& s) { return is_time(s.kind); })) return {};
    const ChannelKind* const time = kinds_called("time").front();
    const Line& first = signals_.front().line;
    if (!contents_.table && first.row && first.array->values.rows() == kLogsRows) {
      signals_.push_back({time, {first.array, time->logs_row - 1, true}, nullptr, false, "row 1", "1"});
      recording_.notes.push_back("time was read from row 1, as in a logs matrix");
      return {};
    }
    const auto is_called_time = [&](const Array& array, std::string_view name) {
      return std::ranges::any_of(parse_column_name(name).kinds, is_time) && !is_matrix(array) &&
             vector_of(array).size() == first.size();
    };
    std::vector<const Array*> called, last_part_called;
    for (const Array& array : contents_.arrays) {
      if (array.clock >= 0) continue;  // the clock says it
      if (is_called_time(array, array.means.empty() ? array.name : array.means)) called.push_back(&array);
      if (!contents_.table && is_called_time(array, leaf(array.name))) last_part_called.push_back(&array);
    }
    if (called.empty() && last_part_called.size() == 1) called = std::move(last_part_called);
    if (called.empty()) return {};
    const Array& array = *called.front();
    for (const Array* other : called) {
      if (same_numbers(array, *other)) continue;
      return bad_data(fmt::format("{} and {} could both be the time", place_of(array), place_of(*other)),
                      fmt::format("select one in --channels, as in time={} or time={}", shortest_source(array),
                                  shortest_source(*other)));
    }
    const auto unit = MBK_TRY(unit_said(*time, array, parse_column_name(leaf(array.name)).unit));
    signals_.push_back({time, vector_of(array), unit, false, array.name, array.name});
    recording_.notes.push_back(fmt::format("time was read from '{}' because of its name", array.name));
    return {};
  }

  /// Whether the array's name is that of this one line.
  [[nodiscard]] bool is_named(const Line& line) const { return contents_.table || !is_matrix(*line.array); }

  /// The number of an array as a column, from 1.
  [[nodiscard]] Index column_of(const Array& array) const { return &array - contents_.arrays.data() + 1; }
  /// The source in a map for an array whose name may be repeated.
  [[nodiscard]] std::string shortest_source(const Array& array) const {
    return contents_.table ? std::to_string(column_of(array)) : array.name;
  }
  [[nodiscard]] std::string place_of(const Array& array) const {
    const bool repeated = std::ranges::count(contents_.arrays, array.name, &Array::name) > 1;
    return fmt::format("'{}'{}", array.name, repeated ? fmt::format(" (column {})", column_of(array)) : "");
  }

  /// A repeated name is ambiguous, unless both arrays are identical.
  [[nodiscard]] Result<void> refuse_repeated(const ChannelSource& entry) const {
    std::vector<const Array*> called;
    for (const Array& array : contents_.arrays) {
      if (array.name == entry.source) called.push_back(&array);
    }
    const auto differs = [&](const Array* other) {
      return other->obstacle.has_value() || !same_numbers(*called.front(), *other);
    };
    if (called.size() < 2 || std::ranges::none_of(called, differs)) return {};
    std::vector<std::string> columns, others;
    for (const Array* array : called) {
      columns.push_back(std::to_string(column_of(*array)));
      if (array != called.front()) others.push_back(fmt::format("{}={}", entry.channel, columns.back()));
    }
    std::vector<std::string> map;
    for (const ChannelSource& one : options_.channels) {
      const bool this_one = one.channel == entry.channel;
      map.push_back(fmt::format("{}={}{}{}{}", one.channel, one.negate ? "-" : "",
                                this_one ? columns.front() : one.source, one.unit.empty() ? "" : ":", one.unit));
    }
    return bad_data(
        fmt::format("channel {}: the name '{}' occurs {} times, in columns {}", entry.channel, entry.source,
                    called.size(), fmt::join(columns, ", ")),
        fmt::format("select one by its number: --channels {} (or {})", fmt::join(map, ","), fmt::join(others, ", ")));
  }

  /// @param asked  the whole of what the map says, for messages
  Result<Line> source(const ChannelSource& entry, const std::string& asked) {
    if (const auto at = entry.source.rfind('@'); at != entry.source.npos && find(contents_, entry.source) == nullptr) {
      return decimated(entry, at, asked);
    }
    if (const Array* array = find(contents_, entry.source)) {
      MBK_TRY(refuse_repeated(entry));
      if (array->obstacle) return tl::unexpected(array->obstacle->in(fmt::format("channel {}", entry.channel)));
      if (contents_.table || is_vector(*array)) return vector_of(*array);
      return bad_data(
          fmt::format("channel {} needs a row or column of numbers, but variable '{}' is {}", entry.channel,
                      entry.source, shape(*array)),
          array->is_block()
              ? fmt::format("select a slice, as in --channels \"{}={}\"", entry.channel, example_slice(*array, 1))
          : is_matrix(*array) ? fmt::format("select one of its {}, as in --channels \"{}={}[1]\"",
                                            is_wide(*array) ? "rows" : "columns", entry.channel, array->name)
                              : "name a signal");
    }
    if (const auto line = sliced_line(entry)) return *line;
    if (const auto line = counted_line(entry)) return *line;
    MBK_TRY(refuse_damaged_source("channel " + entry.channel, entry.source));
    for (const Array& array : contents_.arrays) {  // "tt.force" of an object tt
      if (array.obstacle && !array.name.empty() && with_dots(entry.source).starts_with(with_dots(array.name) + ".")) {
        return tl::unexpected(array.obstacle->in(fmt::format("channel {}", entry.channel)));
      }
    }
    Index number = 0;
    const char* const end = entry.source.data() + entry.source.size();
    if (const auto [stop, error] = std::from_chars(entry.source.data(), end, number);
        error != std::errc() || stop != end) {
      if (const std::string alike = numbered_alike(entry.source); !alike.empty()) {
        return bad_data(fmt::format("channel {}: the name '{}' is not unique: {}", entry.channel, entry.source, alike),
                        "select one of them by name or column number");
      }
      const std::string neither = asked == entry.source ? "" : fmt::format("'{}' or ", asked);
      return bad_data(fmt::format("channel {}: the file has no {}'{}'; {}", entry.channel, neither, entry.source,
                                  inventory(contents_)));
    }
    if (contents_.table) {
      if (number < 1 || number > std::ssize(contents_.arrays)) {
        return bad_data(
            fmt::format("channel {}: there is no column {}; {}", entry.channel, number, inventory(contents_)),
            "count columns from 1");
      }
      return vector_of(contents_.arrays[static_cast<std::size_t>(number - 1)]);
    }
    const auto matrix = MBK_TRY(numbered_matrix(entry));
    return line_of(entry, *matrix, number);
  }

  /// Columns that the reader numbered because their name repeats: "'EMG#1' (column 3), 'EMG#2' (column 7)" for EMG.
  [[nodiscard]] std::string numbered_alike(std::string_view name) const {
    constexpr int kShown = 12;
    std::string found;
    int count = 0;
    for (std::size_t k = 0; contents_.table && k < contents_.arrays.size(); ++k) {
      std::string bare = contents_.arrays[k].name;
      const auto sign = bare.rfind('#');
      if (sign == bare.npos) continue;
      const auto end = bare.find_first_not_of("0123456789", sign + 1);
      bare.erase(sign, std::min(end, bare.size()) - sign);
      if (bare != name || ++count > kShown) continue;
      found += fmt::format("{}'{}' (column {})", found.empty() ? "" : ", ", contents_.arrays[k].name, k + 1);
    }
    if (count > kShown) found += fmt::format(" and {} more", count - kShown);
    return found;
  }

  /// NAME[trial,:,K], a slice of the variable NAME; nothing where the source is written otherwise.
  std::optional<Result<Line>> sliced_line(const ChannelSource& entry) {
    const std::optional<SlicedSource> sliced = sliced_source(entry.source);
    const Array* const array = sliced && !contents_.table ? find(contents_, sliced->name) : nullptr;
    if (array == nullptr) return std::nullopt;
    const std::string channel = fmt::format("channel {}", entry.channel);
    if (array->obstacle) return tl::unexpected(array->obstacle->in(channel));
    const auto plan = plan_of(*array, *sliced);
    if (!plan) return tl::unexpected(plan.error().in(channel));
    const auto trial = trial_of(*array, *plan);
    if (!trial) return tl::unexpected(trial.error().in(channel));
    return Line{array, 0, false, 1, slice_of(*array, *plan, *trial)};
  }

  /// The requested trial, from 1.
  Result<Index> trial_of(const Array& array, const SlicePlan& plan) {
    if (!plan.trial) return Index{1};
    const auto count = static_cast<Index>(dimensions_of(array)[*plan.trial]);
    const std::string what = fmt::format("'{}' ({}) contains {} trial{} along dimension {}", array.name,
                                         shape_text(array), count, count == 1 ? "" : "s", *plan.trial + 1);
    if (trials_ != 0 && trials_ != count) {
      return bad_data(fmt::format("{}, but another array contains {}", what, trials_), "use arrays of the same trials");
    }
    trials_ = count;
    const std::string note = fmt::format("{}; time is dimension {}", what, plan.along + 1);
    if (std::ranges::find(recording_.notes, note) == recording_.notes.end()) recording_.notes.push_back(note);
    if (options_.trial.empty() && count == 1) return Index{1};
    if (options_.trial.empty()) return bad_usage(what, "select one, as in --trial 1");
    Index number = 0;
    const char* const end = options_.trial.data() + options_.trial.size();
    const auto [stop, error] = std::from_chars(options_.trial.data(), end, number);
    if (error == std::errc() && stop == end && number >= 1 && number <= count) return number;
    return bad_usage(fmt::format("trial '{}' does not exist: {}", options_.trial, what), "count from 1");
  }

  /// Row or column `number` of a matrix, counted from 1 across its longer side.
  static Result<Line> line_of(const ChannelSource& entry, const Array& array, Index number) {
    if (array.is_block()) {
      return bad_data(
          fmt::format("channel {}: '{}' is {}", entry.channel, array.name, shape(array)),
          fmt::format("select a slice, as in --channels \"{}={}\"", entry.channel, example_slice(array, 1)));
    }
    const bool wide = is_wide(array);
    const Index lines = wide ? array.values.rows() : array.values.cols();
    if (number < 1 || number > lines) {
      return bad_data(fmt::format("channel {}: there is no {} {}; the matrix is {}", entry.channel,
                                  wide ? "row" : "column", number, shape(array)),
                      "count from 1", fmt::format("variable '{}'", array.name));
    }
    return Line{&array, number - 1, wide};
  }

  /// NAME[K], row or column K of the variable NAME; nothing where the source is written otherwise.
  std::optional<Result<Line>> counted_line(const ChannelSource& entry) {
    const std::optional<CountedSource> counted = counted_source(entry.source);
    if (contents_.table || !counted) return std::nullopt;
    const Array* const array = find(contents_, counted->name);
    if (array == nullptr) {
      MBK_TRY(refuse_damaged_source("channel " + entry.channel, counted->name));
      return bad_data(
          fmt::format("channel {}: the file has no '{}'; {}", entry.channel, counted->name, inventory(contents_)));
    }
    if (is_vector(*array) && counted->number == 1) return vector_of(*array);
    return line_of(entry, *array, counted->number);
  }

  /// @param asked  the requester: "channel x"
  Result<void> refuse_damaged_source(const std::string& asked, std::string_view source) const {
    for (const auto& [name, why] : contents_.damaged) {
      if (with_dots(name) != with_dots(source)) continue;
      return bad_data(fmt::format("{}: '{}' is damaged: {}", asked, name, why),
                      "copy the file again from where it was recorded");
    }
    return {};
  }

  static tl::unexpected<Error> unknown_unit(const ChannelSource& entry, std::string_view unit) {
    std::vector<Dimension> possible;
    for (const ChannelKind* kind : kinds_called(entry.channel)) {
      possible.insert(possible.end(), kind->measures.begin(), kind->measures.end());
    }
    return bad_data(fmt::format("unknown unit '{}' of channel {}", unit, entry.channel),
                    fmt::format("use one of {}", unit_names(possible)));
  }

  /// SOURCE@RATE: every k-th sample of a source that runs at k times that rate.
  Result<Line> decimated(const ChannelSource& entry, std::size_t at, const std::string& asked) {
    const std::string name = entry.source.substr(0, at);
    auto line = source({entry.channel, name, entry.unit, entry.negate}, asked == entry.source ? name : asked);
    if (!line) return line;
    double rate = 0.0;
    const char* const end = entry.source.data() + entry.source.size();
    const auto [stop, error] = std::from_chars(entry.source.data() + at + 1, end, rate);
    line->step = error == std::errc() && stop == end ? whole_ratio(line->array->rate_hz, rate) : 0;
    if (line->step == 0) {
      return bad_usage(
          line->array->rate_hz > 0.0
              ? fmt::format("channel {}: the rate of '{}', {} Hz, is not an integer multiple of '{}'", entry.channel,
                            line->array->name, line->array->rate_hz, entry.source.substr(at + 1))
              : fmt::format("channel {}: the file does not state the rate of '{}'", entry.channel, line->array->name),
          line->array->rate_hz > 0.0 ? fmt::format("{}={}@{} takes every second sample", entry.channel,
                                                   line->array->name, line->array->rate_hz / 2)
                                     : "omit @");
    }
    recording_.notes.push_back(
        fmt::format("{} is every {} sample of '{}', as requested; components of '{}' above {:.6g} Hz alias",
                    entry.channel, ordinal(line->step), line->array->name, line->array->name, line->rate_hz() / 2));
    return line;
  }

  /// The MAT variable whose rows or columns the numbers of the map count.
  Result<const Array*> numbered_matrix(const ChannelSource& entry) const {
    if (!options_.variable.empty()) {
      if (const Array* named = find(contents_, options_.variable)) return named;
      MBK_TRY(refuse_damaged_source("--variable", options_.variable));
      return bad_data(fmt::format("variable '{}' does not exist; {}", options_.variable, inventory(contents_)));
    }
    if (const Array* logs = find(contents_, "logs")) return logs;
    std::vector<const Array*> matrices;
    for (const Array& array : contents_.arrays) {
      if (is_matrix(array)) matrices.push_back(&array);
    }
    if (matrices.empty()) {
      for (const Array& array : contents_.arrays) {
        if (is_vector(array)) matrices.push_back(&array);
      }
    }
    if (matrices.size() == 1) return matrices.front();
    if (matrices.empty()) return bad_data(fmt::format("channel {}: {}", entry.channel, inventory(contents_)));
    return bad_usage(
        fmt::format("the numbers could refer to rows or columns of several variables; {}", inventory(contents_)),
        fmt::format("name the variable, as in --channels \"{}={}[{}]\", or select it with --variable NAME",
                    entry.channel, matrices.front()->name, entry.source));
  }

  [[nodiscard]] bool within_variable(const Array& array) const {
    const std::string name = with_dots(array.name);
    const std::string requested = with_dots(options_.variable);
    return requested.empty() || name == requested || name.starts_with(requested + ".");
  }
  [[nodiscard]] bool names_structure() const {
    return std::ranges::any_of(contents_.arrays, [&](const Array& array) { return within_variable(array); });
  }

  // ---- what they hold ----

  Result<void> check() const {
    for (const Signal& signal : signals_) {
      if (signal.line.array->obstacle)
        return tl::unexpected(signal.line.array->obstacle->in(fmt::format("channel {}", signal.kind->name)));
      MBK_TRY(check_scale(signal));
    }
    if (std::ranges::none_of(signals_, [](const Signal& s) { return s.kind->name != "time"; })) {
      return bad_data("only the time channel is named", "name at least one other channel, as in --channels time=1,x=2");
    }
    const Signal& first = signals_.front();
    for (std::size_t i = 0; i < signals_.size(); ++i) {
      const Signal& signal = signals_[i];
      for (std::size_t j = 0; j < i; ++j) {
        if (signals_[j].channel() != signal.channel()) continue;
        return bad_data(
            fmt::format("{} and {} are both {}", place_of(signals_[j]), place_of(signal), signal.kind->name),
            fmt::format("select one, as in --channels {}", map_of_signals()));
      }
      MBK_TRY(check_rates(first, signal));
      if (clock_of(signal) == clock_of(first) && signal.line.size() != first.line.size()) {
        return bad_data(fmt::format("{} ('{}') has {} samples, but {} ('{}') has {}", first.kind->name, first.source,
                                    first.line.size(), signal.kind->name, signal.source, signal.line.size()),
                        "select channels of equal length with --channels");
      }
    }
    if (first.line.size() == 0) return bad_data("the recording has no samples", "nothing was recorded");
    return {};
  }

  /// The user decides on attributes that may scale the numbers in an undefined way.
  static Result<void> check_scale(const Signal& signal) {
    const std::string& unapplied = signal.line.array->unapplied;
    if (unapplied.empty() || signal.is_scaled) return {};
    return bad_data(
        fmt::format("the file states {} for '{}' but not whether the stored values already include it", unapplied,
                    signal.line.array->name),
        fmt::format("state their scale, as in --channels {0}={1}*GAIN, or {0}={1}*1 if it is already included",
                    signal.kind->alias, signal.source),
        fmt::format("channel {}", signal.kind->name));
  }

  [[nodiscard]] std::string place_of(const Signal& signal) const {
    return is_named(signal.line) ? place_of(*signal.line.array) : fmt::format("'{}'", signal.source);
  }

  /// The signals as a map: "time=1,x=2,Fx=4 (or Fx=6)".
  [[nodiscard]] std::string map_of_signals() const {
    std::vector<std::string> map, others;
    std::vector<const ChannelKind*> seen;
    for (const Signal& signal : signals_) {
      const std::string entry = contents_.table && signal.is_plain()
                                    ? fmt::format("{}{}", signal.negate ? "-" : "", column_of(*signal.line.array))
                                    : signal.entry;
      const bool second = std::ranges::find(seen, signal.kind) != seen.end();
      (second ? others : map)
          .push_back(fmt::format("{}={}{}{}", signal.alias(), entry, signal.unit != nullptr ? ":" : "",
                                 signal.unit != nullptr ? signal.unit->name : ""));
      seen.push_back(signal.kind);
    }
    return fmt::format("{} (or {})", fmt::join(map, ","), fmt::join(others, ", "));
  }

  static Result<void> check_rates(const Signal& a, const Signal& b) {
    if (clock_of(a) >= 0 || clock_of(b) >= 0) return {};
    if (a.line.rate_hz() == 0.0 || b.line.rate_hz() == 0.0 || same_rate(a.line.rate_hz(), b.line.rate_hz())) return {};
    const bool a_is_faster = a.line.rate_hz() > b.line.rate_hz();
    const Signal& fast = a_is_faster ? a : b;
    const double slow_hz = (a_is_faster ? b : a).line.rate_hz();
    const Index ratio = whole_ratio(fast.line.rate_hz(), slow_hz);
    return bad_data(fmt::format("{} ('{}') is sampled at {} Hz, but {} ('{}') at {} Hz", a.kind->name, a.source,
                                a.line.rate_hz(), b.kind->name, b.source, b.line.rate_hz()),
                    ratio > 1
                        ? fmt::format("name channels of equal rate, or use every {} sample of the faster one: {}={}@{}",
                                      ordinal(ratio), fast.kind->name, fast.source, slow_hz)
                        : "name channels of equal rate; they are not resampled");
  }

  // ---- on which clock ----

  static int clock_of(const Signal& signal) { return signal.line.array->clock; }

  [[nodiscard]] std::string clock_list(std::span<const Clock* const> clocks) const {
    std::vector<std::string> names;
    for (const Clock* clock : clocks) names.push_back(fmt::format("'{}' ({:.4g} Hz)", clock->name, rate_of(*clock)));
    return quoted(std::move(names));
  }

  /// The clock that the recording has, where the file has several.
  Result<void> choose_clock() {
    std::vector<const Clock*> used, all;
    for (const Clock& clock : contents_.clocks) {
      all.push_back(&clock);
      const auto index = static_cast<int>(&clock - contents_.clocks.data());
      if (std::ranges::any_of(signals_, [&](const Signal& s) { return clock_of(s) == index; })) used.push_back(&clock);
    }
    if (!options_.clock.empty()) {
      const auto named = std::ranges::find(all, options_.clock, [](const Clock* clock) { return clock->name; });
      if (named == all.end()) {
        return bad_usage(all.empty() ? "the file does not have several clocks"
                                     : fmt::format("clock '{}' does not exist", options_.clock),
                         all.empty() ? "omit --clock" : fmt::format("choose one of {}", clock_list(all)));
      }
      clock_ = *named;
    } else if (!used.empty() &&
               std::ranges::all_of(used, [&](const Clock* clock) { return same_stamps(*clock, *used.front()); })) {
      clock_ = used.front();
    } else if (const Clock* const emg = options_.emg == EmgReading::all ? clock_of_emg() : nullptr) {
      clock_ = emg;
    } else if (!used.empty()) {
      return bad_data(fmt::format("the channels come from streams with different clocks: {}", clock_list(used)),
                      fmt::format("select the time stamps with --clock '{}'; the other streams are interpolated",
                                  fastest(used).name));
    }
    return check_named_time(used);
  }

  /// The fastest of the EMG; nullptr if there is none.
  [[nodiscard]] const Clock* clock_of_emg() const {
    const Clock* found = nullptr;
    for (const Signal& signal : signals_) {
      if (signal.emg.empty() || clock_of(signal) < 0) continue;
      const Clock& own = contents_.clocks[static_cast<std::size_t>(clock_of(signal))];
      if (found == nullptr || rate_of(own) > rate_of(*found)) found = &own;
    }
    return found;
  }

  /// A map may say that other stamps of the stream are its time, as those that were not corrected.
  [[nodiscard]] Result<void> check_named_time(std::span<const Clock* const> used) const {
    const bool named = std::ranges::any_of(signals_, [](const Signal& s) { return is_time(s.kind); });
    if (!named || clock_ == nullptr || (used.size() == 1 && used.front() == clock_)) return {};
    return bad_usage("time is named, but the channels come from streams with different clocks",
                     "omit time from --channels, and select the time stamps with --clock");
  }

  static const Clock& fastest(std::span<const Clock* const> clocks) {
    return **std::ranges::max_element(clocks, {}, [](const Clock* clock) { return rate_of(*clock); });
  }

  /// Time stamps, and every channel at them.
  Result<void> settle_clock() {
    std::vector<ClockedSignal> signals;
    std::size_t channel = 0;
    for (const Signal& signal : signals_) {
      if (signal.kind->name == "time") continue;
      const Clock& own = clock_of(signal) >= 0 ? contents_.clocks[static_cast<std::size_t>(clock_of(signal))] : *clock_;
      signals.push_back({signal.channel(), &own, &recording_.channels[channel++].values});
    }
    auto common = MBK_TRY(put_on_clock(*clock_, signals));
    recording_.time = std::move(common.time);
    recording_.time_origin = {"time", clock_->name, "s"};
    for (std::string& note : common.notes) recording_.notes.push_back(std::move(note));
    // Those that no stream was recorded at; a single clock leaves them as they are.
    if (std::ranges::any_of(signals, [&](const auto& signal) { return !same_stamps(*signal.clock, *clock_); })) {
      std::erase_if(recording_.events, [](const Event& event) { return !std::isfinite(event.time); });
    }
    return {};
  }

  /// Takes the names of joints from the arrays of the file, or from its metadata.
  Result<void> name_joints() {
    std::vector<std::string> noted;
    for (Signal& signal : signals_) {
      if (!is_of_joint(*signal.kind)) continue;
      const std::vector<const ChannelKind*> kinds = kinds_in_file(signal);
      signal.joint = signal.line.array->joint;
      if (signal.joint.empty() && !kinds.empty()) {
        signal.joint = recording_.noted(joint_key(kinds.front()->name));
        if (!signal.joint.empty()) noted.push_back(fmt::format("{} {}", signal.kind->name, signal.joint));
      }
      if (!signal.mapped && !signal.joint.empty()) continue;  // matched by name where the robot is known
      const std::string& array = signal.line.array->name;
      const std::string_view named = !signal.joint.empty() ? signal.joint : contents_.table ? array : leaf(array);
      MBK_TRY(check_joint(*signal.kind, options_.joints, named, signal.source));
      const std::size_t k = joint_index(*signal.kind);
      if (!signal.joint.empty() && k < options_.joints.size()) signal.joint = options_.joints[k];  // as the user says
    }
    for (const ChannelKind& kind : channel_kinds()) {
      if (is_of_joint(kind)) recording_.metadata.erase(joint_key(kind.name));
    }
    if (!noted.empty()) recording_.notes.push_back(fmt::format("the file names the joints: {}", quoted(noted)));
    return {};
  }

  /// Other columns of time that say something else than the one that was recognised; what could be it where none was.
  void note_times() {
    const auto time = std::ranges::find_if(signals_, [](const Signal& signal) { return is_time(signal.kind); });
    if (time != signals_.end()) {
      if (time->mapped || is_matrix(*time->line.array)) return;
      for (std::string& note : other_times(contents_, *time->line.array, time->unit)) {
        recording_.notes.push_back(std::move(note));
      }
    } else if (clock_ == nullptr && said_rate() == 0.0) {
      for (const Array* array : possible_times(contents_)) {
        if (array->values.size() == signals_.front().line.size()) possible_times_.push_back(array->name);
      }
    }
  }

  /// Units that the metadata say, where nothing nearer says another.
  void follow_metadata() {
    for (Signal& signal : signals_) {
      const auto said = recording_.metadata.find(unit_key(signal.kind->name));
      if (said == recording_.metadata.end() || signal.unit != nullptr) continue;
      const Unit* unit = find_unit(said->second);
      if (unit == nullptr || !signal.kind->accepts(*unit)) {
        recording_.notes.push_back(fmt::format("metadata '{}' is '{}', which is not a unit of {}; ignored", said->first,
                                               said->second, signal.kind->name));
        continue;
      }
      signal.unit = unit;
      recording_.metadata.erase(said);
    }
  }

  void extract() {
    for (Array& array : contents_.arrays) {
      if (std::ranges::none_of(signals_, [&](const Signal& s) { return s.line.array == &array; })) forget(array);
    }
    std::vector<Vector> values(signals_.size());
    const Rests rests = rests_of_time();
    DiskPages disk;  // arrays with clocks are columns
    if (clock_ != nullptr || std::ranges::none_of(signals_, [](const Signal& s) { return is_matrix(*s.line.array); })) {
      take_one_by_one(values);
    } else {
      take_together(values);
    }
    for (std::size_t s = 0; s < signals_.size(); ++s) {
      const Signal& signal = signals_[s];
      Vector& channel = values[s];
      const bool other_unit = signal.unit != nullptr && signal.unit->multiply != signal.unit->divide;
      if (is_time(signal.kind)) {
        count_from_first(signal, rests, channel);
      } else if (!signal.line.array->rests.empty()) {
        recording_.notes.push_back(rounded_note(signal.source));
      }
      if (signal.negate) channel = -channel;
      if (!signal.is_plain()) channel = (signal.gain * channel.array() + signal.offset).matrix();
      if (other_unit) channel = channel.unaryExpr([&](double v) { return signal.unit->to_si(v); });
      const bool as_it_stood = contents_.table && !signal.negate && signal.is_plain() && !other_unit;
      if (channel.size() > kLong && !as_it_stood) disk.take(channel.data(), channel.size());
      if (signal.kind->name == "time") {
        recording_.time = std::move(channel);
        recording_.time_origin = origin_of(signal);
        continue;
      }
      // The description of the robot says whether a named joint turns or slides.
      const auto unit = signal.unit != nullptr          ? si_unit(signal.unit->dimension)
                        : !signal.emg.empty()           ? std::string_view()  // amplifiers differ
                        : signal.kind->measures.empty() ? std::string_view(signal.line.array->unit)
                        : !signal.joint.empty()         ? std::string_view()
                                                        : signal.kind->default_unit();
      recording_.channels.push_back({std::string(signal.channel()), std::string(unit), std::string(signal.kind->frame),
                                     std::move(channel), origin_of(signal)});
    }
  }

  /// Remainders of the time after conversion to double, sample by sample.
  [[nodiscard]] Rests rests_of_time() const {
    Rests rests;
    for (const Signal& signal : signals_) {
      const Line& line = signal.line;
      if (!is_time(signal.kind) || line.array->rests.empty()) continue;
      for (Index k = 0; k < line.size(); ++k) {
        rests.put(static_cast<std::size_t>(k), line.array->rests[static_cast<std::size_t>(line.at(k))]);
      }
    }
    return rests;
  }

  /// Whole numbers above 2^53, as nanoseconds since 1970 are: their differences are exact where they are taken before
  /// anything is rounded.
  void count_from_first(const Signal& signal, const Rests& rests, Vector& time) {
    const double first = time.size() > 0 ? time[0] : 0.0;
    if (!(std::abs(first) >= kExactWhole) || !std::isfinite(first)) return;
    for (Index k = 0; k < time.size(); ++k) {
      time[k] = (time[k] - first) + (rests[static_cast<std::size_t>(k)] - rests[0]);
    }
    const std::string_view unit = signal.unit != nullptr ? signal.unit->name : signal.kind->default_unit();
    recording_.time_zero =
        (signal.negate ? -1.0 : 1.0) * signal.gain * (signal.unit != nullptr ? signal.unit->to_si(first) : first);
    for (Event& event : recording_.events) event.time -= recording_.time_zero;
    recording_.notes.push_back(
        fmt::format("time is relative to its first stamp, {} {}", whole_text(first, rests[0]), unit));
  }

  /// The numbers of an array that are needed no more.
  static void forget(Array& array) { array.values.resize(0, 0); }

  /// Each array becomes its channel or goes when that is there, so that no more than one of them is in memory twice.
  void take_one_by_one(std::vector<Vector>& values) {
    for (std::size_t s = 0; s < signals_.size(); ++s) {
      const Line& line = signals_[s].line;
      const auto same = [&](const Signal& other) { return other.line.array == line.array; };
      const bool last = std::ranges::none_of(std::span(signals_).subspan(s + 1), same);
      const bool whole = line.size() == line.array->values.size();
      if (!last || !whole) values[s] = line.samples(0, line.size());
      if (!last) continue;
      SharedMatrix& own = std::ranges::find(contents_.arrays, line.array, [](Array& one) { return &one; })->values;
      if (whole) values[s] = own.take();
      own = SharedMatrix();
    }
  }

  /// Blocks of samples, so that the rows of a wide matrix are gathered from memory that is still in the cache.
  void take_together(std::vector<Vector>& values) {
    constexpr Index kBlock = 256;
    const Index samples = signals_.front().line.size();
    for (Vector& channel : values) channel.resize(samples);
    for (Index begin = 0; begin < samples; begin += kBlock) {
      const Index count = std::min(kBlock, samples - begin);
      for (std::size_t s = 0; s < signals_.size(); ++s) {
        values[s].segment(begin, count) = signals_[s].line.samples(begin, count);
      }
    }
  }

  static ChannelOrigin origin_of(const Signal& signal) {
    const std::string_view unit = signal.unit != nullptr ? signal.unit->name : std::string_view();
    return {std::string(signal.alias()), signal.entry, std::string(unit), called_otherwise(signal), signal.joint};
  }

  /// What the reader or the name of this line in the file says, or its row in a logs matrix; nothing if it is not a
  /// channel. ".force.x" of a ROS topic is no position, although it ends in x.
  static std::vector<const ChannelKind*> kinds_in_file(const Signal& signal) {
    std::vector<const ChannelKind*> kinds;
    if (!is_matrix(*signal.line.array)) {
      const std::string &name = signal.line.array->name, &means = signal.line.array->means;
      if (!means.empty()) return parse_column_name(std::string_view(means).substr(means.front() == '-' ? 1 : 0)).kinds;
      kinds = parse_column_name(name).kinds;
      return kinds.empty() ? parse_column_name(leaf(name)).kinds : kinds;
    }
    if (!signal.line.row || signal.line.array->values.rows() != kLogsRows) return kinds;
    for (const ChannelKind& kind : channel_kinds()) {
      if (kind.logs_row == signal.line.index + 1) kinds.push_back(&kind);
    }
    return kinds;
  }

  /// The channel that the file calls this line, by a name or by its row in a logs matrix, where that measures another
  /// quantity than the channel which it is read as. A swap within a quantity, as Fx=force_y, is no contradiction.
  static std::string called_otherwise(const Signal& signal) {
    const std::vector<const ChannelKind*> kinds = kinds_in_file(signal);
    const std::string_view read_as = quantity_of(*signal.kind);
    const bool fits = read_as.empty() || std::ranges::any_of(kinds, [&](const ChannelKind* kind) {
                        const std::string_view called = quantity_of(*kind);
                        // The one axis may be a joint.
                        const bool joint = signal.kind->axes == 1 && ((read_as == "position" && called == "angle") ||
                                                                      (read_as == "force" && called == "torque"));
                        return called.empty() || called == read_as || joint;
                      });
    return kinds.empty() || fits ? std::string() : std::string(kinds.front()->name);
  }

  /// The quantity of a kind, independent of the axes; "" if arbitrary.
  static std::string_view quantity_of(const ChannelKind& kind) {
    for (const auto& [prefix, quantity] : kQuantities) {
      if (kind.name.starts_with(prefix)) return quantity;
    }
    return {};
  }

  Result<void> settle_time() {
    if (options_.rate && !(options_.rate->value > 0.0 && std::isfinite(options_.rate->value))) {
      return bad_usage(fmt::format("rate {} Hz is not positive", options_.rate->value),
                       "pass the sample rate: --rate 1000");
    }
    if (recording_.time.size() == 0) {
      const double own = said_rate();
      if (own == 0.0 && !options_.rate && options_.untimed) {
        const Index rows = recording_.channels.front().values.size();
        recording_.time = Vector::LinSpaced(rows, 0.0, static_cast<double>(rows - 1));
        recording_.untimed = true;
        return {};
      }
      if (own == 0.0 && !options_.rate) {
        if (possible_times_.empty()) {
          return bad_data("no time channel was recognised",
                          "pass the sample rate (--rate 1000) or name the time (--channels time=1,…)");
        }
        return bad_data(
            fmt::format("no time channel was recognised; judging by the names, it may be {}", quoted(possible_times_)),
            fmt::format("if so, pass --channels \"time={}\"; otherwise pass the sample rate (--rate 1000)",
                        possible_times_.front()));
      }
      const Index samples = recording_.channels.front().values.size();
      const double duration = own > 0.0 ? static_cast<double>(samples) / own : 0.0;
      const bool believable = own == 0.0 || is_believable(own, samples);
      if (!believable && !options_.rate) {
        return bad_data(
            fmt::format("the file states a rate of {:.6g} Hz{}, at which the recording would last {:.4g} s", own,
                        contents_.rate_from.empty() ? "" : fmt::format(" ({})", contents_.rate_from), duration),
            fmt::format("pass --rate HZ, or --rate {:.6g} if this rate is correct", own));
      }
      if (believable && own > 0.0 && options_.rate && !same_rate(own, options_.rate->value)) {
        return bad_usage(fmt::format("rate {} Hz contradicts the file, which states {} Hz", options_.rate->value, own),
                         "omit --rate");
      }
      recording_.time_from_rate = true;
      const double rate = own > 0.0 && believable ? own : options_.rate->value;
      recording_.time = Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1)) / rate;
      return {};
    }
    if (recording_.time.size() < 2) return {};
    MBK_TRY(check_said_rate());
    if (!options_.rate || (clock_ == nullptr && !states_time_ && take_rate(recording_, options_.rate->value)))
      return {};
    const double own = inspect(recording_).rate_hz;
    if (same_rate(own, options_.rate->value)) return {};
    return bad_usage(
        fmt::format("rate {} Hz contradicts the time in the file, which has {:.6g} Hz", options_.rate->value, own),
        "omit --rate, or correct the unit of time (--channels time=…:ms)");
  }

  /// [Hz] of the samples that were taken, as the file says it beside its time; 0 where it does not.
  [[nodiscard]] double said_rate() const {
    const auto said = std::ranges::find_if(signals_, [](const Signal& s) { return s.line.rate_hz() > 0.0; });
    return said != signals_.end() ? said->line.rate_hz()
                                  : contents_.rate_hz / static_cast<double>(signals_.front().line.step);
  }

  /// A rate that the file says beside its time. Devices miss their rate by some per cent, so that the time goes before
  /// it; a time in another unit, or of another signal, differs by more.
  [[nodiscard]] Result<void> check_said_rate() {
    constexpr double kNominal = 0.1;
    const auto differs = [](double rate_hz, double said_hz) {
      return !(std::abs(rate_hz - said_hz) <= kNominal * said_hz);
    };
    const double said = said_rate();
    if (said == 0.0 || clock_ != nullptr || states_time_) return {};
    const Index last = recording_.time.size() - 1;
    const double mean = static_cast<double>(last) / (recording_.time[last] - recording_.time[0]);
    if (same_rate(mean, said)) return {};
    const double own = inspect(recording_).rate_hz;
    if (!std::isfinite(own) || same_rate(own, said)) return {};
    const std::string both = fmt::format("the file states a rate of {:.6g} Hz{}, but its time '{}' has {:.6g} Hz", said,
                                         contents_.rate_from.empty() ? "" : fmt::format(" ({})", contents_.rate_from),
                                         recording_.time_origin.source, own);
    if (!differs(mean, said) || !differs(own, said)) {
      recording_.notes.push_back(both + ", which was used");
      return {};
    }
    for (const auto& [times, unit] : {std::pair{1e3, "ms"}, {1e6, "us"}, {1e9, "ns"}}) {
      if (differs(said / own, times)) continue;
      return bad_data(both, fmt::format("state the unit of the time, as in --channels time={}:{}",
                                        recording_.time_origin.source, unit));
    }
    return bad_data(both, fmt::format("correct the wrong one, or pass --channels time={}:s to use the time as it is",
                                      recording_.time_origin.source));
  }

  Contents contents_;
  const ReadOptions& options_;
  std::vector<Signal> signals_;
  const Clock* clock_ = nullptr;                  ///< of the recording, where the file has clocks
  bool states_time_ = false;                      ///< the map states the unit of time
  std::vector<std::string> aside_;                ///< names of no channel
  bool has_emg_ = false;                          ///< by name
  std::vector<std::string> possible_times_ = {};  ///< by their names, where none is recognised
  Index trials_ = 0;                              ///< that the slices of the map leave over; 0: none
  Recording recording_;
};

}  // namespace

std::vector<TrialName> trials_of_map(const Contents& contents, const std::vector<ChannelSource>& map) {
  Index count = 0;
  for (const ChannelSource& entry : map) {
    for (const SourceReading& way : readings(entry.source)) {
      const auto sliced = sliced_source(way.name.substr(0, way.name.rfind('@')));
      const Array* const array = sliced && !contents.table ? find(contents, sliced->name) : nullptr;
      if (array == nullptr) continue;
      const auto plan = plan_of(*array, *sliced);
      if (!plan || !plan->trial) continue;
      count = std::max(count, static_cast<Index>(dimensions_of(*array)[*plan->trial]));
    }
  }
  std::vector<TrialName> trials;
  for (Index k = 1; count > 1 && k <= count; ++k) trials.push_back({std::to_string(k), ""});
  return trials;
}

bool leaves_names(const ReadOptions& options) {
  const auto is_no_measurement = [](const ChannelSource& entry) {
    const auto kinds = kinds_called(entry.channel);
    return !kinds.empty() && (kinds.front()->name == "time" || kinds.front()->name == "schedule");
  };
  return !options.requested.empty() || std::ranges::all_of(options.channels, is_no_measurement);
}

Result<Recording> assemble(Contents contents, const ReadOptions& options) {
  return Assembler(std::move(contents), options).run();
}

}  // namespace mbk::recording
