#include "mbk/files/c3d/c3d.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "mbk/files/c3d/c3d_events.h"
#include "mbk/files/c3d/c3d_parameters.h"

namespace mbk::recording {
namespace {

constexpr std::byte kSignature{0x50};
constexpr std::byte kFirstBlock{2};  ///< of the parameters; block 1 is the header
constexpr std::byte kLastBlock{31};  ///< beyond it, the byte could be one of a text
constexpr std::size_t kParameterHeader = 4;
constexpr std::size_t kCoordinates = 3;
constexpr std::size_t kPointNumbers = 4;  ///< x, y, z, and a word of residual and cameras
constexpr double kRateTolerance = 1e-3;   ///< relative: what rates of 32 bits and rounded digits differ by
constexpr std::uint64_t kMaxInWord = 0xFFFF;

/// Word k of the header, counted from 1 as the format does.
constexpr std::size_t header_word(std::size_t k) {
  return 2 * (k - 1);
}

/// How the data section is laid out.
struct Layout {
  std::uint64_t points = 0, channels = 0, samples = 0, frames = 0;  ///< samples of each channel in a frame
  double point_rate = 0.0, analog_rate = 0.0;                       ///< [Hz]; 0: not said
  double scale = 0.0;                                               ///< < 0: numbers are reals, and coordinates scaled
  std::uint64_t data = 0;                                           ///< first byte

  [[nodiscard]] bool real() const { return scale < 0.0; }
  [[nodiscard]] std::size_t number_size() const { return real() ? 4 : 2; }
  [[nodiscard]] std::uint64_t frame_size() const {
    return (kPointNumbers * points + channels * samples) * number_size();
  }
};

tl::unexpected<Error> contradiction(std::string_view what, double header, double parameters, std::string where = "") {
  return bad_data(fmt::format("the header says {} {}, the parameters {}", header, what, parameters),
                  "write the file again with the program that recorded it", std::move(where));
}

std::uint64_t whole(double value) {
  return value >= 0.0 && value < 1e15 ? static_cast<std::uint64_t>(value) : 0;
}

double positive_or_zero(double value) {
  return value > 0.0 && std::isfinite(value) ? value : 0.0;
}

class Decoder {
 public:
  Decoder(const C3dBytes& file, C3dParameters parameters) : file_(file), parameters_(std::move(parameters)) {}

  Result<Contents> run() {
    contents_.format = "C3D";
    contents_.table = true;
    if (auto ok = find_numbers(); !ok) return tl::unexpected(ok.error());
    if (auto ok = find_analog(); !ok) return tl::unexpected(ok.error());
    if (auto ok = find_frames(); !ok) return tl::unexpected(ok.error());
    if (auto ok = find_data(); !ok) return tl::unexpected(ok.error());
    say_what_there_is();
    take_points();
    take_analog();
    const double seconds = layout_.point_rate > 0.0 ? static_cast<double>(layout_.frames) / layout_.point_rate : 0.0;
    contents_.events = c3d_events(file_, parameters_, layout_.point_rate, first_frame_, seconds, contents_.notes);
    return std::move(contents_);
  }

  Result<C3dLength> length() {
    if (auto ok = find_numbers(); !ok) return tl::unexpected(ok.error());
    if (auto ok = find_analog(); !ok) return tl::unexpected(ok.error());
    if (auto ok = find_frames(); !ok) return tl::unexpected(ok.error());
    return C3dLength{layout_.frames, layout_.point_rate};
  }

 private:
  [[nodiscard]] double header(std::size_t k) const { return file_.word(header_word(k)); }
  void note(std::string text) { contents_.notes.push_back(std::move(text)); }

  // ---- how it is laid out ----

