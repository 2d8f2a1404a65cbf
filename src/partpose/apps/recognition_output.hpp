// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/png.hpp"
#include "partpose/io/scene.hpp"
#include "partpose/pipeline/recognition.hpp"

#include <filesystem>
#include <map>
#include <string>

namespace partpose::apps {

/// The line of `--jsonl`: scene, model_name or null, T_final (camera_from_model, mm), distances, all detections of the
/// frame, times by step.
Json line_of(const std::filesystem::path& scene, const Recognition& recognition, const Catalogue& catalogue);

/// ", score 0.98, confidence 0.97": what of them is known.
std::string certainty_text(float score, const Detection* detection);
std::string text_of(const Eigen::Isometry3d& pose);
/// The result, its pose, what else it may be, and the frame's other objects.
void print_for_people(const std::filesystem::path& scene, const Recognition& recognition, const Catalogue& catalogue);
std::string text_for_people(const std::filesystem::path& scene, const Recognition& recognition,
                            const Catalogue& catalogue);

/// How long each step took, with --verbose.
void note_stages(const Common& common, const Recognition& recognition);

/// Runs `body`; an Error it throws gets the scene's name before it.
template <typename Body>
auto named_after(const std::filesystem::path& scene, const Body& body) {
  try {
    return body();
  } catch (const Error& error) {
    throw Error("{}: {}", scene.string(), error.what());
  }
}

/// Picture files in a folder, named after their scenes; a second scene of the same name gets NAME_2.png.
class PictureNames {
 public:
  explicit PictureNames(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::filesystem::path next(const std::filesystem::path& scene) {
    const std::string stem = scene.stem().string();
    const int count = ++count_[stem];
    return folder_ / (count == 1 ? stem + ".png" : fmt::format("{}_{}.png", stem, count));
  }

 private:
  std::filesystem::path folder_;
  std::map<std::string, int> count_;
};

/// The scene with all that was recognized drawn over it; a cloud is drawn as a camera that just covers it would see it.
ColourImage picture_of(const Scene& scene, const Recognition& recognition, const Catalogue& catalogue);

}  // namespace partpose::apps
