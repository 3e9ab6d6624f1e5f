#pragma once

#include <string>
#include <vector>

#include "mbk/files/c3d/c3d_parameters.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// The events of a C3D file in the order of their times, on a clock that is 0 at the first frame that the file holds.
/// Events in the header count from that frame, those in the groups EVENT and EVENTS (KINARM) from frame 1, whatever the
/// first frame is. TIMES holds whole minutes and seconds for each event (C3D User Guide, EVENT:TIMES), or seconds only.
/// Dexterit-E does not use the first of the two rows of EVENTS: minutes there are ignored if they lead beyond the
/// recording and the seconds alone do not. An event in both header and group appears once. Events of mbk have the
/// values in MBK:EVENT_VALUES. `notes` lists invalid events.
/// @param file  at least a header; `rate` 0 if unknown    @param seconds  of the recording; 0: not known
[[nodiscard]] std::vector<Event> c3d_events(const C3dBytes& file, const C3dParameters& parameters, double rate_hz,
                                            double first_frame, double seconds, std::vector<std::string>& notes);

}  // namespace mbk::recording
