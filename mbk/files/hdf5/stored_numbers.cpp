#include "mbk/files/hdf5/stored_numbers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>

#include "mbk/base/numeric/parallel.h"
#include "mbk/files/hdf5/deflate.h"

namespace mbk::hdf5 {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 18;  ///< a quarter of what HDF5 keeps in memory of a dataset

/// Calls use(T{}) with the type that the numbers are stored as.
template <class Use>
auto with_type(Stored stored, const Use& use) {
  switch (stored) {
    case Stored::float32:
      return use(float{});
    case Stored::int8:
      return use(std::int8_t{});
    case Stored::uint8:
      return use(std::uint8_t{});
    case Stored::int16:
      return use(std::int16_t{});
    case Stored::uint16:
      return use(std::uint16_t{});
    case Stored::int32:
      return use(std::int32_t{});
    case Stored::uint32:
      return use(std::uint32_t{});
    case Stored::int64:
      return use(std::int64_t{});
    case Stored::uint64:
      return use(std::uint64_t{});
    case Stored::float64:
      break;
  }
  return use(double{});
}

template <class T>
bool holds(double value) {
  if constexpr (std::is_floating_point_v<T>) {
    return !std::isfinite(value) || (std::abs(value) <= static_cast<double>(std::numeric_limits<T>::max()) &&
                                     static_cast<double>(static_cast<T>(value)) == value);
  } else {
    const double above = std::ldexp(1.0, std::numeric_limits<T>::digits);
    return value >= static_cast<double>(std::numeric_limits<T>::min()) && value < above && value == std::trunc(value);
  }
}

template <class T>
void append(std::string& bytes, double value) {
  const auto stored = static_cast<T>(value);
  char raw[sizeof stored];
  std::memcpy(raw, &stored, sizeof raw);
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw, raw + sizeof raw);
  bytes.append(raw, sizeof raw);
}

/// First bytes of all numbers, then second bytes, …: groups slowly changing bytes.
std::string shuffled(std::string_view bytes, std::size_t size) {
  const std::size_t count = bytes.size() / size;
  std::string out(bytes.size(), '\0');
  for (std::size_t b = 0; b < size; ++b) {
    char* const to = out.data() + b * count;
    for (std::size_t i = 0; i < count; ++i) to[i] = bytes[i * size + b];
  }
  return out;
}

}  // namespace

std::size_t size_of(Stored stored) {
  return with_type(stored, [](auto zero) { return sizeof zero; });
}

bool is_float(Stored stored) {
  return with_type(stored, [](auto zero) { return std::is_floating_point_v<decltype(zero)>; });
}

bool is_signed(Stored stored) {
  return with_type(stored, [](auto zero) { return std::is_signed_v<decltype(zero)>; });
}

std::optional<double> first_misfit(const Numbers& numbers) {
  return with_type(numbers.stored, [&](auto zero) -> std::optional<double> {
    const auto misfit = std::ranges::find_if_not(numbers.values, holds<decltype(zero)>);
    return misfit == numbers.values.end() ? std::nullopt : std::optional(*misfit);
  });
}

std::string bytes_of(const Numbers& numbers) {
  return with_type(numbers.stored, [&](auto zero) {
    std::string bytes;
    bytes.reserve(static_cast<std::size_t>(numbers.values.size()) * sizeof zero);
    for (const double value : numbers.values) append<decltype(zero)>(bytes, value);
    return bytes;
  });
}

Chunks pack(const std::string& bytes, const std::vector<std::uint64_t>& shape, std::size_t size) {
  // A piece is a run of numbers as they follow each other: one along the slow dimensions, part of one, all of the rest.
  Chunks chunks{shape, {}};
  std::uint64_t run = bytes.size() / size;  // numbers of a piece
  std::size_t cut = 0;                      // the dimension of which it is a part
  for (; cut < shape.size(); ++cut) {
    const std::uint64_t rest = run / shape[cut];
    const auto most = std::clamp<std::uint64_t>(kChunkBytes / (rest * size), 1, shape[cut]);
    const std::uint64_t count = (shape[cut] + most - 1) / most;
    chunks.shape[cut] = (shape[cut] + count - 1) / count;  // equal ones: the last is padded by as little as can be
    run = rest * chunks.shape[cut];
    if (chunks.shape[cut] > 1) break;
  }
  cut = std::min(cut, shape.size() - 1);
  std::vector<std::uint64_t> offset(shape.size(), 0);
  const std::uint64_t row = run / chunks.shape[cut] * size;  // bytes of one step along the cut dimension
  for (std::size_t begin = 0; begin < bytes.size();) {
    const std::uint64_t steps = std::min(chunks.shape[cut], shape[cut] - offset[cut]);
    chunks.pieces.push_back({offset, bytes.substr(begin, steps * row)});
    begin += chunks.pieces.back().packed.size();
    offset[cut] += chunks.shape[cut];
    for (std::size_t d = cut; d > 0 && offset[d] >= shape[d]; --d) {
      offset[d] = 0;
      ++offset[d - 1];
    }
  }
  constexpr unsigned kThreads = 2;
  const auto packed = numeric::parallel_for(static_cast<int>(chunks.pieces.size()), kThreads, [&](int i) {
    std::string& piece = chunks.pieces[static_cast<std::size_t>(i)].packed;
    piece.resize(run * size, '\0');
    piece = deflated_planes(shuffled(piece, size), run);
    return Result<void>();
  });
  static_cast<void>(packed);  // no piece fails but for want of memory, which is thrown
  return chunks;
}

}  // namespace mbk::hdf5
