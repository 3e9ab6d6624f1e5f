#include "mbk/files/hdf5/deflate.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <string>

#include "mbk/base/numeric/random.h"

namespace mbk::hdf5 {
namespace {

std::string inflated(const std::string& stream, std::size_t size) {
  std::string bytes(size + 1, '?');
  auto got = static_cast<uLongf>(bytes.size());
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &got, reinterpret_cast<const Bytef*>(stream.data()),
                       static_cast<uLong>(stream.size())),
            Z_OK);
  bytes.resize(got);
  return bytes;
}

std::string noise(numeric::Random& random, std::size_t size) {
  std::string bytes(size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random.below(256));
  return bytes;
}

TEST(DeflatedPlanes, ComeBackWhateverTheyHold) {
  numeric::Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const auto plane = static_cast<std::size_t>(1 + random.below(trial % 10 == 0 ? 150'000 : 3000));
    std::string bytes;
    const int planes = static_cast<int>(random.below(9));
    for (int k = 0; k < planes; ++k) {
      switch (random.below(4)) {
        case 0:
          bytes += noise(random, plane);
          break;
        case 1:
          bytes += std::string(plane, static_cast<char>(random.below(256)));
          break;
        case 2:  // noise that comes again
          bytes += noise(random, plane / 2) + bytes.substr(0, plane - plane / 2);
          break;
        default:
          for (std::size_t i = 0; i < plane; ++i) bytes += static_cast<char>(i / 7);
      }
    }
    bytes += noise(random, static_cast<std::size_t>(random.below(plane)));  // a last one that is shorter
    EXPECT_EQ(inflated(deflated_planes(bytes, plane), bytes.size()), bytes) << "trial " << trial;
  }
}

TEST(DeflatedPlanes, OfNoiseAreHardlyLongerAndOthersShort) {
  constexpr std::size_t kPlane = 32'768;
  numeric::Random random(8);
  const std::string first = noise(random, 3 * kPlane), second = noise(random, 2 * kPlane);
  const std::string constant(kPlane, 'c');
  const std::string packed = deflated_planes(first + constant + second + constant, kPlane);
  EXPECT_LT(packed.size(), first.size() + second.size() + 1000);
  // what is stored can be seen in it
  EXPECT_NE(packed.find(first.substr(100, 200)), std::string::npos);
  EXPECT_NE(packed.find(second.substr(100, 200)), std::string::npos);
}

}  // namespace
}  // namespace mbk::hdf5
