#include "mbk/files/hdf5/write_hdf5.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "mbk/files/hdf5/deflate.h"
#include "mbk/files/hdf5/output.h"
#include "mbk/files/hdf5/stored_numbers.h"
#include "mbk/files/hdf5/writable.h"
#include "mbk/files/hdf5/write_messages.h"
#include "mbk/files/hdf5/write_texts.h"
#include "mbk/files/hdf5/write_tree.h"

namespace mbk::hdf5 {
namespace {

constexpr std::uint64_t kSuperblockBytes = 96;
constexpr std::size_t kLeafHalf = 4, kInternalHalf = 16;  ///< symbols of a node, children of a node: twice as many
constexpr std::size_t kChunkHalf = 32;                    ///< the same of chunks; superblock 0 leaves no choice
constexpr std::size_t kMinPacked = 4096;                  ///< [bytes]; less is not worth a tree of chunks
constexpr unsigned kShuffle = 2, kDeflate = 1;            ///< filters

class Writer {
 public:
  explicit Writer(std::string_view user_block) : user_block_(user_block.size()) {
    out_.put_zeros(kSuperblockBytes);
    file_ = user_block;
  }

  std::string write(const Group& root) {
    texts_.write(root, out_);
    const std::uint64_t address = group(root, "/");
    for (const auto& [place, path] : out_.references) {
      out_.overwrite_u64(place, path.empty() ? 0 : objects_.at(path));
    }
    out_.bytes.replace(0, kSuperblockBytes, superblock(address).bytes);
    return file_ + out_.bytes;
  }

 private:
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

  // ---- values ----

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
        texts_.put_pointer(text, out);
      }
    }
    return out;
  }

  void add_attributes(HeaderOutput& header, const Attributes& attributes) const {
    for (const auto& [name, value] : attributes) {
      Output type = datatype_message(value, stand_of(name));
      Output space = dataspace_message(value.shape);
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
      header.add(Says::attribute, std::move(message));
    }
  }

  // ---- datasets ----

  std::uint64_t dataset(const Dataset& dataset, const std::string& path) {
    Output content = content_of(dataset.value, Stand::variable);
    const auto& shape = dataset.value.shape;
    std::optional<Chunks> chunks;
    std::size_t size = 0;
    if (const auto* numbers = std::get_if<Numbers>(&dataset.value.data);
        numbers != nullptr && !shape.empty() && content.bytes.size() >= kMinPacked) {
      size = size_of(numbers->stored);
      chunks = pack(content.bytes, shape, size);
      std::size_t packed = chunk_node_bytes(shape.size());
      for (const Chunks::Piece& piece : chunks->pieces) packed += piece.packed.size();
      if (packed >= content.bytes.size()) chunks.reset();
    }
    HeaderOutput header;
    header.add(Says::dataspace, dataspace_message(shape));
    header.add(Says::datatype, datatype_message(dataset.value, Stand::variable));
    Output fill;
    fill.put_u8(2);
    fill.put_u8(chunks ? 3 : 2);  // space is allocated as it is needed; as late as possible
    fill.put_u8(2);               // nothing is filled in unless a value is set
    fill.put_u8(1);
    fill.put_u32(0);
    header.add(Says::fill_value, std::move(fill));
    if (chunks) {
      add_chunks(header, *chunks, size);
    } else {
      Output layout;
      const std::size_t bytes = content.bytes.size();
      layout.put_u8(3);
      layout.put_u8(1);
      layout.put_u64(bytes == 0 ? kNoAddress : out_.place(std::move(content)));
      layout.put_u64(bytes);
      header.add(Says::layout, std::move(layout));
    }
    add_attributes(header, dataset.attributes);
    return objects_[path] = out_.place(std::move(header).bytes());
  }

  void add_chunks(HeaderOutput& header, const Chunks& chunks, std::size_t size) {
    std::vector<TreeEntry> entries;
    for (const Chunks::Piece& piece : chunks.pieces) {
      Output content;
      content.put_text(piece.packed);
      const std::uint64_t address = out_.place(std::move(content));
      entries.push_back({chunk_key(piece.packed.size(), piece.offset), address});
    }
    std::vector<std::uint64_t> end = chunks.pieces.back().offset;
    for (std::size_t i = 0; i < end.size(); ++i) end[i] += chunks.shape[i];
    Output layout;
    layout.put_u8(3);
    layout.put_u8(2);
    layout.put_u8(static_cast<unsigned>(chunks.shape.size() + 1));
    layout.put_u64(append_tree(out_, TreeOf::chunks, 2 * kChunkHalf, std::move(entries), chunk_key(0, end)));
    for (const std::uint64_t length : chunks.shape) layout.put_u32(length);
    layout.put_u32(size);
    header.add(Says::layout, std::move(layout));

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
    header.add(Says::filters, std::move(filters));
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
    return tree_node_bytes(2 * kChunkHalf, 8 + 8 * (dimensions + 1));
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
    HeaderOutput header;
    header.add(Says::symbol_table, std::move(table));
    add_attributes(header, group.attributes);
    return objects_[path] = out_.place(std::move(header).bytes());
  }

  std::uint64_t symbol_tree(const std::vector<std::pair<std::uint64_t, std::uint64_t>>& symbols) {
    constexpr std::size_t kSymbolBytes = 40, kHead = 8;
    const auto key = [](std::uint64_t name) {
      Output out;
      out.put_u64(name);
      return out.bytes;
    };
    std::vector<TreeEntry> entries;
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
      const std::uint64_t address = out_.place(std::move(node));
      entries.push_back({last, address});
      last = key(symbols[begin + count - 1].first);
    }
    return append_tree(out_, TreeOf::symbols, 2 * kInternalHalf, std::move(entries), last);
  }

  std::uint64_t local_heap(Output names) {
    constexpr std::uint64_t kNothingFree = 1;
    Output heap;
    heap.put_text("HEAP");
    heap.put_u32(0);
    heap.put_u64(names.bytes.size());
    heap.put_u64(kNothingFree);
    const std::uint64_t address = out_.place(std::move(names));
    heap.put_u64(address);
    return out_.place(std::move(heap));
  }

  std::size_t user_block_;
  std::string file_;  ///< the user block
  Output out_;        ///< what follows; addresses count from its beginning
  TextHeaps texts_;
  std::unordered_map<std::string, std::uint64_t> objects_;  ///< addresses of headers
};

}  // namespace

Result<std::string> serialise(const Group& root, std::string_view user_block) {
  if (const std::size_t size = user_block.size(); size != 0 && (size < 512 || (size & (size - 1)) != 0)) {
    return bad_data(fmt::format("a user block of {} bytes is not one of 0, 512, 1024, 2048, …", size));
  }
  MBK_TRY(check_writable(root));
  return Writer(user_block).write(root);
}

}  // namespace mbk::hdf5
