#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// A sample rate that a file says beside its signals.
struct SaidRate {
  std::string scope;  ///< group or structure whose signals it holds for, as the names of arrays begin: "trial"; "": all
  std::string source;  ///< for messages: "'trial.fs'", "attribute 'rate' of 'trial'"
  double hz = 0.0;
};

/// The sample rate [Hz] that a number says by its name: "fs", "sampling_rate", "SampleRate_kHz"; "dt", "sample_time"
/// [s] where they can be nothing but seconds (50 Hz to 100 kHz). Nothing where the name says something else.
/// @param unit  what the file says of the number: "Hz", "kHz", "s", "ms", or ""
[[nodiscard]] std::optional<double> rate_called(std::string_view name, double number, std::string_view unit);

/// Gives every array without a rate the one that is said nearest to it: in `said`, or by a variable of one number. Two
/// rates of one place that differ are not taken. A note says which were.
void give_rates(Contents& contents, std::vector<SaidRate> said = {});

}  // namespace mbk::recording
