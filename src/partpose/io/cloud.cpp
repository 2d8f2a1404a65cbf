// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/cloud.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/pcd.hpp"
#include "partpose/io/ply.hpp"
#include "partpose/io/text_reader.hpp"

namespace partpose {

PointCloud read_cloud(const std::filesystem::path& path) {
  check_is_file(path);
  const std::string extension = path.extension().string();
  if (equal_ignoring_case(extension, ".pcd")) return read_pcd(path);
  if (equal_ignoring_case(extension, ".ply")) return read_ply(path);
  throw Error("{}: extension {}, a point cloud is a .pcd or .ply file", path.string(), in_quotes(extension));
}

}  // namespace partpose
