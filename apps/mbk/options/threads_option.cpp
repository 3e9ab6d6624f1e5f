#include "apps/mbk/options/threads_option.h"

#include "mbk/base/core/option_checks.h"

namespace mbk::app {

Option add_threads_option(Command command, unsigned& threads, const std::string& what) {
  return command.add_option("--threads", threads, what + " (default: number of cores)")
      .type_name("N")
      .check(whole_number(1, 1024));
}

}  // namespace mbk::app
