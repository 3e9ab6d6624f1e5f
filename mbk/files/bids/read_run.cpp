#include "mbk/files/bids/read_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "mbk/base/core/natural_order.h"
#include "mbk/base/core/printable.h"
#include "mbk/files/bids/bids_words.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/contents/memory.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/files/contents/text_lines.h"

namespace mbk::recording {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::string_view kMotion = "_motion.tsv", kChannels = "_channels.tsv", kSidecar = "_motion.json",
                           kDescriptions = "_channels.json", kEvents = "_events.tsv";
constexpr std::size_t kMaxColumns = 10'000;

std::string shown(std::string_view cell) {
  return printable(std::string(cell.substr(0, 60)));
}

/// A table with a header, cell by cell.
struct Tsv {
  std::vector<std::string_view> header;
  std::vector<std::vector<std::string_view>> rows;
  std::vector<std::size_t> lines;  ///< number of the line of each row

  [[nodiscard]] std::string_view cell(std::size_t row, std::string_view column) const {
    const auto at = static_cast<std::size_t>(std::ranges::find(header, column) - header.begin());
    const std::string_view found = at < rows[row].size() ? rows[row][at] : std::string_view();
    return found == kNotAvailable ? std::string_view() : found;
  }
  [[nodiscard]] bool has(std::string_view column) const { return std::ranges::find(header, column) != header.end(); }
};

Tsv parse_tsv(std::string_view text) {
  Tsv table;
  TextLines lines(text);
  if (const auto header = lines.next_filled()) table.header = split(header->text, '\t');
  for (auto line = lines.next_filled(); line; line = lines.next_filled()) {
    table.rows.push_back(split(line->text, '\t'));
    table.lines.push_back(line->number);
  }
  return table;
}

std::optional<double> positive(const Json& sidecar, const char* key) {
  const auto entry = sidecar.find(key);
  if (entry == sidecar.end() || !entry->is_number()) return std::nullopt;
  const double value = entry->get<double>();
  return value > 0.0 && value < 1e300 ? std::optional(value) : std::nullopt;
}

class Run {
 public:
  explicit Run(const BidsTexts& texts) : texts_(texts) {}

  Result<Contents> run() {
    contents_.format = "BIDS motion";
    contents_.table = true;
    MBK_TRY(take_sidecars());
    channels_ = parse_tsv(texts_.channels);
    for (const std::string_view column : {"name", "type", "units"}) {
      if (channels_.has(column)) continue;
      return bad_data(fmt::format("column '{}' is missing", column), "give each channel a name, a type and units",
                      std::string(kChannels.substr(1)));
    }
    const std::size_t count = channels_.rows.size();
    if (count == 0 || count > kMaxColumns) {
      return bad_data(fmt::format("it describes {} channels", count), "describe every column of motion.tsv",
                      std::string(kChannels.substr(1)));
    }
    MBK_TRY(take_numbers());
    MBK_TRY(name_channels());
    take_events();
    return std::move(contents_);
  }

 private:
  Result<void> take_sidecars() {
    sidecar_ = Json::object();
    for (const std::string& text : texts_.sidecars) {
      const Json one = Json::parse(text, nullptr, false);
      if (!one.is_object()) {
        return bad_data("it is not a JSON object", "correct it", std::string(kSidecar.substr(1)));
      }
      for (const auto& [key, value] : one.items()) sidecar_[key] = value;
    }
    const Json descriptions = Json::parse(texts_.descriptions, nullptr, false);
    const auto own = descriptions.is_object() ? descriptions.find(kMetadataKey) : descriptions.end();
    if (own != descriptions.end() && own->is_object() && own->contains("Levels") && (*own)["Levels"].is_object()) {
      for (const auto& [key, value] : (*own)["Levels"].items()) {
        if (value.is_string()) contents_.metadata[printable(key)] = printable(value.get<std::string>());
      }
      return {};
    }
    const auto task = sidecar_.find("TaskName");
    if (task != sidecar_.end() && task->is_string()) contents_.metadata["task"] = printable(task->get<std::string>());
    if (!texts_.label.empty()) contents_.metadata["participant"] = printable(texts_.label);
    return {};
  }

