#include "mbk/present/result/schemas.h"

namespace mbk::result {

void add_schemas(document::Schemas& schemas) {
  for (const auto add : {
           &add_comparison_schemas,
           &add_explore_schemas,
           &add_info_schemas,
           &add_movement_schema,
           &add_passivity_schemas,
           &add_report_schemas,
           &add_reproduction_schemas,
           &add_result_schemas,
           &add_robot_schemas,
           &add_sensor_schemas,
           &add_springs_schema,
           &add_teleop_schema,
           &add_tf_schemas,
           &add_validation_schema,
           &add_workspace_schema,
       }) {
    add(schemas);
  }
}

}  // namespace mbk::result
