#pragma once

// Files that the HDF5 library writes, in memory or in a folder of one test, as bytes.

#include <gtest/gtest.h>
#include <hdf5.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "mbk/files/hdf5/read_hdf5.h"

namespace mbk::hdf5::test {

/// An identifier that closes itself.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) { EXPECT_GE(id, 0); }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  ~Id() { close_(id_); }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// How the library writes: as its first versions did, as 1.8 did, as it does at its newest.
enum class Writer { earliest, v18, latest };
inline constexpr Writer kWriters[] = {Writer::earliest, Writer::v18, Writer::latest};

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The bytes of a file that `fill` fills.
inline std::string written(Writer writer, const std::function<void(hid_t file)>& fill, hsize_t user_block = 0) {
  std::string folder = (std::filesystem::temp_directory_path() / "mbk_hdf5_XXXXXX").string();
  EXPECT_NE(::mkdtemp(folder.data()), nullptr);
  const std::filesystem::path path = std::filesystem::path(folder) / "file.h5";
  {
    const Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    const auto low = writer == Writer::earliest ? H5F_LIBVER_EARLIEST
                     : writer == Writer::v18    ? H5F_LIBVER_V18
                                                : H5F_LIBVER_LATEST;
    const auto high = writer == Writer::v18 ? H5F_LIBVER_V18 : H5F_LIBVER_LATEST;
    H5Pset_libver_bounds(access, low, high);
    const Id create(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_userblock(create, user_block);
    const Id file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, create, access), H5Fclose);
    fill(file);
  }
  std::string bytes = bytes_of(path);
  std::filesystem::remove_all(folder);
  return bytes;
}

/// The most that the tests allow.
inline ReadLimits limits_for(std::size_t size) {
  return {.bytes = 1100 * size + (1 << 20)};
}

/// What reading says of the first thing that is damaged in a tree; nothing where all of it is sound.
inline std::optional<Error> damage_of(const Group& group, const std::string& path = "") {
  const auto error = [](const std::string& what, const std::string& where) {
    return Error{ErrorKind::data, what, "copy it again", where};
  };
  if (!group.damage.empty()) return error(group.damage, path.empty() ? "/" : path);
  for (const auto& [name, dataset] : group.datasets) {
    const auto* const unread = std::get_if<Unread>(&dataset.value.data);
    if (unread != nullptr && unread->damaged) return error(unread->what, path + "/" + name);
  }
  for (const auto& [name, inner] : group.groups) {
    if (auto damage = damage_of(inner, path + "/" + name)) return damage;
  }
  return std::nullopt;
}

/// Reads a file in which nothing may be damaged.
inline Result<Group> read_bytes(std::string_view bytes) {
  auto root = read(std::as_bytes(std::span(bytes)), limits_for(bytes.size()));
  if (!root) return root;
  if (auto damage = damage_of(*root)) return tl::unexpected(*damage);
  return root;
}

inline Group good(std::string_view bytes) {
  auto root = read_bytes(bytes);
  EXPECT_TRUE(root) << root.error().line();
  return root ? std::move(*root) : Group{};
}

inline Vector counted(Index count) {
  return Vector::LinSpaced(count, 0.0, static_cast<double>(count - 1));
}

/// What a dataset or attribute is made of.
struct Shape {
  std::vector<hsize_t> size;
  std::vector<hsize_t> most = {};   ///< empty: it cannot grow
  std::vector<hsize_t> chunk = {};  ///< empty: contiguous
};

inline hid_t make_space(const Shape& shape) {
  if (shape.size.empty()) return H5Screate(H5S_SCALAR);
  return H5Screate_simple(static_cast<int>(shape.size.size()), shape.size.data(),
                          shape.most.empty() ? nullptr : shape.most.data());
}

/// Writes doubles, stored as `type`.
/// @param pack  sets filters and the like
inline void put_numbers(hid_t place, const char* name, const Vector& values, const Shape& shape,
                        hid_t type = H5T_IEEE_F64LE, const std::function<void(hid_t properties)>& pack = {}) {
  const Id space(make_space(shape), H5Sclose);
  const Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (!shape.chunk.empty()) H5Pset_chunk(properties, static_cast<int>(shape.chunk.size()), shape.chunk.data());
  if (pack) pack(properties);
  const Id set(H5Dcreate2(place, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
  EXPECT_GE(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
}

inline const Vector& numbers(const Value& value) {
  return std::get<Numbers>(value.data).values;
}

}  // namespace mbk::hdf5::test
