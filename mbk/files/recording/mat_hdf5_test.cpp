#include "mbk/files/recording/mat_hdf5.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <random>

#include "mbk/files/contents/test_files.h"
#include "mbk/files/recording/hdf5_recording.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {
namespace mat_hdf5_test {

using testing::HasSubstr;

/// A v7.3 file with a logs matrix, as matio writes it.
std::string write_hdf5(const std::filesystem::path& file, Matrix values, matio_compression compression) {
  mat_t* mat = Mat_CreateVer(file.c_str(), nullptr, MAT_FT_MAT73);
  std::size_t dimensions[2] = {static_cast<std::size_t>(values.rows()), static_cast<std::size_t>(values.cols())};
  matvar_t* variable = Mat_VarCreate("logs", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dimensions, values.data(), 0);
  EXPECT_EQ(Mat_VarWrite(mat, variable, compression), 0);
  Mat_VarFree(variable);
  Mat_Close(mat);
  return test::bytes_of(file);
}

TEST(DecodeMatHdf5, ReadsPlainAndCompressedMatrices) {
  const test::Folder folder;
  for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    write_hdf5(folder / "log.mat", test::logs(300), compression);
    const auto recording = read(folder / "log.mat", {});
    ASSERT_TRUE(recording) << recording.error().line();
    EXPECT_EQ(recording->sources[0].format, "MAT v7.3");
    EXPECT_EQ(recording->find("force_y")->values, test::logs(300).row(10).transpose());
  }
}

