// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands.hpp"

#include "partpose/core/progress.hpp"

#include <cstdio>
#include <string>
#include <string_view>

namespace partpose::apps {

/// Shows progress on standard error: a bar that redraws itself on a terminal, a line every tenth of the way in a log,
/// nothing with --quiet. Throws Interrupted when it is called after a signal came.
Progress terminal_progress(const Common& common);

enum class Colour { red = 31, green = 32, yellow = 33, bold = 1 };

/// The text in a colour where `stream` is a terminal, NO_COLOR is not set and TERM is not "dumb"; plain otherwise.
std::string coloured(std::FILE* stream, Colour colour, std::string_view text);

/// One line on standard error: "partpose: ..."
void complain(std::string_view message);
/// The same with --verbose only.
void note(const Common& common, std::string_view message);

}  // namespace partpose::apps
