#include "mbk/files/hdf5/write_texts.h"

#include <algorithm>

#include "mbk/files/hdf5/write_messages.h"

namespace mbk::hdf5 {
namespace {

constexpr std::size_t kHeapBytes = 65'536, kMinHeapBytes = 4096;

void collect(const Group& group, std::vector<const std::string*>& texts) {
  const auto add = [&](const Value& value) {
    if (const auto* all = std::get_if<Texts>(&value.data)) {
      for (const std::string& text : *all) texts.push_back(&text);
    }
  };
  const auto add_attributes = [&](const Attributes& attributes) {
    for (const auto& [name, value] : attributes) {
      if (stand_of(name) != Stand::fixed) add(value);
    }
  };
  add_attributes(group.attributes);
  for (const auto& [name, dataset] : group.datasets) {
    add(dataset.value);
    add_attributes(dataset.attributes);
  }
  for (const auto& [name, child] : group.groups) collect(child, texts);
}

std::uint64_t append_heap(Output objects, Output& out) {
  constexpr std::size_t kHead = 16;
  const std::size_t size = std::max(kMinHeapBytes, objects.bytes.size() + kHead);
  Output heap;
  heap.put_text("GCOL");
  heap.put_u32(1);
  heap.put_u64(size);
  heap.append(std::move(objects));
  if (const std::size_t free = size - heap.bytes.size(); free >= kHead) {
    heap.put_u64(0);
    heap.put_u64(free);
  }
  heap.put_zeros(size - heap.bytes.size());
  return out.place(std::move(heap));
}

}  // namespace

void TextHeaps::write(const Group& root, Output& out) {
  std::vector<const std::string*> texts;
  collect(root, texts);
  for (std::size_t begin = 0; begin < texts.size();) {
    Output heap;
    std::size_t index = 0;
    for (; begin < texts.size() && (index == 0 || heap.bytes.size() + texts[begin]->size() < kHeapBytes); ++begin) {
      heap.put_u16(++index);
      heap.put_zeros(6);
      heap.put_u64(texts[begin]->size());
      heap.put_text(*texts[begin]);
      heap.align();
      places_[texts[begin]] = {0, index};
    }
    const std::uint64_t address = append_heap(std::move(heap), out);
    for (std::size_t i = begin - index; i < begin; ++i) places_[texts[i]].heap = address;
  }
}

void TextHeaps::put_pointer(const std::string& text, Output& out) const {
  const Place& place = places_.at(&text);
  out.put_u32(text.size());
  out.put_u64(place.heap);
  out.put_u32(place.index);
}

}  // namespace mbk::hdf5
