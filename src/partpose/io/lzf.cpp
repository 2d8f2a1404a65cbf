// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/lzf.hpp"

#include "partpose/core/error.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace partpose {

namespace {

// The format: a control byte c < 32 and c + 1 literal bytes, or a control byte with a length (minus 2) in its upper
// three bits, for a length of 7 or more a byte with what is beyond 7, and a distance (minus 1) whose upper five bits
// are the control byte's lower ones and whose other eight bits are a byte of their own.
constexpr std::size_t longest_literal = 32;
constexpr std::size_t shortest_copy = 3;
constexpr std::size_t longest_copy = 2 + 7 + 255;
constexpr std::size_t farthest = 1 << 13;
constexpr std::size_t bytes_of_longest_copy = 3;

/// Of the three bytes at `at`, by multiplicative hashing (Knuth, The Art of Computer Programming, vol. 3, 6.4).
std::size_t hash(std::string_view bytes, std::size_t at, int bits) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[at + i])); };
  return ((byte(0) << 16 | byte(1) << 8 | byte(2)) * 2654435761u) >> (32 - bits);
}

void append_literals(std::string& out, std::string_view literals) {
  while (!literals.empty()) {
    const auto run = literals.substr(0, longest_literal);
    out += static_cast<char>(run.size() - 1);
    out += run;
    literals.remove_prefix(run.size());
  }
}

void append_copy(std::string& out, std::size_t distance, std::size_t length) {
  const std::size_t far = distance - 1, long_ = length - 2;
  out += static_cast<char>(std::min<std::size_t>(long_, 7) << 5 | far >> 8);
  if (long_ >= 7) out += static_cast<char>(long_ - 7);
  out += static_cast<char>(far & 0xff);
}

}  // namespace

std::string lzf_compress(std::string_view bytes) {
  constexpr int hash_bits = 14;
  constexpr std::size_t nowhere = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> last_seen(std::size_t{1} << hash_bits, nowhere);
  std::string out;
  std::size_t at = 0, first_literal = 0;
  while (at + shortest_copy <= bytes.size()) {
    const std::size_t seen = std::exchange(last_seen[hash(bytes, at, hash_bits)], at);
    std::size_t length = 0;
    if (seen != nowhere && at - seen <= farthest) {
      const std::size_t limit = std::min(longest_copy, bytes.size() - at);
      while (length < limit && bytes[seen + length] == bytes[at + length]) ++length;
    }
    if (length < shortest_copy) {
      ++at;
      continue;
    }
    append_literals(out, bytes.substr(first_literal, at - first_literal));
    append_copy(out, at - seen, length);
    at += length;
    first_literal = at;
  }
  append_literals(out, bytes.substr(first_literal));
  return out;
}

std::string lzf_decompress(std::string_view compressed, std::size_t size) {
  if (size / longest_copy > compressed.size() / bytes_of_longest_copy)
    throw Error("LZF data, byte 0: {} compressed bytes cannot hold {}", compressed.size(), size);
  std::string out(size, '\0');
  std::size_t in = 0, filled = 0;
  const auto next = [&] {
    if (in == compressed.size()) throw Error("LZF data, byte {}: truncated, {} of {} bytes unpacked", in, filled, size);
    return static_cast<std::uint8_t>(compressed[in++]);
  };
  const auto expect_room = [&](std::size_t length) {
    if (length > size - filled) throw Error("LZF data, byte {}: more than the expected {} bytes", in, size);
  };
  while (in < compressed.size()) {
    const std::size_t control = next();
    if (control < longest_literal) {
      const std::size_t length = control + 1;
      expect_room(length);
      for (std::size_t i = 0; i < length; ++i) out[filled++] = static_cast<char>(next());
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) length += next();
    length += 2;
    const std::size_t distance = ((control & 0x1f) << 8 | next()) + 1;
    expect_room(length);
    if (distance > filled)
      throw Error("LZF data, byte {}: a copy from {} bytes back where only {} are unpacked", in, distance, filled);
    // Byte by byte: the two ranges may overlap, which repeats a pattern.
    for (std::size_t i = 0; i < length; ++i, ++filled) out[filled] = out[filled - distance];
  }
  if (filled != size) throw Error("LZF data, byte {}: truncated, {} of {} bytes unpacked", in, filled, size);
  return out;
}

}  // namespace partpose
