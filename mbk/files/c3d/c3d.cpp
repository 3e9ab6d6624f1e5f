#include "mbk/files/c3d/c3d.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "mbk/files/c3d/c3d_events.h"
#include "mbk/files/c3d/c3d_layout.h"
#include "mbk/files/c3d/c3d_parameters.h"
#include "mbk/files/c3d/c3d_words.h"

namespace mbk::recording {
namespace {

constexpr std::byte kSignature{0x50};
constexpr std::byte kFirstBlock{2};  ///< of the parameters; block 1 is the header
constexpr std::byte kLastBlock{31};  ///< beyond it, the byte could be one of a text
constexpr std::size_t kParameterHeader = 4;
constexpr std::size_t kCoordinates = 3;
constexpr std::size_t kPointNumbers = C3dLayout::kPointNumbers;

class Decoder {
 public:
  Decoder(const C3dBytes& file, C3dParameters parameters) : file_(file), parameters_(std::move(parameters)) {}

  Result<Contents> run() {
    contents_.format = "C3D";
    contents_.table = true;
    layout_ = MBK_TRY(c3d_layout(file_, parameters_, file_.view.size(), contents_.notes));
    MBK_TRY(check_room());
    take_exact_rate();
    say_what_there_is();
    take_points();
    take_analog();
    const double seconds = layout_.point_rate > 0.0 ? static_cast<double>(layout_.frames) / layout_.point_rate : 0.0;
    contents_.events =
        c3d_events(file_, parameters_, layout_.point_rate, layout_.first_frame, seconds, contents_.notes);
    take_own_group();
    return std::move(contents_);
  }

 private:
  void note(std::string text) { contents_.notes.push_back(std::move(text)); }

  Result<void> check_room() {
    const std::uint64_t room = layout_.end - layout_.data, size = layout_.frame_size();
    if (layout_.frames > room / size) {
      return bad_data(fmt::format("{} frame{} of {} bytes need{} more than the {} bytes from block {} on",
                                  layout_.frames, layout_.frames == 1 ? "" : "s", size, layout_.frames == 1 ? "s" : "",
                                  room, layout_.data / kC3dBlock + 1),
                      std::string(kC3dRemedy));
    }
    const std::uint64_t rest = room - layout_.frames * size;
    if (rest >= std::max<std::uint64_t>(kC3dBlock, size)) {
      note(fmt::format("the data section is longer than its {} frame{}, by {} frame{}; the excess was ignored",
                       layout_.frames, layout_.frames == 1 ? "" : "s", rest / size, rest / size == 1 ? "" : "s"));
    }
    return {};
  }

  void say_what_there_is() {
    const auto rate = [](double hz) {
      return hz > 0.0 ? fmt::format("at {:.6g} Hz", hz) : std::string("without a rate");
    };
    std::string text = fmt::format("frames: {}", layout_.frames);
    if (layout_.points > 0) text += fmt::format("; points: {} {}", layout_.points, rate(layout_.point_rate));
    if (layout_.channels > 0)
      text += fmt::format("; analog channels: {} {}", layout_.channels, rate(layout_.analog_rate));
    note(std::move(text));
  }

  // ---- what it holds ----

  /// Labels of `count` points or channels, made unique and different from `others`. A label that repeats is numbered
  /// everywhere, so that the plain label does not silently mean the first.
  std::vector<std::string> labels(std::string_view group, std::uint64_t count, std::string_view nameless,
                                  const std::set<std::string>& others) {
    std::vector<std::string> names = parameters_.texts(group, "LABELS");
    names.resize(static_cast<std::size_t>(count));
    std::size_t missing = 0;
    std::map<std::string, std::size_t> times;
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (names[k].empty()) names[k] = fmt::format("{}_{}", nameless, k + 1), ++missing;
      ++times[names[k]];
    }
    std::set<std::string> taken = others;
    taken.insert(names.begin(), names.end());
    std::map<std::string, std::size_t> copies;
    std::vector<std::string> numbered;
    for (std::string& name : names) {
      const std::string label = name;
      if (times[label] == 1 && !others.contains(label)) continue;
      std::size_t& n = copies.try_emplace(label, others.contains(label) ? 1 : 0).first->second;
      do {
        name = fmt::format("{}#{}", label, ++n);
      } while (!taken.insert(name).second);
      numbered.push_back(name);
    }
    if (missing > 0) {
      note(fmt::format("{} of {} {} labels are missing; these are named {}_1, {}_2, … by position", missing, count,
                       nameless, nameless, nameless));
    }
    if (!numbered.empty()) {
      note(fmt::format("{} {} labels are not unique and are numbered ('{}' is the first)", numbered.size(), nameless,
                       numbered.front()));
    }
    return names;
  }

