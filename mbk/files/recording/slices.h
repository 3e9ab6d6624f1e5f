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
  static constexpr Index kTrial = -1;  ///< 'trial', the one that --trial walks
  std::string_view name;
  std::vector<Index> at;  ///< for each dimension a number from 1, kAlong or kTrial
};

/// Nothing where the source is written otherwise. A file may have a name that looks so: that goes first.
[[nodiscard]] std::optional<SlicedSource> sliced_source(std::string_view source);

/// The length of the slice, with its brackets, that begins a text ("[:,2]"); 0 where none does. Its commas part no
/// entries of a map.
[[nodiscard]] std::size_t slice_ahead(std::string_view text);

/// The lengths of an array along its dimensions, as its file counts them.
[[nodiscard]] std::vector<std::uint64_t> dimensions_of(const Array& array);

/// "40×2000×6"
[[nodiscard]] std::string shape_text(const Array& array);

/// Which dimension of an array is what, for one slice.
struct SlicePlan {
  std::vector<Index> at;             ///< number from 1 for every dimension that is neither of the next two
  std::size_t along = 0;             ///< of time
  std::optional<std::size_t> trial;  ///< of trials, where one is left over
};

/// A signal runs along ':'. The dimension that a slice leaves over (the last one, where it has one entry less than the
/// array has dimensions; the shorter one of two ':'; 'trial') is that of trials.
/// @fails  data: a number is out of range; which dimension is time may be taken in two ways.
[[nodiscard]] Result<SlicePlan> plan_of(const Array& array, const SlicedSource& source);

/// Where the numbers of a slice stand in Array::values.
struct Slice {
  Index begin = 0, stride = 1, length = 0;
};
/// @param trial  from 1; of a plan without trials it does not count
[[nodiscard]] Slice slice_of(const Array& array, const SlicePlan& plan, Index trial);

/// "data[trial,:,1]": how a slice of an array could be written, the longest dimension being time and the shortest that
/// of channels.
[[nodiscard]] std::string example_slice(const Array& array, Index channel);

}  // namespace mbk::recording
