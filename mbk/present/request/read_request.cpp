#include "mbk/present/request/read_request.h"

#include <fmt/format.h>

#include "mbk/files/recording/channel_map.h"

namespace mbk::request {

const OptionTable<ReadRequest>& read_table() {
  static const auto kTable = [] {
    OptionTable<ReadRequest> table;
    table
        .add({"--channels", "MAP",
              "map columns to channels if the file does not name them: x=2,y=3,Fx=10,Fy=11 takes columns by number or "
              "name (or rows of a wide matrix); x=pos[1],Fx=force[1] columns of several matrices; x=data[trial,:,1] a "
              "slice of an array of trials; x=Arm.angle a channel of a stream. x=2:mm converts a unit, Fx=-10 reverses "
              "a "
              "sign. Channels: time, x, y, Fx, Fy, xr, yr, q1 to q8, tau1 to tau8, qr1 to qr8, ax, ay, Vx, Vy; three "
              "axes: also z, Fz, zr, az; one axis: time, x, F, xr, a; EMG: emg_biceps and other names; for mbk tf: "
              "input, output",
              not_empty()},
             &ReadRequest::channels)
        .group("Reading the file")
        .add(
            {"--variable", "NAME", "variable of a MAT file to read, if several are possible", not_empty()},
            [](auto& request) -> auto& { return request.options.variable; })
        .add(
            {"--trial", "N|NAME", "trial to read from a file or folder with several, by number or name (default: all)",
             not_empty()},
            [](auto& request) -> auto& { return request.options.trial; })
        .add(
            {"--side", "right|left", "arm to analyse if a KINARM exam recorded both", {[](const std::string& arm) {
               return arm == "right" || arm == "left" ? "" : fmt::format("{} is neither right nor left", quoted(arm));
             }}},
            [](auto& request) -> auto& { return request.options.arm; })
        .add(
            {"--clock", "STREAM",
             "stream or topic whose time stamps to use if the channels come from several; the others are interpolated "
             "linearly",
             not_empty()},
            [](auto& request) -> auto& { return request.options.clock; })
        .add(
            {"--rate", "HZ", "sample rate, in Hz, if the file contains no time", positive()},
            [](auto& request) -> auto& { return request.options.rate; })
        .add(
            {"--axes", "N", "number of axes: 1, 2 or 3 (default: from the channels)", {[](const std::string& n) {
               return n == "1" || n == "2" || n == "3" ? "" : fmt::format("{} is not 1, 2 or 3", quoted(n));
             }}},
            [](auto& request) -> auto& { return request.options.axes; })
        .add({"--parts", "", "join the FILEs, which are numbered parts of one recording"}, &ReadRequest::parts);
    return table;
  }();
  return kTable;
}

Result<recording::ReadOptions> read_options(const ReadRequest& request) {
  recording::ReadOptions options = request.options;
  if (!request.channels.empty()) {
    options.channels = MBK_TRY(recording::parse_channel_map(request.channels));
  }
  return options;
}

}  // namespace mbk::request
