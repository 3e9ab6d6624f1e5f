#include "mbk/files/hdf5/links.h"

#include <fmt/format.h>

#include "mbk/files/hdf5/btree1.h"
#include "mbk/files/hdf5/btree2.h"
#include "mbk/files/hdf5/fractal_heap.h"

namespace mbk::hdf5 {
namespace {

constexpr std::uint64_t kLinkMemory = 160;  ///< [bytes], without its texts

class LinkReader {
 public:
  explicit LinkReader(File& file) : file_(file) {}
  std::vector<Link> links;

  /// A symbol table message: a B-tree of nodes whose names are in a local heap (III.B to III.D).
  Result<void> symbol_table(Cursor message) {
    const std::uint64_t tree = message.address();
    const std::uint64_t heap = message.address();
    if (!message.ok()) return damaged("a group is broken");
    const std::size_t head_size = 8 + 2 * file_.sizes.length + file_.sizes.address;
    const auto head = MBK_TRY(file_.block(heap, head_size, "a local heap"));
    Cursor in = file_.cursor(head);
    const bool known = in.is("HEAP") && in.byte() == 0;
    in.skip(3);
    const std::uint64_t size = in.length();
    in.length();  // its free space
    const std::uint64_t address = in.address();
    if (!known) return damaged(fmt::format("the local heap at byte {} is broken", heap));
    const auto names = MBK_TRY(file_.block(address, size, "a local heap"));
    return for_each_child(file_, tree, BTree1::group, file_.sizes.length,
                          [&](Cursor, std::uint64_t child) { return symbols(child, names); });
  }

  Result<void> symbols(std::uint64_t address, Bytes names) {
    constexpr std::uint32_t kSoftLink = 2;
    const std::size_t entry_size = 2 * file_.sizes.address + 4 + 4 + 16;
    const auto head = MBK_TRY(file_.block(address, 8, "a symbol table node"));
    Cursor prefix = file_.cursor(head);
    const bool known = prefix.is("SNOD") && prefix.byte() == 1;
    prefix.skip(1);
    const std::uint64_t count = prefix.word();
    if (!known) return damaged(fmt::format("the symbol table node at byte {} is broken", address));
    const auto block = MBK_TRY(file_.block(address + 8, count * entry_size, "a symbol table node"));
    for (std::uint64_t i = 0; i < count; ++i) {
      Cursor in = file_.cursor(block.subspan(static_cast<std::size_t>(i) * entry_size, entry_size));
      const std::uint64_t name_at = in.number(file_.sizes.address);
      const std::uint64_t target = in.address();
      const bool soft = in.dword() == kSoftLink;
      in.skip(4);
      const std::uint64_t path_at = in.dword();
      Link link{text_at(names, name_at), soft ? Link::Kind::soft : Link::Kind::hard, target};
      if (soft) link.path = text_at(names, path_at);
      if (outside_) return damaged("a name lies outside its local heap");
      MBK_TRY(add(std::move(link)));
    }
    return {};
  }

  /// A link message (IV.A.2.g).
  Result<void> link(Cursor in) {
    constexpr int kHard = 0, kSoft = 1, kExternal = 64;
    const int version = in.byte();
    const unsigned flags = in.byte();
    const int kind = (flags & 0x08u) != 0 ? in.byte() : kHard;
    if ((flags & 0x04u) != 0) in.skip(8);  // when it was made
    if ((flags & 0x10u) != 0) in.skip(1);  // character set of the name
    const Bytes name = in.take(in.number(std::size_t{1} << (flags & 3u)));
    Link link{text_of(name), Link::Kind::other};
    if (kind == kHard) {
      link.kind = Link::Kind::hard;
      link.address = in.address();
    } else if (kind == kSoft) {
      link.kind = Link::Kind::soft;
      link.path = text_of(in.take(in.word()));
    } else if (kind == kExternal) {
      link.kind = Link::Kind::external;
      in.skip(3);  // length of what follows, and its version
      link.file = in.text();
      link.path = in.text();
    }
    if (version != 1 || !in.ok()) return damaged("a link is broken");
    return add(std::move(link));
  }

  /// A link info message (IV.A.2.c): the links are in a fractal heap, if there is one.
  Result<void> link_info(Cursor in) {
    const int version = in.byte();
    const unsigned flags = in.byte();
    if ((flags & 1u) != 0) in.skip(8);
    const std::uint64_t heap_address = in.address();
    const std::uint64_t tree = in.address();
    if (version != 0 || !in.ok()) return damaged("a group is broken");
    if (heap_address == kUndefined) return {};
    auto heap = MBK_TRY(FractalHeap::open(file_, heap_address));
    return for_each_record(file_, tree, [&](BTree2 kind, Cursor record) -> Result<void> {
      record.skip(4);  // hash of the name
      const Cursor id = file_.cursor(record.take(heap.id_size()));
      if (kind != BTree2::link_names || !record.ok()) return damaged("a group is broken");
      const auto message = MBK_TRY(heap.object(file_, id));
      return link(file_.cursor(message));
    });
  }

 private:
  /// A text of the local heap.
  std::string text_at(Bytes names, std::uint64_t at) {
    Cursor in = file_.cursor(names);
    in.skip(at);
    std::string text = in.text();
    outside_ = outside_ || !in.ok();
    return text;
  }

  Result<void> add(Link link) {
    const std::uint64_t texts = link.name.size() + link.path.size() + link.file.size();
    MBK_TRY(file_.budget.keep(1, kLinkMemory + texts));
    links.push_back(std::move(link));
    return {};
  }

  File& file_;
  bool outside_ = false;  ///< a text was outside of its heap
};

}  // namespace

bool is_group(const ObjectHeader& header) {
  return header.find(MessageType::symbol_table) != nullptr || header.find(MessageType::link_info) != nullptr ||
         header.find(MessageType::link) != nullptr || header.find(MessageType::group_info) != nullptr;
}

Result<std::vector<Link>> read_links(File& file, const ObjectHeader& header) {
  LinkReader reader(file);
  for (const Message& message : header.messages) {
    const Cursor body = file.cursor(message.body);
    Result<void> ok;
    if (message.type == MessageType::symbol_table) ok = reader.symbol_table(body);
    if (message.type == MessageType::link) ok = reader.link(body);
    if (message.type == MessageType::link_info) ok = reader.link_info(body);
    if (!ok) return tl::unexpected(ok.error());
  }
  return std::move(reader.links);
}

}  // namespace mbk::hdf5
