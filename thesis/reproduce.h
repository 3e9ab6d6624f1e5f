#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/reproduction.h"
#include "thesis/source.h"

namespace mbk::thesis {

struct ReproduceOptions {
  std::vector<std::string> only;  ///< ids of exhibits; empty: all
  std::uint64_t seed = 1;         ///< of everything that is simulated
  unsigned threads = 0;           ///< 0: as many as there are cores; the numbers do not depend on it
  /// Called before each exhibit: how many are done, of how many, and which is next.
  std::function<void(int done, int of, std::string_view id)> progress = {};
};

/// Ids and titles of all exhibits, in their order.
struct ExhibitName {
  std::string_view id, title;
};
[[nodiscard]] std::vector<ExhibitName> exhibit_names();

/// Every table and figure of the source that can be reproduced, beside what it printed. Ours rests on `source.given`
/// and on simulation alone; `source.printed` is put beside it afterwards and changes none of it. The same source,
/// options and program give the same numbers.
/// @fails  usage: `only` names what is not there. Otherwise as the laboratory and the measurement.
[[nodiscard]] Result<Reproduction> reproduce(const Source& source, const ReproduceOptions& options);

}  // namespace mbk::thesis
