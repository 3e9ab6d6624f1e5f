#include "mbk/files/hdf5/chunks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mbk/files/hdf5/test_hdf5_files.h"

namespace mbk::hdf5 {
namespace {

using test::counted;
using test::good;
using test::Id;
using test::numbers;
using test::put_numbers;
using test::read_bytes;
using test::Shape;
using test::Writer;
using test::written;
using testing::HasSubstr;

constexpr hsize_t kUnlimited = H5S_UNLIMITED;

void deflate(hid_t properties) {
  H5Pset_deflate(properties, 4);
}

void everything(hid_t properties) {
  H5Pset_shuffle(properties);
  H5Pset_deflate(properties, 4);
  H5Pset_fletcher32(properties);
}

void checksum_first(hid_t properties) {
  H5Pset_fletcher32(properties);
  H5Pset_deflate(properties, 1);
}

/// Writes a dataset in every way of packing and by every writer, and reads it back.
void expect_round_trip(const Shape& shape) {
  Index count = 1;
  for (const hsize_t n : shape.size) count *= static_cast<Index>(n);
  const Vector values = counted(count);
  for (const Writer writer : test::kWriters) {
    int way = 0;
    for (void (*pack)(hid_t) : {static_cast<void (*)(hid_t)>(nullptr), deflate, everything, checksum_first}) {
      const Group root =
          good(written(writer, [&](hid_t file) { put_numbers(file, "x", values, shape, H5T_IEEE_F64LE, pack); }));
      ASSERT_TRUE(root.datasets.contains("x"));
      EXPECT_EQ(numbers(root.datasets.at("x").value), values)
          << "writer " << static_cast<int>(writer) << ", packed in way " << way;
      ++way;
    }
  }
}

TEST(ReadChunks, OfADatasetThatCannotGrow) {
  expect_round_trip({{10}, {}, {3}});
  expect_round_trip({{1000}, {}, {53}});  // of which three times sixteen elements are put in order together
  expect_round_trip({{9, 7}, {}, {2, 3}});
  expect_round_trip({{5, 6, 7}, {}, {2, 3, 4}});
}

TEST(ReadChunks, OfADatasetThatIsOneChunk) {
  expect_round_trip({{9, 7}, {}, {9, 7}});
}

TEST(ReadChunks, OfADatasetThatCanGrowToALimit) {
  expect_round_trip({{9, 7}, {20, 31}, {2, 3}});
}

TEST(ReadChunks, OfADatasetThatCanGrowInOneDimension) {
  expect_round_trip({{9, 7}, {kUnlimited, 7}, {2, 3}});
  expect_round_trip({{9, 7}, {9, kUnlimited}, {2, 3}});
  expect_round_trip({{4, 5, 6}, {4, kUnlimited, 11}, {1, 2, 4}});
}

TEST(ReadChunks, OfADatasetThatCanGrowInTwoDimensions) {
  expect_round_trip({{9, 7}, {kUnlimited, kUnlimited}, {2, 3}});
  expect_round_trip({{40, 70}, {kUnlimited, kUnlimited}, {1, 3}});
}

TEST(ReadChunks, ThatFillPagesAndSuperBlocksOfTheirIndex) {
  expect_round_trip({{1500}, {}, {1}});
  expect_round_trip({{3000}, {kUnlimited}, {1}});
  // Blocks of an index that can grow have pages only behind some 130,000 chunks.
  const Vector values = counted(160'000).unaryExpr([](double i) { return std::fmod(i, 127.0); });
  const Group root = good(written(Writer::latest, [&](hid_t file) {
    put_numbers(file, "x", values, {{160'000}, {kUnlimited}, {1}}, H5T_STD_I8LE);
  }));
  EXPECT_EQ(numbers(root.datasets.at("x").value), values);
}

TEST(ReadChunks, OfOneRowEach) {
  expect_round_trip({{50, 8}, {}, {1, 8}});
}

TEST(ReadChunks, ThatWereAllocatedAtOnce) {
  const Vector values = counted(63);
  for (const Writer writer : test::kWriters) {
    const Group root = good(written(writer, [&](hid_t file) {
      put_numbers(file, "x", values, {{9, 7}, {}, {2, 3}}, H5T_IEEE_F64LE,
                  [](hid_t properties) { H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY); });
    }));
    EXPECT_EQ(numbers(root.datasets.at("x").value), values);
  }
}

TEST(ReadChunks, WhoseEdgesAreNotPacked) {
  const Vector values = counted(63);
  const Group root = good(written(Writer::latest, [&](hid_t file) {
    put_numbers(file, "x", values, {{9, 7}, {kUnlimited, 7}, {2, 3}}, H5T_IEEE_F64LE, [](hid_t properties) {
      H5Pset_deflate(properties, 4);
      H5Pset_chunk_opts(properties, H5D_CHUNK_DONT_FILTER_PARTIAL_CHUNKS);
    });
  }));
  EXPECT_EQ(numbers(root.datasets.at("x").value), values);
}

TEST(ReadChunks, ReadsACompactDataset) {
  for (const Writer writer : test::kWriters) {
    const Group root = good(written(writer, [](hid_t file) {
      put_numbers(file, "x", counted(9), {{9}}, H5T_STD_I16BE,
                  [](hid_t properties) { H5Pset_layout(properties, H5D_COMPACT); });
    }));
    EXPECT_EQ(numbers(root.datasets.at("x").value), counted(9));
  }
}

TEST(ReadChunks, RefusesADatasetOfWhichAPartWasNeverWritten) {
  for (const Writer writer : test::kWriters) {
    const std::string bytes = written(writer, [](hid_t file) {
      const Id space(test::make_space({{10}, {kUnlimited}}), H5Sclose);
      const Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
      const hsize_t chunk = 2;
      H5Pset_chunk(properties, 1, &chunk);
      const Id set(H5Dcreate2(file, "x", H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
      const hsize_t start = 4;
      const hsize_t count = 2;
      const Id memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
      H5Sselect_hyperslab(space, H5S_SELECT_SET, &start, nullptr, &count, nullptr);
      const double values[] = {1, 2};
      H5Dwrite(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values);
    });
    const auto root = read_bytes(bytes);
    ASSERT_FALSE(root);
    EXPECT_THAT(root.error().line(), HasSubstr("/x"));
  }
}

TEST(ReadChunks, FollowsADatasetThatBecameShorter) {
  for (const Writer writer : test::kWriters) {
    const Group root = good(written(writer, [](hid_t file) {
      put_numbers(file, "x", counted(10), {{10}, {kUnlimited}, {2}});
      const Id set(H5Dopen2(file, "x", H5P_DEFAULT), H5Dclose);
      const hsize_t size = 5;
      H5Dset_extent(set, &size);
    }));
    EXPECT_EQ(numbers(root.datasets.at("x").value), counted(5));
  }
}

TEST(ReadChunks, VerifiesTheChecksumOfData) {
  std::string bytes = written(Writer::earliest, [](hid_t file) {
    put_numbers(file, "x", Vector::Constant(8, 1.2345), {{8}, {}, {8}}, H5T_IEEE_F64LE,
                [](hid_t properties) { H5Pset_fletcher32(properties); });
  });
  const double value = 1.2345;
  const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(&value), sizeof value));
  ASSERT_NE(at, bytes.npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  EXPECT_THAT(read_bytes(bytes).error().line(), AllOf(HasSubstr("/x"), HasSubstr("checksum")));
}

TEST(ReadChunks, NamesAFilterThatItDoesNotKnow) {
  const Group root = good(written(Writer::earliest, [](hid_t file) {
    put_numbers(file, "x", counted(9), {{9}, {}, {9}}, H5T_STD_I32LE,
                [](hid_t properties) { H5Pset_nbit(properties); });
  }));
  EXPECT_THAT(std::get<Unread>(root.datasets.at("x").value.data).what, HasSubstr("filter 5"));
}

}  // namespace
}  // namespace mbk::hdf5
