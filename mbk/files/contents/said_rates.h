#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// A sample rate stated in a file beside its signals.
struct SaidRate {
  std::string scope;   ///< group or structure to which it applies, as the prefix of array names: "trial"; "": all
  std::string source;  ///< for messages: "'trial.fs'", "attribute 'rate' of 'trial'"
  double hz = 0.0;
};

/// The sample rate [Hz] given by a number with such a name: "fs", "sampling_rate", "SampleRate_kHz"; "dt",
/// "sample_time" [s] if they can only be seconds (50 Hz to 100 kHz). Nothing for other names.
/// @param unit  unit of the number in the file: "Hz", "kHz", "s", "ms", or ""
[[nodiscard]] std::optional<double> rate_called(std::string_view name, double number, std::string_view unit);

/// Gives every array without a rate the one stated nearest to it: in `said`, or in a variable of one number. Two
/// different rates in one place are not used. A note reports the rates.
void give_rates(Contents& contents, std::vector<SaidRate> said = {});

}  // namespace mbk::recording
