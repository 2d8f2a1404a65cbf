// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/foreign_camera.hpp"

#include "partpose/io/camera_json.hpp"
#include "partpose/io/testing.hpp"

namespace partpose {
namespace {

using namespace testing;

std::string hint_of(const std::string& text) { return foreign_camera_hint(Json::parse(text)); }

TEST(ForeignCamera, OursIsOfNoOtherProgram) {
  EXPECT_EQ(hint_of(R"({"width": 640, "height": 480, "fx": 615, "fy": 616, "depth_scale_mm": 1})"), "");
  EXPECT_EQ(hint_of(R"({"fx": 615, "focal_x": 3})"), "");
  EXPECT_EQ(hint_of("[1, 2]"), "");
}

TEST(ForeignCamera, RealSense) {
  const std::string hint = hint_of(R"({"width": 640, "height": 480, "ppx": 321.5, "ppy": 240.25, "fx": 615.5,
      "fy": 616, "model": "distortion.brown_conrady", "coeffs": [0, 0, 0, 0, 0], "depth_scale": 0.001})");
  EXPECT_CONTAINS(hint, "looks like a file of RealSense");
  EXPECT_CONTAINS(
      hint, R"({"width": 640, "height": 480, "fx": 615.5, "fy": 616, "cx": 321.5, "cy": 240.25, "depth_scale_mm": 1})");
  EXPECT_FALSE(contains(hint, "distortion"));
  EXPECT_CONTAINS(
      hint_of(R"({"depth": {"ppx": 321.5, "coeffs": [0.1, 0]}, "color": {"ppx": 1}})"),
      R"("width": ..., "height": ..., "fx": ..., "fy": ..., "cx": 321.5, "cy": ..., "depth_scale_mm": ...)");
  EXPECT_CONTAINS(hint_of(R"({"ppx": 321.5, "coeffs": [0.1, 0]})"), "its distortion is not taken into account");
}

TEST(ForeignCamera, MatricesByRowsAndByColumns) {
  const std::string pinhole = R"("fx": 615, "fy": 616, "cx": 320, "cy": 240)";
  const std::string ros = hint_of(R"({"width": 640, "height": 480, "K": [615, 0, 320, 0, 616, 240, 0, 0, 1]})");
  EXPECT_CONTAINS(ros, "looks like a file of ROS");
  EXPECT_CONTAINS(ros, pinhole);
  const std::string open3d =
      hint_of(R"({"intrinsic": {"width": 640, "intrinsic_matrix": [615, 0, 0, 0, 616, 0, 320, 240, 1]}})");
  EXPECT_CONTAINS(open3d, "looks like a file of Open3D");
  EXPECT_CONTAINS(open3d, R"("width": 640)");
  EXPECT_CONTAINS(open3d, pinhole);
  const std::string opencv = hint_of(R"({"image_width": 640, "camera_matrix": {"rows": 3, "cols": 3,
      "data": [615, 0, 320, 0, 616, 240, 0, 0, 1]}, "dist_coeffs": [[0.1, 0, 0, 0]]})");
  EXPECT_CONTAINS(opencv, "looks like a file of OpenCV");
  EXPECT_CONTAINS(opencv, pinhole);
  EXPECT_CONTAINS(opencv, "its distortion");
  EXPECT_CONTAINS(hint_of(R"({"camera_matrix": [[615, 0, 320], [0, 616, 240], [0, 0, 1]]})"), pinhole);
  EXPECT_CONTAINS(hint_of(R"({"K": [1, 2]})"), R"("fx": ...)");
}

TEST(ForeignCamera, TheUnitOfADepthScaleIsSeenByItsSize) {
  EXPECT_CONTAINS(hint_of(R"({"depth_scale": 0.1})"), R"("depth_scale_mm": 0.1})");
  EXPECT_CONTAINS(hint_of(R"({"depth_scale": 0.00025})"), R"("depth_scale_mm": 0.25})");
  EXPECT_CONTAINS(hint_of(R"({"depth_scale": 5000})"), R"("depth_scale_mm": ...})");
}

TEST(ForeignCamera, IsToldWhereItIsRead) {
  const TempFolder folder;
  const auto path = folder.file("camera.json", R"({"width": 640, "height": 480, "fx": 615, "fy": 615, "ppx": 320,
                                                   "ppy": 240, "coeffs": [0, 0, 0, 0, 0]})");
  EXPECT_CONTAINS(
      error_of([&] { read_camera(path); }),
      path.string() + ": key \"cx\" is missing; it looks like a file of RealSense; write {\"width\": 640, ");
}

}  // namespace
}  // namespace partpose
