#include "mbk/files/hdf5/read_hdf5.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/hdf5/links.h"
#include "mbk/files/hdf5/superblock.h"
#include "mbk/files/hdf5/values.h"

namespace mbk::hdf5 {
namespace {

constexpr int kMaxHops = 16;  ///< soft links that lead to soft links

/// Walks the links of a file, builds the tree in place, and then resolves its references. What is damaged is
/// left with the reason in its place, and the rest is read; only a budget that is used up ends the walk.
class Tree {
 public:
  Tree(const Superblock& superblock, const ReadLimits& limits)
      : limits_(limits),
        reading_{{superblock.contents, superblock.sizes, Budget(limits)}, {}, {}},
        root_address_(superblock.root) {}
  Group root;

  Result<void> walk() {
    const auto header = read_object_header(reading_.file, root_address_);
    if (!header) return tl::unexpected(header.error().in("/"));
    if (!is_group(*header)) return damaged("its root is not a group");
    if (const auto links = links_of(root_address_, *header); !links) return tl::unexpected(links.error().in("/"));
    MBK_TRY(group(root_address_, *header, "", 0, root));
    return resolve();
  }

 private:
  [[nodiscard]] bool is_spent() const { return reading_.file.budget.is_spent(); }

  Result<void> group(std::uint64_t address, const ObjectHeader& header, const std::string& path, int depth,
                     Group& place) {
    const std::string name = path.empty() ? "/" : path;
    paths_.try_emplace(address, name);
    if (auto ok = read_attributes(reading_, header, place.attributes); !ok) {
      if (is_spent()) return tl::unexpected(ok.error().in(name));
      place.damage = ok.error().message;
    }
    const auto links = links_of(address, header);
    if (!links && is_spent()) return tl::unexpected(links.error().in(name));
    if (!links) {
      place.damage = links.error().message;
      return {};
    }
    within_.push_back(address);
    for (const Link& link : **links) {
      const std::string inner = path + "/" + link.name;
      if (place.groups.contains(link.name) || place.datasets.contains(link.name)) {
        place.damage = printable(fmt::format("'{}' occurs twice", link.name));
        continue;
      }
      MBK_TRY(object(address, link, inner, depth, place));
    }
    within_.pop_back();
    return {};
  }

  /// The target of a link.
  /// @param parent  address of the group that the link is in
  Result<void> object(std::uint64_t parent, const Link& link, const std::string& path, int depth, Group& place) {
    if (auto ok = reading_.file.budget.object(path.size()); !ok) return tl::unexpected(ok.error().in(path));
    const auto leave = [&](std::string what, bool is_damaged = false) {
      place.datasets[link.name].value.data = Unread{printable(std::move(what)), is_damaged};
      return Result<void>();
    };
    if (link.kind == Link::Kind::external) {
      return leave(fmt::format("a link to '{}' in another file, '{}'", link.path, link.file));
    }
    if (link.kind == Link::Kind::other) return leave("a user-defined link");
    const std::uint64_t address = link.kind == Link::Kind::soft ? follow(link.path, parent, 0) : link.address;
    if (is_spent()) return tl::unexpected(damaged("its links form a loop").value().in(path));
    if (address == kUndefined) return leave(fmt::format("a link to '{}', which does not exist", link.path));
    if (std::ranges::find(within_, address) != within_.end()) return leave("a link to a group that contains it");
    const auto header = read_object_header(reading_.file, address);
    if (!header && is_spent()) return tl::unexpected(header.error().in(path));
    if (!header) return leave(header.error().message, true);
    if (!is_group(*header)) return dataset(address, *header, link.name, path, place);
    if (depth + 1 > limits_.depth) return leave("groups are nested too deeply", true);
    return group(address, *header, path, depth + 1, place.groups[link.name]);
  }

