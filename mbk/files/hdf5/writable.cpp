#include "mbk/files/hdf5/writable.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "mbk/files/hdf5/stored_numbers.h"

namespace mbk::hdf5 {
namespace {

constexpr std::size_t kMaxAttributeBytes = 65'000;  ///< a message of an object header has at most 65,535
constexpr std::size_t kMaxAttributes = 60'000;      ///< of one object; its header counts to 65,535
constexpr std::size_t kMaxDimensions = 32;

std::string below(const std::string& path, const std::string& name) {
  return path == "/" ? path + name : path + "/" + name;
}

/// Looks at everything in a file before anything is written.
class Check {
 public:
  Result<void> group(const Group& group, const std::string& path) {
    paths_.insert(path);
    MBK_TRY(attributes(group.attributes, path));
    for (const auto& [name, child] : group.groups) {
      MBK_TRY(link(name, path));
      if (group.datasets.contains(name)) return bad_data("is both a group and a dataset", "", below(path, name));
      MBK_TRY(this->group(child, below(path, name)));
    }
    for (const auto& [name, dataset] : group.datasets) {
      const std::string full = below(path, name);
      MBK_TRY(link(name, path));
      paths_.insert(full);
      MBK_TRY(attributes(dataset.attributes, full));
      if (auto ok = value(dataset.value); !ok) return tl::unexpected(ok.error().in(full));
    }
    return {};
  }

  Result<void> references() const {
    const auto lost = std::ranges::find_if(referred_, [&](const auto& path) { return !paths_.contains(path); });
    if (lost == referred_.end()) return {};
    return bad_data(fmt::format("a reference points to '{}', which does not exist", *lost));
  }

 private:
  static Result<void> link(const std::string& name, const std::string& path) {
    if (!name.empty() && name != "." && name.find_first_of(std::string_view("/\0", 2)) == name.npos) return {};
    return bad_data(fmt::format("'{}' cannot be the name of an HDF5 object", name),
                    "use a name without '/' that is not '.'", path);
  }

  Result<void> attributes(const Attributes& all, const std::string& path) {
    if (all.size() > kMaxAttributes) {
      return bad_data(fmt::format("it has {} attributes; the maximum is {}", all.size(), kMaxAttributes), "", path);
    }
    for (const auto& [name, attribute] : all) {
      const std::string place = fmt::format("{}, attribute '{}'", path, name);
      if (name.empty() || name.find('\0') != name.npos) {
        return bad_data(fmt::format("'{}' cannot be the name of an attribute", name), "use a name of letters", path);
      }
      if (auto ok = value(attribute); !ok) return tl::unexpected(ok.error().in(place));
      if (const std::size_t bytes = size(name, attribute); bytes > kMaxAttributeBytes) {
        return bad_data(fmt::format("it has {} bytes; an attribute has at most {}", bytes, kMaxAttributeBytes),
                        "make it a dataset", place);
      }
    }
    return {};
  }

  /// Bytes of an attribute in the header of its object, never less than they are.
  static std::size_t size(const std::string& name, const Value& value) {
    std::size_t each = 16;
    if (const auto* numbers = std::get_if<Numbers>(&value.data)) each = size_of(numbers->stored);
    if (const auto* texts = std::get_if<Texts>(&value.data)) {
      for (const std::string& text : *texts) each = std::max(each, name.starts_with("MATLAB_") ? text.size() : 0);
    }
    return name.size() + count_of(value.shape) * each + 8 * value.shape.size() + 64;
  }

  Result<void> value(const Value& value) {
    if (value.shape.size() > kMaxDimensions) {
      return bad_data(fmt::format("it has {} dimensions; the maximum is {}", value.shape.size(), kMaxDimensions));
    }
    if (const auto* unread = std::get_if<Unread>(&value.data)) {
      return bad_data(fmt::format("is {}, which cannot be written", unread->what));
    }
    const std::uint64_t expected = count_of(value.shape);
    if (const auto* numbers = std::get_if<Numbers>(&value.data)) {
      MBK_TRY(counted(static_cast<std::uint64_t>(numbers->values.size()), expected));
      if (const auto misfit = first_misfit(*numbers)) {
        return bad_data(fmt::format("{} does not fit its storage type", *misfit));
      }
      return {};
    }
    if (const auto* texts = std::get_if<Texts>(&value.data)) {
      if (std::ranges::any_of(*texts, [](const auto& text) { return text.find('\0') != text.npos; })) {
        return bad_data("a text contains a null character", "remove it");
      }
      return counted(texts->size(), expected);
    }
    const auto& paths = std::get<References>(value.data).paths;
    for (const std::string& path : paths) {
      if (!path.empty()) referred_.push_back(path);
    }
    return counted(paths.size(), expected);
  }

  static Result<void> counted(std::uint64_t count, std::uint64_t expected) {
    if (count == expected) return {};
    return bad_data(fmt::format("there are {} values for a shape of {}", count, expected));
  }

  std::set<std::string> paths_;
  std::vector<std::string> referred_;
};

}  // namespace

std::uint64_t count_of(const std::vector<std::uint64_t>& shape) {
  std::uint64_t count = 1;
  for (const std::uint64_t length : shape) count *= length;
  return count;
}

Result<void> check_writable(const Group& root) {
  Check check;
  MBK_TRY(check.group(root, "/"));
  return check.references();
}

}  // namespace mbk::hdf5
