#include "mbk/hdf5/write.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "mbk/hdf5/output.h"
#include "mbk/hdf5/stored_numbers.h"
#include "mbk/hdf5/writable.h"

namespace mbk::hdf5 {
namespace {

constexpr std::uint64_t kSuperblockBytes = 96;
constexpr std::size_t kLeafHalf = 4, kInternalHalf = 16;  ///< symbols of a node, children of a node: twice as many
constexpr std::size_t kChunkHalf = 32;                    ///< the same of chunks; superblock 0 leaves no choice
constexpr std::size_t kLeastPacked = 4096;                ///< [bytes]; less is not worth a tree of chunks
constexpr std::size_t kHeapBytes = 65'536, kLeastHeapBytes = 4096;
constexpr unsigned kShuffle = 2, kDeflate = 1;  ///< filters

// Messages of an object header.
constexpr std::size_t kDataspace = 1, kDatatype = 3, kFillValue = 5, kLayout = 8, kFilters = 11, kAttribute = 12,
                      kSymbolTable = 17;

bool is_ascii(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

/// An object header: what is said about a group or a dataset.
class Header {
 public:
  void add(std::size_t type, Output message) {
    message.align();
    messages_.put_u16(type);
    messages_.put_u16(message.bytes.size());
    messages_.put_zeros(4);
    messages_.append(std::move(message));
    ++count_;
  }

  [[nodiscard]] Output bytes() && {
    Output out;
    out.put_u8(1);
    out.put_u8(0);
    out.put_u16(count_);
    out.put_u32(1);  // one link points to it
    out.put_u32(messages_.bytes.size());
    out.put_zeros(4);
    out.append(std::move(messages_));
    return out;
  }

 private:
  Output messages_;
  std::size_t count_ = 0;
};

Output dataspace(const std::vector<std::uint64_t>& shape) {
  Output out;
  out.put_u8(1);
  out.put_u8(static_cast<unsigned>(shape.size()));
  out.put_zeros(6);
  for (const std::uint64_t length : shape) out.put_u64(length);
  return out;
}

/// Class and version, three bytes of flags, and the size of one value.
Output datatype(unsigned type_class, unsigned flags, unsigned more_flags, std::size_t size) {
  Output out;
  out.put_u8(0x10 | type_class);
  out.put_u8(flags);
  out.put_u8(more_flags);
  out.put_u8(0);
  out.put_u32(size);
  return out;
}

Output number_type(Stored stored) {
  const std::size_t size = size_of(stored);
  if (!is_float(stored)) {
    Output out = datatype(0, is_signed(stored) ? 0x08 : 0, 0, size);
    out.put_u16(0);
    out.put_u16(8 * size);
    return out;
  }
  const bool single = size == 4;
  Output out = datatype(1, 0x20, static_cast<unsigned>(8 * size - 1), size);  // IEEE 754; the place of the sign
  out.put_u16(0);
  out.put_u16(8 * size);
  out.put_u8(single ? 23 : 52);  // exponent: place and bits
  out.put_u8(single ? 8 : 11);
  out.put_u8(0);  // mantissa: place and bits
  out.put_u8(single ? 23 : 52);
  out.put_u32(single ? 127 : 1023);
  return out;
}

std::size_t longest(const Texts& texts) {
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  return length;
}

class Writer {
 public:
  explicit Writer(std::string_view user_block) : user_block_(user_block.size()) {
    out_.put_zeros(kSuperblockBytes);
    file_ = user_block;
  }

  std::string write(const Group& root) {
    write_texts(root);
    const std::uint64_t address = group(root, "/");
    for (const auto& [place, path] : out_.references) {
      out_.overwrite_u64(place, path.empty() ? 0 : objects_.at(path));
    }
    out_.bytes.replace(0, kSuperblockBytes, superblock(address).bytes);
    return file_ + out_.bytes;
  }

 private:
  struct HeapId {
    std::uint64_t heap = 0;
    std::size_t index = 0;
  };
  /// A child of a node in a B-tree, and the key to its left.
  struct Entry {
    std::string key;
    std::uint64_t child = 0;
  };

  [[nodiscard]] Output superblock(std::uint64_t root) const {
    Output out;
    out.put_text("\x89HDF\r\n\x1a\n");
    out.put_zeros(5);  // versions
    out.put_u8(8);     // bytes of an address, and of a length
    out.put_u8(8);
    out.put_u8(0);
    out.put_u16(kLeafHalf);
    out.put_u16(kInternalHalf);
    out.put_u32(0);
    out.put_u64(user_block_);
    out.put_u64(kNoAddress);
    out.put_u64(user_block_ + out_.bytes.size());
    out.put_u64(kNoAddress);
    out.put_u64(0);  // the root has no name
    out.put_u64(root);
    out.put_zeros(24);
    return out;
  }

  /// Puts something where it may begin; its address.
  std::uint64_t place(Output content) {
    out_.align();
    const std::uint64_t address = out_.bytes.size();
    out_.append(std::move(content));
    return address;
  }

  // ---- texts: their lengths vary, so they stand in heaps ----

  void write_texts(const Group& root) {
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
        heap_ids_[texts[begin]] = {0, index};
      }
      const std::uint64_t address = write_heap(std::move(heap));
      for (std::size_t i = begin - index; i < begin; ++i) heap_ids_[texts[i]].heap = address;
    }
  }

