#include "fuzz/fuzz.h"
#include "mbk/files/contents/test_bytes.h"
#include "mbk/files/recording/mat_level5.h"

namespace mbk::fuzz {
namespace {

/// After this letter follows a variable that is compressed by the target: changing a compressed one would only break
/// its checksum.
constexpr char kCompress = 'Z';

std::string file_of(std::string_view input) {
  if (!input.starts_with(kCompress)) return std::string(input);
  return recording::test::header5() + recording::test::compressed5(std::string(input.substr(1)));
}

}  // namespace

std::vector<std::string> seeds() {
  using namespace recording::test;
  const Matrix column = Vector::LinSpaced(8, 0.0, 0.007);
  const std::string text = matrix5("name", {1, 3}, element5(4, std::string("a\0b\0c\0", 6)), 4);
  const std::string integers =
      matrix5("n", {2, 2},
              element5(3, raw(std::int16_t{1}) + raw(std::int16_t{-2}) + raw(std::int16_t{3}) + raw(std::int16_t{-4})));
  const std::string trial = struct5("trial", {{"x", double5("", column)}, {"name", text}});
  const std::string events = struct5("events", {{"time", double5("", Matrix::Ones(1, 1))},
                                                {"value", double5("", Matrix::Ones(1, 1))},
                                                {"name", matrix5("", {1, 1}, text, 1)}});
  return {header5() + double5("logs", logs(4)),
          header5(true) + double5("logs", logs(4), true),
          header5() + double5("t", column) + double5("x", column) + text + integers,
          header5() + trial + struct5("metadata", {{"participant", text}}),
          header5() + compressed5(double5("logs", logs(4))) + compressed5(events),
          kCompress + double5("logs", logs(4)),
          kCompress + trial,
          kCompress + events,
          header5() + matrix5("c", {2, 2}, double5("", column) + text + trial + matrix5("", {1, 1}, text, 1), 1),
          header5() + matrix5("p", {2, 1, 2}, element5(9, raw(1.0) + raw(2.0) + raw(3.0) + raw(4.0))) +
              matrix5("t", {1, 3}, element5(4, ""), 4)};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string file = mbk::fuzz::file_of(mbk::fuzz::text_of(data, size));
  mbk::fuzz::check_decoded(mbk::recording::decode_mat_level5(std::as_bytes(std::span(file))), size + file.size());
  return 0;
}
