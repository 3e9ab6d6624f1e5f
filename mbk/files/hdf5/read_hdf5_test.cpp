#include "mbk/files/hdf5/read_hdf5.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
    EXPECT_THAT(read_bytes(nested(17)).error().message, HasSubstr("nested too deeply"));
  }
}

TEST(ReadHdf5, RefusesGroupsThatContainEachOther) {
  const std::string bytes = written(Writer::latest, [](hid_t file) {
    const Id group(H5Gcreate2(file, "g", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    for (const char* name : {"a", "b", "c"}) H5Lcreate_hard(file, "/", group, name, H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_FALSE(read_bytes(bytes));
}

TEST(ReadHdf5, CountsObjects) {
  const std::string bytes = written(Writer::latest, [](hid_t file) {
    for (const char* name : {"a", "b", "c"}) put_numbers(file, name, counted(2), {{2}});
  });
  ReadLimits limits = test::limits_for(bytes.size());
  limits.objects = 3;
  EXPECT_TRUE(read(std::as_bytes(std::span(bytes)), limits));
  limits.objects = 2;
  EXPECT_THAT(read(std::as_bytes(std::span(bytes)), limits).error().message, HasSubstr("more than 2 objects"));
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
  EXPECT_EQ(why("compound"), "of a compound type");
  EXPECT_EQ(why("complex"), "complex");
  EXPECT_EQ(why("opaque"), "of an opaque type");
  EXPECT_EQ(why("lists"), "of lists of varying length");
  EXPECT_EQ(why("array"), "of an array type");
  EXPECT_EQ(why("odd"), "of integers of an unusual size");
  EXPECT_EQ(why("never"), "without numbers: it was never written");
  EXPECT_EQ(why("soft"), "a link to elsewhere");
  EXPECT_EQ(why("external"), "a link to elsewhere");
  EXPECT_EQ(why("type"), "neither a group nor a dataset");
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
