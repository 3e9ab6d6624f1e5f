#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <span>
#include <string>

#include "mbk/base/system/files.h"
#include "mbk/base/system/mapping.h"
#include "mbk/base/system/process.h"
#include "mbk/base/system/temporary_folder.h"
#include "mbk/base/system/time.h"

namespace mbk::system {
namespace {

using testing::UnorderedElementsAre;

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

std::string text_of(const std::filesystem::path& file) {
  std::string text(100, '\0');
  const auto got = read_some_at(open_to_read(file).number(), text.data(), text.size(), 0);
  text.resize(static_cast<std::size_t>(std::max<std::int64_t>(got, 0)));
  return text;
}

class SystemFiles : public testing::Test {
 protected:
  SystemFiles() : folder_(*TemporaryFolder::create("mbk-system")) {}
  [[nodiscard]] std::filesystem::path path(const char* name) const { return folder_.path() / name; }
  void write(const char* name, std::string_view text) const {
    ASSERT_EQ(write_all(create_new(path(name)).number(), bytes_of(text)), 0);
  }
  TemporaryFolder folder_;
};

TEST_F(SystemFiles, AreCreatedOnce) {
  EXPECT_TRUE(create_new(path("ä b.txt")));
  EXPECT_FALSE(create_new(path("ä b.txt")));
  EXPECT_EQ(errno, EEXIST);
}

TEST_F(SystemFiles, AreWrittenAndReadAtTheirPlaces) {
  const OpenFile file = create_new(path("places"));
  ASSERT_EQ(write_all_at(file.number(), bytes_of("\r\ncde"), 0), 0);
  ASSERT_EQ(write_all_at(file.number(), bytes_of("ab"), 0), 0);
  std::array<char, 10> read{};
  EXPECT_EQ(read_some_at(file.number(), read.data(), read.size(), 1), 4);
  EXPECT_STREQ(read.data(), "bcde");
  EXPECT_EQ(read_some_at(file.number(), read.data(), read.size(), 5), 0);
  ASSERT_EQ(cut(file, 1), 0);
  EXPECT_EQ(status_of(file)->size, 1u);
}

TEST_F(SystemFiles, KeepEachByte) {
  const std::string text = "a\r\nb\nc\x1a\rd";
  write("lines", text);
  EXPECT_EQ(text_of(path("lines")), text);
}

TEST_F(SystemFiles, AreToldFromFolders) {
  write("file", "12");
  EXPECT_EQ(status_of(path("file"))->kind, FileStatus::Kind::regular);
  EXPECT_EQ(status_of(path("file"))->size, 2u);
  EXPECT_EQ(status_of(folder_.path())->kind, FileStatus::Kind::folder);
  const OpenFile folder = open_to_read(folder_.path());
  ASSERT_TRUE(folder);
  EXPECT_EQ(status_of(folder)->kind, FileStatus::Kind::folder);
  EXPECT_FALSE(status_of(path("none")));
  EXPECT_EQ(errno, ENOENT);
}

TEST_F(SystemFiles, AreRenamedOverAFileOrNot) {
  write("old", "old");
  write("new", "new");
  EXPECT_EQ(rename_new(path("new"), path("old")), EEXIST);
  EXPECT_EQ(text_of(path("old")), "old");
  EXPECT_EQ(rename_over(path("new"), path("old")), 0);
  EXPECT_EQ(text_of(path("old")), "new");
  EXPECT_EQ(rename_new(path("old"), path("third")), 0);
  EXPECT_EQ(rename_over(path("old"), path("fourth")), ENOENT);
}

TEST_F(SystemFiles, GetASecondNameThatIsFree) {
  write("one", "1");
  write("other", "2");
  EXPECT_EQ(link(path("one"), path("other")), EEXIST);
  EXPECT_EQ(link(path("one"), path("two")), 0);
  EXPECT_EQ(status_of(path("one"))->number, status_of(path("two"))->number);
  EXPECT_EQ(remove_name(path("one")), 0);
  EXPECT_EQ(remove_name(path("one")), ENOENT);
  EXPECT_EQ(text_of(path("two")), "1");
}

TEST_F(SystemFiles, AreLockedUntilTheyAreClosed) {
  OpenFile one = create_or_open(path("lock")), other = create_or_open(path("lock"));
  EXPECT_EQ(try_lock(one, Lock::alone), 0);
  EXPECT_EQ(try_lock(other, Lock::alone), EWOULDBLOCK);
  EXPECT_EQ(try_lock(other, Lock::shared), EWOULDBLOCK);
  one.close();
  EXPECT_EQ(try_lock(other, Lock::shared), 0);
  EXPECT_EQ(try_lock(create_or_open(path("lock")), Lock::shared), 0);
}

TEST_F(SystemFiles, AreFoundByAPattern) {
  for (const char* const name : {"a1.csv", "a2.csv", "b1.csv", "a1.mat", ".a.csv"}) write(name, "");
  ASSERT_EQ(make_folder(path("below")), 0);
  EXPECT_EQ(make_folder(path("below")), EEXIST);
  write("below/a3.csv", "");
  const auto like = [&](const char* pattern) {
    std::vector<std::string> names;
    for (const auto& found : matching(path(pattern).string())) {
      names.push_back(found.lexically_relative(folder_.path()).generic_string());
    }
    return names;
  };
  EXPECT_THAT(like("a*.csv"), UnorderedElementsAre("a1.csv", "a2.csv"));
  EXPECT_THAT(like("?1.csv"), UnorderedElementsAre("a1.csv", "b1.csv"));
  EXPECT_THAT(like("[a-b]1.csv"), UnorderedElementsAre("a1.csv", "b1.csv"));
  EXPECT_THAT(like("[!a]1.csv"), UnorderedElementsAre("b1.csv"));
  EXPECT_THAT(like("*/*.csv"), UnorderedElementsAre("below/a3.csv"));
  EXPECT_THAT(like("c*"), UnorderedElementsAre());
}

TEST(SystemProcess, DrawsOtherBytesEachTime) {
  std::array<std::byte, 16> one{}, other{};
  ASSERT_TRUE(random_bytes(one));
  ASSERT_TRUE(random_bytes(other));
  EXPECT_NE(one, other);
}

TEST(SystemProcess, KnowsItselfAndWhatItTook) {
  EXPECT_GT(process_id(), 0);
  EXPECT_TRUE(std::filesystem::exists(program_file()));
  EXPECT_GT(usable_processors(), 0u);
  EXPECT_GT(peak_memory(), 1 << 20);
  const double before = cpu_seconds();
  volatile double sum = 0.0;
  while (cpu_seconds() < before + 0.02) sum = sum + 1.0;
}

TEST(SystemMapping, GivesRoomThatIsZero) {
  constexpr std::size_t kBytes = std::size_t{8} << 20;
  auto* const room = static_cast<char*>(map_memory(kBytes));
  ASSERT_NE(room, nullptr);
  EXPECT_EQ(room[0], 0);
  room[kBytes - 1] = 1;
  EXPECT_EQ(room[kBytes - 1], 1);
  forget_memory(room, kBytes / 2);
  EXPECT_EQ(room[kBytes - 1], 1);
  unmap_memory(room, kBytes);
  EXPECT_GT(available_memory(), kBytes);
}

TEST(SystemTime, SleepsUntilItsTime) {
  std::int64_t begin = 0, end = 0;
  ASSERT_TRUE(read_clock(begin));
  while (!sleep_until(begin + 20'000'000)) continue;
  ASSERT_TRUE(read_clock(end));
  EXPECT_GE(end - begin, 20'000'000);
}

}  // namespace
}  // namespace mbk::system
