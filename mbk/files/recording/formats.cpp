#include "mbk/files/recording/formats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "mbk/files/archive/gzip.h"
#include "mbk/files/archive/zip_archive.h"
#include "mbk/files/c3d/c3d.h"
#include "mbk/files/contents/memory.h"
#include "mbk/files/hdf5/read_hdf5.h"
#include "mbk/files/kinarm/kinarm_exam.h"
#include "mbk/files/recording/csv.h"
#include "mbk/files/recording/hdf5_recording.h"
#include "mbk/files/recording/likely_format.h"
#include "mbk/files/recording/mat_level4.h"
#include "mbk/files/recording/mat_level5.h"
#include "mbk/files/recording/open_trials.h"
#include "mbk/files/ros/bag.h"
#include "mbk/files/ros/mcap.h"
#include "mbk/files/tables/capture_tables.h"
#include "mbk/files/tables/delsys.h"
#include "mbk/files/tables/lvm.h"
#include "mbk/files/tables/npy.h"
#include "mbk/files/tables/opensim.h"
#include "mbk/files/tables/physiology_tables.h"
#include "mbk/files/xdf/xdf.h"

namespace mbk::recording {
namespace {

bool is_text(std::string_view bytes) {
  return std::ranges::none_of(bytes, [](char c) {
    const auto code = static_cast<unsigned char>(c);
    return code < 0x20 && c != '\t' && c != '\n' && c != '\r';
  });
}

// ---- what a file looks like ----

template <bool (*LooksLike)(std::span<const std::byte>)>
bool begins_as(OpenFile& file) {
  return LooksLike(file.begin_bytes());
}

template <bool (*LooksLike)(std::string_view)>
bool text_begins_as(OpenFile& file) {
  return LooksLike(file.begin()) && is_text(file.begin());  // which takes longer
}

template <bool (*IsSuch)(const ZipArchive&)>
bool zip_holds(OpenFile& file) {
  if (!ZipArchive::looks_like_zip(file.begin_bytes())) return false;
  const auto bytes = file.bytes();
  if (!bytes) return false;
  const auto archive = ZipArchive::open((*bytes)->bytes());
  return archive && IsSuch(*archive);
}

bool looks_like_mat(OpenFile& file) {
  const std::string_view begin = file.begin();
  return begin.starts_with("MATLAB ") ||
         (begin.size() >= 128 && (begin.substr(126, 2) == "IM" || begin.substr(126, 2) == "MI")) ||
         looks_like_mat_level4(file.begin_bytes());
}

/// XDF is the one format that programs write packed (.xdfz, .xdf.gz).
bool begins_as_xdf(OpenFile& file) {
  constexpr std::size_t kEnough = 64;
  if (looks_like_xdf(file.begin_bytes())) return true;
  const std::string unpacked = gunzip_begin(file.begin_bytes(), kEnough);
  return looks_like_xdf(std::as_bytes(std::span(unpacked)));
}

bool begins_as_table(OpenFile& file) {
  if (file.begin().starts_with(kOctaveText)) return false;  // whose variables are not columns of one table
  return is_text(file.begin()) || looks_like_utf16(file.begin_bytes());
}

bool holds_numpy(OpenFile& file) {
  return looks_like_npy(file.begin_bytes()) || zip_holds<looks_like_npz>(file);
}

/// Its signature is one byte, so that whatever has a longer one goes first.
bool begins_as_c3d(OpenFile& file) {
  return looks_like_c3d(file.begin_bytes()) && !likely_format(file.begin_bytes());
}

constexpr std::string_view kExports =
    "export it from the program that recorded it: Dexterit-E as .kinarm or .zip, Vicon Nexus as C3D or CSV, Qualisys "
    "QTM "
    "as C3D or TSV, LabVIEW as .lvm, Simulink and dSPACE as .mat, Delsys as CSV";

// ---- how it is read ----

template <Result<Contents> (*Decode)(std::span<const std::byte>)>
Result<Contents> whole(OpenFile& file) {
  const auto bytes = MBK_TRY(file.take());
  return Decode(bytes->bytes());
}

template <Result<Contents> (*Decode)(FileInPassing&)>
Result<Contents> in_passing(OpenFile& file) {
  auto passing = MBK_TRY(file.in_passing());
  MBK_TRY(passing.read_on());
  return Decode(passing);
}

Result<Contents> decode_mat(OpenFile& file) {
  const std::string_view begin = file.begin();
  if (begin.starts_with("MATLAB 7.3")) {
    return bad_data("the MAT v7.3 header is not followed by HDF5 data",
                    "copy the file again from where it was recorded");
  }
  if (looks_like_mat_level4(file.begin_bytes())) return whole<decode_mat_level4>(file);
  auto bytes = MBK_TRY(file.take());
  return decode_mat_level5(std::move(bytes));  // which keeps of it what it needs
}

Result<Contents> decode_xdf_file(OpenFile& file) {
  if (!looks_like_gzip(file.begin_bytes())) return whole<decode_xdf>(file);
  auto packed = MBK_TRY(file.take());
  const auto unpacked = MBK_TRY(gunzip(packed->bytes()));
  packed.reset();
  return decode_xdf(unpacked.bytes());
}

Result<Contents> decode_numpy(OpenFile& file) {
  const auto bytes = MBK_TRY(file.take());
  if (looks_like_npy(bytes->bytes())) return decode_npy(bytes->bytes());
  const auto archive = MBK_TRY(ZipArchive::open(bytes->bytes()));
  return decode_npz(archive);
}

Result<std::shared_ptr<const OpenTrials>> open_exam(OpenFile& file) {
  const auto bytes = MBK_TRY(file.take());
  return exam_trials(bytes, file.sha256());
}

/// Of a file that is decoded at once and may hold several records.
template <Result<std::vector<NamedContents>> (*Decode)(std::span<const std::byte>)>
Result<std::shared_ptr<const OpenTrials>> all_records(OpenFile& file) {
  const auto bytes = MBK_TRY(file.take());
  auto records = MBK_TRY(Decode(bytes->bytes()));
  return decoded_trials(std::move(records), file.sha256());
}

/// Text that is not a table may be text of another kind, which is reported instead of the position of the error.
Result<Contents> decode_table(OpenFile& file) {
  MBK_TRY(check_memory(file.size()));  // what its numbers take at most
  auto table = looks_like_utf16(file.begin_bytes()) ? whole<decode_csv>(file) : in_passing<decode_csv>(file);
  if (table) return table;
  if (const auto likely = likely_format(file.begin_bytes())) return not_read(*likely);
  if (table.error().code == kNoTable) return bad_data(table.error().message, std::string(kExports));
  return table;
}

constexpr auto kFormats = std::to_array<FileFormat>({
    {"HDF5", ".h5 .hdf5 .nwb .nc", "mbk's own; h5py, NWB, NetCDF-4", begins_as<hdf5::looks_like_hdf5>,
     whole<decode_hdf5>},
    {"MAT", ".mat", "MATLAB v4 to v7.3, Octave, Simulink, QUARC", looks_like_mat, decode_mat},
    {"XDF", ".xdf .xdfz", "Lab Streaming Layer", begins_as_xdf, decode_xdf_file},
    {"MCAP", ".mcap", "ROS 2", begins_as<looks_like_mcap>, in_passing<decode_mcap>},
    {"ROS bag", ".bag", "ROS 1", begins_as<looks_like_bag>, in_passing<decode_bag>},
    {"TRC", ".trc", "marker paths of OpenSim", text_begins_as<looks_like_trc>, whole<decode_trc>},
    {"OpenSim", ".sto .mot", "OpenSim's storages and motions", text_begins_as<looks_like_opensim>,
     whole<decode_opensim>},
    {"LVM", ".lvm", "LabVIEW measurement files", text_begins_as<looks_like_lvm>, nullptr, all_records<decode_lvm>},
    {"Vicon", ".csv", "Vicon Nexus: trajectories, devices, model outputs", text_begins_as<looks_like_vicon>,
     whole<decode_vicon>},
    {"Motive", ".csv", "OptiTrack Motive", text_begins_as<looks_like_motive>, whole<decode_motive>},
    {"Qualisys", ".tsv", "Qualisys Track Manager: markers", text_begins_as<looks_like_qualisys>,
     whole<decode_qualisys>},
    {"Delsys", ".csv", "EMGworks, Trigno Discover", text_begins_as<looks_like_delsys>, whole<decode_delsys>},
    {"AcqKnowledge", "", "BIOPAC AcqKnowledge, as text", text_begins_as<looks_like_acqknowledge>,
     whole<decode_acqknowledge>},
    {"LabChart", "", "ADInstruments LabChart, as text", text_begins_as<looks_like_labchart>, nullptr,
     all_records<decode_labchart>},
    {"Spike2", "", "CED Spike2, as text", text_begins_as<looks_like_spike2>, whole<decode_spike2>},
    {"CSV", ".csv .tsv", "tables of numbers as text, also .txt, .dat: spreadsheets, Python, libfranka, dSPACE",
     begins_as_table, decode_table},
    {"KINARM exam", ".kinarm .zip", "Dexterit-E", zip_holds<KinarmExam::is_exam>, nullptr, open_exam},
    {"NumPy", ".npy .npz", "numpy.save, numpy.savez", holds_numpy, decode_numpy},
    {"C3D", ".c3d", "motion capture: Vicon, Qualisys, KINARM", begins_as_c3d, whole<decode_c3d>},
    {"BIDS Motion", "", "the folder of a data set", nullptr, nullptr},
});

std::string names_of_formats() {
  std::vector<std::string_view> names;
  for (const FileFormat& format : kFormats) {
    if (format.looks_like != nullptr) names.push_back(format.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::span<const FileFormat> file_formats() {
  return kFormats;
}

Result<const FileFormat*> format_of(OpenFile& file) {
  for (const FileFormat& format : kFormats) {
    if (format.looks_like != nullptr && format.looks_like(file)) return &format;
  }
  if (ZipArchive::looks_like_zip(file.begin_bytes())) {
    auto bytes = MBK_TRY(file.bytes());
    MBK_TRY(ZipArchive::open(bytes->bytes()));
  }
  if (const auto likely = likely_format(file.begin_bytes())) return tl::unexpected(not_read(*likely).value());
  constexpr std::size_t kShown = 8;
  std::string bytes;
  bool zeros = true;
  for (const char c : file.begin()) zeros = zeros && c == '\0';
  for (const char c : file.begin().substr(0, kShown)) bytes += fmt::format("{:02x} ", static_cast<unsigned char>(c));
  if (zeros) return bad_data("the file begins with zeros only", "copy it again from where it was recorded");
  return bad_data(
      fmt::format("the format is unknown: the file is binary data ({}…), not {}", bytes, names_of_formats()),
      std::string(kExports));
}

std::vector<std::string_view> format_extensions() {
  std::vector<std::string_view> extensions;
  for (const FileFormat& format : kFormats) {
    for (std::string_view left = format.extensions; !left.empty();) {
      const std::string_view one = left.substr(0, left.find(' '));
      if (std::ranges::find(extensions, one) == extensions.end()) extensions.push_back(one);
      left.remove_prefix(std::min(left.size(), one.size() + 1));
    }
  }
  return extensions;
}

std::string readable_files() {
  return fmt::format("{} or the folder of a BIDS data set", fmt::join(format_extensions(), ", "));
}

}  // namespace mbk::recording