  std::uint64_t write_heap(Output objects) {
    constexpr std::size_t kHead = 16;
    const std::size_t size = std::max(kLeastHeapBytes, objects.bytes.size() + kHead);
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
    return place(std::move(heap));
  }

  static void collect(const Group& group, std::vector<const std::string*>& texts) {
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

  /// How the texts of a value stand in the file.
  enum class Stand { variable, fixed, letters };

  static Stand stand_of(std::string_view attribute) {
    if (attribute == "MATLAB_fields") return Stand::letters;
    return attribute.starts_with("MATLAB_") ? Stand::fixed : Stand::variable;
  }

  // ---- values ----

  static Output type_of(const Value& value, Stand stand) {
    if (const auto* numbers = std::get_if<Numbers>(&value.data)) return number_type(numbers->stored);
    if (std::holds_alternative<References>(value.data)) return datatype(7, 0, 0, 8);
    const auto& texts = std::get<Texts>(value.data);
    if (stand == Stand::fixed) return datatype(3, std::ranges::all_of(texts, is_ascii) ? 0 : 0x10, 0, longest(texts));
    const bool letters = stand == Stand::letters;  // sequences of strings of one byte; otherwise strings in UTF-8
    Output type = datatype(9, letters ? 0 : 1, letters ? 0 : 1, 16);
    type.append(letters ? datatype(3, 0, 0, 1) : number_type(Stored::uint8));
    return type;
  }

  [[nodiscard]] Output content_of(const Value& value, Stand stand) const {
    Output out;
    if (const auto* numbers = std::get_if<Numbers>(&value.data)) {
      out.bytes = bytes_of(*numbers);
    } else if (const auto* references = std::get_if<References>(&value.data)) {
      for (const std::string& path : references->paths) out.put_reference(path);
    } else {
      const auto& texts = std::get<Texts>(value.data);
      for (const std::string& text : texts) {
        if (stand == Stand::fixed) {
          out.put_text(text);
          out.put_zeros(longest(texts) - text.size());
          continue;
        }
        const HeapId& id = heap_ids_.at(&text);
        out.put_u32(text.size());
        out.put_u64(id.heap);
        out.put_u32(id.index);
      }
    }
    return out;
  }

  void add_attributes(Header& header, const Attributes& attributes) const {
    for (const auto& [name, value] : attributes) {
      Output type = type_of(value, stand_of(name));
      Output space = dataspace(value.shape);
      Output message;
      message.put_u8(3);
      message.put_u8(0);
      message.put_u16(name.size() + 1);
      message.put_u16(type.bytes.size());
      message.put_u16(space.bytes.size());
      message.put_u8(is_ascii(name) ? 0 : 1);
      message.put_text(name);
      message.put_u8(0);
      message.append(std::move(type));
      message.append(std::move(space));
      message.append(content_of(value, stand_of(name)));
      header.add(kAttribute, std::move(message));
    }
  }

  // ---- datasets ----

  std::uint64_t dataset(const Dataset& dataset, const std::string& path) {
    Output content = content_of(dataset.value, Stand::variable);
    const auto& shape = dataset.value.shape;
    std::optional<Chunks> chunks;
    std::size_t size = 0;
    if (const auto* numbers = std::get_if<Numbers>(&dataset.value.data);
        numbers != nullptr && !shape.empty() && content.bytes.size() >= kLeastPacked) {
      size = size_of(numbers->stored);
      chunks = pack(content.bytes, shape, size);
      std::size_t packed = chunk_node_bytes(shape.size());
      for (const Chunks::Piece& piece : chunks->pieces) packed += piece.packed.size();
      if (packed >= content.bytes.size()) chunks.reset();
    }
    Header header;
    header.add(kDataspace, dataspace(shape));
    header.add(kDatatype, type_of(dataset.value, Stand::variable));
    Output fill;
    fill.put_u8(2);
    fill.put_u8(chunks ? 3 : 2);  // space is allocated as it is needed; as late as possible
    fill.put_u8(2);               // nothing is filled in unless a value is set
    fill.put_u8(1);
    fill.put_u32(0);
    header.add(kFillValue, std::move(fill));
    if (chunks) {
      add_chunks(header, *chunks, size);
    } else {
      Output layout;
      const std::size_t bytes = content.bytes.size();
      layout.put_u8(3);
      layout.put_u8(1);
      layout.put_u64(bytes == 0 ? kNoAddress : place(std::move(content)));
      layout.put_u64(bytes);
      header.add(kLayout, std::move(layout));
    }
    add_attributes(header, dataset.attributes);
    return objects_[path] = place(std::move(header).bytes());
  }

  void add_chunks(Header& header, const Chunks& chunks, std::size_t size) {
    std::vector<Entry> entries;
    for (const Chunks::Piece& piece : chunks.pieces) {
      Output content;
      content.put_text(piece.packed);
      const std::uint64_t address = place(std::move(content));
      entries.push_back({chunk_key(piece.packed.size(), piece.offset), address});
    }
    std::vector<std::uint64_t> end = chunks.pieces.back().offset;
    for (std::size_t i = 0; i < end.size(); ++i) end[i] += chunks.shape[i];
    Output layout;
    layout.put_u8(3);
    layout.put_u8(2);
    layout.put_u8(static_cast<unsigned>(chunks.shape.size() + 1));
    layout.put_u64(tree(1, 2 * kChunkHalf, std::move(entries), chunk_key(0, end)));
    for (const std::uint64_t length : chunks.shape) layout.put_u32(length);
    layout.put_u32(size);
    header.add(kLayout, std::move(layout));

    Output filters;
    filters.put_u8(1);
    filters.put_u8(2);
    filters.put_zeros(6);
    for (const auto& [filter, value] : {std::pair(kShuffle, size), std::pair(kDeflate, std::size_t{kDeflateLevel})}) {
      filters.put_u16(filter);
      filters.put_u16(0);
      filters.put_u16(1);  // a reader may do without; nothing is written without
      filters.put_u16(1);
      filters.put_u32(value);
      filters.put_u32(0);
    }
    header.add(kFilters, std::move(filters));
  }

  static std::string chunk_key(std::size_t bytes, const std::vector<std::uint64_t>& offset) {
    Output key;
    key.put_u32(bytes);
    key.put_u32(0);
    for (const std::uint64_t place : offset) key.put_u64(place);
    key.put_u64(0);  // within one number
    return key.bytes;
  }

  static std::size_t chunk_node_bytes(std::size_t dimensions) {
    return node_bytes(2 * kChunkHalf, 8 + 8 * (dimensions + 1));
  }

  // ---- groups ----

  std::uint64_t group(const Group& group, const std::string& path) {
    std::map<std::string, std::uint64_t> children;
    const std::string prefix = path == "/" ? path : path + "/";
    for (const auto& [name, child] : group.groups) children[name] = this->group(child, prefix + name);
    for (const auto& [name, child] : group.datasets) children[name] = dataset(child, prefix + name);

    Output names;
    names.put_u64(0);  // the empty name, left of all others
    std::vector<std::pair<std::uint64_t, std::uint64_t>> symbols;
    for (const auto& [name, address] : children) {
      symbols.emplace_back(names.bytes.size(), address);
      names.put_text(name);
      names.put_u8(0);
      names.align();
    }
    const std::uint64_t tree_address = symbol_tree(symbols);
    Output table;
    table.put_u64(tree_address);
    table.put_u64(local_heap(std::move(names)));
    Header header;
    header.add(kSymbolTable, std::move(table));
    add_attributes(header, group.attributes);
    return objects_[path] = place(std::move(header).bytes());
  }

  std::uint64_t symbol_tree(const std::vector<std::pair<std::uint64_t, std::uint64_t>>& symbols) {
    constexpr std::size_t kSymbolBytes = 40, kHead = 8;
    const auto key = [](std::uint64_t name) {
      Output out;
      out.put_u64(name);
      return out.bytes;
    };
    std::vector<Entry> entries;
    std::string last = key(0);  // a key is the last name to its left
    for (std::size_t begin = 0; begin < symbols.size(); begin += 2 * kLeafHalf) {
      const std::size_t count = std::min(2 * kLeafHalf, symbols.size() - begin);
      Output node;
      node.put_text("SNOD");
      node.put_u8(1);
      node.put_u8(0);
      node.put_u16(count);
      for (std::size_t i = begin; i < begin + count; ++i) {
        node.put_u64(symbols[i].first);
        node.put_u64(symbols[i].second);
        node.put_zeros(24);
      }
      node.put_zeros(kHead + 2 * kLeafHalf * kSymbolBytes - node.bytes.size());
      const std::uint64_t address = place(std::move(node));
      entries.push_back({last, address});
      last = key(symbols[begin + count - 1].first);
    }
    return tree(0, 2 * kInternalHalf, std::move(entries), last);
  }

  std::uint64_t local_heap(Output names) {
    constexpr std::uint64_t kNothingFree = 1;
    Output heap;
    heap.put_text("HEAP");
    heap.put_u32(0);
    heap.put_u64(names.bytes.size());
    heap.put_u64(kNothingFree);
    const std::uint64_t address = place(std::move(names));
    heap.put_u64(address);
    return place(std::move(heap));
  }

  // ---- B-trees ----

  static std::size_t node_bytes(std::size_t most, std::size_t key) { return 24 + most * 8 + (most + 1) * key; }

  /// A tree over entries in order, level by level from the leaves; the address of its root.
  std::uint64_t tree(unsigned type, std::size_t most, std::vector<Entry> entries, const std::string& last_key) {
    const std::size_t bytes = node_bytes(most, last_key.size());
    for (unsigned level = 0;; ++level) {
      out_.align();
      const std::uint64_t first = out_.bytes.size();
      const std::size_t nodes = std::max<std::size_t>(1, (entries.size() + most - 1) / most);
      std::vector<Entry> above;
      for (std::size_t n = 0; n < nodes; ++n) {
        const std::size_t end = std::min((n + 1) * most, entries.size());
        Output node;
        node.put_text("TREE");
        node.put_u8(type);
        node.put_u8(level);
        node.put_u16(end - n * most);
        node.put_u64(n == 0 ? kNoAddress : first + (n - 1) * bytes);
        node.put_u64(n + 1 == nodes ? kNoAddress : first + (n + 1) * bytes);
        for (std::size_t i = n * most; i < end; ++i) {
          node.put_text(entries[i].key);
          node.put_u64(entries[i].child);
        }
        node.put_text(end < entries.size() ? entries[end].key : last_key);
        node.put_zeros(bytes - node.bytes.size());
        above.push_back({entries.empty() ? last_key : entries[n * most].key, first + n * bytes});
        out_.append(std::move(node));
      }
      if (nodes == 1) return first;
      entries = std::move(above);
    }
  }

  std::size_t user_block_;
  std::string file_;  ///< the user block
  Output out_;        ///< what follows; addresses count from its beginning
  std::unordered_map<const std::string*, HeapId> heap_ids_;
  std::unordered_map<std::string, std::uint64_t> objects_;  ///< addresses of headers
};

}  // namespace

Result<std::string> serialise(const Group& root, std::string_view user_block) {
  if (const std::size_t size = user_block.size(); size != 0 && (size < 512 || (size & (size - 1)) != 0)) {
    return bad_data(fmt::format("a user block of {} bytes is none of 0, 512, 1024, 2048, …", size));
  }
  if (auto ok = check_writable(root); !ok) return tl::unexpected(ok.error());
  return Writer(user_block).write(root);
}

}  // namespace mbk::hdf5
