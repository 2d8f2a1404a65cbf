// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/apps/recognition_output.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

namespace partpose::apps {
namespace {

Eigen::Isometry3d at(double x_mm) { return Eigen::Isometry3d(Eigen::Translation3d(x_mm, 0, 600)); }

Catalogue two_parts() {
  Catalogue catalogue;
  catalogue.parts.resize(2);
  catalogue.parts[0].name = "bracket";
  catalogue.parts[1].name = "link";
  catalogue.views.resize(1);
  return catalogue;
}

Recognition one_object() {
  Recognition recognition;
  Candidate candidate;
  candidate.view_row = 0;
  candidate.score = 0.75f;
  candidate.camera_from_model = at(1);
  recognition.candidates = {candidate};
  recognition.accepted = 0;
  recognition.result.model_name = "bracket";
  recognition.result.T_final = at(1);
  return recognition;
}

/// As a recognizer gives it that finds several objects and says how sure it is.
Recognition two_objects() {
  Recognition recognition = one_object();
  Detection first{0, at(1), 0.75f, 0.9, {}, {{1, at(2), 0.08}}};
  first.explanation = Explanation{.explained_pixels = 900, .agreement = 0.95};
  first.covariance(0, 0) = 1e-4;
  first.covariance(5, 5) = 0.25;
  recognition.detections = {first, {1, at(50), 0.5f, 0.6}};
  recognition.detections[1].covariance.setZero();
  return recognition;
}

TEST(RecognitionOutput, AllObjectsAsJson) {
  const Json line = line_of("frame.png", two_objects(), two_parts());
  EXPECT_EQ(line["model_name"], "bracket");
  EXPECT_EQ(line["score"], 0.75);
  ASSERT_EQ(line["detections"].size(), 2u);
  const Json& first = line["detections"][0];
  EXPECT_EQ(first["model_name"], "bracket");
  EXPECT_EQ(first["T"], to_json(at(1)));
  EXPECT_EQ(first["score"], 0.75);
  EXPECT_EQ(first["confidence"], 0.9);
  EXPECT_EQ(first["covariance"][0][0], 1e-4);
  EXPECT_EQ(first["covariance"][5][5], 0.25);
  ASSERT_EQ(first["alternatives"].size(), 1u);
  EXPECT_EQ(first["alternatives"][0]["model_name"], "link");
  EXPECT_EQ(first["alternatives"][0]["T"], to_json(at(2)));
  EXPECT_EQ(first["alternatives"][0]["probability"], 0.08);
  EXPECT_EQ(first["explanation"]["agreement"], 0.95);
  EXPECT_EQ(line["detections"][1]["model_name"], "link");
  EXPECT_FALSE(line["detections"][1].contains("explanation"));
  EXPECT_EQ(line["detections"][1]["T"], to_json(at(50)));
  EXPECT_TRUE(line["detections"][1]["alternatives"].empty());
}

TEST(RecognitionOutput, APictureShowsAllObjects) {
  Catalogue catalogue = two_parts();
  for (auto& part : catalogue.parts) part.mesh = shapes::box({20, 20, 20});
  Scene scene;
  scene.depth.emplace(480, 360);
  scene.intrinsics = Intrinsics{480, 360, 600, 600, 239.5, 179.5};
  const auto drawn = [&](const Recognition& recognition) {
    const ColourImage picture = picture_of(scene, recognition, catalogue);
    const auto is_drawn = [&](double x_mm) {
      const Eigen::Vector2d pixel = scene.intrinsics->project(at(x_mm).translation());
      return picture.pixels[std::lround(pixel.y()) * 480 + std::lround(pixel.x())] != picture.pixels[0];
    };
    return std::vector<bool>{is_drawn(1), is_drawn(50), is_drawn(-50)};
  };
  EXPECT_EQ(drawn(one_object()), (std::vector<bool>{true, false, false}));
  EXPECT_EQ(drawn(two_objects()), (std::vector<bool>{true, true, false}));
}

TEST(RecognitionOutput, WithoutStatedCertaintyTheResultIsTheOneDetection) {
  const Json line = line_of("frame.png", one_object(), two_parts());
  ASSERT_EQ(line["detections"].size(), 1u);
  EXPECT_EQ(line["detections"][0]["model_name"], "bracket");
  EXPECT_EQ(line["detections"][0]["T"], to_json(at(1)));
  EXPECT_FALSE(line["detections"][0].contains("confidence"));
}

TEST(RecognitionOutput, AConfidenceThatIsNotStatedIsNotShown) {
  Recognition recognition = two_objects();
  for (auto& detection : recognition.detections) detection = {detection.part, detection.camera_from_model, 0.5f};
  const Json line = line_of("frame.png", recognition, two_parts());
  ASSERT_EQ(line["detections"].size(), 2u);
  EXPECT_FALSE(line["detections"][1].contains("confidence"));
  EXPECT_EQ(text_for_people("f.png", recognition, two_parts()).find("confidence"), std::string::npos);
}

TEST(RecognitionOutput, NothingRecognized) {
  Recognition recognition;
  recognition.reason = "nothing there";
  const Json line = line_of("frame.png", recognition, two_parts());
  EXPECT_TRUE(line["model_name"].is_null());
  EXPECT_EQ(line["detections"], Json::array());
  EXPECT_EQ(line["reason"], "nothing there");
  EXPECT_EQ(text_for_people("frame.png", recognition, two_parts()),
            "frame.png: nothing recognized: nothing there (0 ms)\n");
}

TEST(RecognitionOutput, AllObjectsAsText) {
  const auto pose = [](const char* x) {
    return fmt::format(
        "    1.00000   0.00000   0.00000 {:>10}\n    0.00000   1.00000   0.00000      0.000\n"
        "    0.00000   0.00000   1.00000    600.000\n    0.00000   0.00000   0.00000      1.000\n",
        x);
  };
  EXPECT_EQ(text_for_people("f.png", one_object(), two_parts()), "f.png: bracket, score 0.75 (0 ms)\n" + pose("1.000"));
  EXPECT_EQ(text_for_people("f.png", two_objects(), two_parts()),
            "f.png: bracket, score 0.75, confidence 0.90 (0 ms)\n" + pose("1.000") +
                "  or, with probability 0.08: link\n" + pose("2.000") +
                "f.png: also link, score 0.50, confidence 0.60\n" + pose("50.000"));
}

}  // namespace
}  // namespace partpose::apps
