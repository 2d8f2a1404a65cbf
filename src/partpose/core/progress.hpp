// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

namespace partpose {

/// Told now and then during long work, one call at a time: `done` of `total` steps of `what`. May be empty.
using Progress = std::function<void(std::string_view what, std::size_t done, std::size_t total)>;

}  // namespace partpose
