// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/json.hpp"

#include <string>

namespace partpose {

/// For people, of a camera file that could not be read: which program seems to have written it (RealSense, ROS, Open3D,
/// OpenCV, BOP), and the line to write in its place, with "..." for what it does not say. Empty: it is of none of them.
std::string foreign_camera_hint(const Json& json);

}  // namespace partpose
