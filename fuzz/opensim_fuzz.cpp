#include "fuzz/fuzz.h"
#include "mbk/files/tables/capture_tables.h"
#include "mbk/files/tables/delsys.h"
#include "mbk/files/tables/lvm.h"
#include "mbk/files/tables/opensim.h"
#include "mbk/files/tables/physiology_tables.h"

namespace mbk::fuzz {

std::vector<std::string> seeds() {
  return {
      "Coordinates\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\n\nendheader\ntime\tq1\tF\n0\t90\t1\n0.1\tNAN\t\n",
      "name old\ndatacolumns 2\ndatarows 1\nendheader\n\n  time   x \n 0.0  10.0\n 1 -nan\n",
      "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tNumFrames\tNumMarkers\tUnits\n100\t2\t1\tmm\nFrame#\tTime\tHand\t\t\n"
      "\t\tX1\tY1\tZ1\n\n1\t0\t1\t2\t3\n2\t0.01\t\t\n",
      "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\tMulti\n***End_of_Header***\t\n\t\n"
      "Channels\t2\nSamples\t2\t\t2\nDate\t2024/03/01\t\t2024/03/01\nTime\t10:15:30.5\t\t10:15:30.5\nX0\t0\t\t0\n"
      "Delta_X\t0.1\t\t0.2\n***End_of_Header***\nX_Value\tx\tX_Value\tF\tComment\n0\t1\t0\t2\n0.1\t2\t0.2\t3\tgo\n",
      "LabVIEW Measurement\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\tNo\n***End_of_Header***\nSamples\t1\t1\n"
      "Delta_X\t0,1\t0,1\n***End_of_Header***\nX_Value\tx\tF\tComment\n\t1,5\t2\n\t2\t3\n",
      "Devices\n200\n,,P - Force,\nFrame,Sub "
      "Frame,Fx,Fy\n,,N,N\n1,0,1,2\n1,1,1,2\n2,0,1,2\n2,1,1,2\n\nTrajectories\n100\n"
      ",,S:A,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n1,0,1,2,3\n2,0,1,,3\n",
      "Format Version,1.23,Export Frame Rate,100,Length Units,Meters\n\n,Type,Marker,Marker,Marker\n,Name,M,M,M\n"
      ",ID,1,1,1\n,,Position,Position,Position\nFrame,Time (Seconds),X,Y,Z\n0,0,1,2,3\n1,0.01,,,\n",
      "NO_OF_FRAMES\t2\nFREQUENCY\t100\nMARKER_NAMES\thand\n1\t2\t3\n0\t0\t0\n",
      "Label: E Sampling frequency: 10 Unit: V Domain: s\nX[s],E,X[s],F [N]\n0,1,0,2\n0.1,2,,\n",
      "arm.acq\n2 msec/sample\n2 channels\nx\nmm\nF\nN\nmin\tCH1\tCH2\t\n\t2\t2\t\n0\t1\t2\t\n0.1\t3\t4\t\n",
      "Interval=\t0.002 s\nChannelTitle=\tx\tF\nRange=\t10 mm\t5 V\nUnitName=\t*\tN\n0\t1\t2\t#* go\n0.002\t3\t4\n",
      "\"INFORMATION\"\n\"CHANNEL\"\t\"1\"\n\"Waveform\"\n\"\"\n\"F\"\n\"N\"\n\"START\"\t0\t0.1\n1\n\"START\"\t9\t0."
      "1\n2\n"};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mbk::recording;  // NOLINT(google-build-using-namespace): this is under test
  const auto bytes = mbk::fuzz::bytes_of(data, size);
  const auto text = mbk::fuzz::text_of(data, size);
  if (looks_like_opensim(text)) mbk::fuzz::check_decoded(decode_opensim(bytes), size);
  if (looks_like_lvm(text)) {
    auto records = decode_lvm(bytes);
    if (!records) mbk::fuzz::require_error(records.error());
    for (NamedContents& record : records ? *records : std::vector<NamedContents>()) {
      mbk::fuzz::check_decoded(std::move(record.contents), size);
    }
  }
  if (looks_like_labchart(text)) {
    auto records = decode_labchart(bytes);
    if (!records) mbk::fuzz::require_error(records.error());
    for (NamedContents& record : records ? *records : std::vector<NamedContents>()) {
      mbk::fuzz::check_decoded(std::move(record.contents), size);
    }
  }
  if (looks_like_acqknowledge(text)) mbk::fuzz::check_decoded(decode_acqknowledge(bytes), size);
  if (looks_like_spike2(text)) mbk::fuzz::check_decoded(decode_spike2(bytes), size);
  if (looks_like_vicon(text)) mbk::fuzz::check_decoded(decode_vicon(bytes), size);
  if (looks_like_motive(text)) mbk::fuzz::check_decoded(decode_motive(bytes), size);
  if (looks_like_qualisys(text)) mbk::fuzz::check_decoded(decode_qualisys(bytes), size);
  if (looks_like_delsys(text)) mbk::fuzz::check_decoded(decode_delsys(bytes), size);
  if (looks_like_trc(text)) mbk::fuzz::check_decoded(decode_trc(bytes), size);
  return 0;
}
