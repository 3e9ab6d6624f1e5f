#include "mbk/files/hdf5/hdf5_layout.h"

#include <fmt/format.h>

#include "mbk/files/hdf5/dataspace.h"

namespace mbk::hdf5 {
namespace {

/// The shape of a chunk and, as the last dimension, the size of an element.
bool read_chunk_shape(Cursor& in, std::size_t dimensions, std::size_t bytes_each, ChunkIndex& chunks) {
  if (dimensions < 2 || dimensions > kMaxDimensions + 1 || bytes_each == 0 || bytes_each > 8) return false;
  for (std::size_t i = 0; i + 1 < dimensions; ++i) {
    chunks.chunk.push_back(in.number(bytes_each));
    if (chunks.chunk.back() == 0) return false;
  }
  chunks.element_size = in.number(bytes_each);
  return in.ok();
}

Result<Layout> broken_layout() {
  return damaged("its layout is broken");
}

/// Versions 1 and 2, as HDF5 wrote before 1.6 and MATLAB up to 7.4 (IV.A.2.i).
Result<Layout> before_1_6(Cursor& in) {
  constexpr int kCompact = 0, kContiguous = 1, kChunked = 2;
  Layout layout;
  const std::size_t dimensions = in.byte();
  const int kind = in.byte();
  in.skip(5);
  if (kind != kCompact && kind != kContiguous && kind != kChunked) return broken_layout();
  const std::uint64_t address = kind == kCompact ? kUndefined : in.address();
  if (kind == kChunked) {
    layout.kind = Layout::Kind::chunked;
    layout.chunks.address = address;
    if (!read_chunk_shape(in, dimensions, 4, layout.chunks)) return broken_layout();
    return layout;
  }
  in.skip(4 * dimensions);  // the dataspace says them again
  if (kind == kContiguous) {
    layout.kind = Layout::Kind::contiguous;
    layout.address = address;
    layout.size = kUndefined;
  } else {
    layout.kind = Layout::Kind::compact;
    layout.compact = in.take(in.dword());
  }
  if (!in.ok()) return broken_layout();
  return layout;
}

Result<Layout> chunked_since_1_10(Cursor& in, Layout layout) {
  constexpr unsigned kPlainEdges = 1, kSingleIsPacked = 2;
  ChunkIndex& chunks = layout.chunks;
  const unsigned flags = in.byte();
  const std::size_t dimensions = in.byte();
  const std::size_t bytes_each = in.byte();
  if (!read_chunk_shape(in, dimensions, bytes_each, chunks)) return broken_layout();
  chunks.whole_edges = (flags & kPlainEdges) == 0;
  const int kind = in.byte();
  switch (kind) {
    case 1:
      chunks.kind = ChunkIndex::Kind::single;
      if ((flags & kSingleIsPacked) != 0) {
        chunks.single_size = in.length();
        chunks.single_skipped = in.dword();
      }
      break;
    case 2:
      chunks.kind = ChunkIndex::Kind::implicit;
      break;
    case 3:
      chunks.kind = ChunkIndex::Kind::fixed_array;
      in.skip(1);  // the index itself says it again
      break;
    case 4:
      chunks.kind = ChunkIndex::Kind::extensible_array;
      in.skip(5);
      break;
    case 5:
      chunks.kind = ChunkIndex::Kind::btree2;
      in.skip(6);
      break;
    default:
      layout.kind = Layout::Kind::unread;
      layout.what = "stored with an unsupported chunk index";
      return layout;
  }
  chunks.address = in.address();
  if (!in.ok()) return broken_layout();
  return layout;
}

}  // namespace

Result<Layout> read_layout(Cursor in) {
  constexpr int kCompact = 0, kContiguous = 1, kChunked = 2, kVirtual = 3;
  const int version = in.byte();
  if (version == 1 || version == 2) return before_1_6(in);
  const int kind = in.byte();
  Layout layout;
  if (version != 3 && version != 4) {
    layout.what = fmt::format("stored in layout version {}, which is not supported", version);
    return layout;
  }
  if (kind == kCompact) {
    layout.kind = Layout::Kind::compact;
    layout.compact = in.take(in.word());
  } else if (kind == kContiguous) {
    layout.kind = Layout::Kind::contiguous;
    layout.address = in.address();
    layout.size = in.length();
  } else if (kind == kChunked) {
    layout.kind = Layout::Kind::chunked;
    if (version == 4) return chunked_since_1_10(in, std::move(layout));
    const std::size_t dimensions = in.byte();
    layout.chunks.address = in.address();
    if (!read_chunk_shape(in, dimensions, 4, layout.chunks)) return broken_layout();
  } else if (kind == kVirtual) {
    layout.what = "stored in other datasets";
  } else {
    return broken_layout();
  }
  if (!in.ok()) return broken_layout();
  return layout;
}

}  // namespace mbk::hdf5
