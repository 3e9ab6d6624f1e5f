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

/// Sentences that hold for several datasets, each written once with all of their names.
class SharedNotes {
 public:
  void add(std::string sentence, std::string name);
  /// "SENTENCE 'a', 'b'", in the order in which they were added.
  [[nodiscard]] std::vector<std::string> lines() const;

 private:
  std::vector<std::pair<std::string, std::vector<std::string>>> all_;
  std::map<std::string, std::size_t> places_;  ///< of the sentences in `all_`
};

/// The attribute that keeps Array::unapplied in a file that mbk writes.
inline constexpr std::string_view kUnapplied = "unapplied";

/// Makes the numbers of a dataset what its attributes say that they are:
///   value = stored · conversion · channel_conversion + offset   (NWB 2, TimeSeries)
///   value = stored · scale_factor + add_offset                  (CF 1.11, section 8.1)
/// where stored is not `_FillValue` or `missing_value`, nor outside of `valid_min`, `valid_max` or `valid_range`; these
/// become NaN. `_Unsigned` is followed. An attribute may have one number, or one for each column. Names count without
/// case, blanks and underscores.
/// @param array    gets unit, rate and, with attributes such as `gain` that do not say what is to be done with them,
///                 Array::unapplied
/// @param columns  numbers that follow each other and belong to one row
/// @param netcdf   numbers that were never written hold the fill value of netCDF
void apply_attributes(const hdf5::Attributes& attributes, hdf5::Numbers& numbers, std::uint64_t columns, bool netcdf,
                      Array& array, SharedNotes& notes);

/// What is left to the columns of a table of the attributes that it has itself: those that hold one value for each of
/// them; and units, fill values and, as Array::unapplied, scales that hold one for all.
void hand_attributes_on(hdf5::Group& table);

/// Sample rates among the attributes of a group.
/// @param path  of the group: "trial"; "": the root
[[nodiscard]] std::vector<SaidRate> rates_of_group(const hdf5::Attributes& attributes, const std::string& path);

/// Notes what a group says that may change the numbers in it, and is not applied.
void note_unapplied(const hdf5::Attributes& attributes, const std::string& path, SharedNotes& notes);

/// The number of an attribute that holds one, as a number or as text.
[[nodiscard]] std::optional<double> number_attribute(const hdf5::Attributes& attributes, std::string_view name);

}  // namespace mbk::recording
