#pragma once

#include "mbk/base/document/fields.h"

namespace mbk::longitudinal {

/// Adds the schemas of both reports. For the sources of this project only.
void add_schemas(document::Schemas& schemas);

}  // namespace mbk::longitudinal
