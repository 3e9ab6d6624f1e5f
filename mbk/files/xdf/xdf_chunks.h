#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/files/xdf/xdf_clocks.h"

namespace mbk::recording {

/// How the values of a stream are stored.
enum class XdfValue { int8, int16, int32, int64, float32, double64, string };

struct XdfChannel {
  std::string label, unit;   ///< as the header says them; may be empty
  std::int16_t rounded = 0;  ///< largest change of its integers by conversion to double
};

/// A stream as stored in the file.
struct XdfStream {
  std::uint32_t id = 0;
  std::string name, type;  ///< one line each; may be empty
  XdfValue value = XdfValue::double64;
  std::vector<XdfChannel> channels;
  double nominal_hz = 0.0;  ///< 0: irregular
  bool can_drop_samples = false;

  Vector stamps;                       ///< [s], on the sender's clock; NaN if missing in the file
  std::vector<Vector> values;          ///< of each channel, one for each stamp; none for texts
  std::vector<std::string> texts;      ///< sample by sample, the channels side by side; none for numbers
  std::vector<ClockOffset> offsets;    ///< in the order of the file
  std::optional<std::uint64_t> total;  ///< samples, as the footer says
};

struct XdfFile {
  std::vector<XdfStream> streams;  ///< in the order of their headers
  std::string recorded;            ///< date and time that the header of the file says; may be empty
  std::vector<std::string> notes;  ///< damage and unusual contents
};

inline constexpr std::size_t kMaxXdfChannels = 65536;  ///< of a stream

/// Reads every chunk. See `decode_xdf`.
/// @fails  data: no XDF signature; it needs more memory than available.
[[nodiscard]] Result<XdfFile> parse_xdf(std::span<const std::byte> file);

}  // namespace mbk::recording
