#include "mbk/files/recording/write_bids.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>

#include "mbk/files/bids/encode_run.h"
#include "mbk/files/recording/write.h"
#include "mbk/files/recording/write_file.h"

namespace mbk::recording {

namespace fs = std::filesystem;

Result<fs::path> write_bids(const Recording& recording, const fs::path& folder, std::string_view name, bool overwrite,
                            Readers readers, std::string_view title) {
  const auto run = MBK_TRY(parse_bids_name(name));
  if (auto ok = check_writable(recording); !ok) return tl::unexpected(ok.error().in(folder.string()));
  std::error_code code;
  if (fs::exists(folder, code)) {
    if (!fs::is_directory(folder, code)) {
      return fail(ErrorKind::usage, "this is a file, but a data set is a folder", "choose another name",
                  folder.string());
    }
    if (!fs::is_empty(folder, code) && !fs::exists(folder / "dataset_description.json", code)) {
      return fail(ErrorKind::usage, "the folder contains files that do not belong to a BIDS data set",
                  "name a new folder", folder.string());
    }
  }
  const auto existing = [&](const std::string& path) -> std::optional<std::string> {
    if (std::error_code unknown; !fs::is_regular_file(folder / path, unknown)) return std::nullopt;
    std::ifstream stream(folder / path, std::ios::binary);
    if (!stream) return std::nullopt;
    return std::string{std::istreambuf_iterator<char>(stream), {}};
  };
  const auto files = encode_bids(recording, run, existing, title);
  if (!files) return tl::unexpected(files.error().in(folder.string()));
  const fs::path motion = folder / files->back().path;
  if (!overwrite && fs::exists(motion, code)) {
    return fail(ErrorKind::usage, "the run already exists", "name another run, or pass --overwrite to replace it",
                motion.string());
  }
  fs::create_directories(motion.parent_path(), code);
  if (code) {
    return bad_data(fmt::format("the folder cannot be created: {}", code.message()), "check its permissions",
                    motion.parent_path().string());
  }
  for (const BidsFile& file : *files) {
    MBK_TRY(write_file(folder / file.path, true, file.text, readers));
  }
  return motion;
}

std::vector<std::string> lost_in_bids(const Recording& recording) {
  std::vector<std::string> lost = withheld_from_bids(recording);
  for (std::string& frame : lost_frames(recording, "BIDS")) lost.push_back(std::move(frame));
  return lost;
}

}  // namespace mbk::recording
