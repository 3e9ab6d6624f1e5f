#include "mbk/files/recording/write_contents.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "mbk/base/core/table_text.h"
#include "mbk/base/core/version.h"
#include "mbk/files/hdf5/write_hdf5.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/encode.h"
#include "mbk/files/recording/hdf5_attributes.h"
#include "mbk/files/recording/mat_variables.h"
#include "mbk/files/recording/write_file.h"

namespace mbk::recording {
namespace {

/// Names that a format can hold, each once, and what became of those that it cannot.
class Names {
 public:
  explicit Names(std::vector<std::string>& said) : said_(said) {}

  /// @param wanted  a writable name    @param from  the name in the file
  std::string take(std::string requested, const std::string& from) {
    std::string name = requested;
    for (int k = 2; !taken_.insert(name).second; ++k) {
      const std::string number = fmt::format("_{}", k);
      name = requested.substr(0, kLongestMatlabName - number.size()) + number;
    }
    if (name != from) said_.push_back(fmt::format("'{}' was renamed '{}'", from, name));
    return name;
  }

 private:
  std::set<std::string> taken_;
  std::vector<std::string>& said_;
};

/// The name of an array, or the number of a column that has none.
std::string name_of(const Contents& contents, std::size_t k) {
  const std::string& name = contents.arrays[k].name;
  return name.empty() ? fmt::format("column_{}", k + 1) : name;
}

std::string matlab_name(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return !is_matlab_name(std::string("a") + c); }, '_');
  if (!is_matlab_name(name.substr(0, 1))) name = "x" + name;
  return name.substr(0, kLongestMatlabName);
}

// ---- HDF5 ----

hdf5::Value one_number(double value) {
  return {{}, hdf5::Numbers{Vector::Constant(1, value), hdf5::Stored::float64}};
}

hdf5::Dataset dataset_of(const SharedMatrix& values) {
  const auto rows = static_cast<std::uint64_t>(values.rows()), columns = static_cast<std::uint64_t>(values.cols());
  hdf5::Dataset dataset;
  dataset.value.shape = columns == 1 ? std::vector{rows} : std::vector{rows, columns};
  dataset.value.data = hdf5::Numbers{values.reshaped<Eigen::RowMajor>(), hdf5::Stored::float64};
  return dataset;
}

/// Puts a dataset at its path; false if a group or dataset of that name exists.
bool put(hdf5::Group& root, std::string_view path, hdf5::Dataset& dataset) {
  hdf5::Group* group = &root;
  while (true) {
    const std::size_t end = path.find('/');
    const std::string name(path.substr(0, end));
    if (name.empty() || name == "." || group->datasets.contains(name)) return false;
    if (end == path.npos) {
      if (group->groups.contains(name)) return false;
      group->datasets[name] = std::move(dataset);
      return true;
    }
    group = &group->groups[name];
    path.remove_prefix(end + 1);
  }
}

std::string flat(std::string name) {
  std::ranges::replace(name, '/', '_');
  return name.empty() || name == "." ? "_" : name;
}

Result<std::string> encode_contents_hdf5(const Contents& contents, std::vector<std::string>& said) {
  hdf5::Group root;
  root.attributes["software"] = hdf5::one_text(fmt::format("mbk {}", version()));
  for (const auto& [key, value] : contents.metadata) root.attributes[key] = hdf5::one_text(value);
  Names names(said);
  std::vector<std::string> clocks;
  for (const Clock& clock : contents.clocks) clocks.push_back(flat(clock.name));
  for (std::size_t k = 0; k < contents.arrays.size(); ++k) {
    const Array& array = contents.arrays[k];
    hdf5::Dataset dataset = dataset_of(array.values);
    if (!array.unit.empty()) dataset.attributes["unit"] = hdf5::one_text(array.unit);
    if (array.rate_hz > 0.0) dataset.attributes["rate_hz"] = one_number(array.rate_hz);
    if (!array.unapplied.empty()) {
      dataset.attributes[std::string(kUnapplied)] = hdf5::one_text(array.unapplied);
    }
    if (array.clock >= 0)
      dataset.attributes["clock"] = hdf5::one_text("clocks/" + clocks[static_cast<std::size_t>(array.clock)]);
    const std::string from = name_of(contents, k);
    const std::string path = names.take(from.substr(from.starts_with('/') ? 1 : 0), from);
    if (put(root, path, dataset)) continue;
    const std::string other = names.take(flat(path), from);
    if (!put(root, other, dataset)) return bad_data(fmt::format("'{}' cannot be named in an HDF5 file", from));
  }
  for (std::size_t k = 0; k < contents.clocks.size(); ++k) {
    hdf5::Dataset dataset = dataset_of(Matrix(contents.clocks[k].time));
    dataset.attributes["unit"] = hdf5::one_text("s");
    if (!put(root, "clocks/" + clocks[k], dataset)) {
      said.push_back(fmt::format("the time stamps of '{}' could not be stored", contents.clocks[k].name));
    }
  }
  const bool events_free = !root.groups.contains("events") && !root.datasets.contains("events");
  if (!contents.events.empty() && events_free) root.groups["events"] = hdf5_events(contents.events);
  return hdf5::serialise(root);
}

// ---- MAT ----

