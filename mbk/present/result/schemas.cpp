#include "mbk/present/result/schemas.h"

namespace mbk::result {

void add_schemas(document::Schemas& schemas) {
  for (const auto add : {&add_movement_schema}) add(schemas);
}

}  // namespace mbk::result