  Result<void> take_numbers() {
    const std::size_t columns = channels_.rows.size();
    const auto lines_there = static_cast<std::uint64_t>(std::ranges::count(texts_.motion, '\n')) + 1;
    const std::uint64_t rows_there = std::min<std::uint64_t>(lines_there, texts_.motion.size() / columns + 1);
    MBK_TRY(check_memory(8 * rows_there * columns));
    std::vector<Vector> numbers(columns, Vector(static_cast<Index>(rows_there)));
    TextLines lines(texts_.motion);
    Index rows = 0;
    for (auto line = lines.next(); line; line = lines.next()) {
      if (line->text.empty()) continue;
      const auto cells = split(line->text, '\t');
      const std::string where = fmt::format("{}, line {}", kMotion.substr(1), line->number);
      if (line->number == 1 && is_header(cells)) {
        contents_.notes.emplace_back("its first line repeats the channel names, which the standard does not require");
        continue;
      }
      if (!line->terminated && cells.size() < columns) {
        contents_.notes.push_back(
            fmt::format("line {} is incomplete (the recording was cut off there) and was ignored", line->number));
        break;
      }
      if (cells.size() != columns) {
        return bad_data(fmt::format("it has {} columns, {} describes {}", cells.size(), kChannels.substr(1), columns),
                        "describe every column, in file order", where);
      }
      for (std::size_t c = 0; c < columns; ++c) {
        const auto value = cells[c] == kNotAvailable ? std::numeric_limits<double>::quiet_NaN() : cell_number(cells[c]);
        if (!value) {
          return bad_data(fmt::format("'{}' is not a number", shown(cells[c])), "write n/a for a missing value",
                          fmt::format("{}, column {}", where, c + 1));
        }
        numbers[c][rows] = *value;
      }
      ++rows;
    }
    if (rows == 0) return bad_data("it contains no samples", "nothing was recorded", std::string(kMotion.substr(1)));
    for (Vector& column : numbers) {
      column.conservativeResize(rows);
      contents_.arrays.emplace_back().values = SharedMatrix::of_column(std::move(column));
    }
    return {};
  }

  [[nodiscard]] bool is_header(const std::vector<std::string_view>& cells) const {
    if (cells.size() != channels_.rows.size()) return false;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (cells[c] != channels_.cell(c, "name") || general_number(cells[c])) return false;
    }
    return true;
  }

  Result<void> name_channels() {
    const auto effective = positive(sidecar_, "SamplingFrequencyEffective");
    const auto nominal = positive(sidecar_, "SamplingFrequency");
    const double rate = effective.value_or(nominal.value_or(0.0));
    bool timed = false;
    std::vector<std::string> bad;
    for (std::size_t c = 0; c < contents_.arrays.size(); ++c) {
      Array& array = contents_.arrays[c];
      array.name = printable(std::string(channels_.cell(c, "name")));
      array.unit = printable(std::string(channels_.cell(c, "units")));
      if (channels_.cell(c, "type") == "LATENCY" && !timed) {
        timed = true;
        array.means = "time";
        if (array.unit.empty()) array.unit = "s";
      }
      const std::string_view point = channels_.cell(c, "tracked_point");
      const bool of_joint = array.name.starts_with("joint_") || array.name.starts_with("torque_");
      const std::string counted = "joint_" + array.name.substr(array.name.find('_') + 1);
      if (of_joint && point != counted) array.joint = printable(std::string(point));
      if (channels_.cell(c, "status") == "bad") bad.push_back(array.name);
    }
    if (!bad.empty()) {
      contents_.notes.push_back(fmt::format("channels.tsv marks these channels as bad: {}", fmt::join(bad, ", ")));
    }
    if (timed) return {};
    if (rate == 0.0) {
      return bad_data("SamplingFrequency is missing, and no channel is of type LATENCY", "add the sampling frequency",
                      std::string(kSidecar.substr(1)));
    }
    for (Array& array : contents_.arrays) array.rate_hz = rate;
    if (effective && nominal && *effective != *nominal) {
      contents_.notes.push_back(
          fmt::format("the effective rate, {:.9g} Hz, is used; the nominal rate is {:.9g} Hz", *effective, *nominal));
    }
    return {};
  }

