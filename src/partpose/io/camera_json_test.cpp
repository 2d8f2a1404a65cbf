// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/camera_json.hpp"

#include "partpose/io/testing.hpp"

namespace partpose {
namespace {

using namespace testing;

const std::string camera_text = R"({"width": 640, "height": 480, "fx": 615.5, "fy": 616.25, "cx": 319.5, "cy": 239,
                                    "depth_scale_mm": 0.125})";

TEST(CameraJson, ReadsEveryKey) {
  const TempFolder folder;
  const auto camera = read_camera(folder.file("camera.json", camera_text));
  EXPECT_EQ(camera.intrinsics.width, 640);
  EXPECT_EQ(camera.intrinsics.height, 480);
  EXPECT_EQ(camera.intrinsics.fx, 615.5);
  EXPECT_EQ(camera.intrinsics.fy, 616.25);
  EXPECT_EQ(camera.intrinsics.cx, 319.5);
  EXPECT_EQ(camera.intrinsics.cy, 239);
  EXPECT_EQ(camera.depth_scale_mm, 0.125);
}

TEST(CameraJson, RoundTripKeepsTheBits) {
  const TempFolder folder;
  CameraFile camera;
  camera.intrinsics = {1281, 719, 1.0 / 3, 614.4378051757812, -0.1, 2e-17};
  camera.depth_scale_mm = 0.1;
  write_camera(folder / "camera.json", camera);
  const auto again = read_camera(folder / "camera.json");
  EXPECT_EQ(again.intrinsics.width, 1281);
  EXPECT_EQ(again.intrinsics.height, 719);
  EXPECT_EQ(again.intrinsics.fx, camera.intrinsics.fx);
  EXPECT_EQ(again.intrinsics.fy, camera.intrinsics.fy);
  EXPECT_EQ(again.intrinsics.cx, camera.intrinsics.cx);
  EXPECT_EQ(again.intrinsics.cy, camera.intrinsics.cy);
  EXPECT_EQ(again.depth_scale_mm, camera.depth_scale_mm);
}

TEST(CameraJson, SaysWhatIsWrong) {
  const TempFolder folder;
  const auto reading = [&](const std::string& from, const std::string& to) {
    const auto path = folder.file("camera.json", replaced(camera_text, from, to));
    return replaced(error_of([&] { read_camera(path); }), path.string() + ": ", "");
  };
  EXPECT_EQ(reading("\"cx\": 319.5,", ""), "key \"cx\" is missing");
  EXPECT_EQ(reading(",\n                                    \"depth_scale_mm\": 0.125", ""),
            "key \"depth_scale_mm\" is missing; write \"depth_scale_mm\": 1 where one unit of the depth image is 1 mm, "
            "0.1 where "
            "it is 0.1 mm");
  EXPECT_EQ(reading("\"fx\"", "\"focal_x\": 1, \"fx\""), "unknown key \"focal_x\"; did you mean \"fx\"?");
  EXPECT_EQ(reading("0.125", "0"), "depth_scale_mm 0: must be positive");
  EXPECT_EQ(reading("0.125", "-1"), "depth_scale_mm -1: must be positive");
  EXPECT_CONTAINS(reading("615.5", "-615.5"), "focal length fx = -615.5");
  EXPECT_CONTAINS(reading("480", "0"), "640 x 0 px");
  EXPECT_CONTAINS(reading("640", "640.5"), "key \"width\": expected a whole number");
}

TEST(CameraDoubt, OrdinaryCamerasAndWindowsOfThemHaveNone) {
  EXPECT_EQ(doubt_about({640, 480, 607.2, 607.2, 321.4, 241.9}), "");
  EXPECT_EQ(doubt_about({512, 424, 365, 365, 254.9, 205.4}), "");
  EXPECT_EQ(doubt_about({2448, 2048, 5500, 5500, 1223, 1023}), "");
  EXPECT_EQ(doubt_about({320, 576, 504, 504, 159, 288}), "");
  for (const double x : {0.35, 0.45, 0.5, 0.6, 0.65})
    for (const double y : {0.35, 0.45, 0.5, 0.6, 0.65})
      for (const int height : {360, 480, 512, 640, 800})
        EXPECT_EQ(doubt_about({640, height, 600, 600, x * 640, y * height}), "") << x << " " << y << " " << height;
  EXPECT_EQ(doubt_about({100, 80, 600, 600, -200, 150}), "") << "a window beside the principal point";
  EXPECT_EQ(doubt_about({640, 240, 600, 300, 319.5, 119.5}), "") << "rows averaged two by two";
}

TEST(CameraDoubt, SaysWhatIsHardlyEverSo) {
  EXPECT_EQ(doubt_about({640, 480, 615, 615, 239.5, 319.5}),
            "cx 239.5 and cy 319.5 are the middle of 480 x 640 px, the image is 640 x 480 px: are they swapped?");
  EXPECT_CONTAINS(doubt_about({848, 480, 425, 425, 238, 426}), "are they swapped?");
  EXPECT_CONTAINS(doubt_about({512, 424, 365, 365, 206, 257}), "are they swapped?");
  EXPECT_EQ(doubt_about({640, 360, 920, 920, 643, 361}),
            "cx 643 and cy 361 are the middle of 1287 x 723 px, the image is 640 x 360 px: are the intrinsics of "
            "another resolution?");
  EXPECT_CONTAINS(doubt_about({1280, 960, 615, 615, 319.5, 239.5}), "are the intrinsics of another resolution?");
  EXPECT_EQ(doubt_about({640, 480, 615, 61.5, 319.5, 239.5}), "fx 615 and fy 61.5 differ more than pixels' sides do");
  EXPECT_EQ(doubt_about({640, 480, 1.93, 1.93, 319.5, 239.5}),
            "fx 1.93 px makes a field of view of 179 deg: is it in another unit?");
}

TEST(CameraFileOf, TheImagesOwnComesFirst) {
  const TempFolder folder;
  const auto image = folder / "frame.v2.png";
  const auto message = error_of([&] { camera_file_of(image); });
  EXPECT_TRUE(message.starts_with(image.string() + ": "));
  EXPECT_CONTAINS(message, (folder / "frame.v2.camera.json").string());
  EXPECT_CONTAINS(message, (folder / "camera.json").string());

  folder.file("camera.json", camera_text);
  EXPECT_EQ(camera_file_of(image), folder / "camera.json");
  folder.file("frame.camera.json", camera_text);
  EXPECT_EQ(camera_file_of(image), folder / "camera.json") << "another image's";
  folder.file("frame.v2.camera.json", camera_text);
  EXPECT_EQ(camera_file_of(image), folder / "frame.v2.camera.json");
}

}  // namespace
}  // namespace partpose
