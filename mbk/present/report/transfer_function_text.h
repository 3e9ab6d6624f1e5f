#pragma once

#include <string>
#include <vector>

#include "mbk/model/trial/chart.h"
#include "mbk/model/trial/frequency_response.h"
#include "mbk/model/trial/transfer_function.h"

namespace mbk::report {

/// A transfer function for the terminal: how it was found, the table of orders, every coefficient, pole, zero and the
/// gain with 95 % intervals, the fit, what is left, and warnings with what to try.
[[nodiscard]] std::string transfer_function_text(const TransferFunctionIdentification& found);

/// Magnitude, phase and Nyquist plot with the ends of the 95 % intervals and of the excited band.
[[nodiscard]] std::vector<Chart> response_charts(const TransferFunctionIdentification& found,
                                                 const FrequencyResponse& response);

/// The impedance behind an admittance: M, B, K where the model says them, and ten frequencies with intervals.
[[nodiscard]] std::string inverted_admittance_text(const InvertedAdmittance& inverse);

}  // namespace mbk::report
