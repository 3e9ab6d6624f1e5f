#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace mbk::recording {

/// The shape of an array without sides of 1, where it has more than two sides and no more than two remain (3×1×1000 is
/// 3×1000); nothing otherwise.
[[nodiscard]] inline std::optional<std::vector<std::uint64_t>> without_ones(const std::vector<std::uint64_t>& shape) {
  if (shape.size() <= 2) return std::nullopt;
  std::vector<std::uint64_t> squeezed = shape;
  std::erase(squeezed, 1U);
  if (squeezed.size() > 2) return std::nullopt;
  squeezed.resize(2, 1);
  return squeezed;
}

}  // namespace mbk::recording