  /// Units of the points that are not markers: those in POINT:ANGLES are in POINT:ANGLE_UNITS, and so on. The unit is
  /// empty if that parameter is missing.
  [[nodiscard]] std::map<std::string, std::string> units_of_types() const {
    constexpr std::string_view kEnd = "_UNITS";
    std::set<std::string> types = {"ANGLE", "FORCE", "MOMENT", "POWER", "REACTION", "SCALAR"};
    for (const std::string_view name : parameters_.names("POINT")) {
      if (name.ends_with(kEnd)) types.emplace(name.substr(0, name.size() - kEnd.size()));
    }
    std::map<std::string, std::string> units;
    for (const std::string& type : types) {
      const auto unit = parameters_.texts("POINT", fmt::format("{}{}", type, kEnd));
      for (const std::string& label : parameters_.texts("POINT", type + "S")) {
        units[label] = unit.empty() ? "" : unit.front();
      }
    }
    return units;
  }

  /// An array without values.
  Array& add(std::string name, std::string unit, double rate, std::optional<Error> obstacle) {
    Array& array = contents_.arrays.emplace_back();
    array.name = std::move(name);
    array.unit = std::move(unit);
    array.rate_hz = rate;
    array.obstacle = std::move(obstacle);
    return array;
  }

  [[nodiscard]] double number(std::uint64_t offset) const {
    const auto at = static_cast<std::size_t>(offset);
    return layout_.real ? file_.real(at) : file_.signed_word(at);
  }

  void take_points() {
    const auto said = parameters_.texts("POINT", "LABELS");
    const auto types = units_of_types();
    const auto markers = parameters_.texts("POINT", "UNITS");
    const auto names = labels("POINT", layout_.points, "point", {});
    const double scale = layout_.scale;
    const std::uint64_t each = layout_.number_size();
    std::size_t lost = 0;
    for (std::size_t p = 0; p < names.size(); ++p) {
      const auto type = p < said.size() ? types.find(said[p]) : types.end();
      const std::string unit = type != types.end() ? type->second : (markers.empty() ? "" : markers.front());
      const std::size_t first = contents_.arrays.size();
      for (const char axis : {'x', 'y', 'z'}) {
        Array& array = add(fmt::format("{}.{}", names[p], axis), unit, layout_.point_rate, layout_.no_scale);
        if (!layout_.no_scale) array.values.resize(static_cast<Index>(layout_.frames), 1);
      }
      if (layout_.no_scale) continue;
      bool invalid = false;
      for (std::uint64_t f = 0; f < layout_.frames; ++f) {
        const std::uint64_t at = layout_.data + f * layout_.frame_size() + p * kPointNumbers * each;
        const bool valid = number(at + kCoordinates * each) >= 0.0;
        invalid = invalid || !valid;
        for (std::size_t c = 0; c < kCoordinates; ++c) {
          contents_.arrays[first + c].values(static_cast<Index>(f), 0) =
              valid ? scale * number(at + c * each) : std::numeric_limits<double>::quiet_NaN();
        }
      }
      lost += invalid ? 1 : 0;
    }
    if (layout_.no_scale) note(fmt::format("{}; the points cannot be used", layout_.no_scale->message));
    if (!names.empty() && (markers.empty() || markers.front().empty())) {
      note(fmt::format("POINT:UNITS is missing; give the unit with the channel, as in x={}.x:mm", names.front()));
    }
    if (lost > 0) {
      note(fmt::format("{} of {} points are marked invalid in some frames; they are NaN there", lost, layout_.points));
    }
  }

