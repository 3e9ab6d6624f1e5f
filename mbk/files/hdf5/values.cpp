#include "mbk/files/hdf5/values.h"

#include <fmt/format.h>

#include <algorithm>

#include "mbk/files/hdf5/btree2.h"
#include "mbk/files/hdf5/chunk_filters.h"
#include "mbk/files/hdf5/chunks.h"
#include "mbk/files/hdf5/elements.h"
#include "mbk/files/hdf5/fractal_heap.h"
#include "mbk/files/hdf5/hdf5_layout.h"

namespace mbk::hdf5 {
namespace {

constexpr std::uint64_t kAttributeMemory = 256;  ///< [bytes], of a node of the tree

void leave(Value& place, const Dataspace& space, std::string what) {
  place = {space.shape, Unread{std::move(what)}};
}

void store(Reading& reading, Value& place, std::optional<Group>& table, const Dataspace& space, const Datatype& type,
           Elements& elements) {
  if (type.kind == Datatype::Kind::compound) {
    table = elements.table(space.shape);
    return;
  }
  place = elements.value(space.shape);
  if (auto* const references = std::get_if<References>(&place.data)) {
    reading.references.push_back({references, elements.addresses()});
  }
}

/// Contiguous elements.
Result<void> read_plain(Reading& reading, const Dataspace& space, const Datatype& type, Bytes bytes, Value& place,
                        std::optional<Group>& table) {
  std::uint64_t size = 0;
  if (!multiply(space.count, type.size, size) || size > bytes.size()) {
    return damaged(
        fmt::format("{} elements of {} bytes do not fit into {} bytes", space.count, type.size, bytes.size()));
  }
  Elements elements(reading.file, reading.heap, type);
  MBK_TRY(elements.allocate(space.count));
  MBK_TRY(elements.put(0, bytes.first(static_cast<std::size_t>(size))));
  store(reading, place, table, space, type, elements);
  return {};
}

/// One attribute message, versions 1 to 3.
Result<void> read_attribute(Reading& reading, Bytes message, Attributes& all) {
  File& file = reading.file;
  Cursor in = file.cursor(message);
  const int version = in.byte();
  const unsigned flags = in.byte();  // version 1: reserved
  const std::uint64_t name_size = in.word();
  const std::uint64_t type_size = in.word();
  const std::uint64_t space_size = in.word();
  if (version == 3) in.skip(1);  // character set of the name
  if (version < 1 || version > 3) return damaged(fmt::format("attribute version {} is unknown", version));
  const auto padded = [&](std::uint64_t size) { return version == 1 ? (size + 7) / 8 * 8 : size; };
  const std::string name = Cursor(in.take(padded(name_size))).text();
  Bytes type_bytes = in.take(padded(type_size));
  Bytes space_bytes = in.take(padded(space_size));
  if (!in.ok()) return damaged("an attribute is broken");
  const auto here = [&](const Error& error) { return tl::unexpected(error.in(fmt::format("attribute '{}'", name))); };
  for (const auto& [bit, bytes, kind] :
       {std::tuple{1u, &type_bytes, MessageType::datatype}, {2u, &space_bytes, MessageType::dataspace}}) {
    if (version == 1 || (flags & bit) == 0) continue;
    const auto body = shared_body(file, kind, *bytes);
    if (!body) return here(body.error());
    *bytes = *body;
  }
  const auto type = read_datatype(file.cursor(type_bytes));
  if (!type) return here(type.error());
  const auto space = read_dataspace(file.cursor(space_bytes));
  if (!space) return here(space.error());
  if (auto ok = file.budget.keep(1, kAttributeMemory + name.size()); !ok) return here(ok.error());
  const auto [place, added] = all.try_emplace(name);
  if (!added) return here(damaged("it occurs twice").value());
  if (type->kind == Datatype::Kind::unread || type->kind == Datatype::Kind::compound) {
    leave(place->second, *space, type->what.empty() ? "of a compound type" : type->what);
    return {};
  }
  std::optional<Group> none;
  if (auto ok = read_plain(reading, *space, *type, in.take(in.left()), place->second, none); !ok) {
    return here(ok.error());
  }
  return {};
}

/// An attribute info message: the attributes are in a fractal heap, if there is one.
Result<void> read_dense_attributes(Reading& reading, Cursor in, Attributes& all) {
  File& file = reading.file;
  const int version = in.byte();
  const unsigned flags = in.byte();
  if ((flags & 1u) != 0) in.skip(2);
  const std::uint64_t heap_address = in.address();
  const std::uint64_t tree = in.address();
  if (version != 0 || !in.ok()) return damaged("its attributes are broken");
  if (heap_address == kUndefined) return {};
  auto heap = MBK_TRY(FractalHeap::open(file, heap_address));
  return for_each_record(file, tree, [&](BTree2 kind, Cursor record) -> Result<void> {
    constexpr unsigned kShared = 2;
    const Cursor id = file.cursor(record.take(heap.id_size()));
    const bool shared = (record.byte() & kShared) != 0;
    if (kind != BTree2::attribute_names || !record.ok()) return damaged("its attributes are broken");
    if (shared)
      return bad_data("its attributes are shared, which is not supported", "write the file without shared messages");
    const auto message = MBK_TRY(heap.object(file, id));
    return read_attribute(reading, message, all);
  });
}

/// The body of the first message of a type.
Result<Bytes> body_of(File& file, const ObjectHeader& header, MessageType type) {
  const Message* const message = header.find(type);
  if (message == nullptr) return damaged("it has no type, shape or layout");
  return message->shared ? shared_body(file, type, message->body) : message->body;
}

/// Description of a dataset before its elements are read.
struct Description {
  Datatype type;
  Dataspace space;
  Layout layout;
  Filters filters;
};

Result<Description> describe(File& file, const ObjectHeader& header) {
  const auto type_body = MBK_TRY(body_of(file, header, MessageType::datatype));
  const auto space_body = MBK_TRY(body_of(file, header, MessageType::dataspace));
  const auto layout_body = MBK_TRY(body_of(file, header, MessageType::layout));
  auto type = MBK_TRY(read_datatype(file.cursor(type_body)));
  auto space = MBK_TRY(read_dataspace(file.cursor(space_body)));
  auto layout = MBK_TRY(read_layout(file.cursor(layout_body)));
  Result<Filters> filters = Filters{};
  if (header.find(MessageType::filters) != nullptr) {
    const auto filters_body = MBK_TRY(body_of(file, header, MessageType::filters));
    filters = read_filters(file.cursor(filters_body));
    if (!filters) return tl::unexpected(filters.error());
  }
  return Description{std::move(type), std::move(space), std::move(layout), std::move(*filters)};
}

/// Why the elements are not read, or "".
std::string why_unread(const Description& dataset, const ObjectHeader& header) {
  using Kind = Layout::Kind;
  const Layout& layout = dataset.layout;
  if (dataset.type.kind == Datatype::Kind::unread) return dataset.type.what;
  if (header.find(MessageType::external_files) != nullptr) return "stored in other files";
  if (layout.kind == Kind::unread) return layout.what;
  if (layout.kind == Kind::chunked && !dataset.filters.unread.empty()) return dataset.filters.unread;
  const bool nowhere = (layout.kind == Kind::contiguous && layout.address == kUndefined) ||
                       (layout.kind == Kind::chunked && layout.chunks.address == kUndefined);
  return nowhere && dataset.space.count > 0 ? "empty: it was never written" : "";
}

}  // namespace

bool is_dataset(const ObjectHeader& header) {
  return header.find(MessageType::layout) != nullptr;
}

Result<void> read_attributes(Reading& reading, const ObjectHeader& header, Attributes& place) {
  for (const Message& message : header.messages) {
    Result<void> ok;
    if (message.type == MessageType::attribute) {
      const auto body = message.shared ? shared_body(reading.file, message.type, message.body) : message.body;
      ok = body ? read_attribute(reading, *body, place) : tl::unexpected(body.error());
    } else if (message.type == MessageType::attribute_info) {
      ok = read_dense_attributes(reading, reading.file.cursor(message.body), place);
    }
    if (!ok) return ok;
  }
  return {};
}

Result<void> read_value(Reading& reading, const ObjectHeader& header, Value& place, std::optional<Group>& table) {
  const auto dataset = MBK_TRY(describe(reading.file, header));
  const Layout& layout = dataset.layout;
  if (std::string why = why_unread(dataset, header); !why.empty()) {
    leave(place, dataset.space, std::move(why));
    return {};
  }
  if (dataset.space.count == 0) return read_plain(reading, dataset.space, dataset.type, {}, place, table);
  if (layout.kind == Layout::Kind::compact) {
    return read_plain(reading, dataset.space, dataset.type, layout.compact, place, table);
  }
  if (layout.kind == Layout::Kind::contiguous) {
    std::uint64_t size = layout.size;
    if (size == kUndefined && !multiply(dataset.space.count, dataset.type.size, size)) size = kUndefined;
    const auto block = MBK_TRY(reading.file.block(layout.address, size, "its data"));
    return read_plain(reading, dataset.space, dataset.type, block, place, table);
  }
  Elements elements(reading.file, reading.heap, dataset.type);
  MBK_TRY(read_chunks(reading.file, layout.chunks, dataset.filters, dataset.space, elements));
  store(reading, place, table, dataset.space, dataset.type, elements);
  return {};
}

}  // namespace mbk::hdf5
