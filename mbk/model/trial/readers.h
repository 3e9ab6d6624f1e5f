#pragma once

#include "mbk/base/core/words.h"

namespace mbk {

/// Who may read a file with data of a person.
enum class Readers {
  owner,  ///< 0600
  group,  ///< 0640
  all,    ///< 0644
};

[[nodiscard]] constexpr auto word_table(Readers) {
  using enum Readers;
  return std::to_array<Word<Readers>>({{owner, "owner"}, {group, "group"}, {all, "all"}});
}

/// The permissions of such a file, independent of the umask.
[[nodiscard]] constexpr unsigned permissions(Readers readers) {
  return readers == Readers::owner ? 0600 : readers == Readers::group ? 0640 : 0644;
}

}  // namespace mbk
