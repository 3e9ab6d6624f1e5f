#pragma once

#include "mbk/base/core/linear_algebra.h"

namespace mbk::recording {

/// The signed number, −32768 to 32767, of a word read as 0 to 65535.
[[nodiscard]] double signed_word(double word);

/// An analog channel as C3D files store it, before it is known whether its words are signed.
struct C3dStored {
  Vector values;        ///< words as 0 to 65535, or reals
  double offset = 0.0;  ///< ANALOG:OFFSET, the same
  bool words = false, offset_is_word = false;
};

/// Whether the words of a channel and its OFFSET are unsigned: as ANALOG:FORMAT states (`said`), unless
/// - values are farther from OFFSET than half the range of a word and, read the other way, are not, with an OFFSET that
///   is usual for that (near mid-range if unsigned, slightly below 0 if signed), or
/// - values jump by half the range between two samples and, read the other way, form a smooth signal.
[[nodiscard]] bool words_are_unsigned(const C3dStored& stored, bool said);

}  // namespace mbk::recording
