#pragma once

#include "mbk/model/trial/inspection.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// A channel is reported as clipped where it sits exactly at its least or greatest value in at least 3 separate runs of
/// at least 5 equal samples that together cover at least 0.2 % of the samples; never a constant channel.
[[nodiscard]] Inspection inspect(const Recording& recording);

}  // namespace mbk::recording
