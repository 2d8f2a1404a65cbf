// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/png.hpp"
#include "partpose/synthesis/synthetic_scene.hpp"

namespace partpose {

/// The frame shaded by its ideal depth: catalogue parts in bright colours of their own, unknown parts magenta, clutter
/// brown, what is put before a part dark, the table light.
ColourImage picture_of(const SyntheticScene& scene);

}  // namespace partpose
