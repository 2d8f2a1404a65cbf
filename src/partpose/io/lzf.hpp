// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace partpose {

/// Compressed in the format of Marc Lehmann's liblzf, which PCD's binary_compressed uses. Bytes that do not compress
/// grow by one in 32.
std::string lzf_compress(std::string_view bytes);

/// The `size` bytes that were compressed. Error, naming the byte in `compressed`, unless it holds exactly that many;
/// nothing is allocated for a size that it cannot hold.
std::string lzf_decompress(std::string_view compressed, std::size_t size);

}  // namespace partpose