  Result<void> find_numbers() {
    const double points = parameters_.number("POINT", "USED").value_or(header(2));
    if (points != header(2)) return contradiction("points", header(2), points);
    layout_.points = whole(points);

    const double header_scale = file_.real(header_word(7));
    layout_.scale = parameters_.number("POINT", "SCALE").value_or(header_scale);
    if (!std::isfinite(layout_.scale) || layout_.scale == 0.0) {
      return bad_data(fmt::format("POINT:SCALE is {}, which leaves open how numbers are stored", layout_.scale),
                      std::string(kC3dRemedy));
    }
    if (header_scale != 0.0 && std::signbit(header_scale) != std::signbit(layout_.scale)) {
      return contradiction("as scale of the points, whose sign says how numbers are stored,", header_scale,
                           layout_.scale);
    }
    layout_.point_rate = positive_or_zero(parameters_.number("POINT", "RATE").value_or(file_.real(header_word(11))));
    return {};
  }

  Result<void> find_analog() {
    const double in_frame = header(3), header_samples = header(10);
    layout_.analog_rate = positive_or_zero(parameters_.number("ANALOG", "RATE").value_or(0.0));
    const double ratio = layout_.point_rate > 0.0 ? layout_.analog_rate / layout_.point_rate : 0.0;
    const double samples = header_samples > 0.0 ? header_samples : std::max(std::round(ratio), 1.0);
    const double channels = parameters_.number("ANALOG", "USED").value_or(std::floor(in_frame / samples));
    if (std::max(channels, samples) > static_cast<double>(kMaxInWord) || channels != std::floor(channels)) {
      return bad_data(fmt::format("{} analog channels of {} samples in a frame are not possible", channels, samples),
                      std::string(kC3dRemedy));
    }
    if (channels * samples != in_frame && channels * samples <= static_cast<double>(kMaxInWord)) {
      return contradiction(fmt::format("analog numbers in a frame, of {} samples each,", samples), in_frame,
                           channels * samples);
    }
    layout_.channels = whole(channels);
    layout_.samples = whole(samples);
    if (layout_.channels == 0 || layout_.point_rate == 0.0) return {};
    const double by_points = layout_.point_rate * samples;
    if (layout_.analog_rate == 0.0) layout_.analog_rate = by_points;
    if (std::abs(layout_.analog_rate - by_points) > kRateTolerance * by_points) {
      return bad_data(fmt::format("ANALOG:RATE is {} Hz, but a frame holds {} samples and POINT:RATE is {} Hz",
                                  layout_.analog_rate, samples, layout_.point_rate),
                      "write the file again with the program that recorded it");
    }
    return {};
  }

  /// The number of frames that the parameters say; nothing where they do not.
  [[nodiscard]] std::optional<double> frames_of_parameters() const {
    const auto frames = parameters_.number("POINT", "FRAMES");
    if (frames && *frames != static_cast<double>(kMaxInWord)) return frames;
    if (const auto frames_long = parameters_.number("POINT", "LONG_FRAMES")) return frames_long;
    const auto first = field("ACTUAL_START_FIELD"), last = field("ACTUAL_END_FIELD");
    if (first && last && *last >= *first) return *last - *first + 1.0;
    return frames;
  }

  /// A count in two words, the lower first.
  [[nodiscard]] std::optional<double> field(std::string_view name) const {
    const auto words = parameters_.numbers("TRIAL", name, true);
    if (words.empty()) return std::nullopt;
    return words[0] + (words.size() > 1 ? 65536.0 * words[1] : 0.0);
  }

  Result<void> find_frames() {
    const double first = header(4), last = header(5);
    const double in_header = last >= first ? last - first + 1.0 : 0.0;
    const double frames = frames_of_parameters().value_or(in_header);
    first_frame_ = field("ACTUAL_START_FIELD").value_or(first);
    layout_.frames = whole(frames);
    if (layout_.frames == 0 || static_cast<double>(layout_.frames) != frames) {
      return bad_data(fmt::format("it says that it holds {} frames", frames), "nothing was recorded, or it is damaged");
    }
    if (frames != in_header && frames < static_cast<double>(kMaxInWord)) {
      note(fmt::format("the header counts {} frames ({} to {}), the parameters {}, which are taken", in_header, first,
                       last, frames));
    }
    return {};
  }

