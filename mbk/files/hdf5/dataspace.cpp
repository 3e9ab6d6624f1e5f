#include "mbk/files/hdf5/dataspace.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace mbk::hdf5 {

Result<Dataspace> read_dataspace(Cursor in) {
  constexpr int kNull = 2;
  const int version = in.byte();
  const std::size_t rank = in.byte();
  const bool has_maximum = (in.byte() & 1u) != 0;
  const int kind = in.byte();  // version 1: reserved
  if (version == 1) in.skip(4);
  if ((version != 1 && version != 2) || rank > kMaxDimensions || !in.ok()) return damaged("its dataspace is broken");
  Dataspace space;
  if (version == 2 && kind == kNull) {
    space.shape = space.maximum = {0};
    space.count = 0;
    return space;
  }
  for (std::size_t i = 0; i < rank; ++i) space.shape.push_back(in.length());
  space.maximum = space.shape;
  const std::uint64_t unlimited = in.sizes().length >= 8 ? kUndefined : (std::uint64_t{1} << 8 * in.sizes().length) - 1;
  for (std::size_t i = 0; has_maximum && i < rank; ++i) {
    const std::uint64_t most = in.length();
    space.maximum[i] = most == unlimited ? kUndefined : most;
  }
  if (!in.ok()) return damaged("its dataspace is broken");
  const auto too_many = [&] {
    return damaged(
        fmt::format("dimensions {} claim more data than a file of this size can contain", fmt::join(space.shape, "×")));
  };
  const bool empty = std::ranges::find(space.shape, std::uint64_t{0}) != space.shape.end();
  if (empty) space.count = 0;
  for (std::size_t i = 0; i < rank; ++i) {
    if (!empty && !multiply(space.count, space.shape[i], space.count)) return too_many();
    if (space.maximum[i] < space.shape[i]) return damaged("its dimensions are larger than their own limits");
  }
  return space;
}

}  // namespace mbk::hdf5
