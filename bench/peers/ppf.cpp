// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// OpenCV's surface_matching (point pair features, Drost et al. 2010) as a peer: one detector a part, its best poses
// refined by OpenCV's ICP, and the two-sided verification decides.
#include "peer.hpp"
#include "shared.h"

#include <opencv2/core.hpp>
#include <opencv2/surface_matching.hpp>
#include <opencv2/surface_matching/ppf_helpers.hpp>

#include <memory>

namespace {

using peers::Json;
namespace ppf = cv::ppf_match_3d;

/// Of the part's diameter. 0.07 takes up to 25 s to train for a flat part and 14 to 77 s a frame; 0.08 got no more
/// poses right than 0.1.
constexpr double model_step = 0.1;
/// So many poses of a part are compared with the frame as they are, with a wide tolerance; the best are refined.
constexpr std::size_t poses_compared = 300, poses_refined = 4;
constexpr double coarse_tolerance_mm = 20;
constexpr double scene_voxel_mm = 2;

struct Part {
  std::string name;
  void* shared = nullptr;
  cv::Mat surface;  ///< points and normals, for the ICP
  std::unique_ptr<ppf::PPF3DDetector> detector;
};

struct Loaded {
  bool table = false;
  double tolerance_mm = 4;
  PeersCamera camera;
  std::vector<float> depth;
};

cv::Mat sampled(void* part, int count) {
  cv::Mat points(count, 6, CV_32F);
  peers_sample_surface(part, count, points.ptr<float>());
  return points;
}

std::vector<Part> trained(const Json& setup) {
  std::vector<Part> parts;
  for (const auto& json : setup.at("parts")) {
    Part part;
    part.name = json.at("name").get<std::string>();
    part.shared = peers_load_part(json.at("stl").get<std::string>().c_str());
    if (!part.shared) throw std::runtime_error(part.name + ": no mesh");
    part.surface = sampled(part.shared, 1500);
    part.detector = std::make_unique<ppf::PPF3DDetector>(model_step, 0.05, 30);
    part.detector->trainModel(sampled(part.shared, 20000));
    parts.push_back(std::move(part));
  }
  return parts;
}

Loaded load(const Json& setup, const Json& frame) {
  const Json& protocol = setup.at("protocols").at(frame.at("protocol").get<std::size_t>());
  return {protocol.at("table").get<bool>(),
          protocol.at("tolerance_mm").get<double>(),
          {frame.at("width"), frame.at("height"), frame.at("fx"), frame.at("fy"), frame.at("cx"), frame.at("cy")},
          peers::read_depth(frame)};
}

std::vector<ppf::Pose3DPtr> best_of(std::vector<ppf::Pose3DPtr> poses, void* part, void* frame) {
  poses.resize(std::min(poses.size(), poses_compared));
  std::vector<std::pair<double, ppf::Pose3DPtr>> scored;
  for (const auto& pose : poses) scored.emplace_back(peers_two_sided(part, frame, pose->pose.val), pose);
  std::stable_sort(scored.begin(), scored.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  scored.resize(std::min(scored.size(), poses_refined));
  poses.clear();
  for (const auto& [score, pose] : scored) poses.push_back(pose);
  return poses;
}

std::optional<peers::Found> recognize(const std::vector<Part>& parts, const Loaded& frame) {
  constexpr int most = 100000;
  cv::Mat scene(most, 6, CV_32F);
  const int count = peers_object_cloud(&frame.camera, frame.depth.data(), frame.table ? 4 : 0, scene_voxel_mm, 9, most,
                                       scene.ptr<float>());
  if (count < 50) return std::nullopt;
  scene = scene.rowRange(0, count).clone();
  std::vector<float> xyz;
  for (int i = 0; i < count; ++i) xyz.insert(xyz.end(), scene.ptr<float>(i), scene.ptr<float>(i) + 3);
  void* seen = peers_open_frame(&frame.camera, frame.depth.data(), frame.table ? xyz.data() : nullptr, count,
                                frame.tolerance_mm);
  void* coarsely_seen = peers_open_frame(&frame.camera, frame.depth.data(), frame.table ? xyz.data() : nullptr, count,
                                         coarse_tolerance_mm);
  peers::Found best;
  for (const auto& part : parts) {
    std::vector<ppf::Pose3DPtr> poses;
    part.detector->match(scene, poses, 1.0 / 5, 0.05);
    poses = best_of(poses, part.shared, coarsely_seen);
    ppf::ICP(100, 0.005f, 2.5f, 4).registerModelToScene(part.surface, scene, poses);
    for (const auto& pose : poses) {
      const double score = peers_two_sided(part.shared, seen, pose->pose.val);
      if (score <= best.score) continue;
      best.part = part.name;
      best.score = score;
      for (int i = 0; i < 16; ++i) best.camera_from_model.matrix()(i / 4, i % 4) = pose->pose.val[i];
    }
  }
  peers_close_frame(coarsely_seen);
  peers_close_frame(seen);
  if (best.score < 0.4) return std::nullopt;
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "peers_ppf setup.json\n";
    return 2;
  }
  try {
    cv::setNumThreads(1);
    const double began = peers::wall_ms();
    const Json setup = peers::read_json(argv[1]);
    const auto parts = trained(setup);
    peers::answer_frames([&](const Json& frame) { return load(setup, frame); },
                         [&](const Loaded& frame) { return recognize(parts, frame); }, began);
  } catch (const std::exception& error) {
    std::cerr << "peers_ppf: " << error.what() << '\n';
    return 1;
  }
}
