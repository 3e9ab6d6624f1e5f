#include "mbk/present/result/exploration_parts_json.h"

namespace mbk {

using document::Fields;
using document::kDigits;
using document::kTimeDigits;

void describe(Fields<EmgProcessing>& fields) {
  fields.type("EmgProcessing",
              "Band-pass (Butterworth, forward and backward, 3 dB at both ends), rectification, envelope.");
  fields.add("rate_hz", &EmgProcessing::rate_hz, "sample rate [Hz]");
  fields.add(
      "band_hz", [](const EmgProcessing& how) { return Interval(how.low_hz, how.high_hz); }, "[Hz]");
  fields.add("order", &EmgProcessing::order, "of both passes together, at each end of the band");
  fields.add("envelope_hz", &EmgProcessing::envelope_hz, "zero-phase low-pass [Hz]; 0: moving RMS");
  fields.add("envelope_rms_s", &EmgProcessing::envelope_rms_s, "window of the moving RMS [s]; 0: low-pass");
}

void describe(Fields<EmgFinding>& fields) {
  fields.type("EmgFinding", "A problem of a raw EMG channel.");
  fields.add("problem", &EmgFinding::problem);
  fields.add("message", &EmgFinding::message);
  fields.add("try", &EmgFinding::remedy);
  fields.add("usable", &EmgFinding::usable, "whether the channel is analysed nevertheless");
  fields.add("input", &EmgFinding::recording, "0 for the first of `inputs`");
}

void describe(Fields<EmgWindow>& fields) {
  fields.type("EmgWindow", "A window after the onset of a perturbation.");
  fields.add("name", &EmgWindow::name);
  fields.add(
      "window_s", [](const EmgWindow& one) { return Interval(one.from_s, one.to_s); }, "[s]");
}

void describe(Fields<EmgDirection>& fields) {
  fields.type("EmgDirection", "A direction of perturbations.");
  fields.add("direction", &EmgDirection::direction, "unit vector");
  fields.add("trials", &EmgDirection::trials);
  fields.add(
      "size", [](const EmgDirection& one) { return Interval(one.smallest, one.largest); },
      "smallest and largest displacement [m or rad]");
}

void describe(Fields<EmgWindowResponse>& fields) {
  fields.type("EmgWindowResponse", "Mean rectified EMG in a window relative to the background.");
  fields.add("ratio", &EmgWindowResponse::ratio);
  fields.add("interval95", &EmgWindowResponse::interval95, "of the ratio, by bootstrap over trials");
  fields.add("response", &EmgWindowResponse::response, "at a level of 3 % for all windows of a direction together");
}

void describe(Fields<EmgLatency>& fields) {
  fields.type("EmgLatency", "Onset of the first increase of EMG, after that of the perturbation.");
  fields.add_rounded("value_s", &EmgLatency::value, kTimeDigits, "[s]");
  fields.add("interval95", &EmgLatency::interval95, "[s]");
}

void describe(Fields<EmgDirectionResponse>& fields) {
  fields.type("EmgDirectionResponse", "One muscle after perturbations in one direction.");
  fields.add("direction", &EmgDirectionResponse::direction, "unit vector");
  fields.add("trials", &EmgDirectionResponse::trials);
  fields.add("background", &EmgDirectionResponse::background,
             "mean rectified EMG before the onset [unit of the channel]");
  fields.add("windows", &EmgDirectionResponse::windows, "in the order of `windows` of the estimate");
  fields.add("latency", &EmgDirectionResponse::latency, "null: no increase, or none with a clear beginning");
  fields.add_rounded("curve", &EmgDirectionResponse::curve, kDigits,
                     "trial mean of the envelope at `curve_time_s` [unit of the channel]");
}

void describe(Fields<EmgChannelEstimate>& fields) {
  fields.type("EmgChannel", "One EMG channel.");
  fields.add("name", &EmgChannelEstimate::name);
  fields.add("unit", &EmgChannelEstimate::unit,
             "V; empty where the recording states none: amplitudes are then in its numbers");
  fields.add("usable", &EmgChannelEstimate::usable);
  fields.add("findings", &EmgChannelEstimate::findings);
  fields.add("background", &EmgChannelEstimate::background, "mean rectified EMG before the onsets [unit]");
  fields.add("mvc", &EmgChannelEstimate::mvc, "mean rectified EMG of a maximal voluntary contraction, if given [unit]");
  fields.add("directions", &EmgChannelEstimate::directions);
}

void describe(Fields<EmgEstimate>& fields) {
  fields.type("EmgEstimate", "EMG after the onsets of perturbations.");
  fields.add("processing", &EmgEstimate::processing);
  fields.add("onset_rule", &EmgEstimate::onset_rule, "where the onsets were found: reference or motion");
  fields.add("onsets", &EmgEstimate::onsets, "used");
  fields.add("omitted", &EmgEstimate::omitted, "onsets too close to each other or to an end of the recording");
  fields.add("background_s", &EmgEstimate::background_s, "before the onset [s]");
  fields.add("windows", &EmgEstimate::windows);
  fields.add("directions", &EmgEstimate::directions);
  fields.add_rounded("curve_time_s", &EmgEstimate::curve_time, kTimeDigits, "after the onset [s]");
  fields.add("channels", &EmgEstimate::channels);
  fields.add("notes", &EmgEstimate::notes);
}

}  // namespace mbk
