#pragma once

#include <vector>

#include "mbk/model/trial/joint_domain.h"
#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/summary.h"
#include "mbk/present/result/described.h"
#include "mbk/present/result/width_json.h"

/// Results and comparisons as other documents hold them, too. For the sources of this module only.
namespace mbk {

namespace result {

inline constexpr const char* kResultSchema = "mbk.result/2";
inline constexpr const char* kFirstResultSchema = "mbk.result/1";  ///< still read
inline constexpr const char* kResultsSchema = "mbk.results/1";

/// Several results, and findings about them together.
struct Results {
  std::vector<const Measurement*> results;
  const SeveralTrials* together;
};

void describe(document::Fields<Results>& fields);
void describe(document::Fields<Comparison>& fields);

}  // namespace result

void describe(document::Fields<JointDomain>& fields);
void describe(document::Fields<Measurement>& fields);

}  // namespace mbk
