#pragma once

#include <string>

#include "mbk/model/trial/frequency_response.h"
#include "mbk/model/trial/transfer_function.h"

namespace mbk::result {

/// Schema "mbk.tf/1". Numerator and denominator from the highest power of s to the constant, as tf(num, den) of
/// control packages takes them; the covariance is of [a₀ … a_{n−1}, b₀ … b_m]. The frequency response with its
/// intervals, and the impedance where the admittance was inverted.
[[nodiscard]] std::string to_json(const TransferFunctionIdentification& found,
                                  const TransferFunctionFindings& findings);

/// Schema "mbk.tf_report/1", for the page of web/report: `result` as `to_json` writes it, measured and simulated output
/// with six digits, the command line as typed and a note that may be empty.
[[nodiscard]] std::string report_json(const TransferFunctionIdentification& found,
                                      const TransferFunctionFindings& findings, const std::string& command,
                                      const std::string& note);

}  // namespace mbk::result
