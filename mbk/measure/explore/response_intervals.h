#pragma once

#include "mbk/model/trial/frequency_response_estimate.h"

namespace mbk::explore {

/// 95 % intervals of every entry G of a response from its covariance σ² and ν complex degrees of freedom:
///   |G|: |Ĝ| ± t_{0.975, 2ν} σ̂/√2, not below 0
///   arg G: ± arcsin of that half width over |Ĝ|; π where the half width is not below |Ĝ|
///   G:   within σ̂ √F_{0.95; 2, 2ν} of Ĝ, with F_{0.95; 2, 2ν} = ν (0.05^{−1/ν} − 1)
/// for errors that are circular and complex normal (Pintelon & Schoukens 2012, §2.4). Infinite where ν < 1.
void add_intervals(FrequencyResponseEstimate& estimate);

}  // namespace mbk::explore
