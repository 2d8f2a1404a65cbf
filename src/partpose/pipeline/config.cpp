// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/config.hpp"

#include "partpose/core/error.hpp"
#include "partpose/descriptor/descriptors.hpp"

namespace partpose {

void DatabaseOptions::check() const {
  if (normals != "estimated" && normals != "mesh")
    throw Error("normals \"{}\": must be \"estimated\" or \"mesh\"", normals);
}

void GlobalPipelineConfig::check() const { make_global_descriptor(global_descriptor, descriptors); }

}  // namespace partpose
