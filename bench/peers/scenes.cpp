// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// Makes what the peers are compared on: the parts' database of clean views, frames of two protocols, and (apart from
// them) the truth.
#include "partpose/core/error.hpp"
#include "partpose/evaluation/ambiguity.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/mesh_files.hpp"
#include "partpose/io/pcd.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/pipeline/config_file.hpp"
#include "partpose/synthesis/bop_scenes.hpp"

#include <CLI/CLI.hpp>

#include <iostream>

namespace partpose {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::vector<fs::path> parts;
  fs::path repository = ".";
  fs::path output;
  int frames = 30;
};

void write_depth(const fs::path& path, const DepthImage& depth) {
  write_file_atomically(
      path, std::string(reinterpret_cast<const char*>(depth.z_mm.data()), depth.z_mm.size() * sizeof(float)));
}

Json camera_json(const Intrinsics& c) {
  return {{"width", c.width}, {"height", c.height}, {"fx", c.fx}, {"fy", c.fy}, {"cx", c.cx}, {"cy", c.cy}};
}

class SceneWriter {
 public:
  explicit SceneWriter(const Arguments& arguments) : a_(arguments) {
    fs::create_directories(a_.output / "frames");
    parts_ = read_meshes(a_.parts);
    if (parts_.size() < 2) throw Error("--parts: give at least two STL files; one part cannot be confused");
  }

  void write() {
    write_parts();
    write_virtual_noise();
    write_stereo();
    write_json_file(a_.output / "setup.json", setup_);
    write_json_file(a_.output / "frames.json", frames_);
    write_json_file(a_.output / "truths.json", truths_);
  }

 private:
  fs::path repository_file(const char* name) const { return fs::canonical(a_.repository / name); }

  void write_parts() {
    const Dataset database =
        create_dataset(read_dataset_config(repository_file("configs/dataset_ground_truth.json")), parts_,
                       a_.output / "database");
    setup_["database"] = fs::absolute(database.folder).string();
    setup_["protocols"] = {
        {{"name", "virtual noise"}, {"pipeline", repository_file("configs/pipeline_virtual.json")}, {"table", false},
         {"tolerance_mm", 6.0}},
        {{"name", "stereo camera, on a table"}, {"pipeline", repository_file("experiments/pipeline_depth_image.json")},
         {"table", true}, {"tolerance_mm", 4.0}}};
    for (std::size_t m = 0; m < database.out.models.size(); ++m) {
      const auto& model = database.out.models[m];
      setup_["parts"].push_back({{"name", model.name}, {"stl", fs::absolute(database.mesh_path(model.id)).string()}});
      for (std::size_t v = 0; v < database.out.views.size(); ++v)
        setup_["views"].push_back(
            {{"part", m},
             {"pcd", fs::absolute(database.view_path(model.id, database.out.views[v].id)).string()},
             {"camera_from_model", json_of(database.camera_from_model(m, v))}});
    }
  }

  static Json json_of(const Eigen::Isometry3d& pose) {
    Json numbers = Json::array();
    for (int i = 0; i < 16; ++i) numbers.push_back(pose.matrix()(i / 4, i % 4));
    return numbers;
  }

  void add(const std::string& name, int protocol, const DepthImage& depth, const Intrinsics& camera, const Json& cloud,
           const std::string& part, const Eigen::Isometry3d& pose, const AmbiguityOptions& noise) {
    const fs::path file = fs::absolute(a_.output / "frames" / (name + ".f32"));
    write_depth(file, depth);
    Json frame = {{"name", name}, {"protocol", protocol}, {"depth", file.string()}, {"cloud", cloud}};
    frame.update(camera_json(camera));
    frames_.push_back(frame);
    truths_[name] = {{"part", part}, {"T", json_of(pose)}, {"noise", to_json(noise)}};
  }

  /// The views of 6.1.2, spread evenly over parts and directions.
  void write_virtual_noise() {
    const Dataset test = create_dataset(read_dataset_config(repository_file("configs/dataset_virtual_noise.json")),
                                        parts_, a_.output / "virtual_noise");
    const auto& camera = test.out.dataset_preparation_config.virtual_depth_camera;
    const std::size_t parts = test.out.models.size(), views = test.out.views.size();
    for (int i = 0; i < a_.frames; ++i) {
      const std::size_t m = i % parts, v = (static_cast<std::size_t>(i) * views / a_.frames + 7 * m) % views;
      const auto& model = test.out.models[m];
      const fs::path path = fs::absolute(test.view_path(model.id, test.out.views[v].id));
      add(fmt::format("B{:03}", i), 0, to_depth_image(read_pcd(path), camera.intrinsics()), camera.intrinsics(),
          path.string(), model.name, test.camera_from_model(m, v), AmbiguityOptions::of(camera.noise));
    }
  }

  /// Full frames of parts at rest on a table, stereo noise.
  void write_stereo() {
    const auto options = read_json<SceneDatasetOptions>(repository_file("experiments/scenes_stereo.json"));
    std::vector<ScenePart> parts;
    for (const auto& part : parts_) parts.push_back({part.name, part.mesh});
    write_scene_dataset(parts, {}, options, static_cast<std::size_t>(a_.frames), a_.output / "stereo");
    const SceneDataset drawn = read_scene_dataset(a_.output / "stereo");
    AmbiguityOptions noise;
    noise.disparity_sigma_px = options.sensor.stereo.disparity_noise_px;
    noise.baseline_mm = options.sensor.stereo.baseline_mm;
    int i = 0;
    for (const auto& [id, scene] : drawn.bop.scenes) {
      for (const auto& image : scene.images) {
        const DepthImage depth = scene.read_depth(image);
        const auto& truth = image.ground_truths.at(0);
        add(fmt::format("C{:03}", i++), 1, depth, image.camera.intrinsics(depth.width, depth.height), nullptr,
            drawn.part_names.at(truth.obj_id), truth.camera_from_model, noise);
      }
    }
  }

  Arguments a_;
  std::vector<NamedMesh> parts_;
  Json setup_ = Json::object(), frames_ = Json::array(), truths_ = Json::object();
};

}  // namespace
}  // namespace partpose

int main(int argc, char** argv) {
  partpose::Arguments arguments;
  CLI::App app("Makes the database, the frames and the truth of bench/peers.");
  app.add_option("--parts", arguments.parts, "STL files")->required();
  app.add_option("--repository", arguments.repository, "where configs/ and experiments/ are")->capture_default_str();
  app.add_option("--frames", arguments.frames, "of each protocol")->check(CLI::Range(1, 100000));
  app.add_option("--output", arguments.output, "folder")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    partpose::SceneWriter(arguments).write();
  } catch (const std::exception& error) {
    std::cerr << "peers_scenes: " << error.what() << '\n';
    return 1;
  }
}
