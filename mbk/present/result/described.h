#pragma once

#include "mbk/base/document/fields.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/warning.h"

/// Descriptions of values that several documents hold. For the sources of this module only.
namespace mbk {

void describe(document::Fields<Warning>& fields);
void describe(document::Fields<SourceFile>& fields);

}  // namespace mbk
