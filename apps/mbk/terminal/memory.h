#pragma once

namespace mbk::app {

/// Lets the memory of this process come in large pages where the system has them, and keeps what was freed for the next
/// use, but for what is larger than the columns of minutes need. A recording of a minute touches 25 MB; page by page of
/// 4 kB, asking for them takes longer than the measurement. Changes nothing but time and memory. To be called first.
void prefer_large_pages();

/// Where that was called: from now on what is larger than the columns of some minutes goes back when it is freed. For a
/// long recording, of which there would otherwise be much that nobody uses.
void give_back_large_blocks();

}  // namespace mbk::app
