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
           {"#ROSBAG V1.2\n", "ROS bag"},
           {"SQLite format 3\0"s, "SQLite"},
           {"PAR1\x15", "Parquet"},
           {"ARROW1\0\0"s, "Arrow"},
           {"\x80\x04\x95\x10", "pickle"},
           {"X\n\0\0\0\3"s, ".rds"},
           {"RDX3\nX", ".RData"},
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
           {"function y = f(x)", "MATLAB"},
       }) {
    EXPECT_THAT(what(bytes), HasSubstr(is)) << bytes;
  }
  for (const char* bytes : {"", "P", "time,x\n0,1\n", "TDS", "GDF", "\x80"}) EXPECT_EQ(what(bytes), "nothing") << bytes;
}

TEST(LikelyFormat, LooksIntoArchives) {
  EXPECT_THAT(what(zip("[Content_Types].xml", "xl/workbook.xml")), HasSubstr("Excel"));
  EXPECT_THAT(what(zip("mimetypeapplication/vnd.oasis.opendocument.spreadsheet")), HasSubstr("OpenDocument"));
  EXPECT_THAT(what(zip("[Content_Types].xml", "simulink/blockdiagram.xml")), HasSubstr("Simulink"));
  EXPECT_THAT(what(zip("raw/01_01.c3d")), AllOf(HasSubstr("zip"), HasSubstr("C3D")));
  EXPECT_THAT(what(zip("readme.txt")), AllOf(HasSubstr("zip"), Not(HasSubstr("C3D"))));
  EXPECT_THAT(what("PK\5\6" + std::string(18, '\0')), HasSubstr("zip"));
}

TEST(LikelyFormat, IsSaidByTheReader) {
  const test::Folder folder;
  const auto line = [&](const std::string& bytes) {
    const auto recording = read(folder.write("trial.csv", bytes), {});
    EXPECT_FALSE(recording);
    return recording ? "" : recording.error().line();
  };
  EXPECT_THAT(line("\x01\x7F\x03"), AllOf(HasSubstr("01 7f 03"), HasSubstr("HDF5"), HasSubstr("MAT")));
  EXPECT_THAT(line(std::string(300, '\0')), HasSubstr("zeros"));
  for (const char* text : {"Dear all,\nhere are the data.\n", "[a]\nkey=value\n", "T;X\na;b\n"}) {
    EXPECT_THAT(line(text), AllOf(HasSubstr("table"), HasSubstr("Dexterit-E"), HasSubstr(".kinarm"))) << text;
  }
  // A table is a table, whatever its first letters.
  const auto table = read(folder.write("trial.csv", "ID;Pressure\n0;1\n1;2\n"), {});
  ASSERT_FALSE(table);
  EXPECT_THAT(table.error().line(), AllOf(HasSubstr("2 columns"), HasSubstr("Pressure")));
}

}  // namespace likely_format_test
}  // namespace mbk::recording
