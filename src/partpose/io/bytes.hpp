// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace partpose {

static_assert(std::endian::native == std::endian::little, "the readers and writers of binary files rely on it");

/// The value whose bytes begin at `offset`, unaligned; the caller has checked that all of them are there.
template <typename T>
T load(std::string_view bytes, std::size_t offset, std::endian order = std::endian::little) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes.data() + offset, sizeof(T));
  if (order == std::endian::big) std::ranges::reverse(raw);
  return std::bit_cast<T>(raw);
}

/// Appends the value's bytes, little-endian.
template <typename T>
void store(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// As a 32-bit float; nothing for a finite number too large for one.
inline std::optional<float> narrowed(double value) {
  const auto narrow = static_cast<float>(value);
  if (std::isinf(narrow) && std::isfinite(value)) return std::nullopt;
  return narrow;
}

}  // namespace partpose
