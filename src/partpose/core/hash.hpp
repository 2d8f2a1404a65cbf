// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace partpose {

/// FNV-1a, 64 bits, as 16 hexadecimal digits: tells whether content changed, not who changed it.
inline std::string content_hash(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3ull;
  return fmt::format("{:016x}", hash);
}

}  // namespace partpose
