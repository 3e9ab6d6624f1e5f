#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/c3d/c3d_parameters.h"

namespace mbk::recording {

/// How the data section of a C3D file is laid out.
struct C3dLayout {
  static constexpr std::size_t kPointNumbers = 4;  ///< x, y, z, and a word of residual and cameras

  std::uint64_t points = 0, channels = 0, samples = 1;  ///< samples: of each channel in a frame
  bool real = false;                                    ///< numbers are reals; points are already scaled
  double scale = 1.0;                                   ///< of the points, > 0
  std::optional<Error> no_scale = {};                   ///< why the scale of the points is unknown
  double point_rate = 0.0, analog_rate = 0.0;           ///< [Hz]; 0: not known
  std::uint64_t data = 0, end = 0;                      ///< [bytes] start and end of the section
  std::uint64_t frames = 0;
  double first_frame = 1.0;

  [[nodiscard]] std::size_t number_size() const { return real ? 4 : 2; }
  [[nodiscard]] std::uint64_t frame_size() const {
    return (kPointNumbers * points + channels * samples) * number_size();
  }
};

/// Finds the layout from the header, the parameters and the file size. The size decides where header and parameters
/// contradict each other: the data end where the file ends, except for at most 511 bytes of padding. If it does not
/// decide, the parameters take precedence for the number of frames and the start of the data. `notes` lists each
/// contradiction.
/// @param file  at least the header and the parameters    @param size  [bytes] of the whole file
/// @fails  data: header and parameters disagree on points, channels, samples, rates or the type of the numbers, and the
/// size does not decide; the data cannot start where the file says; there are no frames, or neither points nor
/// channels.
[[nodiscard]] Result<C3dLayout> c3d_layout(const C3dBytes& file, const C3dParameters& parameters, std::uint64_t size,
                                           std::vector<std::string>& notes);

}  // namespace mbk::recording
