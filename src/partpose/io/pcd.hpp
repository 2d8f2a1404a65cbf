// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/point_cloud.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace partpose {

enum class PcdEncoding { ascii, binary, binary_compressed };

/// A PCD file (0.5 to 0.7, any encoding) in mm. Fields x y z, of 4 or 8 byte floats, are needed; normal_x normal_y
/// normal_z and curvature are read when there; all other fields and the viewpoint are skipped. An organized cloud keeps
/// its width and height, missing points are NaN as in the file; a file without points is an empty cloud. Error, naming
/// the file and the byte (and line, in the header and in ASCII data), when anything is not as the format says. Zero
/// bytes behind the data are no error: PCL before 1.8 wrote them.
PointCloud read_pcd(const std::filesystem::path& path);

/// PCD 0.7 in mm with 32-bit floats, normals and curvatures when the cloud has them. Read back, the numbers have the
/// same bits in all encodings (but for the payload of a NaN in ASCII). Error when the file cannot be written, or a
/// cloud is too large for binary_compressed (4 GiB).
void write_pcd(const std::filesystem::path& path, const PointCloud& cloud,
               PcdEncoding encoding = PcdEncoding::binary_compressed);

/// The field `field_name` of every point of a PCD file: one row per point, as long as the field's COUNT. So does PCL
/// store descriptors: a VFHSignature308 is one point with the field "vfh" of COUNT 308. Error as for read_pcd, and when
/// the field is not there or not of 4 or 8 byte floats.
std::vector<std::vector<float>> read_pcd_histograms(const std::filesystem::path& path, const std::string& field_name);

/// One point per row, with the one field `field_name` of COUNT `bins`, binary. Error when a row has another length,
/// when `bins` is not positive, when the name is empty or has white space, or when the file cannot be written.
void write_pcd_histograms(const std::filesystem::path& path, const std::string& field_name, int bins,
                          const std::vector<std::vector<float>>& rows);

}  // namespace partpose
