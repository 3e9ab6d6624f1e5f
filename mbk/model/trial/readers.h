#pragma once

#include <array>
#include <string_view>
#include <utility>

namespace mbk {

/// Who may read a file that holds what was measured on a person.
enum class Readers {
  owner,  ///< 0600
  group,  ///< 0640
  all,    ///< 0644
};

inline constexpr std::array<std::pair<std::string_view, Readers>, 3> kReaders = {
    {{"owner", Readers::owner}, {"group", Readers::group}, {"all", Readers::all}}};

[[nodiscard]] constexpr std::string_view text(Readers readers) {
  return kReaders[static_cast<std::size_t>(readers)].first;
}

/// The permissions of such a file, whatever the umask.
[[nodiscard]] constexpr unsigned permissions(Readers readers) {
  return readers == Readers::owner ? 0600 : readers == Readers::group ? 0640 : 0644;
}

}  // namespace mbk