  Result<void> dataset(std::uint64_t address, const ObjectHeader& header, const std::string& name,
                       const std::string& path, Group& place) {
    const auto [first, is_new] = paths_.try_emplace(address, path);
    Dataset& read = place.datasets[name];
    if (!is_new && read_again_ > reading_.file.bytes.size()) {
      read.value.data = Unread{printable(fmt::format("another name of '{}'", first->second))};
      return {};
    }
    std::optional<Group> table;
    const auto ok = contents(header, read, table);
    if (!ok && is_spent()) return tl::unexpected(ok.error().in(path));
    if (!ok) {
      read.value = {{}, Unread{ok.error().message, true}};
      return {};
    }
    if (!is_new) read_again_ += table ? bytes_of(*table) : bytes_of(read);
    if (!table) return {};
    table->attributes = std::move(read.attributes);
    place.groups[name] = std::move(*table);
    place.datasets.erase(name);
    return {};
  }

  Result<void> contents(const ObjectHeader& header, Dataset& place, std::optional<Group>& table) {
    MBK_TRY(read_attributes(reading_, header, place.attributes));
    if (is_dataset(header)) return read_value(reading_, header, place.value, table);
    place.value.data = Unread{"neither a group nor a dataset"};
    return {};
  }

  /// The address of the object at a path, or kUndefined if there is none.
  /// @param from  address of the group that the path begins in
  std::uint64_t follow(std::string_view path, std::uint64_t from, int hops) {
    std::uint64_t at = path.starts_with('/') ? root_address_ : from;
    while (!path.empty() && at != kUndefined && hops <= kMaxHops) {
      const std::size_t end = std::min(path.find('/'), path.size());
      const std::string_view name = path.substr(0, end);
      path.remove_prefix(std::min(end + 1, path.size()));
      if (!name.empty() && name != ".") at = step(name, at, hops);
    }
    return hops <= kMaxHops ? at : kUndefined;
  }

  /// The same for one name in a group.
  std::uint64_t step(std::string_view name, std::uint64_t in, int hops) {
    const auto header = read_object_header(reading_.file, in);
    if (!header || !is_group(*header)) return kUndefined;
    const auto links = links_of(in, *header);
    if (!links) return kUndefined;
    const auto link = std::ranges::find(**links, name, &Link::name);
    if (link == (*links)->end()) return kUndefined;
    return link->kind == Link::Kind::soft ? follow(link->path, in, hops + 1) : link->address;
  }

  /// The links of a group, which are read once.
  Result<const std::vector<Link>*> links_of(std::uint64_t address, const ObjectHeader& header) {
    const auto known = links_.find(address);
    if (known != links_.end()) return &known->second;
    auto links = MBK_TRY(read_links(reading_.file, header));
    return &links_.emplace(address, std::move(links)).first->second;
  }

  static std::uint64_t bytes_of(const Dataset& dataset) {
    const auto* const numbers = std::get_if<Numbers>(&dataset.value.data);
    return numbers == nullptr ? 0 : static_cast<std::uint64_t>(numbers->values.size()) * sizeof(double);
  }
  static std::uint64_t bytes_of(const Group& group) {
    std::uint64_t bytes = 0;
    for (const auto& [name, dataset] : group.datasets) bytes += bytes_of(dataset);
    for (const auto& [name, inner] : group.groups) bytes += bytes_of(inner);
    return bytes;
  }

  Result<void> resolve() {
    for (const OpenReferences& open : reading_.references) {
      for (std::size_t i = 0; i < open.addresses.size(); ++i) {
        const auto found = paths_.find(open.addresses[i]);
        if (found == paths_.end()) continue;  // null, or an object without a link
        MBK_TRY(reading_.file.budget.keep(1, found->second.size()));
        open.place->paths[i] = found->second;
      }
    }
    return {};
  }

  const ReadLimits& limits_;
  Reading reading_;
  std::uint64_t root_address_;
  std::vector<std::uint64_t> within_;                 ///< addresses of the groups on the way from the root
  std::map<std::uint64_t, std::string> paths_;        ///< the first path to each object
  std::map<std::uint64_t, std::vector<Link>> links_;  ///< of each group, by its address
  std::uint64_t read_again_ = 0;                      ///< [bytes] of datasets that have several names
};

}  // namespace

bool looks_like_hdf5(std::span<const std::byte> file) {
  return find_superblock(file).has_value();
}

Result<Group> read(std::span<const std::byte> file, const ReadLimits& limits) {
  const auto superblock = MBK_TRY(read_superblock(file));
  Tree tree(superblock, limits);
  MBK_TRY(tree.walk());
  return std::move(tree.root);
}

}  // namespace mbk::hdf5
