#include "apps/mbk/options/readers_option.h"

#include "apps/mbk/options/word_options.h"

namespace mbk::app {

void add_readers_option(Command command, std::optional<Readers>& readers) {
  add_choice(command, "--readable-by", readers, "who may read the recording (default: owner)");
}

}  // namespace mbk::app
