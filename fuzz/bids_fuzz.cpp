#include <array>

#include "fuzz/fuzz.h"
#include "mbk/files/bids/encode_run.h"
#include "mbk/files/bids/read_run.h"

namespace mbk::fuzz {
namespace {

constexpr char kBetween = '\x1e';  ///< texts of a recording

}  // namespace

std::vector<std::string> seeds() {
  const auto none = [](const std::string&) { return std::optional<std::string>(); };
  const auto name = recording::parse_bids_name("sub-1_task-a").value();
  std::array<std::string, 5> texts;
  const Recording recording = small_recording();
  const auto files = recording::encode_bids(recording, name, none).value();
  for (const auto& file : files) {
    const auto is = [&](std::string_view end) { return file.path.ends_with(end); };
    if (is("_motion.tsv")) texts[0] = file.text;
    if (is("_channels.tsv")) texts[1] = file.text;
    if (is("_motion.json")) texts[2] = file.text;
    if (is("_events.tsv")) texts[3] = file.text;
    if (is("_channels.json")) texts[4] = file.text;
  }
  std::string all;
  for (const std::string& text : texts) all += text + kBetween;
  const std::string untimed = std::string("1\t2\nn/a\t4\n") + kBetween +
                              "name\ttype\tunits\tstatus\nhand_x\tPOS\tmm\tbad\nF\tMISC\tN\n" + kBetween +
                              R"({"TaskName": "walk", "SamplingFrequency": 50, "SamplingFrequencyEffective": 49.5})" +
                              kBetween + "onset\tduration\tvalue\n0.5\t0\tgo\nn/a\t0\t1\n" + kBetween;
  return {all, untimed};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text = mbk::fuzz::text_of(data, size);
  std::array<std::string_view, 5> parts;
  for (std::string_view& part : parts) {
    const std::size_t end = std::min(text.find(mbk::fuzz::kBetween), text.size());
    part = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  mbk::fuzz::check_decoded(
      mbk::recording::decode_bids({parts[0], parts[1], {std::string(parts[2])}, parts[3], parts[4], "1"}), size);
  return 0;
}
