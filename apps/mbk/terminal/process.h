#pragma once

namespace mbk::app {

/// For the beginning of main, before anything is opened.
/// - Descriptors 0 to 2 that are closed are held, so that no file that is opened later takes their place and gets what
///   is meant for standard output or standard error. Reading from such a one finds the end, writing fails.
/// - A pipe that nobody reads any more and a file that has reached its largest size are errors of whoever writes
/// (EPIPE,
///   EFBIG), no signals that end the program.
void prepare_process() noexcept;

}  // namespace mbk::app
