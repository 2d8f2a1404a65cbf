// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/progress.hpp"

namespace partpose::apps {

/// Shows progress on standard error: a bar that redraws itself on a terminal, a line every tenth of the way in a log.
Progress terminal_progress(bool quiet);

}  // namespace partpose::apps
