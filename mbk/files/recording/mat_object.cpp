#include "mbk/files/recording/mat_object.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace mbk::recording {
namespace {

/// Two lines of MATLAB that write the numbers of an object so that they can be read.
/// @param name  of the variable: "trial.tt"
std::string matlab_export(const std::string& name, std::string_view type) {
  using Cure = std::pair<std::string_view, std::string_view>;
  constexpr auto kCures = std::to_array<Cure>({
      {"table", "writetable({0}, '{1}.csv')"},
      {"timetable", "writetable(timetable2table({0}), '{1}.csv')"},
      {"timeseries", "s = struct('time', {0}.Time, 'data', squeeze({0}.Data)); save('{1}_plain.mat', '-struct', 's')"},
      {"Simulink.SimulationData.Dataset",
       "e = {0}{{1}}.Values; s = struct('time', e.Time, 'data', squeeze(e.Data)); save('{1}_plain.mat', '-struct', "
       "'s')"},
      {"string", "{1} = cellstr({0}); save('{1}_plain.mat', '{1}')"},
      {"datetime", "{1} = posixtime({0}); save('{1}_plain.mat', '{1}')"},
      {"duration", "{1} = seconds({0}); save('{1}_plain.mat', '{1}')"},
      {"categorical", "{1} = double({0}); save('{1}_plain.mat', '{1}')"},
  });
  const auto cure = std::ranges::find(kCures, type, &Cure::first);
  const std::string_view words =
      cure != kCures.end() ? cure->second : "s = struct({0}); save('{1}_plain.mat', '-struct', 's')";
  return fmt::format(fmt::runtime(words), name, name.substr(name.find_last_of('.') + 1));
}

}  // namespace

void list_object(Contents& contents, std::string_view name, std::string_view type) {
  Array& array = contents.arrays.emplace_back();
  array.name = name;
  const std::string what =
      fmt::format("'{}' is an object of MATLAB class '{}', whose storage format is undocumented", name, type);
  const std::string cure = "in MATLAB: " + matlab_export(array.name, type);
  array.obstacle = bad_data(what, cure + "; in Python, load_from_mat of the package mat-io reads many classes").value();
  contents.notes.push_back(fmt::format("variable {}; ignored ({})", what, cure));
}

}  // namespace mbk::recording
