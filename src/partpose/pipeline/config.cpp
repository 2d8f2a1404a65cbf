// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/config.hpp"

#include "partpose/core/error.hpp"
#include "partpose/descriptor/descriptors.hpp"

namespace partpose {

void DatabaseOptions::check() const {
  if (normals != "estimated" && normals != "mesh")
    throw Error("normals \"{}\": must be \"estimated\" or \"mesh\"", normals);
  if (noise_levels_mm.empty()) throw Error("noise_levels_mm: give at least one, 0 for the views as they are");
  for (const float level : noise_levels_mm)
    if (!(level >= 0)) throw Error("noise_levels_mm {}: must be 0 or more", level);
}

void GlobalPipelineConfig::check() const { make_global_descriptor(global_descriptor, descriptors); }

}  // namespace partpose
