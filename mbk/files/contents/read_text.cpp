#include "mbk/files/contents/read_text.h"

#include <cstdint>
#include <fstream>
#include <iterator>
#include <system_error>

#include "mbk/base/core/requester.h"

namespace mbk {

Result<std::string> read_text(const std::filesystem::path& file) {
  if (const Requester* const requester = Requester::current()) {
    if (const std::string* const document = requester->document(file)) return *document;
  }
  constexpr std::uintmax_t kLargest = 256u << 20u;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    return bad_data(std::filesystem::exists(file, error) ? "not a file" : "no such file", "check the name",
                    file.string());
  }
  if (std::filesystem::file_size(file, error) > kLargest)
    return bad_data("the file is larger than 256 MB", "check the name: a result is much smaller", file.string());
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream.good() && !stream.eof()) return bad_data("cannot be read", "check its permissions", file.string());
  if (text.empty()) return bad_data("the file is empty", "copy it again", file.string());
  return text;
}

}  // namespace mbk
