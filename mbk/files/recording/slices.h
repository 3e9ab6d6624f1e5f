#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// "data[trial,:,2]" or "data(:,2)": one signal of an array of two or more dimensions, by the channel map.
struct SlicedSource {
  static constexpr Index kAlong = 0;   ///< ':', the dimension along which the signal runs
  static constexpr Index kTrial = -1;  ///< 'trial', the one selected by --trial
  std::string_view name;
  std::vector<Index> at;  ///< for each dimension a number from 1, kAlong or kTrial
};

/// Nothing where the source is written otherwise. An identical name in the file takes precedence.
[[nodiscard]] std::optional<SlicedSource> sliced_source(std::string_view source);

/// The length of the slice, with its brackets, that begins a text ("[:,2]"); 0 if none does. Its commas do not separate
/// entries of a map.
[[nodiscard]] std::size_t slice_ahead(std::string_view text);

/// The lengths of an array along its dimensions, in file order.
[[nodiscard]] std::vector<std::uint64_t> dimensions_of(const Array& array);

/// "40×2000×6"
[[nodiscard]] std::string shape_text(const Array& array);

/// The roles of the dimensions of an array in one slice.
struct SlicePlan {
  std::vector<Index> at;             ///< number from 1 for every dimension that is neither of the next two
  std::size_t along = 0;             ///< of time
  std::optional<std::size_t> trial;  ///< of trials, if one is free
};

/// A signal runs along ':'. The free dimension of a slice (the last one, if the slice has one entry less than the array
/// has dimensions; the shorter of two ':'; 'trial') is that of trials.
/// @fails  data: a number is out of range; the time dimension is ambiguous.
[[nodiscard]] Result<SlicePlan> plan_of(const Array& array, const SlicedSource& source);

/// Positions of the numbers of a slice in Array::values.
struct Slice {
  Index begin = 0, stride = 1, length = 0;
};
/// @param trial  from 1; ignored by a plan without trials
[[nodiscard]] Slice slice_of(const Array& array, const SlicePlan& plan, Index trial);

/// "data[trial,:,1]": an example slice of an array, with time along the longest dimension and channels along the
/// shortest.
[[nodiscard]] std::string example_slice(const Array& array, Index channel);

}  // namespace mbk::recording
