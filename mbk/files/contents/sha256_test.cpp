#include "mbk/files/contents/sha256.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace mbk::recording {
namespace {

std::string hash(std::string_view text) {
  return sha256(std::as_bytes(std::span(text)));
}

// Vectors of FIPS 180-2, appendix B, and of NIST's SHAVS.
TEST(Sha256, MatchesPublishedVectors) {
  EXPECT_EQ(hash(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hash("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hash("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(hash(std::string(1'000'000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, InstructionsAndArithmeticAgreeAtEveryLength) {
  std::mt19937 random(1);
  std::vector<std::byte> bytes(300);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  for (std::size_t n = 0; n <= bytes.size(); ++n) {
    const auto part = std::span(bytes).first(n);
    ASSERT_EQ(sha256(part), detail::sha256_portable(part)) << n << " bytes";
  }
}

TEST(Sha256, OfPiecesIsThatOfTheWhole) {
  std::mt19937 random(2);
  std::vector<std::byte> bytes(1000);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  for (int trial = 0; trial < 200; ++trial) {
    const auto part = std::span(bytes).first(random() % 1001);
    Sha256 sum;
    for (auto rest = part; !rest.empty();) {
      const std::size_t count = std::min<std::size_t>(rest.size(), 1 + random() % 150);
      sum.add(rest.first(count));
      rest = rest.subspan(count);
    }
    ASSERT_EQ(sum.hex(), sha256(part)) << part.size() << " bytes";
  }
}

}  // namespace
}  // namespace mbk::recording
