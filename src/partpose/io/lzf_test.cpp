// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/lzf.hpp"

#include "partpose/io/testing.hpp"

namespace partpose {
namespace {

using namespace testing;
using namespace std::string_literals;

/// Random bytes of an alphabet: the smaller, the better they compress.
std::string noise(std::size_t size, unsigned alphabet, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes(size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random() % alphabet);
  return bytes;
}

TEST(Lzf, WritesTheFormatOfLiblzf) {
  EXPECT_EQ(lzf_compress(""), "");
  EXPECT_EQ(lzf_compress("ab"), "\x01"s + "ab");
  EXPECT_EQ(lzf_compress("abcabc"), "\x02"s + "abc" + "\x20\x02"s) << "3 bytes from 3 back";
  EXPECT_EQ(lzf_compress(std::string(10, 'a')), "\0"s + "a" + "\xe0\0\0"s) << "9 bytes from 1 back";
  EXPECT_EQ(lzf_compress(std::string(265, 'a')), "\0"s + "a" + "\xe0\xff\0"s) << "the longest copy";
}

TEST(Lzf, ReadsTheFormatOfLiblzf) {
  EXPECT_EQ(lzf_decompress("", 0), "");
  EXPECT_EQ(lzf_decompress("\x02"s + "abc" + "\x40\x02"s, 7), "abcabca");
  const std::string far = noise(8192, 256, 3);
  std::string packed;
  for (std::size_t i = 0; i < far.size(); i += 32) packed.append("\x1f").append(far, i, 32);
  EXPECT_EQ(lzf_decompress(packed + "\x3f\xff", 8195), far + far.substr(0, 3)) << "the farthest copy";
}

TEST(Lzf, GivesBackEverySizeOfEveryKind) {
  for (const unsigned alphabet : {1, 2, 5, 256})
    for (std::size_t size = 0; size < 700; ++size) {
      const std::string bytes = noise(size, alphabet, static_cast<unsigned>(size));
      ASSERT_EQ(lzf_decompress(lzf_compress(bytes), size), bytes) << size << " bytes of " << alphabet;
    }
  for (const unsigned alphabet : {1, 3, 256}) {
    const std::string bytes = noise(300001, alphabet, 1);
    EXPECT_EQ(lzf_decompress(lzf_compress(bytes), bytes.size()), bytes);
  }
}

TEST(Lzf, CompressesAndNeverGrowsMuch) {
  EXPECT_LT(lzf_compress(std::string(100000, 'z')).size(), 100000 / 80);
  const std::string bytes = noise(100000, 256, 1);
  EXPECT_LE(lzf_compress(bytes).size(), bytes.size() + bytes.size() / 32 + 1);
}

TEST(Lzf, RefusesWhatDoesNotHoldExactlyTheSize) {
  const std::string packed = "\x02"s + "abc" + "\x20\x02"s;  // 6 bytes
  EXPECT_EQ(error_of([&] { lzf_decompress(packed, 7); }), "LZF data, byte 6: truncated, 6 of 7 bytes unpacked");
  EXPECT_EQ(error_of([&] { lzf_decompress(packed, 5); }), "LZF data, byte 6: more than the expected 5 bytes");
  EXPECT_EQ(error_of([&] { lzf_decompress(packed, 2); }), "LZF data, byte 1: more than the expected 2 bytes");
  EXPECT_CONTAINS(error_of([&] { lzf_decompress("a", 0); }), "byte 1: truncated");
  EXPECT_CONTAINS(error_of([&] { lzf_decompress("\x02"s + "ab", 3); }), "byte 3: truncated");
  EXPECT_CONTAINS(error_of([&] { lzf_decompress("\0"s + "a" + "\xe0"s, 100); }), "byte 3: truncated");
  EXPECT_CONTAINS(error_of([&] { lzf_decompress("\0"s + "a" + "\x20\x01"s, 4); }),
                  "byte 4: a copy from 2 bytes back where only 1 are unpacked");
}

TEST(Lzf, AllocatesNothingForAnImpossibleSize) {
  EXPECT_CONTAINS(error_of([] { lzf_decompress("\0a"s, std::size_t{1} << 62); }), "2 compressed bytes cannot hold");
}

TEST(Lzf, SurvivesAnything) {
  int readable = 0;
  for (unsigned seed = 0; seed < 20000; ++seed) {
    const std::string bytes = noise(1 + seed % 40, 256, seed);
    readable += error_of([&] { lzf_decompress(bytes, seed % 90); }) == "no error";
  }
  EXPECT_GT(readable, 0);
  EXPECT_LT(readable, 1000);
}

}  // namespace
}  // namespace partpose
