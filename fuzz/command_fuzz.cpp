#include "fuzz/fuzz.h"
#include "mbk/experiment/console/command.h"

namespace mbk::fuzz {

std::vector<std::string> seeds() {
  return {R"({"command":"stop"})", R"({"command":"reset","code":"0-12"})", R"({"command":"note","text":"a \u00e4 b"})"};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto command = mbk::console::parse_command(mbk::fuzz::text_of(data, size));
  if (command) {
    mbk::fuzz::require(command->text.size() <= mbk::console::kLongestNote, "a text is no longer than a note");
  } else {
    mbk::fuzz::require_error(command.error());
  }
  return 0;
}
