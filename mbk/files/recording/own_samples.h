#pragma once

#include <span>
#include <string>

#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// Fills in Channel::updates of every channel but references, which may well be held.
void find_updates(Recording& recording);

/// Why samples of a channel are no measurements: "force_x was updated at 50 Hz in a recording of 1000 Hz: …"; "" where
/// all are.
[[nodiscard]] std::string stale_text(const Channel& channel, double rate_hz);

/// The recording with its measured channels at their own samples: what was measured stays to the bit, between lies a
/// natural cubic spline over time, and NaN where two measurements are further apart than 50 ms and 2.5 of the channel's
/// own intervals. Each channel that was changed gets a warning (held_signal, missing_samples). A held torque or input
/// may be a command that acted as it is recorded: it stays, and gets a warning.
/// @param recording  with Channel::updates; time rises, else nothing is changed
/// @param commands  names of channels that are treated so, too
[[nodiscard]] Recording at_own_samples(Recording recording, std::span<const std::string> commands = {});

}  // namespace mbk::recording
