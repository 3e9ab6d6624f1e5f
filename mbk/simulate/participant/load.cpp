#include "mbk/simulate/participant/load.h"

namespace mbk::participant {

void Load::tick(double /*t*/, double /*sample_time*/, const HandState& /*hand*/,
                const Eigen::Vector2d& /*force_on_robot*/) {}

}  // namespace mbk::participant
