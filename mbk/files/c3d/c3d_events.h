#pragma once

#include <string>
#include <vector>

#include "mbk/files/c3d/c3d_parameters.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// The events of a C3D file, in the order of their times, on a clock that is 0 at the first frame that the file holds.
/// Those of the header count from that frame; those of the groups EVENT and EVENTS (KINARM) from frame 1, whatever the
/// first frame is: the former in minutes and seconds, the latter in seconds alone, in the second of two rows where
/// there are two. An event of both stands once. What cannot be an event is named in `notes`.
/// @param file  at least a header; `rate` 0 where it is not known
[[nodiscard]] std::vector<Event> c3d_events(const C3dBytes& file, const C3dParameters& parameters, double rate_hz,
                                            double first_frame, std::vector<std::string>& notes);

}  // namespace mbk::recording