  void take_events() {
    if (texts_.events.empty()) return;
    const Tsv events = parse_tsv(texts_.events);
    double begin = 0.0;
    for (const Array& array : contents_.arrays) {
      if (array.means == "time") begin = array.values(0, 0) / (array.unit == "ms" ? 1e3 : 1.0);
    }
    std::size_t left_out = 0;
    for (std::size_t k = 0; k < events.rows.size(); ++k) {
      const auto number = [&](std::string_view column) -> std::optional<double> {
        const std::string_view cell = events.cell(k, column);
        return cell.empty() ? std::nullopt : general_number(cell);
      };
      const auto onset = number("onset"), exact = number(kRecordedTime);
      if (!onset && !exact) {
        ++left_out;
        continue;
      }
      std::string_view name;
      for (const std::string_view column : {"trial_type", "event_type", "stim_type"}) {
        if (name.empty()) name = events.cell(k, column);
      }
      const std::string_view value = events.cell(k, "value");
      const auto as_number = value.empty() ? std::optional(0.0) : general_number(value);
      if (name.empty() && !as_number) name = value;
      contents_.events.push_back(
          {exact ? *exact : begin + *onset, printable(std::string(name)), as_number.value_or(0.0)});
    }
    if (left_out > 0) contents_.notes.push_back(fmt::format("{} events have no onset; ignored", left_out));
  }

  const BidsTexts& texts_;
  Json sidecar_;
  Tsv channels_;
  Contents contents_;
};

std::string stem_of(const fs::path& motion) {
  const std::string name = motion.filename().string();
  return name.substr(0, name.size() - kMotion.size());
}

std::string without_tracking_system(const std::string& stem) {
  std::string kept;
  for (const std::string_view part : split(stem, '_')) {
    if (!part.starts_with("tracksys-")) kept += (kept.empty() ? "" : "_") + std::string(part);
  }
  return kept;
}

/// Whether every part of a more general name, before its suffix, occurs in that of the recording.
bool applies(std::string_view general, const std::vector<std::string_view>& parts) {
  return general.empty() || std::ranges::all_of(split(general, '_'), [&](std::string_view part) {
           return part.empty() || std::ranges::find(parts, part) != parts.end();
         });
}

Result<std::string> read_text(const fs::path& file) {
  const auto bytes = read_file(file);
  if (!bytes) return tl::unexpected(bytes.error().in(file.filename().string()));
  const auto text = bytes->bytes();
  return std::string(reinterpret_cast<const char*>(text.data()), text.size());
}

/// Files with that end that hold for a recording, the most general first: those of its folder and of the folders above,
/// up to the data set.
std::vector<fs::path> files_for(const fs::path& motion, std::string_view end) {
  constexpr int kUp = 4;
  const std::string stem = stem_of(motion);
  const auto parts = split(stem, '_');
  std::vector<fs::path> found;
  fs::path folder = motion.has_parent_path() ? motion.parent_path() : fs::path(".");
  for (int k = 0; k < kUp; ++k) {
    std::vector<fs::path> here;
    std::error_code code;
    for (fs::directory_iterator entry(folder, code), last; !code && entry != last; entry.increment(code)) {
      const std::string name = entry->path().filename().string();
      const bool bare = name == end.substr(1);
      if (!bare && !name.ends_with(end)) continue;
      if (applies(bare ? std::string_view() : std::string_view(name).substr(0, name.size() - end.size()), parts)) {
        here.push_back(entry->path());
      }
    }
    std::ranges::sort(here, {}, [](const fs::path& path) { return path.filename().string().size(); });
    found.insert(found.begin(), here.begin(), here.end());
    const bool is_root = fs::exists(folder / "dataset_description.json", code);
    const std::string name = fs::absolute(folder, code).lexically_normal().filename().string();
    if (is_root || !(name == "motion" || name.starts_with("ses-") || name.starts_with("sub-"))) break;
    folder = fs::absolute(folder, code).lexically_normal().parent_path();
  }
  return found;
}

}  // namespace

