#include "mbk/present/request/read_request.h"

#include <fmt/format.h>

#include "mbk/files/recording/channel_map.h"

namespace mbk::request {

const OptionTable<ReadRequest>& read_table() {
  static const auto kTable = [] {
    OptionTable<ReadRequest> table;
    table
        .add({"--channels", "MAP",
              "where the channels stand, where the file does not say it itself: x=2,y=3,Fx=10,Fy=11 names columns "
              "(or rows of a wide matrix, or names in the file); x=pos[1],Fx=force[1] takes them from several "
              "matrices, x=data[trial,:,1] a slice of an array of trials; x=Arm.angle is a channel of a stream; "
              "x=2:mm converts, Fx=-10 flips. Channels: time, x, "
              "y, Fx, Fy, xr, yr, q1 to q8, tau1 to "
              "tau8, qr1 to qr8, ax, ay, Vx, Vy; one axis: time, x, F, xr, a; for mbk tf: input, output",
              not_empty()},
             &ReadRequest::channels)
        .add(
            {"--variable", "NAME", "which variable of a MAT file, where several could be meant", not_empty()},
            [](auto& request) -> auto& { return request.options.variable; })
        .add(
            {"--trial", "N|NAME",
             "which trial of a file or folder that holds several, by its number or name; otherwise all of them",
             not_empty()},
            [](auto& request) -> auto& { return request.options.trial; })
        .add(
            {"--side",
             "right|left",
             "whose hand is the hand, where a KINARM exam recorded both: right or left",
             {[](const std::string& arm) {
               return arm == "right" || arm == "left" ? "" : fmt::format("{} is neither right nor left", quoted(arm));
             }}},
            [](auto& request) -> auto& { return request.options.arm; })
        .add(
            {"--clock", "STREAM",
             "the stream or topic whose time stamps the recording has, where its channels come from several: those "
             "of the others are interpolated linearly",
             not_empty()},
            [](auto& request) -> auto& { return request.options.clock; })
        .add(
            {"--rate", "HZ", "sample rate, where the file holds no time", positive()},
            [](auto& request) -> auto& { return request.options.rate; })
        .add(
            {"--axes", "N", "1 or 2; otherwise by the channels that are there", {[](const std::string& n) {
               return n == "1" || n == "2" ? "" : fmt::format("{} is neither 1 nor 2", quoted(n));
             }}},
            [](auto& request) -> auto& { return request.options.axes; })
        .add({"--parts", "", "the FILEs are numbered parts of one record: join them"}, &ReadRequest::parts);
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