  Result<void> find_data() {
    const double block = parameters_.number("POINT", "DATA_START").value_or(header(9));
    if (header(9) != block) {
      note(fmt::format("the header begins the data at block {}, POINT:DATA_START at {}, which is taken", header(9),
                       block));
    }
    if (!(block >= 2.0)) {
      return bad_data(fmt::format("the data are said to begin at block {}", block), std::string(kC3dRemedy));
    }
    layout_.data = (whole(block) - 1) * kC3dBlock;
    const std::uint64_t left = file_.view.size() - std::min<std::uint64_t>(layout_.data, file_.view.size());
    if (layout_.frame_size() == 0) return bad_data("it holds neither points nor analog channels");
    if (layout_.frames > left / layout_.frame_size()) {
      return bad_data(fmt::format("{} frames of {} bytes need more than the {} bytes from block {} on", layout_.frames,
                                  layout_.frame_size(), left, block),
                      std::string(kC3dRemedy));
    }
    if (const std::uint64_t room = left / layout_.frame_size() - layout_.frames;
        room > 0 && room * layout_.frame_size() >= kC3dBlock) {
      note(fmt::format("it has more bytes than its {} frames need, enough for {} more; they were ignored",
                       layout_.frames, room));
    }
    return {};
  }

  void say_what_there_is() {
    const auto rate = [](double hz) { return hz > 0.0 ? fmt::format("at {:.6g} Hz", hz) : std::string("of no rate"); };
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
      note(fmt::format("{} of {} {} labels are missing; those are called {}_1, {}_2, … by their place", missing, count,
                       nameless, nameless, nameless));
    }
    if (!numbered.empty()) {
      note(fmt::format("{} {} labels are not unique and are numbered ('{}' is the first)", numbered.size(), nameless,
                       numbered.front()));
    }
    return names;
  }

  /// Units of the points that are no markers: those that POINT:ANGLES lists are in POINT:ANGLE_UNITS, and so on.
  [[nodiscard]] std::map<std::string, std::string> units_of_types() const {
    constexpr std::string_view kEnd = "_UNITS";
    std::map<std::string, std::string> units;
    for (const std::string_view name : parameters_.names("POINT")) {
      if (!name.ends_with(kEnd)) continue;
      const auto unit = parameters_.texts("POINT", name);
      const std::string type = std::string(name.substr(0, name.size() - kEnd.size())) + "S";
      for (const std::string& label : parameters_.texts("POINT", type)) units[label] = unit.empty() ? "" : unit.front();
    }
    return units;
  }

  Array& add(std::string name, std::string unit, double rate, std::uint64_t samples) {
    Array& array = contents_.arrays.emplace_back();
    array.name = std::move(name);
    array.unit = std::move(unit);
    array.rate_hz = rate;
    array.values.resize(static_cast<Index>(samples), 1);
    return array;
  }

  [[nodiscard]] double number(std::uint64_t offset, bool unsigned_words = false) const {
    const auto at = static_cast<std::size_t>(offset);
    if (layout_.real()) return file_.real(at);
    return unsigned_words ? file_.word(at) : file_.signed_word(at);
  }

