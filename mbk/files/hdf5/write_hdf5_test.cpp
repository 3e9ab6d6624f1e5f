#include "mbk/files/hdf5/write_hdf5.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <utility>

#include "mbk/files/hdf5/read_hdf5.h"
#include "mbk/files/hdf5/test_library.h"

namespace mbk::hdf5 {
namespace {

using test::Handle;
using test::Library;
using test::stored_types;
using testing::HasSubstr;

void expect_same(const Value& read, const Value& written, const std::string& place) {
  EXPECT_EQ(read.shape, written.shape) << place;
  ASSERT_EQ(read.data.index(), written.data.index()) << place;
  if (const auto* numbers = std::get_if<Numbers>(&written.data)) {
    const auto& found = std::get<Numbers>(read.data);
    EXPECT_EQ(found.stored, numbers->stored) << place;
    ASSERT_EQ(found.values.size(), numbers->values.size()) << place;
    for (Index i = 0; i < found.values.size(); ++i) {
      const double one = found.values[i], other = numbers->values[i];
      if (std::isnan(one) && std::isnan(other)) continue;
      if (one != other || std::signbit(one) != std::signbit(other)) {
        FAIL() << place << " " << i << ": " << one << " for " << other;
      }
    }
  } else if (const auto* texts = std::get_if<Texts>(&written.data)) {
    EXPECT_EQ(std::get<Texts>(read.data), *texts) << place;
  } else {
    EXPECT_EQ(std::get<References>(read.data).paths, std::get<References>(written.data).paths) << place;
  }
}

void expect_same(const Attributes& read, const Attributes& written, const std::string& place) {
  ASSERT_EQ(read.size(), written.size()) << place;
  for (const auto& [name, value] : written) {
    ASSERT_TRUE(read.contains(name)) << place << " " << name;
    expect_same(read.at(name), value, place + " " + name);
  }
}

void expect_same(const Group& read, const Group& written, const std::string& place) {
  expect_same(read.attributes, written.attributes, place);
  ASSERT_EQ(read.datasets.size(), written.datasets.size()) << place;
  for (const auto& [name, dataset] : written.datasets) {
    ASSERT_TRUE(read.datasets.contains(name)) << place << "/" << name;
    expect_same(read.datasets.at(name).value, dataset.value, place + "/" + name);
    expect_same(read.datasets.at(name).attributes, dataset.attributes, place + "/" + name);
  }
  ASSERT_EQ(read.groups.size(), written.groups.size()) << place;
  for (const auto& [name, group] : written.groups) {
    ASSERT_TRUE(read.groups.contains(name)) << place << "/" << name;
    expect_same(read.groups.at(name), group, place + "/" + name);
  }
}

void expect_comes_back(const Group& written, std::string_view user_block = "") {
  const auto bytes = serialise(written, user_block);
  ASSERT_TRUE(bytes) << bytes.error().line();
  const Library library(*bytes);
  ASSERT_GE(library.file(), 0) << "the library does not open it";
  expect_same(library.read(), written, "");
  const auto read_back = read(std::as_bytes(std::span(*bytes)), {.bytes = std::uint64_t{1} << 30});
  ASSERT_TRUE(read_back) << read_back.error().line();
  expect_same(*read_back, written, "by our own reader: ");
}

Value numbers(std::vector<std::uint64_t> shape, Vector values, Stored stored = Stored::float64) {
  return {std::move(shape), Numbers{std::move(values), stored}};
}

Value texts(Texts all) {
  const std::uint64_t count = all.size();
  return {{count}, std::move(all)};
}

Value text(std::string one) {
  return {{}, Texts{std::move(one)}};
}

TEST(Serialise, AFileWithNothingInIt) {
  expect_comes_back({});
}

TEST(Serialise, NumbersOfEveryTypeAtTheirLimits) {
  Group root;
  const auto add = [&](const char* name, Stored stored, std::initializer_list<double> values) {
    Vector all(static_cast<Index>(values.size()));
    std::ranges::copy(values, all.begin());
    root.datasets[name] = {numbers({values.size()}, all, stored), {}};
    root.attributes[name] = numbers({values.size()}, all, stored);
  };
  const double infinity = std::numeric_limits<double>::infinity();
  add("float64", Stored::float64, {0.1, -0.0, 5e-324, 1.7976931348623157e308, infinity, -infinity, std::nan("")});
  add("float32", Stored::float32, {0.5, -0.0, 0x1p-149, 0x1.fffffep127, -infinity, std::nan("")});
  add("int8", Stored::int8, {-128, 127});
  add("uint8", Stored::uint8, {0, 255});
  add("int16", Stored::int16, {-32768, 32767});
  add("uint16", Stored::uint16, {0, 65535});
  add("int32", Stored::int32, {-2147483648.0, 2147483647.0});
  add("uint32", Stored::uint32, {0, 4294967295.0});
  add("int64", Stored::int64, {-0x1p63, 0x1p62});
  add("uint64", Stored::uint64, {0, 0x1p63});
  expect_comes_back(root);
}

TEST(Serialise, ShapesFromNoneToFourDimensions) {
  Group root;
  root.datasets["single"] = {numbers({}, Vector::Constant(1, 7)), {}};
  root.datasets["empty"] = {numbers({0}, Vector(0)), {}};
  root.datasets["empty 3×0"] = {numbers({3, 0}, Vector(0)), {}};
  root.datasets["four"] = {numbers({2, 3, 4, 5}, Vector::LinSpaced(120, 0, 119)), {}};
  root.attributes["empty"] = numbers({0}, Vector(0));
  expect_comes_back(root);
}

/// How the library says that a dataset is stored.
std::pair<H5D_layout_t, hsize_t> layout_of(const Library& library, const char* path) {
  const Handle dataset(H5Dopen2(library.file(), path, H5P_DEFAULT), H5Dclose);
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  return {H5Pget_layout(properties), H5Dget_storage_size(dataset)};
}

TEST(Serialise, PacksLargeNumbersWhereThatIsShorter) {
  Group root;
  const Vector smooth = Vector::LinSpaced(200'000, 0.0, 199.999);
  root.datasets["smooth"] = {numbers({200'000}, smooth), {}};
  std::mt19937_64 random(1);
  Vector noise(2000);
  for (double& value : noise) value = std::bit_cast<double>(random());
  root.datasets["noise"] = {numbers({2000}, noise.unaryExpr([](double v) { return std::isnan(v) ? 1.0 : v; })), {}};
  const auto bytes = serialise(root);
  ASSERT_TRUE(bytes);
  const Library library(*bytes);
  EXPECT_EQ(layout_of(library, "/smooth").first, H5D_CHUNKED);
  EXPECT_LT(layout_of(library, "/smooth").second, 8u * 200'000 / 2);
  EXPECT_EQ(layout_of(library, "/noise"), std::pair(H5D_CONTIGUOUS, hsize_t{16'000}));
  expect_comes_back(root);
}

TEST(Serialise, ManyChunksInSeveralDimensions) {
  Group root;
  const auto counted = [](Index size) { return Vector(Vector::LinSpaced(size, 0.0, static_cast<double>(size - 1))); };
  root.datasets["one"] = {numbers({17'000'000}, Vector::Zero(17'000'000), Stored::int8), {}};  // 65 chunks: two levels
  root.datasets["two"] = {numbers({30'001, 19}, counted(30'001 * 19)), {}};
  root.datasets["wide"] = {numbers({3, 70'000}, counted(210'000)), {}};
  root.datasets["deep"] = {numbers({5, 1, 7, 9000, 1}, counted(315'000)), {}};
  expect_comes_back(root);
}

TEST(Serialise, AnyNumberOfNames) {
  for (const int count : {1, 7, 8, 9, 255, 256, 257, 9000}) {
    Group root;
    for (int i = 0; i < count; ++i) {
      const std::string name = fmt::format("n{}", (i * 7919) % 100'003);
      if (i % 3 == 0) {
        root.groups[name];
      } else {
        root.datasets[name] = {numbers({}, Vector::Constant(1, i)), {}};
      }
    }
    SCOPED_TRACE(count);
    expect_comes_back(root);
  }
}

TEST(Serialise, TextsOfEveryLength) {
  Group root;
  root.attributes["plain"] = text("participant 7");
  root.attributes["Größe"] = text("Ánna 😀");
  root.attributes["empty"] = text("");
  root.attributes["long"] = text(std::string(300'000, 'x'));
  root.attributes["several"] = texts({"", "a", std::string(70'000, 'y'), "ü"});
  root.attributes["MATLAB_class"] = text("double");
  root.attributes["MATLAB_many"] = texts({"a", "bcd", ""});
  Texts many;
  for (int i = 0; i < 20'000; ++i) many.push_back(fmt::format("event {}", i));
  root.datasets["many"] = {texts(many), {}};
  root.datasets["none"] = {texts({}), {}};
  root.datasets["single"] = {text("one"), {{"unit", text("m")}}};
  expect_comes_back(root);
}

TEST(Serialise, NamesOfFieldsAsSequencesOfLetters) {
  Group root;
  root.attributes["MATLAB_fields"] = texts({"time", "a", "value"});
  const auto bytes = serialise(root);
  ASSERT_TRUE(bytes);
  expect_same(Library(*bytes).read(), root, "");
  EXPECT_TRUE(read(std::as_bytes(std::span(*bytes)), {.bytes = 1 << 20}));
}

TEST(Serialise, ReferencesToObjectsAnywhere) {
  Group root;
  root.groups["#refs#"].datasets["a"] = {numbers({1, 2}, Vector::Ones(2)), {}};
  root.groups["#refs#"].groups["deep"].groups["er"];
  root.datasets["cells"] = {{{2, 2}, References{{"/#refs#/a", "", "/#refs#/deep/er", "/"}}},
                            {{"self", {{1}, References{{"/cells"}}}}}};
  root.attributes["first"] = {{}, References{{"/#refs#/a"}}};
  expect_comes_back(root);
}

TEST(Serialise, AUserBlockStandsBeforeIt) {
  Group root;
  root.datasets["x"] = {numbers({50'000}, Vector::LinSpaced(50'000, 0, 1)), {{"unit", text("m")}}};
  root.datasets["r"] = {{{1}, References{{"/x"}}}, {}};
  const std::string block = "MATLAB" + std::string(506, '\0');
  expect_comes_back(root, block);
  EXPECT_TRUE(serialise(root, block)->starts_with(block + "\x89HDF"));
  EXPECT_FALSE(serialise(root, "too short"));
  EXPECT_FALSE(serialise(root, std::string(513, ' ')));
}

/// A tree of random shape, names, types and values.
class RandomTree {
 public:
  explicit RandomTree(unsigned seed) : random_(seed) {}

  Group group(int depth) {
    Group made{attributes(), {}, {}};
    for (int i = upto(12); i > 0; --i) made.datasets["d" + name()] = {value(120), attributes()};
    for (int i = depth > 0 ? upto(4) : 0; i > 0; --i) made.groups["g" + name()] = group(depth - 1);
    return made;
  }

 private:
  int upto(int most) { return static_cast<int>(random_() % static_cast<unsigned>(most + 1)); }

  std::string name() {
    static const std::array<const char*, 8> parts{"a", "Z", "_", "9", "é", " ", "😀", "."};
    std::string made;
    for (int i = 1 + upto(12); i > 0; --i) made += parts[random_() % parts.size()];
    return made;
  }

  Attributes attributes() {
    Attributes made;
    for (int i = upto(5); i > 0; --i) made[name()] = value(10);
    return made;
  }

  Value value(int most) {
    std::vector<std::uint64_t> shape;
    std::uint64_t count = 1;
    for (int i = upto(3); i > 0; --i) {
      shape.push_back(static_cast<std::uint64_t>(upto(most)));
      count *= shape.back();
      most = most / 8 + 2;
    }
    if (upto(3) == 0) {
      Texts all(count);
      for (std::string& one : all) one = upto(4) == 0 ? "" : name();
      return {shape, all};
    }
    const Stored stored = stored_types()[random_() % stored_types().size()].first;
    Vector values(static_cast<Index>(count));
    for (double& one : values) one = upto(100);
    if (stored == Stored::float64) {
      for (double& one : values) one = std::ldexp(static_cast<double>(random_()), upto(200) - 100);
    }
    return {shape, Numbers{values, stored}};
  }

  std::mt19937 random_;
};

TEST(Serialise, RandomTreesComeBack) {
  for (unsigned seed = 0; seed < 25; ++seed) {
    SCOPED_TRACE(seed);
    expect_comes_back(RandomTree(seed).group(3), seed % 2 == 0 ? "" : std::string(1024, 'u'));
    if (testing::Test::HasFailure()) return;
  }
}

TEST(Serialise, EqualTreesGiveEqualBytes) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    EXPECT_EQ(*serialise(RandomTree(seed).group(2)), *serialise(RandomTree(seed).group(2)));
  }
}

TEST(Serialise, RefusesWhatAFileCannotHold) {
  const auto said = [](const Group& root) {
    const auto bytes = serialise(root);
    return bytes ? "" : bytes.error().line();
  };
  const auto with_dataset = [](const std::string& name, Value value) {
    Group root;
    root.datasets[name] = {std::move(value), {}};
    return root;
  };
  for (const std::string& name : {std::string(), std::string("a/b"), std::string("."), std::string("a\0b", 3)}) {
    EXPECT_THAT(said(with_dataset(name, text("x"))), HasSubstr("name"));
  }
  EXPECT_THAT(said(with_dataset("x", numbers({3}, Vector::Ones(2)))), AllOf(HasSubstr("/x"), HasSubstr("2 values")));
  EXPECT_THAT(said(with_dataset("x", numbers({1}, Vector::Constant(1, 256), Stored::uint8))), HasSubstr("256"));
  EXPECT_THAT(said(with_dataset("x", numbers({1}, Vector::Constant(1, 0.5), Stored::int32))), HasSubstr("0.5"));
  EXPECT_THAT(said(with_dataset("x", numbers({1}, Vector::Constant(1, 0x1p64), Stored::uint64))),
              HasSubstr("1.8446744073709552e+19"));
  EXPECT_THAT(said(with_dataset("x", numbers({1}, Vector::Constant(1, 0.1), Stored::float32))), HasSubstr("0.1"));
  EXPECT_THAT(said(with_dataset("x", numbers({1}, Vector::Constant(1, std::nan("")), Stored::int8))), HasSubstr("nan"));
  EXPECT_THAT(said(with_dataset("x", text(std::string("a\0b", 3)))), HasSubstr("null"));
  EXPECT_THAT(said(with_dataset("x", {{}, Unread{"of a compound type"}})), HasSubstr("of a compound type"));
  EXPECT_THAT(said(with_dataset("x", {{1}, References{{"/y"}}})), HasSubstr("'/y'"));
  Group both = with_dataset("x", text("x"));
  both.groups["x"];
  EXPECT_THAT(said(both), AllOf(HasSubstr("/x"), HasSubstr("dataset")));
  Group large;
  large.attributes["x"] = numbers({9000}, Vector::Zero(9000));
  EXPECT_THAT(said(large), HasSubstr("65000"));
}

}  // namespace
}  // namespace mbk::hdf5