TEST(DecodeMatHdf5, ReadsMetadata) {
  const test::Folder folder;
  write_hdf5(folder / "log.mat", test::logs(30), MAT_COMPRESSION_NONE);
  mat_t* mat = Mat_Open((folder / "log.mat").c_str(), MAT_ACC_RDWR);
  ASSERT_NE(mat, nullptr);
  std::size_t one[2] = {1, 1};
  std::size_t length[2] = {1, 6};
  const char* fields[] = {"name"};
  matvar_t* metadata = Mat_VarCreateStruct("metadata", 2, one, fields, 1);
  char16_t name[] = u"Ánna é";
  Mat_VarSetStructFieldByName(metadata, "name", 0,
                              Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UINT16, 2, length, name, 0));
  EXPECT_EQ(Mat_VarWrite(mat, metadata, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(metadata);
  Mat_Close(mat);
  const auto recording = read(folder / "log.mat", {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->metadata, (std::map<std::string, std::string>{{"name", "Ánna é"}}));
}

matvar_t* numbers(const char* name, std::vector<double> values, std::size_t rows, std::size_t columns) {
  std::size_t size[2] = {rows, columns};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, values.data(), 0);
}

TEST(DecodeMatHdf5, ReadsEventsWhoseNamesAreCells) {
  const test::Folder folder;
  write_hdf5(folder / "log.mat", test::logs(30), MAT_COMPRESSION_NONE);
  mat_t* mat = Mat_Open((folder / "log.mat").c_str(), MAT_ACC_RDWR);
  ASSERT_NE(mat, nullptr);
  std::size_t one[2] = {1, 1};
  std::size_t two[2] = {2, 1};
  std::size_t length[2] = {1, 5};
  char16_t onset[] = u"onset";
  char16_t hold[] = u"höld ";
  const char* fields[] = {"time", "value", "name"};
  matvar_t* events = Mat_VarCreateStruct("events", 2, one, fields, 3);
  Mat_VarSetStructFieldByName(events, "time", 0, numbers(nullptr, {0.25, 0.5}, 2, 1));
  Mat_VarSetStructFieldByName(events, "value", 0, numbers(nullptr, {1, -1}, 2, 1));
  matvar_t* names = Mat_VarCreate(nullptr, MAT_C_CELL, MAT_T_CELL, 2, two, nullptr, 0);
  Mat_VarSetCell(names, 0, Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UINT16, 2, length, onset, 0));
  Mat_VarSetCell(names, 1, Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UINT16, 2, length, hold, 0));
  Mat_VarSetStructFieldByName(events, "name", 0, names);
  EXPECT_EQ(Mat_VarWrite(mat, events, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(events);
  Mat_Close(mat);
  const auto recording = read(folder / "log.mat", {});
  ASSERT_TRUE(recording) << recording.error().line();
  ASSERT_EQ(recording->events.size(), 2u);
  EXPECT_EQ(recording->events[0].time, 0.25);
  EXPECT_EQ(recording->events[0].name, "onset");
  EXPECT_EQ(recording->events[1].name, "höld ");
  EXPECT_EQ(recording->events[1].value, -1.0);
}

TEST(DecodeMatHdf5, ReadsStructureArraysAndCellsOfNumbers) {
  const test::Folder folder;
  write_hdf5(folder / "log.mat", test::logs(30), MAT_COMPRESSION_NONE);
  mat_t* mat = Mat_Open((folder / "log.mat").c_str(), MAT_ACC_RDWR);
  ASSERT_NE(mat, nullptr);
  std::size_t two[2] = {1, 2};
  matvar_t* cell = Mat_VarCreate("c", MAT_C_CELL, MAT_T_CELL, 2, two, nullptr, 0);
  Mat_VarSetCell(cell, 0, numbers(nullptr, {1, 2, 3}, 3, 1));
  const char* fields[] = {"values", "label"};
  std::size_t one[2] = {1, 1};
  matvar_t* inner = Mat_VarCreateStruct(nullptr, 2, one, fields, 1);
  Mat_VarSetStructFieldByName(inner, "values", 0, numbers(nullptr, {4, 5, 6, 7, 8, 9}, 3, 2));
  Mat_VarSetCell(cell, 1, inner);
  EXPECT_EQ(Mat_VarWrite(mat, cell, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(cell);
  matvar_t* signals = Mat_VarCreateStruct("signals", 2, two, fields, 2);
  char16_t label[] = u"posi";
  std::size_t length[2] = {1, 4};
  for (int k = 0; k < 2; ++k) {
    Mat_VarSetStructFieldByName(signals, "values", static_cast<std::size_t>(k),
                                numbers(nullptr, {k + 0.5, 2, 3, 4}, 2, 2));
    Mat_VarSetStructFieldByName(signals, "label", static_cast<std::size_t>(k),
                                Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UINT16, 2, length, label, 0));
  }
  EXPECT_EQ(Mat_VarWrite(mat, signals, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(signals);
  Mat_Close(mat);
  const std::string bytes = test::bytes_of(folder / "log.mat");
  const auto contents = decode_hdf5(std::as_bytes(std::span(bytes)));
  ASSERT_TRUE(contents) << contents.error().line();
  std::vector<std::string> names;
  for (const Array& array : contents->arrays) names.push_back(array.name);
  EXPECT_THAT(names, testing::ElementsAre("c{1}", "c{2}.values", "logs", "signals(1).values", "signals(2).values"));
  EXPECT_EQ(contents->arrays[1].values, (Matrix(3, 2) << 4, 7, 5, 8, 6, 9).finished());
  EXPECT_EQ(contents->arrays[4].values, (Matrix(2, 2) << 1.5, 3, 2, 4).finished());
  EXPECT_EQ(contents->texts.size(), 2u);
}

hdf5::Dataset matlab(hdf5::Value value, const char* type) {
  hdf5::Dataset dataset{std::move(value), {}};
  if (*type != '\0') dataset.attributes["MATLAB_class"] = {{}, hdf5::Texts{type}};
  return dataset;
}

TEST(DecodeMatHdf5, EndsWhereReferencesLeadBackOrToOneObjectTwice) {
  hdf5::Group root;
  hdf5::Group& hidden = root.groups["#refs#"];
  hidden.datasets["a"] = matlab({{1, 3}, hdf5::Numbers{Vector::LinSpaced(3, 1, 3)}}, "double");
  hidden.datasets["loop"] = matlab({{1, 2}, hdf5::References{{"/#refs#/loop", "/#refs#/loop"}}}, "cell");
  root.datasets["c"] = matlab({{1, 4}, hdf5::References{{"/#refs#/a", "/#refs#/a", "", "/#refs#/nowhere"}}}, "cell");
  root.datasets["d"] = matlab({{1, 1}, hdf5::References{{"/#refs#/loop"}}}, "cell");
  const Contents contents = contents_of_mat_hdf5(std::move(root));
  ASSERT_EQ(contents.arrays.size(), 1u);
  EXPECT_EQ(contents.arrays[0].name, "c{1}");
  EXPECT_EQ(contents.arrays[0].values, (Matrix(3, 1) << 1, 2, 3).finished());
  EXPECT_THAT(contents.notes, testing::Contains(AllOf(HasSubstr("'c{2}'"), HasSubstr("'c{1}'"))));
  EXPECT_LT(contents.notes.size(), 100'002u);
}

TEST(DecodeMatHdf5, SaysWhichElementIsDamaged) {
  hdf5::Group root;
  root.groups["#refs#"].datasets["a"] = matlab({{}, hdf5::Unread{"a chunk has a wrong checksum", true}}, "double");
  root.groups["s"].datasets["x"] = matlab({{1, 1}, hdf5::References{{"/#refs#/a"}}}, "");
  const Contents contents = contents_of_mat_hdf5(std::move(root));
  EXPECT_TRUE(contents.damaged.contains("s(1).x"));
  EXPECT_THAT(contents.notes, testing::ElementsAre(HasSubstr("'s(1).x'")));
}

TEST(DecodeMatHdf5, RefusesAFileCutAnywhere) {
  const test::Folder folder;
  for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    const std::string whole = write_hdf5(folder / "whole.mat", test::logs(20), compression);
    for (std::size_t n = 0; n < whole.size(); ++n) {
      ASSERT_FALSE(decode_hdf5(std::as_bytes(std::span(whole)).first(n))) << "cut to " << n;
    }
    for (const std::size_t n : {std::size_t{5}, std::size_t{300}, std::size_t{519}, whole.size() - 1}) {
      EXPECT_FALSE(read(folder.write("cut.mat", std::string_view(whole).substr(0, n)), {})) << "cut to " << n;
    }
  }
}

TEST(DecodeMatHdf5, SurvivesFlippedBytes) {
  const test::Folder folder;
  const std::string whole = write_hdf5(folder / "whole.mat", test::logs(20), MAT_COMPRESSION_ZLIB);
  std::mt19937 random(20130603);
  for (int i = 0; i < 3000; ++i) {
    std::string bytes = whole;
    const std::size_t at = 512 + random() % (bytes.size() - 512);
    bytes[at] = static_cast<char>(random());
    SCOPED_TRACE(at);
    const auto recording = read(folder.write("flipped.mat", bytes), {});
    if (recording) {
      ASSERT_LE(recording->samples(), 1100 * std::ssize(bytes) + (1 << 20));
    }
  }
}

}  // namespace mat_hdf5_test
}  // namespace mbk::recording
