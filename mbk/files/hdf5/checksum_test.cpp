#include "mbk/files/hdf5/checksum.h"

#include <gtest/gtest.h>

namespace mbk::hdf5 {
namespace {

Bytes bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

TEST(Lookup3, GivesThePublishedValues) {
  EXPECT_EQ(lookup3(bytes_of("")), 0xdeadbeefU);  // Jenkins 2006, lookup3.c, driver5
  EXPECT_EQ(lookup3(bytes_of("Four score and seven years ago")), 0x17770551U);
}

TEST(Lookup3, DependsOnEveryByte) {
  for (std::size_t size = 1; size < 40; ++size) {
    const std::string text(size, 'a');
    const std::uint32_t sum = lookup3(bytes_of(text));
    for (std::size_t i = 0; i < size; ++i) {
      std::string other = text;
      other[i] = 'b';
      EXPECT_NE(lookup3(bytes_of(other)), sum) << i << " of " << size;
    }
  }
}

TEST(Fletcher32, AddsBigEndianWords) {
  EXPECT_EQ(fletcher32(bytes_of("")), 0U);
  EXPECT_EQ(fletcher32(bytes_of("ab")), 0x61626162U);
  // Words 0x6162, 0x6364: sums 0xC4C6 and 0x12628, folded to 0x2629.
  EXPECT_EQ(fletcher32(bytes_of("abcd")), 0x2629C4C6U);
  EXPECT_EQ(fletcher32(bytes_of("abc")), fletcher32(bytes_of(std::string_view("abc\0", 4))));
}

}  // namespace
}  // namespace mbk::hdf5
