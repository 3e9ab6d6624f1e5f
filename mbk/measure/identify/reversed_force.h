#pragma once

#include "mbk/model/trial/warning.h"

namespace mbk::identify {

/// The warning that M, B and K are all negative.
[[nodiscard]] inline Warning reversed_force(int axes) {
  return {WarningCode::force_sign_reversed,
          "inertia, damping and stiffness are all negative: the force was probably recorded with the opposite sign",
          axes == 1 ? "F must be the force of the limb on the machine: put a minus before its column, naming all "
                      "channels, as in --channels x=1,F=-2"
                    : "F must be the force of the limb on the machine: put a minus before its columns, naming all "
                      "channels, as in --channels x=2,y=3,Fx=-10,Fy=-11,xr=12,yr=13"};
}

}  // namespace mbk::identify
