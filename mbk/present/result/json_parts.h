#pragma once

#include "mbk/base/document/json_values.h"
/// What every JSON document of mbk is put together from. For the sources of this module only.
namespace mbk::result {

using document::dumped;
using document::header;
using document::interval;
using document::Json;
using document::kDigits;
using document::kTimeDigits;
using document::list;
using document::number;
using document::rounded;
using document::rows;

}  // namespace mbk::result
