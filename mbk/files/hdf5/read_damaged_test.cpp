#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "mbk/files/hdf5/checksum.h"
#include "mbk/files/hdf5/test_hdf5_files.h"

namespace mbk::hdf5 {
namespace {

using test::counted;
using test::Id;
using test::put_numbers;
using test::read_bytes;
using test::Writer;
using test::written;
using testing::HasSubstr;

/// A small file with a little of everything.
std::string little_of_everything(Writer writer) {
  return written(writer, [](hid_t file) {
    const auto pack = [](hid_t properties) {
      H5Pset_shuffle(properties);
      H5Pset_deflate(properties, 1);
      H5Pset_fletcher32(properties);
    };
    const Id group(H5Gcreate2(file, "g", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    put_numbers(group, "fixed", counted(63), {{9, 7}, {}, {4, 3}}, H5T_IEEE_F64LE, pack);
    put_numbers(file, "one", counted(30), {{30}, {H5S_UNLIMITED}, {1}});
    put_numbers(file, "two", counted(12), {{3, 4}, {H5S_UNLIMITED, H5S_UNLIMITED}, {1, 2}}, H5T_STD_I16BE, pack);
    const Id space(test::make_space({{2}}), H5Sclose);
    const Id type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, H5T_VARIABLE);
    const char* texts[] = {"onset", "offset"};
    for (int i = 0; i < 12; ++i) {
      const Id attribute(H5Acreate2(file, ("a" + std::to_string(i)).c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
      H5Awrite(attribute, type, texts);
    }
  });
}

/// Memory of the tree itself, without what maps and strings take beside.
std::uint64_t numbers_in(const Group& group) {
  std::uint64_t count = 0;
  for (const auto& [name, dataset] : group.datasets) {
    if (const auto* const numbers = std::get_if<Numbers>(&dataset.value.data)) {
      count += static_cast<std::uint64_t>(numbers->values.size());
    }
  }
  for (const auto& [name, inner] : group.groups) count += numbers_in(inner);
  return count;
}

TEST(ReadDamagedHdf5, RefusesAFileCutAnywhere) {
  for (const Writer writer : test::kWriters) {
    const std::string whole = little_of_everything(writer);
    ASSERT_TRUE(read_bytes(whole));
    for (std::size_t n = 0; n < whole.size(); ++n) {
      // Bytes of its own: a read beyond them is one that the address sanitizer sees.
      const std::vector<char> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));
      ASSERT_FALSE(read_bytes({cut.data(), cut.size()})) << "cut to " << n;
    }
    EXPECT_THAT(read_bytes(std::string_view(whole).substr(0, whole.size() - 1)).error().message,
                HasSubstr(std::to_string(whole.size()) + " bytes"));
  }
}

TEST(ReadDamagedHdf5, SurvivesRandomBytes) {
  std::mt19937 random(20130603);
  int read_well = 0;
  for (const Writer writer : test::kWriters) {
    const std::string whole = little_of_everything(writer);
    for (int i = 0; i < 8000; ++i) {
      std::vector<char> bytes(whole.begin(), whole.end());
      for (std::size_t changes = 1 + random() % 3; changes > 0; --changes) {
        bytes[random() % bytes.size()] = static_cast<char>(random() % 3 == 0 ? 0xFF : random());
      }
      SCOPED_TRACE(i);
      const auto root = read_bytes({bytes.data(), bytes.size()});
      if (!root) {
        ASSERT_EQ(root.error().kind, ErrorKind::data);
        ASSERT_FALSE(root.error().message.empty());
        continue;
      }
      ++read_well;
      ASSERT_LE(8 * numbers_in(*root), test::limits_for(bytes.size()).bytes);
    }
  }
  EXPECT_GT(read_well, 0);  // changes to numbers, and to what is not used
}

TEST(ReadDamagedHdf5, SeesDamageToStructuresThatHaveAChecksum) {
  const std::string whole = little_of_everything(Writer::latest);
  for (const std::string_view signature : {"OHDR", "BTHD", "BTLF", "FRHP", "FHDB", "FAHD", "FADB", "EAHD", "EAIB"}) {
    const std::size_t at = whole.find(signature);
    ASSERT_NE(at, whole.npos) << signature;
    std::string bytes = whole;
    bytes[at + 6] = static_cast<char>(bytes[at + 6] ^ 0x40);
    const auto root = read_bytes(bytes);
    ASSERT_FALSE(root) << signature;
    EXPECT_EQ(root.error().kind, ErrorKind::data) << signature;
  }
}

TEST(ReadDamagedHdf5, DoesNotBelieveDimensionsThatTheFileCannotHold) {
  std::string bytes = written(Writer::earliest, [](hid_t file) { put_numbers(file, "x", counted(11), {{11}}); });
  const std::uint64_t eleven = 11;
  const std::string field(reinterpret_cast<const char*>(&eleven), sizeof eleven);
  const std::size_t at = bytes.find(field);  // the dataspace: the dimension, then its limit
  ASSERT_NE(at, bytes.npos);
  for (const std::uint64_t claim : {std::uint64_t{12}, std::uint64_t{1} << 40, ~std::uint64_t{0} - 1}) {
    std::string damaged = bytes;
    damaged.replace(at, 8, reinterpret_cast<const char*>(&claim), 8);
    damaged.replace(at + 8, 8, reinterpret_cast<const char*>(&claim), 8);
    const auto root = read_bytes(damaged);
    ASSERT_FALSE(root) << claim;
    EXPECT_THAT(root.error().where, HasSubstr("/x"));
  }
}

TEST(ReadDamagedHdf5, SaysOfALayoutOfNoKnownClassThatItIsBroken) {
  std::string bytes = written(Writer::earliest, [](hid_t file) { put_numbers(file, "x", counted(9), {{9}}); });
  const std::uint64_t size = 9 * sizeof(double);
  const std::string field(reinterpret_cast<const char*>(&size), sizeof size);
  std::size_t at = bytes.find("\3\1");  // version and class: contiguous; then address and size
  while (at != bytes.npos && bytes.compare(at + 10, field.size(), field) != 0) at = bytes.find("\3\1", at + 1);
  ASSERT_NE(at, bytes.npos);
  bytes[at + 1] = 9;
  const auto root = read_bytes(bytes);
  ASSERT_FALSE(root);
  EXPECT_THAT(root.error().where, HasSubstr("/x"));
  EXPECT_THAT(root.error().message, HasSubstr("layout"));
}

TEST(ReadDamagedHdf5, KeepsToTheMemoryThatIsAllowed) {
  const std::string bytes = written(Writer::earliest, [](hid_t file) {
    put_numbers(file, "x", Vector::Zero(100'000), {{100'000}, {}, {100'000}}, H5T_IEEE_F64LE,
                [](hid_t properties) { H5Pset_deflate(properties, 9); });
  });
  ReadLimits limits = test::limits_for(bytes.size());
  EXPECT_TRUE(read(std::as_bytes(std::span(bytes)), limits));
  limits.bytes = 800'000 - 1;
  const auto root = read(std::as_bytes(std::span(bytes)), limits);
  ASSERT_TRUE(root);
  const auto damage = test::damage_of(*root);
  ASSERT_TRUE(damage);
  EXPECT_EQ(damage->where, "/x");
}

TEST(ReadDamagedHdf5, LosesNothingButWhatIsDamaged) {
  for (const Writer writer : test::kWriters) {
    const std::string whole = written(writer, [](hid_t file) {
      put_numbers(file, "a", Vector::Constant(8, 1.5), {{8}, {}, {8}}, H5T_IEEE_F64LE,
                  [](hid_t properties) { H5Pset_fletcher32(properties); });
      put_numbers(file, "b", counted(9), {{9}});
      const Id space(test::make_space({{20}}), H5Sclose);
      const Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
      const hsize_t chunk = 5, start = 0, count = 5;
      H5Pset_chunk(properties, 1, &chunk);
      const Id set(H5Dcreate2(file, "half", H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
      const Id memory(test::make_space({{5}}), H5Sclose);
      const Id part(H5Scopy(space), H5Sclose);
      H5Sselect_hyperslab(part, H5S_SELECT_SET, &start, nullptr, &count, nullptr);
      H5Dwrite(set, H5T_NATIVE_DOUBLE, memory, part, H5P_DEFAULT, counted(5).data());
    });
    std::string bytes = whole;
    const double value = 1.5;
    bytes[bytes.find(std::string(reinterpret_cast<const char*>(&value), sizeof value))] = 1;
    const auto root = read(std::as_bytes(std::span(bytes)), test::limits_for(bytes.size()));
    ASSERT_TRUE(root) << root.error().line();
    EXPECT_EQ(test::numbers(root->datasets.at("b").value), counted(9));
    const auto why = [&](const char* name) { return std::get<Unread>(root->datasets.at(name).value.data); };
    EXPECT_THAT(why("a").what, HasSubstr("checksum"));
    EXPECT_TRUE(why("a").damaged);
    EXPECT_TRUE(why("half").damaged);
  }
}

TEST(ReadDamagedHdf5, EndsInTimeWhereLinksMultiply) {
  const std::string bytes = written(Writer::latest, [](hid_t file) {  // 8 groups, each holding all of them
    std::vector<std::string> names;
    for (int i = 0; i < 8; ++i) names.push_back("g" + std::to_string(i));
    for (const std::string& name : names) {
      H5Gclose(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    }
    for (const std::string& outer : names) {
      for (const std::string& inner : names) {
        H5Lcreate_hard(file, inner.c_str(), file, (outer + "/" + inner).c_str(), H5P_DEFAULT, H5P_DEFAULT);
      }
    }
  });
  EXPECT_FALSE(read_bytes(bytes));  // 8^16 paths
}

}  // namespace
}  // namespace mbk::hdf5
