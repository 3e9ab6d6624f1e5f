#include "mbk/files/hdf5/global_heap.h"

#include <fmt/format.h>

namespace mbk::hdf5 {
namespace {

constexpr std::uint64_t kNodeMemory = 96;  ///< [bytes], of an entry of the map

tl::unexpected<Error> broken_heap(std::uint64_t address) {
  return damaged(fmt::format("the global heap at byte {} is broken", address));
}

}  // namespace

Result<GlobalHeap::Collection> GlobalHeap::read(File& file, std::uint64_t address) {
  const std::size_t prefix_size = 8 + file.sizes.length;
  const auto prefix = MBK_TRY(file.block(address, prefix_size, "a global heap"));
  Cursor head = file.cursor(prefix);
  const bool known = head.is("GCOL") && head.byte() == 1;
  head.skip(3);
  const std::uint64_t size = head.length();
  if (!known || size < prefix_size) return broken_heap(address);
  const auto block = MBK_TRY(file.block(address, size, "a global heap"));

  Collection objects;
  Cursor in = file.cursor(block.subspan(prefix_size));
  while (in.left() >= prefix_size) {
    const std::uint64_t number = in.word();
    in.skip(6);  // references and a reserved field
    const std::uint64_t length = in.length();
    if (number == 0) break;  // the rest is free
    const Bytes object = in.take(length);
    if (!in.ok() || !objects.emplace(number, object).second) return broken_heap(address);
    MBK_TRY(file.budget.keep(1, kNodeMemory));
    in.skip(std::min<std::uint64_t>((8 - length % 8) % 8, in.left()));
  }
  return objects;
}

Result<Bytes> GlobalHeap::object(File& file, std::uint64_t collection, std::uint64_t number) {
  auto known = collections_.find(collection);
  if (known == collections_.end()) {
    auto objects = MBK_TRY(read(file, collection));
    known = collections_.emplace(collection, std::move(objects)).first;
  }
  const auto found = known->second.find(number);
  if (found == known->second.end()) {
    return damaged(fmt::format("the global heap at byte {} has no object {}", collection, number));
  }
  return found->second;
}

}  // namespace mbk::hdf5
