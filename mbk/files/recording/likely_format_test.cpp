#include "mbk/files/recording/likely_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "mbk/files/contents/test_files.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {
namespace likely_format_test {

using namespace std::string_literals;
using testing::HasSubstr;

std::string what(const std::string& bytes) {
  const auto likely = likely_format(std::as_bytes(std::span(bytes)));
  return likely ? std::string(likely->what) : "nothing";
}

/// A zip archive that begins with a file of this name and has another in its directory.
std::string zip(const std::string& first, const std::string& later = "") {
  return "PK\3\4"s + std::string(26, '\0') + first + std::string(100'000, 'x') + "PK\1\2" + std::string(42, '\0') +
         later;
}

TEST(LikelyFormat, KnowsFilesByTheirFirstBytes) {
  for (const auto& [bytes, is] : {
           std::pair{"TDSm\x0E\0"s, "TDMS"},
           {"\xFF"s + "BIOSEMI", "BDF"},
           {"0       X X X X", "EDF"},
           {"#ROSBAG V1.2\n", "version 1"},
           {"SQLite format 3\0"s, "SQLite"},
           {"PAR1\x15", "Parquet"},
           {"ARROW1\0\0"s, "Arrow"},
           {"\x80\x04\x95\x10", "pickle"},
           {"X\n\0\0\0\3"s, "R object"},
           {"RDX3\nX", "R data"},
           {"\x1F\x8B\x08", "gzip"},
           {"\xFD"s + "7zXZ\0"s, "xz"},
           {"\x28\xB5\x2F\xFD", "Zstandard"},
           {"7z\xBC\xAF\x27\x1C", "7z"},
           {std::string(257, 'a') + "ustar", "tar"},
           {"%PDF-1.7", "PDF"},
           {"\x89PNG\r\n\x1A\n", "PNG"},
           {"\xFF\xD8\xFF\xE0", "JPEG"},
           {"ID;PWXL;N;E", "SYLK"},
           {"\xEF\xBB\xBF<?xml version", "XML"},
           {"{\"schema\": \"mbk.result/2\"}", "JSON"},
           {"function y = f(x)", "MATLAB program"},
       }) {
    EXPECT_THAT(what(bytes), HasSubstr(is)) << bytes;
  }
  for (const char* bytes : {"", "P", "time,x\n0,1\n", "TDS", "GDF", "\x80"}) EXPECT_EQ(what(bytes), "nothing") << bytes;
}

TEST(LikelyFormat, LooksIntoArchives) {
  EXPECT_EQ(what(zip("[Content_Types].xml", "xl/workbook.xml")), "an Excel workbook");
  EXPECT_EQ(what(zip("mimetypeapplication/vnd.oasis.opendocument.spreadsheet")), "an OpenDocument sheet");
  EXPECT_EQ(what(zip("[Content_Types].xml", "simulink/blockdiagram.xml")), "a Simulink model (.slx)");
  EXPECT_EQ(what(zip("raw/01_01.c3d")), "a zip archive with C3D files");
  EXPECT_EQ(what(zip("readme.txt")), "a zip archive");
  EXPECT_EQ(what("PK\5\6" + std::string(18, '\0')), "an empty zip archive");
}

TEST(LikelyFormat, IsSaidByTheReader) {
  const test::Folder folder;
  const auto line = [&](const std::string& bytes) {
    const auto recording = read(folder.write("trial.csv", bytes), {});
    EXPECT_FALSE(recording);
    return recording ? "" : recording.error().line();
  };
  EXPECT_THAT(line("\x01\x7F\x03"), HasSubstr("no known format: it is binary data (01 7f 03 …), and not HDF5, MAT,"));
  EXPECT_THAT(line(std::string(300, '\0')), HasSubstr("it begins with zeros alone; copy it again"));
  for (const char* text : {"Dear all,\nhere are the data.\n", "[a]\nkey=value\n", "T;X\na;b\n"}) {
    EXPECT_THAT(line(text), HasSubstr("it is text without a table of numbers (")) << text;
    EXPECT_THAT(line(text), HasSubstr("Dexterit-E as .kinarm")) << text;
  }
  // A table is a table, whatever its first letters.
  const auto table = read(folder.write("trial.csv", "ID;Pressure\n0;1\n1;2\n"), {});
  ASSERT_FALSE(table);
  EXPECT_THAT(table.error().line(), HasSubstr("no channel is recognised"));
}

}  // namespace likely_format_test
}  // namespace mbk::recording
