#pragma once

namespace mbk::app {

/// To be called at the beginning of main, before anything is opened.
/// - Closed descriptors 0 to 2 are opened, so that no file that is opened later takes their number and receives
/// standard
///   output or standard error. Reading from them finds the end, writing fails.
/// - Writing to a pipe without reader or to a file of maximum size returns an error (EPIPE, EFBIG) instead of a signal
///   that ends the program.
void prepare_process() noexcept;

}  // namespace mbk::app
