#include "mbk/files/archive/zip_archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zip.h>

#include <cstring>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

// Archives that libzip writes, which is not what reads them.

namespace mbk::recording {
namespace {

using testing::HasSubstr;

std::string archive_of(const std::vector<std::pair<std::string, std::string>>& members, bool packed = true,
                       bool encrypted = false) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const source = zip_source_buffer_create(nullptr, 0, 0, &error);
  zip_source_keep(source);
  zip_t* const archive = zip_open_from_source(source, ZIP_TRUNCATE, &error);
  for (const auto& [name, content] : members) {
    zip_source_t* const from = zip_source_buffer(archive, content.data(), content.size(), 0);
    const auto index =
        static_cast<zip_uint64_t>(zip_file_add(archive, name.c_str(), from, ZIP_FL_ENC_UTF_8 | ZIP_FL_OVERWRITE));
    zip_set_file_compression(archive, index, packed ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 0);
    if (encrypted) zip_file_set_encryption(archive, index, ZIP_EM_TRAD_PKWARE, "secret");
  }
  EXPECT_EQ(zip_close(archive), 0);
  zip_stat_t about;
  zip_source_stat(source, &about);
  std::string bytes(about.size, '\0');
  zip_source_open(source);
  zip_source_read(source, bytes.data(), bytes.size());
  zip_source_close(source);
  zip_source_free(source);
  return bytes;
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

std::string text_of(const Result<Buffer>& read) {
  return read ? std::string(reinterpret_cast<const char*>(read->bytes().data()), read->size) : read.error().line();
}

const std::vector<std::pair<std::string, std::string>> kMembers = {
    {"raw/common/header.bin", std::string(100'000, 'x') + "end"}, {"raw/Öffnen.bin", "short"}, {"empty", ""}};

TEST(ZipArchive, GivesWhatWasPutIn) {
  for (const bool packed : {true, false}) {
    const std::string file = archive_of(kMembers, packed);
    EXPECT_TRUE(ZipArchive::looks_like_zip(bytes_of(file)));
    const auto archive = ZipArchive::open(bytes_of(file));
    ASSERT_TRUE(archive) << archive.error().line();
    ASSERT_EQ(archive->members().size(), kMembers.size());
    for (std::size_t k = 0; k < kMembers.size(); ++k) {
      const auto& [name, content] = kMembers[k];
      EXPECT_EQ(archive->members()[k].name, name);
      EXPECT_EQ(archive->members()[k].size, content.size());
      EXPECT_TRUE(archive->has(name));
      EXPECT_EQ(text_of(archive->read(name)), content);
      EXPECT_EQ(text_of(archive->read_begin(name, 3)), content.substr(0, 3));
    }
    EXPECT_FALSE(archive->has("Empty"));
    EXPECT_THAT(text_of(archive->read("Empty")), HasSubstr("'Empty'"));
  }
}

TEST(ZipArchive, IsReadByManyAtOnce) {
  const std::string file = archive_of(kMembers);
  const auto archive = ZipArchive::open(bytes_of(file));
  ASSERT_TRUE(archive);
  std::vector<int> right(4, 0);
  std::vector<std::thread> threads;
  for (int& count : right) {
    threads.emplace_back([&] {
      for (int i = 0; i < 20; ++i) {
        for (const auto& [name, content] : kMembers) count += text_of(archive->read(name)) == content ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int count : right) EXPECT_EQ(count, 60);
}

TEST(ZipArchive, NeverGivesDamagedContent) {
  const std::string file = archive_of(kMembers);
  int refused = 0;
  for (std::size_t at = 0; at < file.size(); ++at) {
    std::string damaged = file;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    const auto archive = ZipArchive::open(bytes_of(damaged));
    if (!archive) {
      ++refused;
      continue;
    }
    for (const auto& [name, content] : kMembers) {
      if (!archive->has(name)) continue;
      const auto read = archive->read(name);
      if (!read) ++refused;
      EXPECT_TRUE(!read || text_of(read) == content) << at << " " << name;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(ZipArchive, RefusesWhatIsCutShortEncryptedOrClaimsTooMuch) {
  const std::string file = archive_of(kMembers);
  for (const std::size_t size : {22U, 60U, static_cast<unsigned>(file.size()) - 30U}) {
    EXPECT_FALSE(ZipArchive::open(bytes_of(file.substr(0, size))));
  }
  const auto encrypted = archive_of(kMembers, true, true);
  const auto opened = ZipArchive::open(bytes_of(encrypted));
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().line(), HasSubstr("encrypt"));
  std::string greedy = file;  // the first member's size in the directory
  const std::size_t entry = greedy.find("PK\x01\x02");
  const std::uint32_t claim = 0xFFFFFFF0U;
  std::memcpy(greedy.data() + entry + 24, &claim, sizeof claim);
  const auto claims = ZipArchive::open(bytes_of(greedy));
  ASSERT_FALSE(claims);
  EXPECT_THAT(claims.error().line(), HasSubstr("4294967280 bytes"));
}

}  // namespace
}  // namespace mbk::recording
