// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/bop_recognition.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/stopwatch.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/pipeline/catalogue_cache.hpp"

#include <unistd.h>

#include <cmath>
#include <set>

namespace partpose {

namespace {

namespace fs = std::filesystem;

/// The name of an object's part in the catalogue.
std::string part_name(int obj_id) { return fs::path(bop_model_name(obj_id)).stem().string(); }

int obj_id_of(const std::string& part_name) { return std::stoi(part_name.substr(part_name.find('_') + 1)); }

class TemporaryFolder {
 public:
  explicit TemporaryFolder(fs::path path) : path_(std::move(path)) { fs::create_directories(path_); }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

Scene scene_of(const DepthImage& depth, const Intrinsics& camera) {
  Scene scene;
  scene.depth = depth;
  scene.intrinsics = camera;
  return scene;
}

/// Makes that part of the image empty which the mesh explains; returns how many pixels.
int take_out(DepthImage& depth, const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
             const Intrinsics& camera) {
  constexpr float tolerance_mm = 10;  // as far as render-and-compare takes a point for one of the surface
  const DepthImage rendered = render(mesh, camera_from_model, camera).depth;
  int taken = 0;
  for (std::size_t i = 0; i < depth.z_mm.size(); ++i) {
    const bool explained =
        depth.z_mm[i] > 0 && rendered.z_mm[i] > 0 && std::abs(depth.z_mm[i] - rendered.z_mm[i]) <= tolerance_mm;
    if (explained) depth.z_mm[i] = 0;
    taken += explained;
  }
  return taken;
}

}  // namespace

Catalogue bop_catalogue(const BopDataset& dataset, const fs::path& cache_folder, const Progress& progress) {
  std::set<int> wanted;
  for (const auto& target : dataset.targets) {
    const BopScene& scene = dataset.scene(target.scene_id);
    check_is_file(scene.depth_path(scene.image(target.im_id)));
    wanted.insert(target.obj_id);
  }
  if (wanted.empty()) throw Error("{}: has no targets: nothing to recognize", dataset.folder.string());
  const TemporaryFolder folder(fs::temp_directory_path() / fmt::format("partpose-bop-{}", getpid()));
  std::vector<fs::path> paths;
  for (const int obj_id : wanted) {
    paths.push_back(folder.path() / (part_name(obj_id) + ".stl"));
    write_stl(paths.back(), dataset.read_model(obj_id));
  }
  return cached_catalogue(paths, DatasetPreparationConfig{}, Recognizer::catalogue_config(), cache_folder, progress);
}

std::vector<BopEstimate> recognize_bop_image(const PartRecognizer& recognizer, const DepthImage& depth,
                                             const Intrinsics& camera, std::map<int, int> wanted, float min_score) {
  const Stopwatch stopwatch;
  const Catalogue& catalogue = recognizer.catalogue();
  const auto part_of = [&](const Candidate& candidate) -> const CataloguePart& {
    return catalogue.parts[catalogue.views[candidate.view_row].part];
  };
  int missing = 0;
  for (const auto& [obj_id, count] : wanted) missing += count;

  DepthImage left = depth;
  std::vector<BopEstimate> estimates;
  // What is recognized but not wanted is taken out as well; that, too, happens only so often.
  for (int tries = 2 * missing; tries > 0 && missing > 0; --tries) {
    const Recognition recognition = recognizer.recognize(scene_of(left, camera));
    if (recognition.accepted < 0) break;
    const Candidate* found = &recognition.candidates[recognition.accepted];
    for (const auto& candidate : recognition.candidates) {
      int& count = wanted[obj_id_of(part_of(candidate).name)];
      if (count <= 0 || candidate.score < min_score) continue;
      found = &candidate;
      --count;
      --missing;
      BopEstimate& estimate = estimates.emplace_back();
      estimate.obj_id = obj_id_of(part_of(candidate).name);
      estimate.score = candidate.score;
      estimate.camera_from_model = candidate.camera_from_model;
      break;
    }
    if (take_out(left, part_of(*found).mesh, found->camera_from_model, camera) == 0) break;
  }
  const double time_s = std::round(stopwatch.elapsed_ms()) / 1000;
  for (auto& estimate : estimates) estimate.time_s = time_s;
  return estimates;
}

std::vector<BopEstimate> recognize_bop(const BopDataset& dataset, const PartRecognizer& recognizer, float min_score,
                                       const Progress& progress) {
  std::map<std::pair<int, int>, std::map<int, int>> wanted_in;
  for (const auto& t : dataset.targets) wanted_in[{t.scene_id, t.im_id}][t.obj_id] = t.inst_count;
  std::vector<BopEstimate> estimates;
  std::size_t done = 0;
  for (const auto& [ids, wanted] : wanted_in) {
    const BopScene& scene = dataset.scene(ids.first);
    const BopImage& image = scene.image(ids.second);
    const DepthImage depth = scene.read_depth(image);
    try {
      for (auto& estimate : recognize_bop_image(recognizer, depth, image.camera.intrinsics(depth.width, depth.height),
                                                wanted, min_score)) {
        estimate.scene_id = scene.id;
        estimate.im_id = image.id;
        estimates.push_back(estimate);
      }
    } catch (const Error& error) {
      throw Error("{}: {}", scene.depth_path(image).string(), error.what());
    }
    if (progress) progress("recognition", ++done, wanted_in.size());
  }
  return estimates;
}

}  // namespace partpose
