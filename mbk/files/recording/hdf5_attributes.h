#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/said_rates.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::recording {

/// Notes that apply to several datasets, each written once with all names.
class SharedNotes {
 public:
  void add(std::string sentence, std::string name);
  /// "SENTENCE 'a', 'b'", in the order in which they were added.
  [[nodiscard]] std::vector<std::string> lines() const;

 private:
  std::vector<std::pair<std::string, std::vector<std::string>>> all_;
  std::map<std::string, std::size_t> places_;  ///< of the sentences in `all_`
};

/// The attribute that stores Array::unapplied in files written by mbk.
inline constexpr std::string_view kUnapplied = "unapplied";

/// Applies the attributes of a dataset to its numbers:
///   value = stored · conversion · channel_conversion + offset   (NWB 2, TimeSeries)
///   value = stored · scale_factor + add_offset                  (CF 1.11, section 8.1)
/// where stored is not `_FillValue` or `missing_value`, nor outside `valid_min`, `valid_max` or `valid_range`; these
/// become NaN. `_Unsigned` is applied. An attribute may have one number, or one per column. Case, blanks and
/// underscores in names are ignored.
/// @param array    receives unit, rate and, for attributes with undefined use such as `gain`, Array::unapplied
/// @param columns  consecutive numbers that form one row
/// @param netcdf   unwritten numbers have the fill value of netCDF
void apply_attributes(const hdf5::Attributes& attributes, hdf5::Numbers& numbers, std::uint64_t columns, bool netcdf,
                      Array& array, SharedNotes& notes);

/// The attributes of a table that apply to its columns: those with one value per column; and units, fill values and, as
/// Array::unapplied, scales with one value for all.
void hand_attributes_on(hdf5::Group& table);

/// Sample rates among the attributes of a group.
/// @param path  of the group: "trial"; "": the root
[[nodiscard]] std::vector<SaidRate> rates_of_group(const hdf5::Attributes& attributes, const std::string& path);

/// Notes attributes of a group that may change its numbers and are not applied.
void note_unapplied(const hdf5::Attributes& attributes, const std::string& path, SharedNotes& notes);

/// The value of an attribute with a single number, stored as number or text.
[[nodiscard]] std::optional<double> number_attribute(const hdf5::Attributes& attributes, std::string_view name);

}  // namespace mbk::recording
