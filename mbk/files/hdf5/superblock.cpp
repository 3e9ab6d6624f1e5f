#include "mbk/files/hdf5/superblock.h"

#include <fmt/format.h>

#include "mbk/files/hdf5/checksum.h"

namespace mbk::hdf5 {
namespace {

constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
constexpr std::size_t kFirstUserBlock = 512;

tl::unexpected<Error> broken_superblock() {
  return damaged("its HDF5 superblock is broken");
}

bool possible(std::size_t size) {
  return size == 2 || size == 4 || size == 8;
}

/// Versions 0 and 1; the cursor is after the version.
void read_old(Cursor& in, int version, Superblock& superblock, std::uint64_t& base, std::uint64_t& end) {
  in.skip(4);  // versions of other parts, and a reserved byte
  superblock.sizes.address = in.byte();
  superblock.sizes.length = in.byte();
  in.skip(1 + 2 + 2 + 4);  // sizes of B-tree nodes and flags: the nodes say themselves how much they hold
  if (version == 1) in.skip(2 + 2);
  if (!possible(superblock.sizes.address) || !possible(superblock.sizes.length)) return;
  Cursor addresses(in.take(6 * superblock.sizes.address), superblock.sizes);
  base = addresses.address();
  addresses.address();  // free space
  end = addresses.address();
  addresses.address();  // driver
  addresses.address();  // the root group's name: none
  superblock.root = addresses.address();
}

}  // namespace

std::optional<std::size_t> find_superblock(Bytes file) {
  for (std::size_t at = 0; at < file.size(); at = at == 0 ? kFirstUserBlock : 2 * at) {
    if (Cursor(file.subspan(at)).is(kSignature)) return at;
    if (at > file.size() / 2) break;
  }
  return std::nullopt;
}

Result<Superblock> read_superblock(Bytes file) {
  const auto start = find_superblock(file);
  if (!start) return bad_data("the HDF5 signature is missing", "the file is not HDF5");
  Cursor in(file.subspan(*start));
  in.skip(kSignature.size());
  const int version = in.byte();
  if (version > 3) {
    return bad_data(fmt::format("HDF5 superblock version {} is unknown", version),
                    "write the file with libver='v110' or earlier");
  }
  Superblock superblock;
  std::uint64_t base = 0;
  std::uint64_t end = 0;
  bool open = false;
  if (version < 2) {
    read_old(in, version, superblock, base, end);
  } else {
    superblock.sizes.address = in.byte();
    superblock.sizes.length = in.byte();
    open = version == 3 && (in.byte() & 1u) != 0;
    if (version == 2) in.skip(1);
    if (!possible(superblock.sizes.address)) return broken_superblock();
    Cursor addresses(in.take(4 * superblock.sizes.address), superblock.sizes);
    base = addresses.address();
    addresses.address();  // extension
    end = addresses.address();
    superblock.root = addresses.address();
    in.skip(kChecksumSize);
    if (in.ok() && !checksum_is_right(file.subspan(*start, in.at()))) return broken_superblock();
  }
  if (!in.ok() || !possible(superblock.sizes.address) || !possible(superblock.sizes.length) || end == kUndefined ||
      end < base) {
    return broken_superblock();
  }
  // A user block that was put before the file or taken away moves everything.
  const std::uint64_t size = end - base;
  if (size > file.size() - *start) {
    return damaged(fmt::format("the file has {} of its {} bytes", file.size() - *start, size));
  }
  if (open) {
    return bad_data("the program that wrote it did not close it",
                    "close it in that program, or repair it with h5clear -s");
  }
  superblock.contents = file.subspan(*start, static_cast<std::size_t>(size));
  return superblock;
}

}  // namespace mbk::hdf5
