#pragma once

#include <array>
#include <optional>
#include <string>

#include "mbk/model/trial/quantity_channels.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// How one axis of a quantity should have been read.
struct AxisCure {
  int from = 0;         ///< axis whose source it takes
  bool negate = false;  ///< with the other sign
  std::string unit;     ///< in that unit; "" as it was
  double gain = 1.0;    ///< times that much more
};

/// Corrections to the reading; initially none.
struct ChannelCure {
  std::array<AxisCure, 3> position{AxisCure{0}, AxisCure{1}, AxisCure{2}}, force = position;
  std::string reference_unit, time_unit;  ///< "" as they were
};

/// A channel by its name in --channels, "Fx", or by its full name if it was not read from a file.
[[nodiscard]] std::string name_of(const Channel& channel);

/// The same for one axis of a quantity, recorded or not.
[[nodiscard]] std::string name_of(const Recording& recording, const QuantityChannels& quantity, int axes, int axis);

/// The complete --channels for that reading, as "--channels x=2:mm,y=3:mm,Fx=10,Fy=11,xr=12,yr=13"; absent if the
/// recording was not read from a file, or a source cannot be expressed in --channels.
[[nodiscard]] std::optional<std::string> cured_channels(const Recording& recording, int axes, const ChannelCure& cure);

/// --channels for one axis of a recording of two: "--axes 1 --channels x=3,F=11,xr=13".
[[nodiscard]] std::optional<std::string> channels_of_axis(const Recording& recording, int axis);

}  // namespace mbk::analyse
