#pragma once

#include "mbk/base/document/fields.h"

namespace mbk::result {

/// Adds the schemas of the documents of this module.
void add_schemas(document::Schemas& schemas);

// Each source of documents adds its own.
void add_comparison_schemas(document::Schemas& schemas);
void add_info_schemas(document::Schemas& schemas);
void add_movement_schema(document::Schemas& schemas);
void add_springs_schema(document::Schemas& schemas);
void add_sensor_schemas(document::Schemas& schemas);
void add_teleop_schema(document::Schemas& schemas);
void add_tf_schemas(document::Schemas& schemas);
void add_explore_schemas(document::Schemas& schemas);
void add_robot_schemas(document::Schemas& schemas);
void add_workspace_schema(document::Schemas& schemas);
void add_reproduction_schemas(document::Schemas& schemas);
void add_validation_schema(document::Schemas& schemas);
void add_passivity_schemas(document::Schemas& schemas);
void add_report_schemas(document::Schemas& schemas);
void add_result_schemas(document::Schemas& schemas);

}  // namespace mbk::result
