#pragma once

#include <vector>

#include "mbk/model/trial/inspection.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// A channel is reported as clipped if it is exactly at its minimum or maximum in at least 3 separate runs of
/// at least 5 equal samples that together cover at least 0.2 % of the samples; never a constant channel.
[[nodiscard]] Inspection inspect(const Recording& recording);

/// The channels that are clipped in a part of a recording, by its local extremes.
/// @param from_s, to_s  [s] from the first sample; times rise
[[nodiscard]] std::vector<ChannelFacts> clipped_channels(const Recording& recording, double from_s, double to_s);

}  // namespace mbk::recording
