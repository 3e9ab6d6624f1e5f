#include "mbk/files/hdf5/read_hdf5.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <liblzf/lzf.h>

#include <cmath>
#include <thread>

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
using testing::ElementsAre;
using testing::HasSubstr;

std::string unread(const Value& value) {
  return std::get<Unread>(value.data).what;
}

TEST(ReadHdf5, FindsTheSuperblockBehindAUserBlock) {
  for (const Writer writer : test::kWriters) {
    for (const hsize_t user_block : {hsize_t{0}, hsize_t{512}, hsize_t{2048}}) {
      const std::string bytes = written(
          writer, [](hid_t file) { put_numbers(file, "x", counted(5), {{5}}); }, user_block);
      EXPECT_TRUE(looks_like_hdf5(std::as_bytes(std::span(bytes))));
      EXPECT_EQ(numbers(good(bytes).datasets.at("x").value), counted(5));
      // A user block that someone took away, or put before a file that had none.
      EXPECT_EQ(numbers(good(bytes.substr(user_block)).datasets.at("x").value), counted(5));
      if (user_block == 0) {
        EXPECT_EQ(numbers(good(std::string(1024, ' ') + bytes).datasets.at("x").value), counted(5));
      }
    }
  }
}

TEST(ReadHdf5, ReadsEveryOrdinaryNumber) {
  const std::pair<hid_t, Stored> types[] = {
      {H5T_IEEE_F64LE, Stored::float64}, {H5T_IEEE_F64BE, Stored::float64}, {H5T_IEEE_F32LE, Stored::float32},
      {H5T_IEEE_F32BE, Stored::float32}, {H5T_STD_I8LE, Stored::int8},      {H5T_STD_U8BE, Stored::uint8},
      {H5T_STD_I16LE, Stored::int16},    {H5T_STD_I16BE, Stored::int16},    {H5T_STD_U16LE, Stored::uint16},
      {H5T_STD_U16BE, Stored::uint16},   {H5T_STD_I32LE, Stored::int32},    {H5T_STD_I32BE, Stored::int32},
      {H5T_STD_U32LE, Stored::uint32},   {H5T_STD_U32BE, Stored::uint32},   {H5T_STD_I64LE, Stored::int64},
      {H5T_STD_I64BE, Stored::int64},    {H5T_STD_U64LE, Stored::uint64},   {H5T_STD_U64BE, Stored::uint64}};
  const Vector values = (Vector(4) << 0, 1, 100, 127).finished();
  for (const Writer writer : test::kWriters) {
    const Group root = good(written(writer, [&](hid_t file) {
      for (std::size_t i = 0; i < std::size(types); ++i) {
        put_numbers(file, std::to_string(i).c_str(), values, {{2, 2}}, types[i].first);
      }
      put_numbers(file, "negative", -values, {{4}}, H5T_STD_I16BE);
    }));
    for (std::size_t i = 0; i < std::size(types); ++i) {
      const Value& value = root.datasets.at(std::to_string(i)).value;
      EXPECT_EQ(numbers(value), values) << i;
      EXPECT_EQ(std::get<Numbers>(value.data).stored, types[i].second) << i;
      EXPECT_THAT(value.shape, ElementsAre(2, 2));
    }
    EXPECT_EQ(numbers(root.datasets.at("negative").value), -values);
  }
}

