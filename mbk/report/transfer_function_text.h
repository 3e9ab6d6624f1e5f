#pragma once

#include <string>

#include "mbk/trial/transfer_function.h"

namespace mbk::report {

/// A transfer function for the terminal: how it was found, the table of orders, every coefficient, pole, zero and the
/// gain with 95 % intervals, the fit, what is left, and warnings with what to try.
[[nodiscard]] std::string transfer_function_text(const TransferFunctionIdentification& found);

}  // namespace mbk::report
