#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "mbk/base/core/words.h"

namespace mbk::console {

/// Why something was refused, or did not work.
enum class Refusal { token, host, origin, request, crowd, descriptors, message, too_long, haste, command, failure };
inline constexpr std::size_t kRefusals = 11;

[[nodiscard]] constexpr auto word_table(Refusal) {
  using enum Refusal;
  return std::to_array<Word<Refusal>>({
      {token, "wrong token"},
      {host, "foreign host"},
      {origin, "foreign origin"},
      {request, "malformed request"},
      {crowd, "crowded out"},
      {descriptors, "no descriptor is free"},
      {message, "malformed message"},
      {too_long, "message too long"},
      {haste, "too many messages"},
      {command, "command out of place"},
      {failure, "failure of the console"},
  });
}

/// Limits the log of refusals: the first five of each kind in ten seconds get a line each, all others one line when the
/// ten seconds are over. However much comes, the log gets less than six lines a second, and
/// what comes by the thousand hides nothing of another kind.
class Refusals {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::uint64_t kSaid = 5;
  static constexpr std::chrono::seconds kSpell{10};

  /// Counts it.   @returns  whether it shall be said
  [[nodiscard]] bool take(Refusal kind, Time now);

  /// "1203 more within 10 s: 1200 × wrong token, 3 × host". Nothing where all were said, or the spell goes on.
  /// @param last  does not wait for the spell's end
  [[nodiscard]] std::optional<std::string> summary(Time now, bool last = false);

 private:
  std::optional<Time> begin_;  // of the spell, with its first refusal
  std::array<std::uint64_t, kRefusals> counts_{};
};

}  // namespace mbk::console