Result<Contents> decode_bids(const BidsTexts& texts) {
  return Run(texts).run();
}

bool may_be_bids(const fs::path& path) {
  std::error_code code;
  return path.filename().string().ends_with(kMotion) || fs::is_directory(path, code);
}

Result<std::vector<BidsRun>> find_bids_runs(const fs::path& path) {
  constexpr int kDeepest = 4;
  std::vector<BidsRun> runs;
  std::error_code code;
  if (!fs::is_directory(path, code)) {
    runs.push_back({{stem_of(path), ""}, path});
    return runs;
  }
  for (fs::recursive_directory_iterator entry(path, code), last; !code && entry != last; entry.increment(code)) {
    const std::string name = entry->path().filename().string();
    std::error_code ignored;
    if (entry->is_directory(ignored)) {
      const bool other = name == "derivatives" || name == "sourcedata" || name == "code" || name.starts_with('.');
      if (other || entry.depth() >= kDeepest) entry.disable_recursion_pending();
    } else if (name.ends_with(kMotion) && name.starts_with("sub-")) {
      runs.push_back({{stem_of(entry->path()), ""}, entry->path()});
    }
  }
  if (code) return bad_data(fmt::format("the folder cannot be read: {}", code.message()), "check its permissions");
  std::ranges::sort(runs, in_natural_order, [](const BidsRun& run) { return std::string_view(run.name.name); });
  std::set<std::string> shorter;
  bool alike = false;
  for (const BidsRun& run : runs) alike = !shorter.insert(without_tracking_system(run.name.name)).second || alike;
  if (!alike) {
    for (BidsRun& run : runs) run.name.name = without_tracking_system(run.name.name);
  }
  for (BidsRun& run : runs) run.name.name = printable(run.name.name);
  return runs;
}

Result<BidsRecording> read_bids_run(const fs::path& motion) {
  const auto numbers = MBK_TRY(read_text(motion));
  const auto channel_files = files_for(motion, kChannels);
  if (channel_files.empty()) {
    return bad_data(fmt::format("its file {}{} is missing", stem_of(motion), kChannels),
                    "add it, with name, type and units of every column");
  }
  const auto channels = MBK_TRY(read_text(channel_files.back()));
  BidsTexts texts{numbers, channels, {}, "", "", ""};
  for (const fs::path& file : files_for(motion, kSidecar)) {
    auto text = MBK_TRY(read_text(file));
    texts.sidecars.push_back(std::move(text));
  }
  std::string events, descriptions;
  for (auto& [text, end] : {std::pair(&events, kEvents), std::pair(&descriptions, kDescriptions)}) {
    const auto files = files_for(motion, end);
    if (files.empty()) continue;
    *text = MBK_TRY(read_text(files.back()));
  }
  texts.events = events;
  texts.descriptions = descriptions;
  const std::string stem = stem_of(motion);
  for (const std::string_view part : split(stem, '_')) {
    if (part.starts_with("sub-")) texts.label = std::string(part.substr(4));
  }
  auto contents = MBK_TRY(decode_bids(texts));
  return BidsRecording{std::move(contents), sha256(std::as_bytes(std::span(numbers)))};
}

}  // namespace mbk::recording
