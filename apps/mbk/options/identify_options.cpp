#include "apps/mbk/options/identify_options.h"

#include "apps/mbk/options/word_options.h"
#include "mbk/base/core/option_checks.h"

namespace mbk::app {

void add_identify_options(Command command, identify::Options& options) {
  const char* const model = "Model";
  add_choice(command, "--method", options.method,
             "ls: least squares; iv: instrumental variables, which need the reference and hold in closed loop too; "
             "otherwise iv where the reference is a force and they hold, else ls")
      .group(model);
  add_choice(command, "--structure", options.structure,
             "full; symmetric: M and K symmetric; mass-spring: M = m I, no damping, K symmetric")
      .group(model);
  add_choice(command, "--parameters-from", options.parameters_from,
             "all: parameters from every window, fit judged on the held-out half (default for underdamped)")
      .group(model);
  command
      .add_option("--handle-mass", options.handle_mass,
                  "mass between sensor and hand, subtracted from the inertia; otherwise what the recording says, and "
                  "none in reference mode")
      .type_name("KG")
      .check(not_negative())
      .group(model);
  command.add_option("--hac-lag", options.hac_lag_s, "reach of the residual's correlation in the standard errors (1)")
      .type_name("S")
      .check(positive())
      .group(model);
  command
      .add_option("--bootstrap", options.bootstrap,
                  "so many fits to data drawn anew from blocks of 2.5 s, for intervals of every parameter, ellipse, "
                  "eigenvalue and the excess of passivity that rest on no formula (0: none; 1000 take a moment)")
      .type_name("N")
      .check(whole_number(0, 1'000'000))
      .group(model);
  command.add_option("--seed", options.seed, "of the bootstrap (1)")
      .type_name("N")
      .check(whole_number(0, 2'000'000'000))
      .group(model);
  command.add_flag("--decimate-check", options.decimate_check, "fit again at 100 Hz and say what changes").group(model);
}

}  // namespace mbk::app
