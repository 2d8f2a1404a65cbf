// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/engine/engine.hpp"
#include "partpose/io/mesh_files.hpp"
#include "partpose/synthesis/bop_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace partpose {
namespace {

/// A wrong pose may explain all that shows of a part, and be sure: the right one is found with what hides it in mind.
TEST(HiddenPart, IsLookedForBehindWhatHidesIt) {
  std::vector<std::filesystem::path> files;
  for (const char* name : {"pump_body", "bracket", "link", "keyed_shaft", "housing", "flange"})
    files.push_back(std::filesystem::path(PARTPOSE_SOURCE_DIR) / "parts" / (std::string(name) + ".stl"));
  const std::vector<NamedMesh> parts = read_meshes(files);
  SceneDatasetOptions options;
  options.scene.hidden_fraction = {0.18, 0.22};
  options.scene.seed = 12;
  std::vector<ScenePart> shown;
  for (const auto& part : parts) shown.push_back({part.name, part.mesh});
  const SceneGenerator generator(std::move(shown), {}, options.scene);
  const SceneSensor sensor = make_scene_sensor(options.sensor);
  const Engine engine(parts);
  for (const int frame : {49, 82}) {  // the bracket and the housing, which seem to lie the other way round
    const SyntheticScene scene = generator.generate(frame);
    const auto truth = std::find_if(scene.pieces.begin(), scene.pieces.end(),
                                    [](const ScenePiece& piece) { return piece.in_catalogue(); });
    ASSERT_NE(truth, scene.pieces.end());
    const Recognition r = engine.recognize(sensor(scene, options.scene.seed), scene.intrinsics);
    ASSERT_EQ(r.result.model_name, truth->name);
    double farthest_mm = 0;
    for (const auto& v : truth->mesh->vertices) {
      const Eigen::Vector3d place = v.cast<double>();
      farthest_mm = std::max(farthest_mm, (r.result.T_final * place - truth->camera_from_model * place).norm());
    }
    EXPECT_LT(farthest_mm, 10);
  }
}

}  // namespace
}  // namespace partpose
