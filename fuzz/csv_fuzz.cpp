#include "fuzz/fuzz.h"
#include "mbk/files/recording/csv.h"
#include "mbk/files/recording/encode.h"

namespace mbk::fuzz {

std::vector<std::string> seeds() {
  return {recording::encode_csv(small_recording()).value(),
          "time,x,Fx\n0,1,2\n0.001,1.5,2.5\n0.002,1e-3,-7\n",
          "# a comment\nt;position [mm];reaction (N)\n0;1;2\n1;;nan\n",
          "time_ms\tx_mm\tF\n0\t1\t2\n1\t+2\t3\n",
          "0,1,2,\n1,2,3,\n2,3,4,\n",
          "\xEF\xBB\xBF\"t\",\"hand_x\"\r\n0,1\r\n0.5,2\r\n1,3",
          "a,b\n0,1\n1,\"0,1\"\n",
          "sep=;\nRecorder;7\nZeit;x;Zustand\nhh:mm:ss;mm;-\n23:59:59,500;1,5;ruhe\n00:00:00,500;-0,25;los\n",
          "# time hand_x\n 0.0e+00  1.5\n 1.0e-03  NA\n",
          "time|x\n2024-02-29T10:15:30.5+01:00|1\n2024-02-29 10:15:31Z|2\n",
          std::string("\xFF\xFEt\0,\0x\0\n\0"
                      "0\0,\0"
                      "1\0\n\0",
                      20)};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mbk::fuzz::check_decoded(mbk::recording::decode_csv(mbk::fuzz::bytes_of(data, size)), size);
  return 0;
}
