#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mbk/files/hdf5/bytes.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5 {

struct Member;

/// What an element is, as far as this library reads it.
struct Datatype {
  enum class Kind {
    number,
    half,       ///< IEEE binary16
    text,       ///< of fixed length
    long_text,  ///< of variable length, kept in the global heap
    reference,  ///< the address of an object
    compound,   ///< several values of types of their own
    unread,
  };
  Kind kind = Kind::unread;
  std::uint32_t size = 0;                 ///< [bytes] of an element in the file, of an array all of it
  std::vector<std::uint64_t> array = {};  ///< shape of an element that is an array of the kind; empty: it is one value
  std::uint32_t values = 1;               ///< in an element: 1, or those of the array
  Stored stored = Stored::float64;        ///< of numbers
  bool big_endian = false;                ///< of numbers
  bool padded_with_blanks = false;        ///< of texts of fixed length
  std::string what;                       ///< of what is not read: "of an opaque type"
  std::vector<Member> members;            ///< of a compound
};

/// A value in an element of a compound type.
struct Member {
  std::string name;
  std::uint64_t offset = 0;  ///< [bytes] from the begin of the element
  Datatype type;
};

/// A datatype message (specification, IV.A.2.d). Enumerations, among them h5py's bool, are numbers.
/// @fails  it is broken.
[[nodiscard]] Result<Datatype> read_datatype(Cursor in);

}  // namespace mbk::hdf5
