#pragma once

// The HDF5 library as an oracle of the tests.

#include <gtest/gtest.h>
#include <hdf5.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5::test {

/// Closes what the HDF5 library opened.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor)

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

inline const std::array<std::pair<Stored, hid_t>, 10>& stored_types() {
  static const std::array<std::pair<Stored, hid_t>, 10> types{{{Stored::float64, H5T_IEEE_F64LE},
                                                               {Stored::float32, H5T_IEEE_F32LE},
                                                               {Stored::int8, H5T_STD_I8LE},
                                                               {Stored::uint8, H5T_STD_U8LE},
                                                               {Stored::int16, H5T_STD_I16LE},
                                                               {Stored::uint16, H5T_STD_U16LE},
                                                               {Stored::int32, H5T_STD_I32LE},
                                                               {Stored::uint32, H5T_STD_U32LE},
                                                               {Stored::int64, H5T_STD_I64LE},
                                                               {Stored::uint64, H5T_STD_U64LE}}};
  return types;
}

/// The HDF5 library's own eyes: reads a file back into the tree that should have been written.
class Library {
 public:
  explicit Library(const std::string& bytes) {
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fapl_core(access, 1 << 20, 0);
    H5Pset_file_image(access, const_cast<char*>(bytes.data()), bytes.size());
    file_ = H5Fopen("image", H5F_ACC_RDONLY, access);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() {
    if (file_ >= 0) H5Fclose(file_);
  }
  [[nodiscard]] hid_t file() const { return file_; }

  [[nodiscard]] Group read() const { return group(Handle(H5Gopen2(file_, "/", H5P_DEFAULT), H5Gclose)); }

 private:
  static std::string name_of(hid_t group, hsize_t i) {
    std::string name(4096, '\0');
    const auto size = H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), 4096, H5P_DEFAULT);
    name.resize(static_cast<std::size_t>(size));
    return name;
  }

  Group group(hid_t id) const {
    Group read{attributes(id), {}, {}};
    H5G_info_t info{};
    EXPECT_GE(H5Gget_info(id, &info), 0);
    for (hsize_t i = 0; i < info.nlinks; ++i) {
      const std::string name = name_of(id, i);
      const Handle child(H5Oopen(id, name.c_str(), H5P_DEFAULT), H5Oclose);
      if (H5Iget_type(child) == H5I_GROUP) {
        read.groups[name] = group(child);
      } else {
        const Handle type(H5Dget_type(child), H5Tclose);
        const Handle space(H5Dget_space(child), H5Sclose);
        read.datasets[name] = {
            value(type, space,
                  [&](hid_t memory, void* to) { return H5Dread(child, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, to); }),
            attributes(child)};
      }
    }
    return read;
  }

  Attributes attributes(hid_t object) const {
    Attributes read;
    for (int i = 0; i < H5Aget_num_attrs(object); ++i) {
      const Handle attribute(
          H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, static_cast<hsize_t>(i), H5P_DEFAULT, H5P_DEFAULT),
          H5Aclose);
      std::string name(4096, '\0');
      name.resize(static_cast<std::size_t>(H5Aget_name(attribute, 4096, name.data())));
      const Handle type(H5Aget_type(attribute), H5Tclose);
      const Handle space(H5Aget_space(attribute), H5Sclose);
      read[name] = value(type, space, [&](hid_t memory, void* to) { return H5Aread(attribute, memory, to); });
    }
    return read;
  }

  template <class Read>
  Value value(hid_t type, hid_t space, const Read& read_into) const {
    Value value;
    std::vector<hsize_t> shape(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, shape.data(), nullptr);
    value.shape.assign(shape.begin(), shape.end());
    const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
    const auto read = [&](hid_t memory, void* to) { return count == 0 ? 0 : read_into(memory, to); };
    if (H5Tget_class(type) == H5T_REFERENCE) {
      std::vector<hobj_ref_t> references(count);
      EXPECT_GE(read(H5T_STD_REF_OBJ, references.data()), 0);
      References paths;
      for (const hobj_ref_t& reference : references) {
        std::string path(4096, '\0');
        const auto size = reference == 0 ? 0 : H5Rget_name(file_, H5R_OBJECT, &reference, path.data(), 4096);
        path.resize(static_cast<std::size_t>(size));
        paths.paths.push_back(path);
      }
      value.data = paths;
    } else if (H5Tget_class(type) == H5T_VLEN) {
      std::vector<hvl_t> sequences(count);
      EXPECT_GE(read(type, sequences.data()), 0);
      Texts letters;
      for (const hvl_t& one : sequences) letters.emplace_back(static_cast<const char*>(one.p), one.len);
      if (count > 0) H5Dvlen_reclaim(type, space, H5P_DEFAULT, sequences.data());
      value.data = letters;
    } else if (H5Tget_class(type) == H5T_STRING) {
      value.data = texts(type, count, space, read);
    } else {
      Numbers numbers{Vector(static_cast<Index>(count)), Stored::float64};
      for (const auto& [stored, library_type] : stored_types()) {
        if (H5Tequal(type, library_type) > 0) numbers.stored = stored;
      }
      EXPECT_GE(read(H5T_NATIVE_DOUBLE, numbers.values.data()), 0);
      value.data = numbers;
    }
    return value;
  }

  template <class Read>
  static Texts texts(hid_t type, std::size_t count, hid_t space, const Read& read) {
    Texts texts;
    if (H5Tis_variable_str(type) > 0) {
      EXPECT_EQ(H5Tget_cset(type), H5T_CSET_UTF8);
      std::vector<char*> found(count);
      EXPECT_GE(read(type, found.data()), 0);
      for (const char* text : found) texts.emplace_back(text);
      if (count > 0) H5Dvlen_reclaim(type, space, H5P_DEFAULT, found.data());
      return texts;
    }
    const std::size_t size = H5Tget_size(type);
    std::string found(count * size, '\0');
    EXPECT_GE(read(type, found.data()), 0);
    for (std::size_t i = 0; i < count; ++i) texts.emplace_back(found.substr(i * size, size).c_str());
    return texts;
  }

  hid_t file_ = -1;
};

}  // namespace mbk::hdf5::test
