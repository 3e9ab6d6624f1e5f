#include "mbk/base/config/text_file.h"

#include <fstream>
#include <system_error>

namespace mbk::config {

Result<std::string> read_text_file(const std::filesystem::path& file, std::size_t largest) {
  std::error_code code;
  const std::filesystem::file_status status = std::filesystem::status(file, code);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    return bad_data("this is not a regular file", "check its name, or copy its contents to a file", file.string());
  }
  std::ifstream in(file, std::ios::binary);
  std::string text(largest + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!in.is_open() || in.bad())
    return bad_data("the file cannot be read", "check its name and permissions", file.string());
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

}  // namespace mbk::config