  void take_analog() {
    const auto scales = parameters_.numbers("ANALOG", "SCALE");
    const auto units = parameters_.texts("ANALOG", "UNITS");
    const auto general = parameters_.number("ANALOG", "GEN_SCALE");
    const auto offsets = parameters_.numbers("ANALOG", "OFFSET", true);
    const C3dParameter* const stored_offset = parameters_.find("ANALOG", "OFFSET");
    const bool words = stored_offset != nullptr && stored_offset->type == C3dParameter::Type::word;
    const auto format = parameters_.texts("ANALOG", "FORMAT");
    const bool says_unsigned = !format.empty() && (format.front() == "UNSIGNED" || format.front() == "unsigned");
    std::set<std::string> points;
    for (const Array& array : contents_.arrays) points.insert(array.name);
    const auto names = labels("ANALOG", layout_.channels, "analog", points);
    std::vector<std::string> unscaled, without_offset, unusable, misread;
    for (std::size_t c = 0; c < names.size(); ++c) {
      const bool scaled = c < scales.size();
      const double scale = (scaled ? scales[c] : 1.0) * general.value_or(1.0);
      std::optional<Error> obstacle;
      if (scale == 0.0 || !std::isfinite(scale)) {
        obstacle = Error{
            ErrorKind::data,
            fmt::format("'{}' has ANALOG:SCALE {} and ANALOG:GEN_SCALE {}, so it cannot be converted to physical units",
                        names[c], scaled ? scales[c] : 1.0, general.value_or(1.0)),
            std::string(kC3dWriteAgain)};
        unusable.push_back(names[c]);
      }
      if (!scaled) unscaled.push_back(names[c]);
      if (c >= offsets.size()) without_offset.push_back(names[c]);
      Array& array =
          add(names[c], scaled && c < units.size() ? units[c] : "", layout_.analog_rate, std::move(obstacle));
      if (array.obstacle) continue;
      C3dStored stored{values_of(c), c < offsets.size() ? offsets[c] : 0.0, !layout_.real, words};
      const bool is_unsigned = words_are_unsigned(stored, says_unsigned);
      if (is_unsigned != says_unsigned) misread.push_back(names[c]);
      if (!is_unsigned && stored.offset_is_word) stored.offset = signed_word(stored.offset);
      if (!is_unsigned && stored.words) stored.values = stored.values.unaryExpr(&signed_word).eval();
      stored.values = (stored.values.array() - stored.offset) * scale;
      array.values = SharedMatrix::of_column(std::move(stored.values));
    }
    const auto say = [&](const std::vector<std::string>& which, std::string_view what) {
      if (!which.empty()) {
        note(fmt::format("{} of {} analog channels {} ('{}' is the first)", which.size(), names.size(), what,
                         which.front()));
      }
    };
    say(unscaled, "have no SCALE; their values are raw converter counts without unit");
    say(unusable, "have a SCALE or GEN_SCALE that is 0 or not finite; they cannot be used");
    say(without_offset, "have no OFFSET; 0 is used");
    say(misread, fmt::format("are read as {} numbers because their values and OFFSET contradict ANALOG:FORMAT",
                             says_unsigned ? "signed" : "unsigned"));
    if (!general && !names.empty()) note("ANALOG:GEN_SCALE is missing; 1 is used");
  }

  /// An analog channel as stored; integers as words of 0 to 65535.
  [[nodiscard]] Vector values_of(std::size_t channel) const {
    const std::uint64_t each = layout_.number_size();
    Vector values(static_cast<Index>(layout_.frames * layout_.samples));
    Index sample = 0;
    for (std::uint64_t f = 0; f < layout_.frames; ++f) {
      const std::uint64_t frame = layout_.data + f * layout_.frame_size() + kPointNumbers * layout_.points * each;
      for (std::uint64_t s = 0; s < layout_.samples; ++s, ++sample) {
        const auto at = static_cast<std::size_t>(frame + (s * layout_.channels + channel) * each);
        values[sample] = layout_.real ? file_.real(at) : file_.word(at);
      }
    }
    return values;
  }

  // ---- what only mbk writes ----

  [[nodiscard]] std::optional<double> own_number(std::string_view name) const {
    const auto numbers = parameters_.numbers_in_digits(kOwnC3dGroup, name);
    return numbers.empty() ? std::nullopt : std::optional(numbers.front());
  }

  /// The rate that POINT:RATE rounds, unless another program has changed that.
  void take_exact_rate() {
    constexpr double kReal = 1e-6;  // relative
    const auto rate = own_number("RATE");
    if (!rate || !(std::abs(*rate - layout_.point_rate) <= kReal * layout_.point_rate)) return;
    layout_.point_rate = *rate;
    if (layout_.analog_rate > 0.0) layout_.analog_rate = *rate * static_cast<double>(layout_.samples);
  }

