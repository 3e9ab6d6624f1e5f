#include "mbk/files/hdf5/read_hdf5.h"

#include <fmt/format.h>

#include <utility>

#include "mbk/files/hdf5/links.h"
#include "mbk/files/hdf5/superblock.h"
#include "mbk/files/hdf5/values.h"

namespace mbk::hdf5 {
namespace {

/// Walks the links of a file, builds the tree in place, and then says where its references lead.
class Tree {
 public:
  Tree(const Superblock& superblock, const ReadLimits& limits)
      : limits_(limits), reading_{{superblock.contents, superblock.sizes, Budget(limits)}, {}, {}} {}
  Group root;

  Result<void> walk(std::uint64_t address) {
    const auto header = read_object_header(reading_.file, address);
    if (!header) return tl::unexpected(header.error().in("/"));
    if (!is_group(*header)) return damaged("its root is not a group");
    if (auto ok = group(address, *header, "", 0, root); !ok) return ok;
    return resolve();
  }

 private:
  Result<void> group(std::uint64_t address, const ObjectHeader& header, const std::string& path, int depth,
                     Group& place) {
    const std::string name = path.empty() ? "/" : path;
    if (depth > limits_.depth) return tl::unexpected(damaged("groups are nested too deeply").value().in(name));
    paths_.try_emplace(address, name);
    if (auto ok = read_attributes(reading_, header, place.attributes); !ok) {
      return tl::unexpected(ok.error().in(name));
    }
    const auto links = read_links(reading_.file, header);
    if (!links) return tl::unexpected(links.error().in(name));
    for (const Link& link : *links) {
      const std::string inner = path + "/" + link.name;
      if (place.groups.contains(link.name) || place.datasets.contains(link.name)) {
        return tl::unexpected(damaged("it is there twice").value().in(inner));
      }
      if (auto ok = object(link, inner, depth, place); !ok) return ok;
    }
    return {};
  }

  Result<void> object(const Link& link, const std::string& path, int depth, Group& place) {
    if (auto ok = reading_.file.budget.object(path.size()); !ok) return tl::unexpected(ok.error().in(path));
    if (link.address == kUndefined) {
      place.datasets[link.name].value.data = Unread{"a link to elsewhere"};
      return {};
    }
    const auto header = read_object_header(reading_.file, link.address);
    if (!header) return tl::unexpected(header.error().in(path));
    if (is_group(*header)) return group(link.address, *header, path, depth + 1, place.groups[link.name]);
    if (auto ok = dataset(link.address, *header, path, place.datasets[link.name]); !ok) {
      return tl::unexpected(ok.error().in(path));
    }
    return {};
  }

  Result<void> dataset(std::uint64_t address, const ObjectHeader& header, const std::string& path, Dataset& place) {
    paths_.try_emplace(address, path);
    if (auto ok = read_attributes(reading_, header, place.attributes); !ok) return ok;
    if (is_dataset(header)) return read_value(reading_, header, place.value);
    place.value.data = Unread{"neither a group nor a dataset"};
    return {};
  }

  Result<void> resolve() {
    for (const OpenReferences& open : reading_.references) {
      for (std::size_t i = 0; i < open.addresses.size(); ++i) {
        const auto found = paths_.find(open.addresses[i]);
        if (found == paths_.end()) continue;  // null, or an object without a link
        if (auto ok = reading_.file.budget.keep(1, found->second.size()); !ok) return ok;
        open.place->paths[i] = found->second;
      }
    }
    return {};
  }

  const ReadLimits& limits_;
  Reading reading_;
  std::map<std::uint64_t, std::string> paths_;  ///< the first path to each object
};

}  // namespace

bool looks_like_hdf5(std::span<const std::byte> file) {
  return find_superblock(file).has_value();
}

Result<Group> read(std::span<const std::byte> file, const ReadLimits& limits) {
  const auto superblock = read_superblock(file);
  if (!superblock) return tl::unexpected(superblock.error());
  Tree tree(*superblock, limits);
  if (auto ok = tree.walk(superblock->root); !ok) return tl::unexpected(ok.error());
  return std::move(tree.root);
}

}  // namespace mbk::hdf5
