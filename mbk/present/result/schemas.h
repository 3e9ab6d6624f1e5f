#pragma once

#include "mbk/base/document/fields.h"

namespace mbk::result {

/// Adds the schemas of the documents of this module.
void add_schemas(document::Schemas& schemas);

// Each source of documents adds its own.
void add_movement_schema(document::Schemas& schemas);

}  // namespace mbk::result