  /// Metadata, and the time of frame 1.
  void take_own_group() {
    const auto keys = parameters_.texts(kOwnC3dGroup, "KEYS"), rows = parameters_.texts(kOwnC3dGroup, "VALUES");
    std::string* value = nullptr;
    for (std::size_t k = 0; k < std::min(keys.size(), rows.size()); ++k) {
      if (!keys[k].empty()) value = &contents_.metadata[keys[k]];
      if (value != nullptr && rows[k].size() >= 2) *value += rows[k].substr(1, rows[k].size() - 2);  // without quotes
    }
    const auto start = own_number("START");
    if (!start || !std::isfinite(*start) || layout_.point_rate == 0.0 || layout_.points * (layout_.samples - 1) > 0) {
      return;
    }
    const double rate = layout_.point_rate * static_cast<double>(layout_.samples);
    const double first = *start + (layout_.first_frame - 1.0) / layout_.point_rate;
    const auto samples = static_cast<Index>(layout_.frames * layout_.samples);
    const Vector steps = Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
    add("time", "s", rate, {}).values = SharedMatrix::of_column(first + (steps.array() / rate));
    for (Event& event : contents_.events) event.time += first;
  }

  C3dBytes file_;
  C3dParameters parameters_;
  C3dLayout layout_;
  Contents contents_;
};

}  // namespace

bool looks_like_c3d(std::span<const std::byte> file) {
  return file.size() >= 2 && file[1] == kSignature && file[0] >= kFirstBlock && file[0] <= kLastBlock;
}

namespace {

struct Parameters {
  C3dBytes file;
  C3dParameters parameters;
};

Result<Parameters> parameters_of(std::span<const std::byte> bytes) {
  const std::size_t begin = (std::to_integer<std::size_t>(bytes[0]) - 1) * kC3dBlock;
  if (bytes.size() < kC3dBlock || bytes.size() < begin + kParameterHeader) {
    return bad_data(fmt::format("the C3D file has {} bytes and ends before its parameters, which begin at block {}",
                                bytes.size(), std::to_integer<int>(bytes[0])),
                    std::string(kC3dRemedy));
  }
  const int processor = std::to_integer<int>(bytes[begin + 3]);
  if (processor < static_cast<int>(C3dProcessor::intel) || processor > static_cast<int>(C3dProcessor::sgi)) {
    return bad_data(
        fmt::format("the C3D processor type {} is unknown; 84 (Intel), 85 (DEC) and 86 (SGI) are supported", processor),
        std::string(kC3dRemedy));
  }
  const C3dBytes file(bytes, C3dProcessor{static_cast<std::uint8_t>(processor)});
  // The count of blocks is one byte and often wrong; the data begin behind the parameters in any case.
  const std::size_t counted = begin + std::to_integer<std::size_t>(bytes[begin + 2]) * kC3dBlock;
  const std::size_t data = std::max<std::size_t>(file.word(c3d_header_word(9)), 1) * kC3dBlock - kC3dBlock;
  auto parameters = C3dParameters::read(file, begin, data > begin ? data : counted);
  if (!parameters) return tl::unexpected(parameters.error());
  const double start = parameters->number("POINT", "DATA_START").value_or(0.0);
  if (!parameters->terminated() && start != file.word(c3d_header_word(9))) {
    // The header's block may be inside the parameters. Read on if the rest of the section has an end.
    const auto other = start >= 2.0 && start <= 65535.0 ? (static_cast<std::size_t>(start) - 1) * kC3dBlock : 0;
    auto longer = C3dParameters::read(file, begin, std::max(counted, other));
    if (longer && longer->terminated()) parameters = std::move(longer);
  }
  return Parameters{file, std::move(*parameters)};
}

}  // namespace

Result<C3dParameters> decode_c3d_parameters(std::span<const std::byte> bytes) {
  auto found = MBK_TRY(parameters_of(bytes));
  return std::move(found.parameters);
}

Result<C3dLength> decode_c3d_length(std::span<const std::byte> bytes, std::uint64_t size) {
  const auto found = MBK_TRY(parameters_of(bytes));
  std::vector<std::string> notes;
  const auto layout = MBK_TRY(c3d_layout(found.file, found.parameters, size, notes));
  return C3dLength{layout.frames, layout.point_rate};
}

Result<Contents> decode_c3d(std::span<const std::byte> bytes) {
  auto found = MBK_TRY(parameters_of(bytes));
  return Decoder(found.file, std::move(found.parameters)).run();
}

}  // namespace mbk::recording
