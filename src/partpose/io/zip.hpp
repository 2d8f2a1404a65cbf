// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace partpose {

/// The beginning, at most `most_bytes`, of the first file in a ZIP archive whose name ends with `ending` (any case).
/// Throws Error naming the archive and the byte where it stops being one, and when there is no such file.
std::string zip_entry(std::string_view archive, std::string_view ending, std::size_t most_bytes, std::string_view name);

}  // namespace partpose
