// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "described.hpp"
#include "interruptible.hpp"
#include "rooms.hpp"

#include "partpose/evaluation/bop_recognition.hpp"
#include "partpose/evaluation/bop_score.hpp"
#include "partpose/io/bop.hpp"
#include "partpose/pipeline/catalogue_cache.hpp"
#include "partpose/synthesis/bop_scenes.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>

namespace partpose::python {

namespace {

namespace fs = std::filesystem;
const auto released = nb::call_guard<nb::gil_scoped_release>();
using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

void bind_bop_images(nb::module_& m) {
  nb::class_<BopModelInfo> info(m, "BopModelInfo", "An object's entry of models_info.json.");
  info.def_ro("diameter_mm", &BopModelInfo::diameter_mm, "The largest distance of two vertices.")
      .def_prop_ro(
          "box_mm",
          [](const BopModelInfo& self) {
            return std::pair(Eigen::Vector3d(self.box_mm.min()), Eigen::Vector3d(self.box_mm.max()));
          },
          "Lower and upper corner.")
      .def_ro("symmetries", &BopModelInfo::symmetries, "As the file states them.");
  bind_repr(info, {"diameter_mm", "box_mm", "symmetries"});
  m.def("bop_model_info", &bop_model_info, "mesh"_a, "symmetries"_a = Symmetries{}, released,
        "Diameter and box of a mesh.");

  nb::class_<BopCamera> camera(m, "BopCamera", "An image's entry of scene_camera.json.");
  camera
      .def(
          "__init__",
          [](BopCamera* self, const Intrinsics& intrinsics, double depth_scale_mm,
             const std::optional<Eigen::Isometry3d>& camera_from_world) {
            new (self) BopCamera(BopCamera::of(intrinsics, depth_scale_mm));
            self->camera_from_world = camera_from_world;
          },
          "intrinsics"_a, "depth_scale_mm"_a = 1.0, "camera_from_world"_a = nb::none())
      .def_prop_ro(
          "K", [](const BopCamera& self) { return Matrix3(self.K); }, "Camera matrix, px; pixel centres at integers.")
      .def_ro("depth_scale_mm", &BopCamera::depth_scale_mm, "mm for each unit of the depth image.")
      .def_ro("camera_from_world", &BopCamera::camera_from_world, "Where it is stated.")
      .def("intrinsics", &BopCamera::intrinsics, "width"_a, "height"_a, "Error when K has skew.");
  bind_repr(camera, {"K", "depth_scale_mm", "camera_from_world"});

  nb::class_<BopVisibility> visibility(m, "BopVisibility",
                                       "A ground truth's entry of scene_gt_info.json. Boxes: x, y, width, height, px.");
  visibility
      .def(
          "__init__",
          [](BopVisibility* self, const std::array<int, 4>& bbox_obj, const std::array<int, 4>& bbox_visib,
             int px_count_all, int px_count_valid, int px_count_visib, double visib_fract) {
            new (self) BopVisibility{bbox_obj, bbox_visib, px_count_all, px_count_valid, px_count_visib, visib_fract};
          },
          nb::kw_only(), "bbox_obj"_a, "bbox_visib"_a, "px_count_all"_a, "px_count_valid"_a, "px_count_visib"_a,
          "visib_fract"_a)
      .def_ro("bbox_obj", &BopVisibility::bbox_obj, "Of the silhouette, which may reach beyond the image.")
      .def_ro("bbox_visib", &BopVisibility::bbox_visib, "Of its visible part.")
      .def_ro("px_count_all", &BopVisibility::px_count_all, "Of the silhouette.")
      .def_ro("px_count_valid", &BopVisibility::px_count_valid, "Where the depth image has a value.")
      .def_ro("px_count_visib", &BopVisibility::px_count_visib, "Of the visible part.")
      .def_ro("visib_fract", &BopVisibility::visib_fract, "px_count_visib / px_count_all");
  bind_repr(visibility, {"bbox_obj", "bbox_visib", "px_count_all", "px_count_valid", "px_count_visib", "visib_fract"});

  nb::class_<BopGroundTruth> truth(m, "BopGroundTruth", "An instance in an image.");
  truth
      .def(
          "__init__",
          [](BopGroundTruth* self, int obj_id, const Eigen::Isometry3d& pose,
             const std::optional<BopVisibility>& visible) {
            new (self) BopGroundTruth{obj_id, pose, visible};
          },
          "obj_id"_a, "camera_from_model"_a, "visibility"_a = nb::none())
      .def_ro("obj_id", &BopGroundTruth::obj_id, "Which object.")
      .def_ro("camera_from_model", &BopGroundTruth::camera_from_model, "Its pose.")
      .def_ro("visibility", &BopGroundTruth::visibility, "None: not known.");
  bind_repr(truth, {"obj_id", "camera_from_model", "visibility"});

  nb::class_<BopImage> image(m, "BopImage", "An image of a scene: its camera and what it shows.");
  image
      .def(
          "__init__",
          [](BopImage* self, int id, const BopCamera& taken_by, std::vector<BopGroundTruth> ground_truths) {
            new (self) BopImage{id, taken_by, std::move(ground_truths)};
          },
          "id"_a, "camera"_a, "ground_truths"_a = nb::list())
      .def_ro("id", &BopImage::id, "The image's number.")
      .def_ro("camera", &BopImage::camera, "The camera that took it.")
      .def_ro("ground_truths", &BopImage::ground_truths, "The position is the ground truth's id.");
  bind_repr(image, {"id", "camera", "ground_truths"});

  nb::class_<BopScene> scene(m, "BopScene", "A scene's folder; depth images are read on demand.");
  scene
      .def(
          "__init__",
          [](BopScene* self, int id, const fs::path& folder, std::vector<BopImage> images, bool has_ground_truth) {
            new (self) BopScene{id, folder, has_ground_truth, std::move(images)};
          },
          "id"_a, "folder"_a, "images"_a, "has_ground_truth"_a = true)
      .def_ro("id", &BopScene::id, "The scene's number.")
      .def_ro("folder", &BopScene::folder, "Where its files are.")
      .def_ro("has_ground_truth", &BopScene::has_ground_truth, "False: there is no scene_gt.json.")
      .def_ro("images", &BopScene::images, "By rising id.")
      .def("image", &BopScene::image, "im_id"_a, nb::rv_policy::copy, "Error when there is no such image.")
      .def("depth_path", &BopScene::depth_path, "image"_a, "Where an image's depth is.")
      .def("read_depth", &BopScene::read_depth, "image"_a, released, "An image's depth, in mm.");
  bind_repr(scene, {"id", "folder", "has_ground_truth", "images"});
}

void bind_bop_files(nb::module_& m) {
  nb::class_<BopTarget> target(m, "BopTarget", "Find `inst_count` instances of an object in an image.");
  target
      .def(
          "__init__",
          [](BopTarget* self, int scene_id, int im_id, int obj_id, int inst_count) {
            new (self) BopTarget{scene_id, im_id, obj_id, inst_count};
          },
          "scene_id"_a, "im_id"_a, "obj_id"_a, "inst_count"_a = 1)
      .def_ro("scene_id", &BopTarget::scene_id, "In which scene.")
      .def_ro("im_id", &BopTarget::im_id, "In which image.")
      .def_ro("obj_id", &BopTarget::obj_id, "Which object.")
      .def_ro("inst_count", &BopTarget::inst_count, "How many of it.");
  bind_repr(target, {"scene_id", "im_id", "obj_id", "inst_count"});

  nb::class_<BopDatasetCamera> camera(m, "BopDatasetCamera", "camera.json: the camera that a dataset is meant for.");
  camera
      .def(
          "__init__",
          [](BopDatasetCamera* self, const Intrinsics& intrinsics, double depth_scale_mm) {
            new (self) BopDatasetCamera{intrinsics, depth_scale_mm};
          },
          "intrinsics"_a, "depth_scale_mm"_a = 1.0)
      .def_ro("intrinsics", &BopDatasetCamera::intrinsics, "Of the depth images.")
      .def_ro("depth_scale_mm", &BopDatasetCamera::depth_scale_mm, "mm for each unit of the depth images.");
  bind_repr(camera, {"intrinsics", "depth_scale_mm"});

  nb::class_<BopDataset> dataset(m, "BopDataset", "A dataset in the format of the BOP benchmark.");
  dataset.def_ro("folder", &BopDataset::folder, "Where it is.")
      .def_ro("split", &BopDataset::split, "The folder of its scenes.")
      .def_ro("camera", &BopDataset::camera, "camera.json; None: there is none.")
      .def_ro("models_folder", &BopDataset::models_folder, "models_eval/ if there, or else models/.")
      .def_ro("models", &BopDataset::models, "By obj_id.")
      .def_ro("scenes", &BopDataset::scenes, "By scene_id.")
      .def_ro("targets", &BopDataset::targets, "As in their file; without one: all ground truths.")
      .def("read_model", &BopDataset::read_model, "obj_id"_a, released, "An object's mesh.")
      .def("scene", &BopDataset::scene, "scene_id"_a, nb::rv_policy::copy, "Error when there is no such scene.");
  dataset.attr("__repr__") = nb::cpp_function(
      [](const BopDataset& self) {
        return fmt::format("BopDataset('{}', split '{}', {} models, {} scenes, {} targets)", self.folder.string(),
                           self.split, self.models.size(), self.scenes.size(), self.targets.size());
      },
      nb::name("__repr__"), nb::scope(dataset), nb::is_method());
  m.def("read_bop_dataset", &read_bop_dataset, "folder"_a, "split"_a = "test", released,
        "Models, scenes and targets; what is missing or damaged is an Error naming file and key.");
  m.def("bop_scene_folder", &bop_scene_folder, "dataset"_a, "split"_a, "scene_id"_a, "DATASET/SPLIT/000001.");
  m.def("bop_model_name", &bop_model_name, "obj_id"_a, "obj_000001.ply.");
  m.def("read_bop_models_info", &read_bop_models_info, "file"_a, "By obj_id.");
  m.def("read_bop_scene", &read_bop_scene, "scene_folder"_a, "scene_id"_a, "Cameras and, if there, ground truths.");
  m.def("read_bop_targets", &read_bop_targets, "file"_a, "test_targets_bop19.json.");
  m.def("write_bop_model", &write_bop_model, "models_folder"_a, "obj_id"_a, "mesh"_a, released,
        "models_folder/obj_000001.ply.");
  m.def("write_bop_models_info", &write_bop_models_info, "models_folder"_a, "models"_a, "models_info.json.");
  m.def("write_bop_camera", &write_bop_camera, "dataset"_a, "camera"_a, "DATASET/camera.json.");
  m.def("write_bop_depth", &write_bop_depth, "scene_folder"_a, "im_id"_a, "depth"_a, "depth_scale_mm"_a, released,
        "scene_folder/depth/000000.png.");
  m.def("write_bop_scene", &write_bop_scene, "scene"_a,
        "scene_camera.json, and the ground truth's files where it is known. No depth images.");
  m.def(
      "write_bop_targets",
      [](const fs::path& folder, const std::vector<BopTarget>& targets) { write_bop_targets(folder, targets); },
      "dataset"_a, "targets"_a, "DATASET/test_targets_bop19.json.");
  m.def(
      "bop_targets_of",
      [](const std::vector<BopScene>& scenes, double min_visib_fract) {
        return bop_targets_of(scenes, min_visib_fract);
      },
      "scenes"_a, "min_visib_fract"_a = 0.1, "A target for each object in each image that is visible enough.");

  nb::class_<BopEstimate> estimate(m, "BopEstimate", "A row of a results file.");
  estimate
      .def(
          "__init__",
          [](BopEstimate* self, int scene_id, int im_id, int obj_id, double score, const Eigen::Isometry3d& pose,
             double time_s) { new (self) BopEstimate{scene_id, im_id, obj_id, score, pose, time_s}; },
          "scene_id"_a, "im_id"_a, "obj_id"_a, "score"_a, "camera_from_model"_a, "time_s"_a = -1.0)
      .def_ro("scene_id", &BopEstimate::scene_id, "In which scene.")
      .def_ro("im_id", &BopEstimate::im_id, "In which image.")
      .def_ro("obj_id", &BopEstimate::obj_id, "Which object.")
      .def_ro("score", &BopEstimate::score, "Higher: more certain.")
      .def_ro("camera_from_model", &BopEstimate::camera_from_model, "The estimated pose.")
      .def_ro("time_s", &BopEstimate::time_s, "For the whole image, equal in all its rows; -1: not known.");
  bind_repr(estimate, {"scene_id", "im_id", "obj_id", "score", "camera_from_model", "time_s"});
  m.def("read_bop_results", &read_bop_results, "file"_a, "A results file; an Error names the damaged line.");
  m.def(
      "write_bop_results",
      [](const fs::path& file, const std::vector<BopEstimate>& estimates) { write_bop_results(file, estimates); },
      "file"_a, "estimates"_a, "scene_id,im_id,obj_id,score,R,t,time.");
}

/// With the description that makes it a Python class like all other options.
struct DescribedBopScoreOptions : BopScoreOptions {
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("vsd", self.vsd, "whether VSD is taken, where there are depth images");
    visit("vsd_delta_mm", self.vsd_delta_mm,
          "a surface this far behind what was measured still counts as visible [mm]");
    visit("image_width", self.image_width, "px; 0: of camera.json, or else of the depth images");
  }
};

void bind_bop_evaluation(nb::module_& m) {
  m.def(
      "bop_catalogue",
      [](const BopDataset& dataset, const std::optional<fs::path>& cache_folder, const Callback& progress) {
        const fs::path cache = cache_folder ? *cache_folder : default_cache_folder();
        return interruptible(progress, [&](const Progress& told) { return bop_catalogue(dataset, cache, told); });
      },
      "dataset"_a, "cache_folder"_a = nb::none(), "progress"_a = nb::none(), released,
      "The catalogue of those objects of a dataset that its targets ask for.");
  m.def("recognize_bop_image", &recognize_bop_image, "recognizer"_a, "depth"_a, "intrinsics"_a, "wanted"_a,
        "min_score"_a, released, "The instances that are wanted, by obj_id, in one depth image.");
  m.def(
      "recognize_bop",
      [](const BopDataset& dataset, const PartRecognizer& recognizer, float min_score, const Callback& progress) {
        return interruptible(progress,
                             [&](const Progress& told) { return recognize_bop(dataset, recognizer, min_score, told); });
      },
      "dataset"_a, "recognizer"_a, "min_score"_a, "progress"_a = nb::none(), released,
      "The estimates of all targets' images.");

  bind_described<DescribedBopScoreOptions>(m, "BopScoreOptions", "How a results file is scored.");

  nb::class_<BopMatch> match(m, "BopMatch", "An estimate that found a ground truth.");
  match.def_ro("scene_id", &BopMatch::scene_id, "In which scene.")
      .def_ro("im_id", &BopMatch::im_id, "In which image.")
      .def_ro("gt_id", &BopMatch::gt_id, "The ground truth found.")
      .def_ro("est_id", &BopMatch::est_id, "The estimate that found it.");
  bind_repr(match, {"scene_id", "im_id", "gt_id", "est_id"});
  nb::class_<BopRecall> recall(m, "BopRecall", "What is found at one threshold.");
  recall.def_ro("threshold", &BopRecall::threshold, "Of the error.")
      .def_ro("targets_count", &BopRecall::targets_count, "Valid ground truths.")
      .def_ro("tp_count", &BopRecall::tp_count, "Of them: found.")
      .def_ro("recall", &BopRecall::recall, "Of all targets together.")
      .def_ro("mean_obj_recall", &BopRecall::mean_obj_recall, "Mean of the objects' recalls.")
      .def_ro("mean_scene_recall", &BopRecall::mean_scene_recall, "Mean of the scenes' recalls.")
      .def_ro("obj_recall", &BopRecall::obj_recall, "By obj_id.")
      .def_ro("scene_recall", &BopRecall::scene_recall, "By scene_id.")
      .def_ro("matches", &BopRecall::matches, "Which estimate found what.");
  bind_repr(recall, {"threshold", "recall", "tp_count", "targets_count"});
  nb::class_<BopScore> score(m, "BopScore", "Recalls by one error.");
  score.def_ro("recalls", &BopScore::recalls, "By threshold; of VSD by tau, then by threshold.")
      .def_ro("average_recall", &BopScore::average_recall, "Mean over the thresholds.")
      .def_ro("obj_recall", &BopScore::obj_recall, "The same of each object alone.");
  bind_repr(score, {"average_recall", "obj_recall"});
  nb::class_<BopScores> scores(m, "BopScores", "Everything about a results file.");
  scores.def_ro("targets_count", &BopScores::targets_count, "Instances to be found.")
      .def_ro("estimates_kept", &BopScores::estimates_kept, "The best of each target.")
      .def_ro("vsd", &BopScores::vsd, "None without depth images.")
      .def_ro("mssd", &BopScores::mssd, "By MSSD.")
      .def_ro("mspd", &BopScores::mspd, "By MSPD.")
      .def_ro("average_recall", &BopScores::average_recall, "AR: the mean of AR_VSD, AR_MSSD and AR_MSPD.")
      .def_ro("average_time_per_image_s", &BopScores::average_time_per_image_s, "-1: not known.");
  bind_repr(scores, {"average_recall", "vsd", "mssd", "mspd", "targets_count", "estimates_kept"});
  m.def(
      "score_bop",
      [](const BopDataset& dataset, const std::vector<BopEstimate>& estimates, const DescribedBopScoreOptions& how,
         const Callback& progress) {
        return interruptible(progress, [&](const Progress& told) { return score_bop(dataset, estimates, how, told); });
      },
      "dataset"_a, "estimates"_a, "options"_a = DescribedBopScoreOptions{}, "progress"_a = nb::none(), released,
      "Scores estimates as the BOP benchmark's localization task does.");
}

void bind_scene_datasets(nb::module_& m) {
  nb::class_<SceneDataset> dataset(m, "SceneDataset", "A dataset that write_scene_dataset wrote.");
  dataset.def_ro("bop", &SceneDataset::bop, "Models, images and truth.")
      .def_ro("options", &SceneDataset::options, "As it was made.")
      .def_ro("part_names", &SceneDataset::part_names, "By obj_id.")
      .def_ro("unknown_names", &SceneDataset::unknown_names, "Parts that are not in the catalogue, by their obj_id.")
      .def_ro("unknown", &SceneDataset::unknown, "By scene_id: where these are.");
  bind_repr(dataset, {"bop", "part_names", "unknown_names"});
  m.def("read_scene_dataset", &read_scene_dataset, "folder"_a, released,
        "Error when the folder is no such dataset, or is damaged.");
}

}  // namespace

void bind_bop(nb::module_& parent) {
  auto io = nb::cast<nb::module_>(parent.attr("io"));
  bind_bop_images(io);
  bind_bop_files(io);
  auto evaluation = nb::cast<nb::module_>(parent.attr("evaluation"));
  bind_bop_evaluation(evaluation);
  auto synthesis = nb::cast<nb::module_>(parent.attr("synthesis"));
  bind_scene_datasets(synthesis);
}

}  // namespace partpose::python
