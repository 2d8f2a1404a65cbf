// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace partpose {

/// The entry of `known` that needs the fewest single-letter changes to become `word`; empty when `known` is.
std::string nearest_word(std::string_view word, std::span<const std::string> known);
/// The same where at least half of its letters are the word's: it may have been meant. Empty otherwise.
std::string similar_word(std::string_view word, std::span<const std::string> known);

}  // namespace partpose
