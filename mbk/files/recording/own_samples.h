#pragma once

#include <span>
#include <string>

#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// Sets Channel::updates of every channel except references, which may be held.
void find_updates(Recording& recording);

/// Why samples of a channel are not measurements: "force_x was updated at 50 Hz in a recording of 1000 Hz: …"; "" if
/// all are.
[[nodiscard]] std::string stale_text(const Channel& channel, double rate_hz);

/// The recording with its measured channels at their own samples: measured samples are unchanged, samples between them
/// are a natural cubic spline over time, or NaN if two measurements are further apart than 50 ms and 2.5 intervals of
/// the channel. Each channel that was changed gets a warning (held_signal, missing_samples). A held torque or input may
/// be a command that acted as recorded: it is unchanged and gets a warning.
/// @param recording  with Channel::updates; nothing is changed unless time increases
/// @param commands  names of further channels that may be commands
[[nodiscard]] Recording at_own_samples(Recording recording, std::span<const std::string> commands = {});

}  // namespace mbk::recording
