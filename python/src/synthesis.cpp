// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "described.hpp"
#include "interruptible.hpp"
#include "rooms.hpp"

#include "partpose/synthesis/bop_scenes.hpp"
#include "partpose/geometry/resting_poses.hpp"
#include "partpose/synthesis/scene_picture.hpp"
#include "partpose/synthesis/synthetic_scene.hpp"

namespace partpose::python {

namespace {

using NamedMeshes = std::vector<std::pair<std::string, TriangleMesh>>;

std::vector<ScenePart> parts_of(const NamedMeshes& meshes) {
  std::vector<ScenePart> parts;
  for (const auto& [name, mesh] : meshes) parts.push_back({name, mesh});
  return parts;
}

}  // namespace

void bind_synthesis(nb::module_& parent) {
  auto m = room(parent, "synthesis", "Scenes of parts on a table, with their truth.");
  const auto released = nb::call_guard<nb::gil_scoped_release>();

  bind_described<RestingPoseOptions>(m, "RestingPoseOptions", "How resting poses are found.");
  nb::class_<RestingPose> pose(m, "RestingPose", "A pose in which a part stays on a level table by itself.");
  pose.def_ro("table_from_model", &RestingPose::table_from_model, "Table frame: z up, its top at 0.")
      .def_ro("probability", &RestingPose::probability, "To come to rest so, dropped at random.")
      .def_ro("centre_height_mm", &RestingPose::centre_height_mm, "Of the centre of mass, above the table.")
      .def_ro("stability_deg", &RestingPose::stability_deg, "The tilt that it takes to tip it over.")
      .def_ro("group", &RestingPose::group, "Poses of a group are equal by the part's symmetry.")
      .def_ro("down", &RestingPose::down, "The direction that is down, model frame.");
  bind_repr(pose, {"probability", "centre_height_mm", "stability_deg", "group", "down"});
  nb::class_<RestingPoses> poses(m, "RestingPoses", "The resting poses of a part, most probable first.");
  poses.def_ro("poses", &RestingPoses::poses, "Each of them.")
      .def_ro("groups", &RestingPoses::groups, "How many are different.")
      .def_ro("centre_of_mass_mm", &RestingPoses::centre_of_mass_mm, "Model frame.")
      .def_ro("centre_of_mass_from_mesh", &RestingPoses::centre_of_mass_from_mesh,
              "False: the mesh is open, and the hull's was taken.");
  bind_repr(poses, {"poses", "groups", "centre_of_mass_mm"});
  m.def("resting_poses", &resting_poses, "mesh"_a, "options"_a = RestingPoseOptions{}, released,
        "The resting poses of a part of even density.");

  bind_described<SceneCameraOptions>(m, "SceneCameraOptions", "The camera and where it stands.")
      .def_prop_ro(
          "intrinsics", [](const SceneCameraOptions& self) { return self.intrinsics; }, "The camera itself.");
  bind_described<SceneOptions>(m, "SceneOptions", "What is on the table.");
  bind_described<SceneSensorOptions>(m, "SceneSensorOptions", "What the sensor does to the depth.");
  bind_described<SceneDatasetOptions>(m, "SceneDatasetOptions", "All that a dataset's frames depend on.");

  nb::class_<ScenePiece> piece(m, "ScenePiece", "Anything in a scene.");
  piece.def_ro("name", &ScenePiece::name, "The part's, or the kind of clutter.")
      .def_ro("index", &ScenePiece::index, "Of the part; -1 for anything else.")
      .def_ro("camera_from_model", &ScenePiece::camera_from_model, "Its pose.")
      .def_ro("visible_px", &ScenePiece::visible_px, "Pixels in which it is seen.")
      .def_ro("silhouette_px", &ScenePiece::silhouette_px, "Pixels that it would have if nothing hid it.")
      .def("visible_fraction", &ScenePiece::visible_fraction, "visible_px / silhouette_px.")
      .def("in_catalogue", &ScenePiece::in_catalogue, "Whether it is one of the catalogue's parts.");
  bind_repr(piece, {"name", "index", "camera_from_model", "visible_px"});
  nb::class_<SyntheticScene> scene(m, "SyntheticScene", "A frame and the truth about it.");
  scene.def_ro("frame", &SyntheticScene::frame, "The number that it was drawn by.")
      .def_ro("intrinsics", &SyntheticScene::intrinsics, "Of the camera.")
      .def_ro("camera_from_table", &SyntheticScene::camera_from_table, "Table frame: z up, its top at 0.")
      .def_ro("pieces", &SyntheticScene::pieces, "Catalogue parts first.")
      .def_ro("depth", &SyntheticScene::depth, "Without noise.")
      .def(
          "measured",
          [](const SyntheticScene& self, const SceneSensorOptions& sensor, std::uint64_t seed) {
            return make_scene_sensor(sensor)(self, seed);
          },
          "sensor"_a = SceneSensorOptions{}, "seed"_a = 0, released, "What a sensor measures of it.")
      .def(
          "picture",
          [](const SyntheticScene& self) {
            auto* image = new ColourImage(picture_of(self));
            const nb::capsule owner(image, [](void* p) noexcept { delete static_cast<ColourImage*>(p); });
            return nb::ndarray<nb::numpy, std::uint8_t, nb::shape<-1, -1, 3>>(
                image->pixels.data()->data(), {std::size_t(image->height), std::size_t(image->width), 3}, owner);
          },
          "Height x width x 3, RGB.");
  bind_repr(scene, {"frame", "intrinsics", "pieces"});
  nb::class_<SceneGenerator>(m, "SceneGenerator", "Draws frames of parts that rest on a table.")
      .def(
          "__init__",
          [](SceneGenerator* self, const NamedMeshes& catalogue, const NamedMeshes& unknown,
             const SceneOptions& options) {
            new (self) SceneGenerator(parts_of(catalogue), parts_of(unknown), options);
          },
          "catalogue"_a, "unknown"_a = nb::list(), "options"_a = SceneOptions{}, released,
          "`catalogue` and `unknown`: pairs of name and mesh.")
      .def("generate", &SceneGenerator::generate, "frame"_a, released,
           "Depends on the options, the parts and frame alone.")
      .def_prop_ro("names", &SceneGenerator::names, "Of all parts, the catalogue's first.")
      .def_prop_ro("options", &SceneGenerator::options, nb::rv_policy::copy, "What it was made with.");
  m.def(
      "write_scene_dataset",
      [](const NamedMeshes& catalogue, const NamedMeshes& unknown, const SceneDatasetOptions& options,
         std::size_t frames, const std::filesystem::path& folder, const Callback& progress) {
        interruptible(progress, [&](const Progress& told) {
          write_scene_dataset(parts_of(catalogue), parts_of(unknown), options, frames, folder, {}, told);
        });
      },
      "catalogue"_a, "unknown"_a, "options"_a, "frames"_a, "folder"_a, "progress"_a = nb::none(), released,
      "Draws frames and writes them as a BOP dataset.");
}

}  // namespace partpose::python