Result<std::vector<MatVariable>> variables_of(const Contents& contents, std::vector<std::string>& said) {
  Names names(said);
  std::vector<MatVariable> variables;
  MatVariable::Structure units, rates, clocks;
  for (std::size_t k = 0; k < contents.arrays.size(); ++k) {
    const Array& array = contents.arrays[k];
    const std::string from = name_of(contents, k);
    const std::string name = names.take(matlab_name(from), from);
    variables.push_back({name, Matrix(array.values)});
    if (!array.unit.empty()) units.push_back({name, array.unit});
    if (array.rate_hz > 0.0) rates.push_back({name, Matrix(Matrix::Constant(1, 1, array.rate_hz))});
    if (array.clock >= 0) clocks.push_back({name, contents.clocks[static_cast<std::size_t>(array.clock)].name});
  }
  for (const Clock& clock : contents.clocks) {
    variables.push_back({names.take(matlab_name("clock_" + clock.name), "clock_" + clock.name), Matrix(clock.time)});
  }
  MatVariable::Structure metadata;
  Names keys(said);
  for (const auto& [key, value] : contents.metadata) metadata.push_back({keys.take(matlab_name(key), key), value});
  const auto add = [&](const char* name, MatVariable::Structure fields) {
    if (!fields.empty()) variables.push_back({names.take(name, name), std::move(fields)});
  };
  add("units", std::move(units));
  add("rates_hz", std::move(rates));
  add("clocks", std::move(clocks));
  add("metadata", std::move(metadata));
  if (!contents.events.empty()) add("events", structure_of(contents.events));
  return variables;
}

// ---- CSV ----

/// A column of the table: a row or column of an array.
struct TableColumn {
  std::string name;
  const SharedMatrix* values;
  Index line;
  bool row;
  [[nodiscard]] double at(Index k) const { return row ? (*values)(line, k) : (*values)(k, line); }
};

std::string cell(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return std::string_view(",;\t\"#%\r\n").find(c) != std::string_view::npos; }, '_');
  if (is_formula(name)) name.front() = '_';
  return name;
}

Result<std::string> encode_contents_csv(const Contents& contents, std::vector<std::string>& said) {
  Names names(said);
  std::vector<TableColumn> columns;
  Index samples = -1;
  const Array& first = contents.arrays.front();
  for (std::size_t k = 0; k < contents.arrays.size(); ++k) {
    const Array& array = contents.arrays[k];
    const bool row = array.values.cols() > array.values.rows();
    const Index length = row ? array.values.cols() : array.values.rows();
    if (samples < 0) samples = length;
    if (length != samples || array.clock != first.clock) {
      return bad_data(
          fmt::format("'{}' has {} samples{}, '{}' has {}; they cannot form one table", name_of(contents, 0), samples,
                      array.clock != first.clock ? " of a different clock" : "", name_of(contents, k), length),
          "write .h5 or .mat, or select channels of equal length with --channels");
    }
    const Index lines = row ? array.values.rows() : array.values.cols();
    for (Index line = 0; line < lines; ++line) {
      const std::string one = lines == 1 ? name_of(contents, k) : fmt::format("{}[{}]", name_of(contents, k), line + 1);
      const std::string with_unit = array.unit.empty() ? one : fmt::format("{} [{}]", one, array.unit);
      columns.push_back({names.take(cell(with_unit), with_unit), &array.values, line, row});
    }
  }
  if (samples <= 0 || columns.empty()) return bad_data("the arrays contain no samples", "nothing was recorded");
  const bool one_rate = first.rate_hz > 0.0 && std::ranges::all_of(contents.arrays, [&](const Array& array) {
                          return array.rate_hz == first.rate_hz;
                        });
  const Vector* const stamps =
      first.clock >= 0 ? &contents.clocks[static_cast<std::size_t>(first.clock)].time : nullptr;
  const bool timed = one_rate || (stamps != nullptr && stamps->size() == samples);
  std::string text =
      fmt::format("# written by mbk {}, unchanged from a file of the format {}\n", version(), contents.format);
  for (const auto& [key, value] : contents.metadata) text += fmt::format("# {}: {}\n", key, value);
  if (timed) {
    text += names.take("time_s", "time_s");
    said.emplace_back(stamps != nullptr ? "the first column contains the time stamps"
                                        : "the first column is the time computed from the rate in the file");
  }
  for (std::size_t k = 0; k < columns.size(); ++k) text += (k > 0 || timed ? "," : "") + columns[k].name;
  text += '\n';
  for (Index k = 0; k < samples; ++k) {
    if (timed) append_number(text, stamps != nullptr ? (*stamps)[k] : static_cast<double>(k) / first.rate_hz);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (c > 0 || timed) text += ',';
      append_number(text, columns[c].at(k));
    }
    text += '\n';
  }
  if (!contents.events.empty())
    said.push_back(fmt::format("{} events cannot be stored in such a CSV file", contents.events.size()));
  return text;
}

Result<std::string> encode(const Contents& contents, Format format, std::vector<std::string>& said) {
  if (format == Format::hdf5) return encode_contents_hdf5(contents, said);
  if (format == Format::csv) return encode_contents_csv(contents, said);
  if (format == Format::c3d) {
    return bad_data("no channel is recognised, and C3D cannot store arrays unchanged",
                    "name the channels with --channels, or write .h5, .mat or .csv");
  }
  const auto variables = MBK_TRY(variables_of(contents, said));
  return format == Format::mat5 ? encode_mat_level5(variables) : encode_mat_hdf5(variables);
}

}  // namespace

Result<std::vector<std::string>> write_contents(const Contents& contents, const std::filesystem::path& file,
                                                Format format, bool overwrite, Readers readers) {
  if (contents.arrays.empty()) {
    return fail(ErrorKind::data, "there is no numeric array to write", "check the contents of the file with 'mbk info'",
                file.string());
  }
  std::vector<std::string> said;
  const auto bytes = encode(contents, format, said);
  if (!bytes) return tl::unexpected(bytes.error().in(file.string()));
  MBK_TRY(write_file(file, overwrite, *bytes, readers));
  return said;
}

}  // namespace mbk::recording
