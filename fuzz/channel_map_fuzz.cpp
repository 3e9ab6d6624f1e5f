#include "fuzz/fuzz.h"
#include "mbk/files/recording/assemble.h"
#include "mbk/files/recording/channel_map.h"
#include "mbk/files/recording/channel_table.h"

namespace mbk::fuzz {
namespace {

/// A table, a file of rates and units, and a matrix: everything that a map can refer to.
std::vector<recording::Contents> files() {
  recording::Contents table;
  table.table = true;
  recording::Contents variables;
  for (const char* name : {"clock", "pos_mm", "Fx", "y"}) {
    table.arrays.push_back({name, Matrix(Vector::LinSpaced(6, 0.0, 5.0))});
    variables.arrays.push_back({name, Matrix(Vector::LinSpaced(6, 0.0, 5.0).transpose())});
  }
  table.arrays.push_back({"HAND.x", Matrix(Vector::Ones(6)), "mm", true, 100.0});
  table.arrays.push_back({"Force X", Matrix(Vector::Ones(12)), "N", true, 200.0});
  table.arrays.push_back({"S:H.x", Matrix(Vector::Ones(6)), "furlong", true, 100.0});
  variables.arrays.push_back({"logs", Matrix(Matrix::Ones(19, 6))});
  variables.arrays.push_back({"data", Matrix(Matrix::Ones(2 * 6 * 3, 1))});
  variables.arrays.back().shape = {2, 6, 3};
  return {table, variables};
}

}  // namespace

std::vector<std::string> seeds() {
  return {"x=2:mm,y=4,Fx=-3",
          "time=clock:ms, x=pos_mm, F=-Fx:kN",
          "hand_x=HAND.x,force_x=Force X@100",
          "q1=1:deg,q2=2,tau1=3:N.m",
          "x=S:H.x,xr=5:rad",
          "x=data[trial,:,2]:mm,Fx=-data(2,:,3)*2,y=data[:,1],t=logs[1,:]",
          "t=1,x=-logs:mm,ax=7:g",
          "x=logs[2]*2:mm,Fx=-logs[10],y=y[1],t=clock[1]:ms",
          "Fx=-Fx*-8.56+0.54:N,Vx=3:mV,q3=2*2:mm,tau8=y-1e-3:N"};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto map = mbk::recording::parse_channel_map(mbk::fuzz::text_of(data, size));
  if (!map) {
    mbk::fuzz::require_error(map.error());
    return 0;
  }
  mbk::fuzz::require(!map->empty(), "a map names a channel");
  static const auto kFiles = mbk::fuzz::files();
  for (const auto& file : kFiles) {
    mbk::recording::ReadOptions options;
    options.channels = *map;
    options.trial = mbk::recording::trials_of_map(file, *map).empty() ? "" : "2";
    const auto recording = mbk::recording::assemble(file, options);
    if (!recording) {
      mbk::fuzz::require_error(recording.error());
      continue;
    }
    for (const auto& channel : recording->channels) {
      mbk::fuzz::require(channel.values.size() == recording->samples(), "every channel is as long as the time");
    }
    for (const auto& note : recording->notes) mbk::fuzz::require_line(note, "a note");
  }
  return 0;
}
