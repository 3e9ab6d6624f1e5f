#pragma once

#include <string>

#include "mbk/files/hdf5/bytes.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5 {

/// What an element is, as far as this library reads it.
struct Datatype {
  enum class Kind {
    number,
    half,       ///< IEEE binary16
    text,       ///< of fixed length
    long_text,  ///< of variable length, kept in the global heap
    reference,  ///< the address of an object
    unread,
  };
  Kind kind = Kind::unread;
  std::uint32_t size = 0;           ///< [bytes] of an element in the file
  Stored stored = Stored::float64;  ///< of numbers
  bool big_endian = false;          ///< of numbers
  bool padded_with_blanks = false;  ///< of texts of fixed length
  std::string what;                 ///< of what is not read: "of a compound type"
};

/// A datatype message (specification, IV.A.2.d). Enumerations, among them h5py's bool, are numbers.
/// @fails  it is broken.
[[nodiscard]] Result<Datatype> read_datatype(Cursor in);

}  // namespace mbk::hdf5