  void take_points() {
    const auto said = parameters_.texts("POINT", "LABELS");
    const auto types = units_of_types();
    const auto markers = parameters_.texts("POINT", "UNITS");
    const auto names = labels("POINT", layout_.points, "point", {});
    const double scale = layout_.real() ? 1.0 : layout_.scale;
    const std::uint64_t each = layout_.number_size();
    std::size_t lost = 0;
    for (std::size_t p = 0; p < names.size(); ++p) {
      const auto type = p < said.size() ? types.find(said[p]) : types.end();
      const std::string unit = type != types.end() ? type->second : (markers.empty() ? "" : markers.front());
      const std::size_t first = contents_.arrays.size();
      for (const char axis : {'x', 'y', 'z'}) {
        add(fmt::format("{}.{}", names[p], axis), unit, layout_.point_rate, layout_.frames);
      }
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
    if (lost > 0) {
      note(fmt::format("{} of {} points are marked invalid in some frames; they are NaN there", lost, layout_.points));
    }
  }

  void take_analog() {
    const auto format = parameters_.texts("ANALOG", "FORMAT");
    const bool unsigned_words = !format.empty() && format.front() == "UNSIGNED";
    const auto scales = parameters_.numbers("ANALOG", "SCALE");
    const auto offsets = parameters_.numbers("ANALOG", "OFFSET", unsigned_words);
    const auto units = parameters_.texts("ANALOG", "UNITS");
    const double general = parameters_.number("ANALOG", "GEN_SCALE").value_or(1.0);
    std::set<std::string> points;
    for (const Array& array : contents_.arrays) points.insert(array.name);
    const auto names = labels("ANALOG", layout_.channels, "analog", points);
    const std::uint64_t each = layout_.number_size();
    for (std::size_t c = 0; c < names.size(); ++c) {
      const bool scaled = c < scales.size();
      Array& array = add(names[c], scaled && c < units.size() ? units[c] : "", layout_.analog_rate,
                         layout_.frames * layout_.samples);
      const double scale = (scaled ? scales[c] : 1.0) * general;
      const double offset = c < offsets.size() ? offsets[c] : 0.0;
      Index sample = 0;
      for (std::uint64_t f = 0; f < layout_.frames; ++f) {
        const std::uint64_t frame = layout_.data + f * layout_.frame_size() + kPointNumbers * layout_.points * each;
        for (std::uint64_t s = 0; s < layout_.samples; ++s, ++sample) {
          array.values(sample, 0) =
              (number(frame + (s * layout_.channels + c) * each, unsigned_words) - offset) * scale;
        }
      }
    }
    if (scales.size() < names.size()) {
      note(fmt::format("{} of {} analog channels have no SCALE; theirs are the numbers of the converter, without unit",
                       names.size() - scales.size(), names.size()));
    }
  }

  C3dBytes file_;
  C3dParameters parameters_;
  Layout layout_;
  double first_frame_ = 1.0;
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
    return bad_data(fmt::format("a C3D file of {} bytes ends before its parameters, which begin at block {}",
                                bytes.size(), std::to_integer<int>(bytes[0])),
                    std::string(kC3dRemedy));
  }
  const int processor = std::to_integer<int>(bytes[begin + 3]);
  if (processor < static_cast<int>(C3dProcessor::intel) || processor > static_cast<int>(C3dProcessor::sgi)) {
    return bad_data(fmt::format("a C3D file of processor {}; 84 (Intel), 85 (DEC) and 86 (SGI) are known", processor),
                    std::string(kC3dRemedy));
  }
  const C3dBytes file(bytes, C3dProcessor{static_cast<std::uint8_t>(processor)});
  // The count of blocks is one byte and often wrong; the data begin behind the parameters in any case.
  const std::size_t counted = begin + std::to_integer<std::size_t>(bytes[begin + 2]) * kC3dBlock;
  const std::size_t data = std::max<std::size_t>(file.word(header_word(9)), 1) * kC3dBlock - kC3dBlock;
  const std::size_t end = data > begin ? data : counted;
  auto parameters = C3dParameters::read(file, begin + kParameterHeader, end);
  if (!parameters) return tl::unexpected(parameters.error());
  return Parameters{file, std::move(*parameters)};
}

}  // namespace

Result<C3dParameters> decode_c3d_parameters(std::span<const std::byte> bytes) {
  auto found = parameters_of(bytes);
  if (!found) return tl::unexpected(found.error());
  return std::move(found->parameters);
}

Result<C3dLength> decode_c3d_length(std::span<const std::byte> bytes) {
  auto found = parameters_of(bytes);
  if (!found) return tl::unexpected(found.error());
  return Decoder(found->file, std::move(found->parameters)).length();
}

Result<Contents> decode_c3d(std::span<const std::byte> bytes) {
  auto found = parameters_of(bytes);
  if (!found) return tl::unexpected(found.error());
  return Decoder(found->file, std::move(found->parameters)).run();
}

}  // namespace mbk::recording