TEST(ReadHdf5, KeepsWhatDoublesLeaveOfWholeNumbers) {
  constexpr std::int64_t kOdd = (std::int64_t{1} << 60) + 1;
  const std::int64_t stored[] = {5, kOdd, -kOdd, kOdd - 1};
  for (const hid_t type : {H5T_STD_I64LE, H5T_STD_I64BE}) {
    const Group root = good(written(Writer::latest, [&](hid_t file) {
      const test::Id space(test::make_space({{4}}), H5Sclose);
      const test::Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
      const hsize_t chunk = 3;
      H5Pset_chunk(properties, 1, &chunk);
      const test::Id set(H5Dcreate2(file, "n", type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
      EXPECT_GE(H5Dwrite(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, stored), 0);
      put_numbers(file, "small", counted(4), {{4}}, type);
    }));
    const Rests& rests = std::get<Numbers>(root.datasets.at("n").value.data).rests;
    EXPECT_THAT((std::vector<int>{rests[0], rests[1], rests[2], rests[3]}), ElementsAre(0, 1, -1, 0));
    EXPECT_TRUE(std::get<Numbers>(root.datasets.at("small").value.data).rests.empty());
  }
}

TEST(ReadHdf5, KeepsDoublesBitForBit) {
  const Vector values =
      (Vector(5) << 0.1, -0.0, std::numeric_limits<double>::denorm_min(), HUGE_VAL, std::nan("")).finished();
  const Group root = good(written(Writer::latest, [&](hid_t file) {
    put_numbers(file, "little", values, {{5}});
    put_numbers(file, "big", values, {{5}}, H5T_IEEE_F64BE);
  }));
  for (const char* name : {"little", "big"}) {
    EXPECT_EQ(std::memcmp(numbers(root.datasets.at(name).value).data(), values.data(), 5 * sizeof(double)), 0) << name;
  }
}

TEST(ReadHdf5, ReadsHalfPrecisionAndEnumerations) {
  const Group root = good(written(Writer::earliest, [](hid_t file) {
    const Id half(H5Tcopy(H5T_IEEE_F32LE), H5Tclose);
    H5Tset_fields(half, 15, 10, 5, 0, 10);
    H5Tset_size(half, 2);
    H5Tset_ebias(half, 15);
    put_numbers(file, "half", (Vector(4) << 1.5, -2, 0x1p-24, 65504).finished(), {{4}}, half);
    const Id truth(H5Tenum_create(H5T_STD_I8LE), H5Tclose);
    for (const auto& [name, value] : {std::pair<const char*, signed char>{"FALSE", 0}, {"TRUE", 1}}) {
      H5Tenum_insert(truth, name, &value);
    }
    const Id space(test::make_space({{3}}), H5Sclose);
    const Id set(H5Dcreate2(file, "bool", truth, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    const signed char values[] = {1, 0, 1};
    H5Dwrite(set, truth, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  }));
  EXPECT_EQ(numbers(root.datasets.at("half").value), (Vector(4) << 1.5, -2, 0x1p-24, 65504).finished());
  EXPECT_EQ(numbers(root.datasets.at("bool").value), (Vector(3) << 1, 0, 1).finished());
}

void put_texts(hid_t file) {
  const Id space(test::make_space({{2}}), H5Sclose);
  const auto fixed = [&](const char* name, H5T_str_t padding, const char* bytes) {
    const Id type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, 4);
    H5Tset_strpad(type, padding);
    const Id set(H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes);
  };
  fixed("terminated", H5T_STR_NULLTERM, "ab\0\0cde\0");
  fixed("padded", H5T_STR_NULLPAD, "ab\0\0cdef");
  fixed("blanks", H5T_STR_SPACEPAD, "ab  cdef");
  const Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  const Id set(H5Dcreate2(file, "long", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  const std::string second(5000, 'x');
  const char* texts[] = {"Ánna", second.c_str()};
  H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts);
}

TEST(ReadHdf5, ReadsTextsOfFixedAndVariableLength) {
  for (const Writer writer : test::kWriters) {
    const Group root = good(written(writer, put_texts));
    const auto texts = [&](const char* name) { return std::get<Texts>(root.datasets.at(name).value.data); };
    EXPECT_THAT(texts("terminated"), ElementsAre("ab", "cde"));
    EXPECT_THAT(texts("padded"), ElementsAre("ab", "cdef"));
    EXPECT_THAT(texts("blanks"), ElementsAre("ab", "cdef"));
    EXPECT_THAT(texts("long"), ElementsAre("Ánna", std::string(5000, 'x')));
  }
}

TEST(ReadHdf5, SaysWhereReferencesLead) {
  const Group root = good(written(Writer::earliest, [](hid_t file) {
    const Id inner(H5Gcreate2(file, "#refs#", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    put_numbers(inner, "a", counted(3), {{3}});
    hobj_ref_t references[2] = {};
    H5Rcreate(&references[0], file, "/#refs#/a", H5R_OBJECT, -1);
    const Id space(test::make_space({{2}}), H5Sclose);
    const Id set(H5Dcreate2(file, "cell", H5T_STD_REF_OBJ, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    H5Dwrite(set, H5T_STD_REF_OBJ, H5S_ALL, H5S_ALL, H5P_DEFAULT, references);
  }));
  EXPECT_THAT(std::get<References>(root.datasets.at("cell").value.data).paths, ElementsAre("/#refs#/a", ""));
}

TEST(ReadHdf5, ReadsManyLinksAndManyAttributes) {
  constexpr int kMany = 500;  // beyond what object headers hold: heaps and B-trees
  for (const Writer writer : test::kWriters) {
    const Group root = good(written(writer, [](hid_t file) {
      const Id space(H5Screate(H5S_SCALAR), H5Sclose);
      for (int i = 0; i < kMany; ++i) {
        const double value = i;
        put_numbers(file, ("set " + std::to_string(i)).c_str(), Vector::Constant(1, value), {});
        const Id attribute(H5Acreate2(file, ("attribute " + std::to_string(i)).c_str(), H5T_IEEE_F64LE, space,
                                      H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
        H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value);
      }
    }));
    ASSERT_EQ(root.datasets.size(), static_cast<std::size_t>(kMany));
    ASSERT_EQ(root.attributes.size(), static_cast<std::size_t>(kMany));
    for (int i = 0; i < kMany; ++i) {
      EXPECT_EQ(numbers(root.datasets.at("set " + std::to_string(i)).value)[0], i);
      EXPECT_EQ(numbers(root.attributes.at("attribute " + std::to_string(i)))[0], i);
      EXPECT_TRUE(root.attributes.at("attribute " + std::to_string(i)).shape.empty());
    }
  }
}

TEST(ReadHdf5, ReadsAnAttributeTooLargeForTheHeaderOfItsObject) {
  const Vector values = counted(20'000);
  const Group root = good(written(Writer::latest, [&](hid_t file) {
    const Id space(test::make_space({{20'000}}), H5Sclose);
    const Id attribute(H5Acreate2(file, "large", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data());
  }));
  EXPECT_EQ(numbers(root.attributes.at("large")), values);
}

TEST(ReadHdf5, ReadsGroupsWithinGroups) {
  for (const Writer writer : test::kWriters) {
    const auto nested = [&](int depth) {
      return written(writer, [&](hid_t file) {
        std::string path;
        for (int i = 0; i < depth; ++i) {
          path += "/g";
          H5Gclose(H5Gcreate2(file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
        }
        put_numbers(file, (path + "/x").c_str(), counted(2), {{2}});
      });
    };
    const Group root = good(nested(2));
    EXPECT_EQ(numbers(root.groups.at("g").groups.at("g").datasets.at("x").value), counted(2));
    EXPECT_TRUE(read_bytes(nested(16)));
    EXPECT_THAT(read_bytes(nested(17)).error().message, HasSubstr("group"));
  }
}

TEST(ReadHdf5, NamesGroupsThatContainEachOther) {
  const std::string bytes = written(Writer::latest, [](hid_t file) {
    const Id group(H5Gcreate2(file, "g", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    for (const char* name : {"a", "b", "c"}) H5Lcreate_hard(file, "/", group, name, H5P_DEFAULT, H5P_DEFAULT);
  });
  const Group root = good(bytes);
  const Group& group = root.groups.at("g");
  EXPECT_TRUE(group.groups.empty());
  for (const char* name : {"a", "b", "c"}) {
    EXPECT_THAT(unread(group.datasets.at(name).value), HasSubstr("link"));
  }
}

TEST(ReadHdf5, FollowsLinksWithinTheFile) {
  for (const Writer writer : test::kWriters) {
    const Group root = good(written(writer, [](hid_t file) {
      const Id group(H5Gcreate2(file, "raw", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
      put_numbers(group, "x", counted(3), {{3}});
      H5Lcreate_hard(group, "x", file, "hard", H5P_DEFAULT, H5P_DEFAULT);
      H5Lcreate_soft("/raw/x", file, "absolute", H5P_DEFAULT, H5P_DEFAULT);
      H5Lcreate_soft("./raw//x", file, "relative", H5P_DEFAULT, H5P_DEFAULT);
      H5Lcreate_soft("x", group, "beside", H5P_DEFAULT, H5P_DEFAULT);
      H5Lcreate_soft("/relative", file, "chain", H5P_DEFAULT, H5P_DEFAULT);
      H5Lcreate_soft("raw", file, "folder", H5P_DEFAULT, H5P_DEFAULT);
      H5Lcreate_soft("/raw/none", file, "dangling", H5P_DEFAULT, H5P_DEFAULT);
      H5Lcreate_soft("itself", file, "itself", H5P_DEFAULT, H5P_DEFAULT);
      H5Lcreate_soft("/", group, "up", H5P_DEFAULT, H5P_DEFAULT);
      H5Lcreate_external("other.h5", "/x", file, "external", H5P_DEFAULT, H5P_DEFAULT);
    }));
    for (const char* name : {"hard", "absolute", "relative", "chain"}) {
      EXPECT_EQ(numbers(root.datasets.at(name).value), counted(3)) << name;
    }
    EXPECT_EQ(numbers(root.groups.at("raw").datasets.at("beside").value), counted(3));
    EXPECT_EQ(numbers(root.groups.at("folder").datasets.at("x").value), counted(3));
    EXPECT_THAT(unread(root.datasets.at("dangling").value), HasSubstr("'/raw/none'"));
    EXPECT_THAT(unread(root.datasets.at("itself").value), HasSubstr("'itself'"));
    EXPECT_THAT(unread(root.groups.at("raw").datasets.at("up").value), HasSubstr("group"));
    EXPECT_THAT(unread(root.datasets.at("external").value), AllOf(HasSubstr("'/x'"), HasSubstr("'other.h5'")));
  }
}

TEST(ReadHdf5, DoesNotReadAnObjectAgainForEachOfManyNames) {
  const Group root = good(written(Writer::latest, [](hid_t file) {
    put_numbers(file, "big", counted(20'000), {{20'000}});
    for (int i = 0; i < 20; ++i) {
      H5Lcreate_hard(file, "big", file, ("name" + std::to_string(i)).c_str(), H5P_DEFAULT, H5P_DEFAULT);
    }
  }));
  int read = 0;
  for (const auto& [name, dataset] : root.datasets) {
    if (std::holds_alternative<Numbers>(dataset.value.data)) {
      ++read;
    } else {
      EXPECT_THAT(unread(dataset.value), testing::AnyOf(HasSubstr("'/big'"), HasSubstr("'/name")));
    }
  }
  EXPECT_GE(read, 2);
  EXPECT_LE(read, 4);
}

/// The row of a robot's log.
struct Row {
  double time;
  float q[3];
  std::int16_t state;
  char mode[4];
};

hid_t row_type() {
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Row));
  const hsize_t three = 3;
  const Id array(H5Tarray_create2(H5T_NATIVE_FLOAT, 1, &three), H5Tclose);
  const Id text(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(text, 4);
  const Id state(H5Tenum_create(H5T_NATIVE_INT16), H5Tclose);
  for (const auto& [name, value] : {std::pair<const char*, std::int16_t>{"IDLE", 0}, {"A_LONGER_NAME", 7}}) {
    H5Tenum_insert(state, name, &value);
  }
  const Id inner(H5Tcreate(H5T_COMPOUND, sizeof(float) * 3), H5Tclose);
  H5Tinsert(inner, "q", 0, array);
  H5Tinsert(type, "time", HOFFSET(Row, time), H5T_NATIVE_DOUBLE);
  H5Tinsert(type, "state", HOFFSET(Row, state), state);
  H5Tinsert(type, "mode", HOFFSET(Row, mode), text);
  H5Tinsert(type, "arm", HOFFSET(Row, q), inner);
  return type;
}

void put_table(hid_t file, const Shape& shape, bool pack) {
  const Id type(row_type(), H5Tclose);
  const Id space(test::make_space(shape), H5Sclose);
  const Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (!shape.chunk.empty()) H5Pset_chunk(properties, static_cast<int>(shape.chunk.size()), shape.chunk.data());
  if (pack) {
    H5Pset_shuffle(properties);
    H5Pset_deflate(properties, 4);
  }
  const Id set(H5Dcreate2(file, "log", type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
  std::vector<Row> rows(shape.size[0]);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto f = static_cast<float>(k);
    rows[k] = {0.25 * static_cast<double>(k), {f, f + 100, f + 200}, static_cast<std::int16_t>(k % 2 * 7), "on"};
  }
  EXPECT_GE(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()), 0);
  const Id unit(H5Screate(H5S_SCALAR), H5Sclose);
  const double rate = 4.0;
  const Id attribute(H5Acreate2(set, "rate", H5T_IEEE_F64LE, unit, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  H5Awrite(attribute, H5T_NATIVE_DOUBLE, &rate);
}

TEST(ReadHdf5, ReadsTablesColumnByColumn) {
  for (const Writer writer : test::kWriters) {
    for (const Shape& shape : {Shape{{50}}, Shape{{50}, {H5S_UNLIMITED}, {7}}}) {
      const Group root = good(written(writer, [&](hid_t file) { put_table(file, shape, !shape.chunk.empty()); }));
      const Group& log = root.groups.at("log");
      EXPECT_THAT(log.columns, ElementsAre("time", "state", "mode", "arm"));
      EXPECT_EQ(numbers(log.datasets.at("time").value), 0.25 * counted(50));
      EXPECT_EQ(numbers(log.datasets.at("state").value)[49], 7);
      EXPECT_EQ(std::get<Texts>(log.datasets.at("mode").value.data).at(49), "on");
      const Value& q = log.groups.at("arm").datasets.at("q").value;
      EXPECT_THAT(q.shape, ElementsAre(50, 3));
      EXPECT_EQ(numbers(q)[3 * 49 + 2], 249);
      EXPECT_EQ(numbers(log.attributes.at("rate"))[0], 4.0);
    }
  }
}

TEST(ReadHdf5, ReadsArraysInElements) {
  const Group root = good(written(Writer::earliest, [](hid_t file) {
    const hsize_t sides[] = {2, 3};
    const Id type(H5Tarray_create2(H5T_NATIVE_DOUBLE, 2, sides), H5Tclose);
    const Id space(test::make_space({{4}}), H5Sclose);
    const Id set(H5Dcreate2(file, "x", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    EXPECT_GE(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, counted(24).data()), 0);
  }));
  EXPECT_THAT(root.datasets.at("x").value.shape, ElementsAre(4, 2, 3));
  EXPECT_EQ(numbers(root.datasets.at("x").value), counted(24));
}

TEST(ReadHdf5, ReadsWhatLzfPacked) {
  const Vector values = (counted(4000) / 16).array().floor();  // that repeats
  std::string packed(32'000, '\0');
  packed.resize(lzf_compress(values.data(), 32'000, packed.data(), 31'000));
  ASSERT_GT(packed.size(), 0u);
  const auto file_of = [&](const std::string& chunk, unsigned skipped) {
    return written(Writer::earliest, [&](hid_t file) {
      const hsize_t size = 4000, start = 0;
      const Id space(test::make_space({{size}}), H5Sclose);
      const Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
      H5Pset_chunk(properties, 1, &size);
      const unsigned options[] = {4, 0x0105, 32'000};
      H5Pset_filter(properties, 32000, H5Z_FLAG_OPTIONAL, 3, options);
      const Id set(H5Dcreate2(file, "x", H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
      EXPECT_GE(H5Dwrite_chunk(set, H5P_DEFAULT, skipped, &start, chunk.size(), chunk.data()), 0);
    });
  };
  EXPECT_EQ(numbers(good(file_of(packed, 0)).datasets.at("x").value), values);
  const std::string plain(reinterpret_cast<const char*>(values.data()), 32'000);
  EXPECT_EQ(numbers(good(file_of(plain, 1)).datasets.at("x").value), values);
  EXPECT_THAT(read_bytes(file_of(packed.substr(0, packed.size() / 2), 0)).error().message, HasSubstr("chunk"));
  EXPECT_THAT(read_bytes(file_of(packed + packed, 0)).error().message, HasSubstr("chunk"));
}

TEST(ReadHdf5, CountsObjects) {
  const std::string bytes = written(Writer::latest, [](hid_t file) {
    for (const char* name : {"a", "b", "c"}) put_numbers(file, name, counted(2), {{2}});
  });
  ReadLimits limits = test::limits_for(bytes.size());
  limits.objects = 3;
  EXPECT_TRUE(read(std::as_bytes(std::span(bytes)), limits));
  limits.objects = 2;
  EXPECT_THAT(read(std::as_bytes(std::span(bytes)), limits).error().message, HasSubstr("2 objects"));
}

TEST(ReadHdf5, NamesWhatItDoesNotRead) {
  const Group root = good(written(Writer::latest, [](hid_t file) {
    const Id space(test::make_space({{2}}), H5Sclose);
    const auto set = [&](const char* name, hid_t type) {
      const Id made(H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    };
    const Id pair(H5Tcreate(H5T_COMPOUND, 16), H5Tclose);
    H5Tinsert(pair, "one", 0, H5T_IEEE_F64LE);
    H5Tinsert(pair, "two", 8, H5T_IEEE_F64LE);
    set("compound", pair);
    const Id complex(H5Tcreate(H5T_COMPOUND, 16), H5Tclose);
    H5Tinsert(complex, "real", 0, H5T_IEEE_F64LE);
    H5Tinsert(complex, "imag", 8, H5T_IEEE_F64LE);
    set("complex", complex);
    const Id opaque(H5Tcreate(H5T_OPAQUE, 4), H5Tclose);
    set("opaque", opaque);
    const Id lists(H5Tvlen_create(H5T_IEEE_F64LE), H5Tclose);
    set("lists", lists);
    const hsize_t two = 2;
    const Id array(H5Tarray_create2(H5T_IEEE_F64LE, 1, &two), H5Tclose);
    set("array", array);
    const Id odd(H5Tcopy(H5T_STD_I16LE), H5Tclose);
    H5Tset_precision(odd, 12);
    set("odd", odd);
    set("never", H5T_IEEE_F64LE);
    H5Lcreate_soft("/never", file, "soft", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_external("other.h5", "/x", file, "external", H5P_DEFAULT, H5P_DEFAULT);
    H5Tcommit2(file, "type", pair, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  }));
  const auto why = [&](const char* name) { return unread(root.datasets.at(name).value); };
  EXPECT_THAT(why("compound"), HasSubstr("never written"));
  EXPECT_THAT(why("complex"), HasSubstr("complex"));
  EXPECT_THAT(why("opaque"), HasSubstr("opaque"));
  EXPECT_THAT(why("lists"), HasSubstr("list"));
  EXPECT_THAT(why("array"), HasSubstr("never written"));
  EXPECT_THAT(why("odd"), HasSubstr("integer"));
  EXPECT_THAT(why("never"), HasSubstr("never written"));
  EXPECT_THAT(why("soft"), HasSubstr("never written"));
  EXPECT_THAT(why("external"), AllOf(HasSubstr("'/x'"), HasSubstr("'other.h5'")));
  EXPECT_THAT(why("type"), HasSubstr("dataset"));
}

TEST(ReadHdf5, ReadsDatasetsOfANamedType) {
  const Group root = good(written(Writer::latest, [](hid_t file) {
    const Id type(H5Tcopy(H5T_IEEE_F32BE), H5Tclose);
    H5Tcommit2(file, "type", type, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    put_numbers(file, "x", counted(3), {{3}}, type);
  }));
  EXPECT_EQ(numbers(root.datasets.at("x").value), counted(3));
}

TEST(ReadHdf5, ReadsEmptyAndSingleValues) {
  const Group root = good(written(Writer::latest, [](hid_t file) {
    put_numbers(file, "single", Vector::Constant(1, 7.0), {});
    put_numbers(file, "empty", Vector(), {{0, 3}});
    const Id space(H5Screate(H5S_NULL), H5Sclose);
    H5Dclose(H5Dcreate2(file, "null", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  }));
  EXPECT_TRUE(root.datasets.at("single").value.shape.empty());
  EXPECT_EQ(numbers(root.datasets.at("single").value)[0], 7.0);
  EXPECT_THAT(root.datasets.at("empty").value.shape, ElementsAre(0, 3));
  EXPECT_EQ(numbers(root.datasets.at("null").value).size(), 0);
}

TEST(ReadHdf5, RefusesAFileThatItsWriterLeftOpen) {
  std::string bytes = written(Writer::latest, [](hid_t file) { put_numbers(file, "x", counted(3), {{3}}); });
  bytes[11] = '\x01';               // the flag of a writer
  EXPECT_FALSE(read_bytes(bytes));  // and the checksum with it
}

TEST(ReadHdf5, IsSafeInSeveralThreads) {
  const std::string bytes = written(Writer::latest, put_texts);
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) threads.emplace_back([&] { EXPECT_EQ(good(bytes).datasets.size(), 4u); });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace mbk::hdf5
