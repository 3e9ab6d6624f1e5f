#pragma once

#include <cstddef>
#include <cstdint>

#include "mbk/base/system/files.h"

/// The memory of this process, and of others.
namespace mbk::system {

/// Memory that this process may still take [bytes], within what its system, its control group and its address space
/// have; the largest number where nobody says.
[[nodiscard]] std::uint64_t available_memory();

[[nodiscard]] std::size_t page_size();  ///< [bytes]

/// Room for so many bytes, of which only those that are written to take memory; in large pages, if the system has them,
/// but for the last `count` modulo 2 MiB.   @returns  nullptr where it fails
[[nodiscard]] void* map_memory(std::size_t count);
/// The same, though there be less memory: most of it will be forgotten before the last of it is written to.
[[nodiscard]] void* reserve_memory(std::size_t count);
void unmap_memory(void* room, std::size_t count);
/// Gives back the memory of whole pages that nobody reads any more.
void forget_memory(void* from, std::size_t count);
/// Gives the memory of whole pages to others, which are of no use before.   @returns  false: they have their own
[[nodiscard]] bool move_memory(void* from, void* to, std::size_t count);
/// In place of whole pages of memory a view of the file that nobody else sees changes of.
/// @returns  false: nothing has changed
[[nodiscard]] bool map_file_over(void* at, std::size_t count, const OpenFile& file, std::uint64_t place);

}  // namespace mbk::system
