#include "mbk/files/recording/likely_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

namespace mbk::recording {
namespace {

using namespace std::string_view_literals;

/// Bytes at a fixed position in every file of a format.
struct Signature {
  std::string_view bytes;
  LikelyFormat format;
  std::size_t at = 0;
};

constexpr std::string_view kUnpack = "unpack it and pass the file inside";
constexpr std::string_view kSaveSheet = "save the sheet as CSV (File > Save As) and pass the CSV file";
constexpr std::string_view kNoNumbers = "pass the recording itself, as CSV, MAT, HDF5 or C3D";
constexpr std::string_view kFromPandas =
    "in Python: pandas.read_parquet or read_feather of the file, then .to_csv(\"trial.csv\", index=False)";
constexpr std::string_view kFromMne =
    "in Python: mne.io.read_raw of the file, then .to_data_frame().to_csv(\"trial.csv\", index=False)";
constexpr std::string_view kFromNeo = "in Python: neo.io.get_io of the file reads it; write time and channels as CSV";
constexpr std::string_view kToHdf5 = "convert it to HDF5, or to NetCDF-4 (nccopy -k nc4 old.nc new.nc), which is HDF5";

constexpr auto kSignatures = std::to_array<Signature>({
    // recordings of other programs
    {"TDSm",
     {"a LabVIEW TDMS file",
      "in Python: nptdms.TdmsFile.read of the file, then .as_dataframe().to_csv(\"trial.csv\")"}},
    {"TDSh",
     {"the index of a LabVIEW TDMS file",
      "convert the .tdms file beside it to CSV (Python: nptdms) and pass the CSV file"}},
    {"\xFF"
     "BIOSEMI"sv,
     {"a BDF file (BioSemi)", kFromMne}},
    {"0       "sv, {"an EDF file", kFromMne}},
    {"GDF 1."sv, {"a GDF file (biosignals)", kFromMne}},
    {"GDF 2."sv, {"a GDF file (biosignals)", kFromMne}},
    {"Brain Vision Data Exchange"sv, {"the header of a BrainVision recording", kFromMne}},
    {"BrainVision Data Exchange"sv, {"the header of a BrainVision recording", kFromMne}},
    {"#ROSBAG V1"sv,
     {"a ROS bag of version 1",
      "convert it to version 2 with 'rosbag fix', then: rostopic echo -b FILE -p /TOPIC > trial.csv"}},
    {"#ROSLOG"sv,
     {"a ROS bag of version 1",
      "convert it to version 2 with 'rosbag fix', then: rostopic echo -b FILE -p /TOPIC > trial.csv"}},
    {"SQLite format 3\0"sv,
     {"an SQLite database",
      "if it is a ROS 2 bag, convert it to MCAP with 'ros2 bag convert'; otherwise: sqlite3 -header -csv FILE \"select "
      "* from TABLE\" > trial.csv"}},
    {"NEURALSG"sv, {"a Blackrock NSx file", kFromNeo}},
    {"NEURALCD"sv, {"a Blackrock NSx file", kFromNeo}},
    {"BRSMPGRP"sv, {"a Blackrock NSx file", kFromNeo}},
    {"\xC1\x02\x27\x91"sv, {"an Intan recording", kFromNeo}},
    {"\x02\x27\x91\xC6"sv, {"an Intan recording (.rhd)", kFromNeo}},
    {"\xAC\x27\x91\xD6"sv, {"an Intan recording (.rhs)", kFromNeo}},
    {"ABF "sv, {"an Axon recording (ABF)", kFromNeo}},
    {"ABF2"sv, {"an Axon recording (ABF)", kFromNeo}},
    {"HIERARCHY"sv,
     {"a BVH file of motion capture", "export C3D, or positions as CSV, from the program that recorded it"}},
    {"NO_OF_FRAMES"sv, {"a TSV export of Qualisys Track Manager", "export C3D, or the 3D data as TSV"}},
    {"FILE_VERSION\t"sv, {"a TSV export of Qualisys Track Manager", "export C3D, or the 3D data as TSV"}},
    {"ID;P"sv,
     {"a SYLK sheet (.slk), as Noraxon MR and old spreadsheets export",
      "open it in a spreadsheet and save the sheet as CSV, or export C3D or MAT instead"}},
    // arrays and tables of programs
    {"PAR1"sv, {"a Parquet file", kFromPandas}},
    {"FEA1"sv, {"a Feather file", kFromPandas}},
    {"ARROW1\0\0"sv, {"a Feather or Arrow file", kFromPandas}},
    {"\x80\x02"sv,
     {"a Python pickle",
      "a pickle can run arbitrary code: open it only if you trust its source, and write the arrays with numpy.savetxt "
      "or h5py"}},
    {"\x80\x03"sv,
     {"a Python pickle",
      "a pickle can run arbitrary code: open it only if you trust its source, and write the arrays with numpy.savetxt "
      "or h5py"}},
    {"\x80\x04\x95"sv,
     {"a Python pickle",
      "a pickle can run arbitrary code: open it only if you trust its source, and write the arrays with numpy.savetxt "
      "or h5py"}},
    {"\x80\x05\x95"sv,
     {"a Python pickle",
      "a pickle can run arbitrary code: open it only if you trust its source, and write the arrays with numpy.savetxt "
      "or h5py"}},
    {"RDX2\n"sv, {"R data (.RData)", "in R: load it, then write.csv(data, \"trial.csv\", row.names=FALSE)"}},
    {"RDX3\n"sv, {"R data (.RData)", "in R: load it, then write.csv(data, \"trial.csv\", row.names=FALSE)"}},
    {"X\n\0\0\0\2"sv, {"an R object (.rds)", "in R: write.csv(readRDS(FILE), \"trial.csv\", row.names=FALSE)"}},
    {"X\n\0\0\0\3"sv, {"an R object (.rds)", "in R: write.csv(readRDS(FILE), \"trial.csv\", row.names=FALSE)"}},
    {"CDF\1"sv, {"a NetCDF file of the classic format", kToHdf5}},
    {"CDF\2"sv, {"a NetCDF file of the classic format", kToHdf5}},
    {"CDF\5"sv, {"a NetCDF file of the classic format", kToHdf5}},
    {"\x0E\x03\x13\x01"sv, {"an HDF4 file", "convert it to HDF5 with h4toh5"}},
    {"$FL2"sv, {"an SPSS file", "save it as CSV from SPSS (File > Save As)"}},
    {"<stata_dta>"sv, {"a Stata file", "in Stata: export delimited trial.csv"}},
    {"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"sv, {"an old Office document, perhaps an Excel workbook (.xls)", kSaveSheet}},
    {"Model {"sv, {"a Simulink model", "pass the MAT file that it logs"}},
    // archives
    {"\x1F\x8B"sv,
     {"compressed with gzip", "unpack it with gunzip; if it is an R file (.rds, .RData), use write.csv in R"}},
    {"\xFD"
     "7zXZ\0"sv,
     {"compressed with xz", "unpack it with unxz and pass the file inside"}},
    {"\x28\xB5\x2F\xFD"sv, {"compressed with Zstandard", "unpack it with unzstd and pass the file inside"}},
    {"BZh"sv, {"compressed with bzip2", "unpack it with bunzip2 and pass the file inside"}},
    {"\x04\x22\x4D\x18"sv, {"compressed with LZ4", "unpack it with unlz4 and pass the file inside"}},
    {"7z\xBC\xAF\x27\x1C"sv, {"a 7z archive", kUnpack}},
    {"Rar!\x1A\x07"sv, {"a RAR archive", kUnpack}},
    {"ustar"sv, {"a tar archive", "unpack it with tar -xf and pass a file inside"}, 257},
    {"PK\3\4"sv, {"a zip archive", kUnpack}},
    {"PK\5\6"sv, {"an empty zip archive", kNoNumbers}},
    // documents, pictures, films
    {"%PDF-"sv, {"a PDF document", kNoNumbers}},
    {"\x89PNG\r\n\x1A\n"sv, {"a picture (PNG)", kNoNumbers}},
    {"\xFF\xD8\xFF"sv, {"a picture (JPEG)", kNoNumbers}},
    {"GIF8"sv, {"a picture (GIF)", kNoNumbers}},
    {"II*\0"sv, {"a picture (TIFF)", kNoNumbers}},
    {"MM\0*"sv, {"a picture (TIFF)", kNoNumbers}},
    {"RIFF"sv,
     {"a film or sound (RIFF: AVI, WAV)", "for sound, write the samples as CSV; for a film, pass the tracked data"}},
    {"ftyp"sv, {"a film (MP4, MOV)", "pass the tracked data as CSV"}, 4},
    {"\x1A\x45\xDF\xA3"sv, {"a film (Matroska, WebM)", "pass the tracked data as CSV"}},
    {"{\\rtf"sv, {"a text document (RTF)", "save only the numbers as plain text with one line per sample"}},
    {"\x7F"
     "ELF"sv,
     {"a program", kNoNumbers}},
    {"MZ"sv, {"a Windows program", kNoNumbers}},
    // text
    {kOctaveText, {"Octave's text format", "save it with 'save -v7 trial.mat'"}},
    {"<?xml"sv, {"an XML document", "export the samples as CSV, MAT or C3D from the program that wrote it"}},
    {"<!DOCTYPE"sv, {"a web page", kNoNumbers}},
    {"<!doctype"sv, {"a web page", kNoNumbers}},
    {"<html"sv, {"a web page", kNoNumbers}},
    {"function "sv, {"a MATLAB program (.m)", "run it in MATLAB and pass the file that it saves"}},
    {"function["sv, {"a MATLAB program (.m)", "run it in MATLAB and pass the file that it saves"}},
    {"classdef "sv, {"a MATLAB program (.m)", "run it in MATLAB and pass the file that it saves"}},
    {"{"sv, {"JSON text, such as an mbk result", "pass the original recording, or write the arrays as CSV"}},
});

/// Files that are zip archives by the name of something in them.
struct Inside {
  std::string_view name;
  LikelyFormat format;
};

constexpr auto kInside = std::to_array<Inside>({
    {"xl/workbook.xml", {"an Excel workbook", kSaveSheet}},
    {"xl/workbook.bin", {"an Excel workbook", kSaveSheet}},
    {"application/vnd.oasis.opendocument.spreadsheet", {"an OpenDocument sheet", kSaveSheet}},
    {"word/document.xml", {"a Word document", kNoNumbers}},
    {"ppt/presentation.xml", {"a PowerPoint document", kNoNumbers}},
    {"application/vnd.oasis.opendocument", {"an OpenDocument text or picture", kNoNumbers}},
    {"simulink/", {"a Simulink model (.slx)", "pass the MAT file that it logs"}},
    {"matlab/document.xml", {"a MATLAB live script (.mlx)", "run it in MATLAB and pass the file that it saves"}},
    {".c3d", {"a zip archive with C3D files", "unpack it with unzip and pass the C3D files"}},
    {".kinarm", {"a zip archive of a KINARM", "unpack it with unzip and pass the C3D files"}},
});

constexpr std::size_t kNames = std::size_t{64} << 10;  ///< [bytes] at begin and end of an archive that are looked at

std::optional<LikelyFormat> zip_of(std::string_view text) {
  const std::string_view begin = text.substr(0, kNames), end = text.substr(text.size() - std::min(text.size(), kNames));
  for (const Inside& inside : kInside) {
    if (begin.find(inside.name) != begin.npos || end.find(inside.name) != end.npos) return inside.format;
  }
  return std::nullopt;
}

}  // namespace

std::optional<LikelyFormat> likely_format(std::span<const std::byte> file) {
  std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
  if (text.starts_with("PK\3\4")) {
    if (const auto inside = zip_of(text)) return inside;
  }
  const bool marked = text.starts_with("\xEF\xBB\xBF");  // UTF-8 needs no note
  if (marked) text.remove_prefix(3);
  for (const Signature& signature : kSignatures) {
    if (text.size() > signature.at && text.substr(signature.at).starts_with(signature.bytes)) return signature.format;
  }
  return std::nullopt;
}

tl::unexpected<Error> not_read(const LikelyFormat& format) {
  return bad_data(fmt::format("the file is {}, which is not supported", format.what), std::string(format.way_out));
}

}  // namespace mbk::recording
