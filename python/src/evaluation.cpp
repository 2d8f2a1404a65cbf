// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "described.hpp"
#include "interruptible.hpp"
#include "recognition.hpp"
#include "rooms.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/evaluation/accuracy.hpp"
#include "partpose/evaluation/ambiguity.hpp"
#include "partpose/evaluation/captured_set.hpp"
#include "partpose/evaluation/experiment.hpp"
#include "partpose/evaluation/object_judge.hpp"
#include "partpose/evaluation/pose_error.hpp"
#include "partpose/evaluation/pose_judge.hpp"
#include "partpose/geometry/symmetries.hpp"
#include "partpose/pipeline/iteration_output.hpp"

#include <nanobind/stl/map.h>

namespace partpose::python {

namespace {

const auto released = nb::call_guard<nb::gil_scoped_release>();

Eigen::Matrix3d matrix_of(const Intrinsics& camera) {
  Eigen::Matrix3d K;
  K << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  return K;
}

void bind_pose_errors(nb::module_& m) {
  m.def(
      "add_mm",
      [](const Points& vertices, const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth) {
        return add_mm(vertices.span(), estimate, truth);
      },
      "vertices"_a, "estimate"_a, "truth"_a, released, "ADD: mean distance of each vertex from itself.");
  m.def(
      "adi_mm",
      [](const Points& vertices, const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth) {
        return adi_mm(vertices.span(), estimate, truth);
      },
      "vertices"_a, "estimate"_a, "truth"_a, released, "ADI (ADD-S): mean distance from the nearest vertex.");
  m.def(
      "mssd_mm",
      [](const Points& vertices, const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth,
         const Symmetries& symmetries) {
        return mssd_mm(vertices.span(), estimate, truth, symmetry_transformations(symmetries));
      },
      "vertices"_a, "estimate"_a, "truth"_a, "symmetries"_a = Symmetries{}, released,
      "MSSD: the largest distance of a vertex from itself, at the nearest of the equivalent poses.");
  m.def(
      "mspd_px",
      [](const Points& vertices, const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth,
         const Symmetries& symmetries, const Intrinsics& camera) {
        return mspd_px(vertices.span(), estimate, truth, symmetry_transformations(symmetries), matrix_of(camera));
      },
      "vertices"_a, "estimate"_a, "truth"_a, "symmetries"_a, "intrinsics"_a, released,
      "MSPD: the same in the image, px.");
  m.def(
      "ad_mm",
      [](const Points& vertices, const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth, bool symmetric) {
        return ad_mm(vertices.span(), estimate, truth, symmetric);
      },
      "vertices"_a, "estimate"_a, "truth"_a, "symmetric"_a, released, "AD: ADI of a symmetric object, or else ADD.");
  m.def(
      "projection_error_px",
      [](const Points& vertices, const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth,
         const Intrinsics& camera) { return projection_error_px(vertices.span(), estimate, truth, matrix_of(camera)); },
      "vertices"_a, "estimate"_a, "truth"_a, "intrinsics"_a, released,
      "The mean distance of the vertices' projections in px, symmetry ignored.");
  m.def(
      "visible_surface_discrepancy",
      [](const TriangleMesh& mesh, const DepthImage& measured, const Eigen::Isometry3d& estimate,
         const Eigen::Isometry3d& truth, const Intrinsics& camera, double diameter_mm, double delta_mm) {
        const Eigen::Matrix3d K = matrix_of(camera);
        const auto distances = [&](const Eigen::Isometry3d& pose) {
          return distance_image(render(mesh, pose, camera).depth, K);
        };
        const std::span<const double> taus = bop_fractions();
        return array_of(visible_surface_discrepancy(distance_image(measured, K), distances(estimate), distances(truth),
                                                    diameter_mm, taus, {delta_mm})
                            .vsd);
      },
      "mesh"_a, "measured"_a, "estimate"_a, "truth"_a, "intrinsics"_a, "diameter_mm"_a,
      "delta_mm"_a = VsdOptions{}.delta_mm,
      "VSD for each tau of bop_fractions(), in shares of the diameter. The part is rendered at both poses.");
  m.def(
      "bop_fractions", [] { return std::vector<double>(bop_fractions().begin(), bop_fractions().end()); },
      "0.05, 0.10, ..., 0.50: the thresholds of MSSD (shares of the diameter) and VSD, and its taus.");
  m.def(
      "bop_pixels", [] { return std::vector<double>(bop_pixels().begin(), bop_pixels().end()); },
      "5, 10, ..., 50: the thresholds of MSPD in px of an image 640 px wide.");
}

void bind_captured_sets(nb::module_& m) {
  nb::class_<CapturedScene> scene(m, "CapturedScene", "One object in a scene of a set, or none.");
  scene.def_ro("path", &CapturedScene::path, "Its file.")
      .def_ro("kind", &CapturedScene::kind, "What it shows beside the object, as with_table.")
      .def_ro("model_name", &CapturedScene::model_name, "Empty: the scene shows none of the set's models.")
      .def_ro("camera_from_model", &CapturedScene::camera_from_model, "All equivalent poses.");
  bind_repr(scene, {"path", "kind", "model_name"});
  nb::class_<CapturedSet> set(m, "CapturedSet", "Scenes with ground truth.");
  set.def_ro("folder", &CapturedSet::folder, "Where it is.")
      .def_ro("scenes", &CapturedSet::scenes, "As gt.json lists them.")
      .def_ro("symmetries", &CapturedSet::symmetries, "By model name: model_from_model, the identity first.");
  set.attr("__repr__") = nb::cpp_function(
      [](const CapturedSet& self) {
        return fmt::format("CapturedSet('{}', {} scenes)", self.folder.string(), self.scenes.size());
      },
      nb::name("__repr__"), nb::scope(set), nb::is_method());
  m.def("read_captured_set", &read_captured_set, "folder"_a,
        "A folder with models/, gt.json and, if it likes, symmetries.json.");
  nb::class_<SymmetricPoseError> error(m, "SymmetricPoseError", "How far a pose is from the nearest equivalent one.");
  error.def_ro("rotation_deg", &SymmetricPoseError::rotation_deg, "Angle between the two.")
      .def_ro("translation_mm", &SymmetricPoseError::translation_mm, "Distance of the two origins.")
      .def_ro("largest_displacement_mm", &SymmetricPoseError::largest_displacement_mm,
              "Of a corner of the part's bounding box.");
  bind_repr(error, {"rotation_deg", "translation_mm", "largest_displacement_mm"});
  m.def(
      "symmetric_pose_error",
      [](const Eigen::Isometry3d& camera_from_model, const std::vector<Eigen::Isometry3d>& truth,
         const std::vector<Eigen::Isometry3d>& symmetries, const TriangleMesh& mesh) {
        if (truth.empty() || symmetries.empty()) throw Error("truth and symmetries: give one pose at least");
        return symmetric_pose_error(camera_from_model, truth, symmetries, bounding_box(mesh));
      },
      "camera_from_model"_a, "truth"_a, "symmetries"_a, "mesh"_a, released,
      "`truth`: equivalent poses; `symmetries`: model_from_model, the identity at least.");
}

void bind_judge(nb::module_& m) {
  nb::class_<PoseJudge>(m, "PoseJudge",
                        "Judges results by figures that know the parts' symmetries and what a camera can tell apart.")
      .def(nb::init<const Catalogue&>(), "catalogue"_a, released)
      .def(
          "judge",
          [](const PoseJudge& self, const Result& result, const GroundTruth& truth, const Intrinsics& camera,
             const DepthImage* depth, const AmbiguityOptions& noise) {
            noise.check();
            return self.judge(result, truth, {camera, depth ? *depth : DepthImage(), noise});
          },
          "result"_a, "truth"_a, "intrinsics"_a, "depth"_a = nb::none(), "noise"_a = AmbiguityOptions{}, released,
          "`evaluate` with ADD, ADI, MSSD, MSPD and VSD beside, and whether the camera can tell part and pose from the "
          "truth. `depth`: as measured; None: VSD takes all of the part for visible.")
      .def("diameter_mm", &PoseJudge::diameter_mm, "part"_a, "The largest distance of two vertices.");
  m.def("mssd_below", &mssd_below, "evaluation"_a, "share_of_diameter"_a,
        "Whether the largest deviation (MSSD) is below a share of the part's diameter.");
}

void bind_accuracy(nb::module_& m) {
  nb::class_<GroundTruth> truth(m, "GroundTruth", "What a scene shows. An empty name: none of the catalogue's parts.");
  truth
      .def(
          "__init__",
          [](GroundTruth* self, std::string name, const Eigen::Isometry3d& pose, int model_id, int view_id) {
            new (self) GroundTruth{std::move(name), pose, model_id, view_id};
          },
          "model_name"_a, "camera_from_model"_a, "model_id"_a = -1, "view_id"_a = -1)
      .def_ro("model_name", &GroundTruth::model_name, "Of the part shown.")
      .def_ro("camera_from_model", &GroundTruth::camera_from_model, "Its pose.")
      .def_ro("model_id", &GroundTruth::model_id, "Its number in the dataset; -1: not known.")
      .def_ro("view_id", &GroundTruth::view_id, "Of the dataset's view; -1: it is none.");
  bind_repr(truth, {"model_name", "camera_from_model", "model_id", "view_id"});
  m.def("evaluate", &evaluate, "result"_a, "truth"_a, "Compares a result with the truth (C.2.4; eq. 2.2 and 2.3).");

  nb::class_<ProtocolFrame> frame(m, "ProtocolFrame", "A dataset's view as a test scene.");
  frame.def_ro("truth", &ProtocolFrame::truth, "What was shown.")
      .def_ro("result", &ProtocolFrame::result, "What was recognized.")
      .def_ro("evaluation", &ProtocolFrame::evaluation, "How they compare.")
      .def_ro("time_ms", &ProtocolFrame::time_ms, "Of the recognition.");
  bind_repr(frame, {"truth", "evaluation", "time_ms"});
  nb::class_<ProtocolSummary> summary(m, "ProtocolSummary", "What some frames came to.");
  summary.def_ro("frames", &ProtocolSummary::frames, "How many.")
      .def_ro("correct", &ProtocolSummary::correct, "The part is right.")
      .def_ro("wrong", &ProtocolSummary::wrong, "Another part.")
      .def_ro("none", &ProtocolSummary::none, "Nothing recognized.")
      .def_ro("pose_right", &ProtocolSummary::pose_right, "Correct, and within both limits.")
      .def_ro("median_ms", &ProtocolSummary::median_ms, "Time of a frame.")
      .def_ro("p95_ms", &ProtocolSummary::p95_ms, "Time of a frame that 95 % stay below.")
      .def("correct_percent", &ProtocolSummary::correct_percent, "Of all frames.")
      .def("wrong_percent", &ProtocolSummary::wrong_percent, "Of all frames.")
      .def("none_percent", &ProtocolSummary::none_percent, "Of all frames.")
      .def("pose_right_percent", &ProtocolSummary::pose_right_percent, "Of all frames.");
  bind_repr(summary, {"frames", "correct", "wrong", "none", "pose_right", "median_ms", "p95_ms"});
  m.def(
      "run_protocol",
      [](const GlobalPipeline& pipeline, const Dataset& test, const Callback& progress,
         const std::optional<std::filesystem::path>& output) {
        const auto save = [&](const ProtocolFrame& frame, const Recognition& recognition, const PointCloud& scene) {
          const Scene view{test.view_path(frame.truth.model_id, frame.truth.view_id), scene, {}, {}};
          const auto folder = write_iteration(*output, recognition, view, pipeline.catalogue(), pipeline.config());
          write_json(folder / "evaluation.json", frame.evaluation);
          write_json(folder / "evaluation_dataset.json", test.out);
        };
        return interruptible(progress, [&](const Progress& told) {
          return output ? run_protocol(pipeline, test, told, save) : run_protocol(pipeline, test, told);
        });
      },
      "pipeline"_a, "test"_a, "progress"_a = nb::none(), "output"_a = nb::none(), released,
      "Runs the pipeline on every view of every model of `test` (reference, 6.2.1). `output`: where each frame's "
      "iteration folder, with evaluation.json, goes.");
  m.def("summarize", &summarize, "frames"_a, "limit_deg"_a = 15.0, "limit_mm"_a = 15.0,
        "Counts; a pose is right below both limits, symmetry ignored.");

  bind_described<BoundRecord>(m, "BoundRecord",
                              "How well a frame's pose can be known at best (Cramer-Rao), and how well it was.");
  bind_described<ObjectRecord>(m, "ObjectRecord",
                               "A part of the catalogue that is in a frame, and whether it was found.");
  bind_described<DetectionRecord>(m, "DetectionRecord", "What one detection is worth.");
  bind_described<FrameObjects>(m, "FrameObjects", "What is in a frame, and what was recognized in it.");
  bind_described<FrameRecord>(m, "FrameRecord", "What one frame of one run of an experiment gave.");
  m.def(
      "run_experiment",
      [](const std::filesystem::path& spec, const std::filesystem::path& output, const Callback& progress) {
        return interruptible(progress, [&](const Progress& told) { return run_experiment(spec, output, told); });
      },
      "spec_file"_a, "output"_a, "progress"_a = nb::none(), released,
      "Runs all frames that `output` does not have yet, and writes the tables.");
  m.def("read_frame_records", &read_frame_records, "output"_a, "The finished frames of an experiment's folder.");
}

void bind_ambiguity(nb::module_& m) {
  bind_described<AmbiguityOptions>(m, "AmbiguityOptions", "When two depth images are the same to a camera.");
  nb::class_<DepthDifference> difference(m, "DepthDifference", "How far apart two depth images are.");
  difference.def_ro("union_px", &DepthDifference::union_px, "Pixels where either part is seen.")
      .def_ro("differing_px", &DepthDifference::differing_px, "Of them: those that differ by more than noise.")
      .def_ro("rms_sigmas", &DepthDifference::rms_sigmas, "Of the others, in standard deviations.")
      .def("share", &DepthDifference::share, "differing_px / union_px.")
      .def("indistinguishable", &DepthDifference::indistinguishable, "options"_a = AmbiguityOptions{},
           "Whether a camera with this noise sees no difference.");
  bind_repr(difference, {"union_px", "differing_px", "rms_sigmas"});
  m.def(
      "depth_difference",
      [](const TriangleMesh& part_a, const Eigen::Isometry3d& camera_from_a, const TriangleMesh& part_b,
         const Eigen::Isometry3d& camera_from_b, const Intrinsics& camera, const AmbiguityOptions& options) {
        return depth_difference(part_a, camera_from_a, part_b, camera_from_b, camera, options);
      },
      "part_a"_a, "camera_from_a"_a, "part_b"_a, "camera_from_b"_a, "intrinsics"_a, "options"_a = AmbiguityOptions{},
      released, "As rendered by this camera, nothing else in view.");
  nb::class_<AmbiguousPose> pose(m, "AmbiguousPose", "Another pose, perhaps of another part, that looks the same.");
  pose.def_ro("part", &AmbiguousPose::part, "Index of whose; may be another part than the one seen.")
      .def_ro("camera_from_model", &AmbiguousPose::camera_from_model, "The other pose.")
      .def_ro("difference", &AmbiguousPose::difference, "How the two depth images differ.")
      .def_ro("displacement_mm", &AmbiguousPose::displacement_mm, "How far a point of the part is moved at most.");
  bind_repr(pose, {"part", "camera_from_model", "displacement_mm"});
  nb::class_<AmbiguitySearch>(m, "AmbiguitySearch",
                              "Finds, for a part at a pose, other poses of it and poses of other parts that a camera "
                              "cannot tell from it.")
      .def(
          "__init__",
          [](AmbiguitySearch* self, const Catalogue& catalogue, const Intrinsics& camera,
             const AmbiguityOptions& options, double min_displacement, double turn_step_deg, int most_poses) {
            std::vector<AmbiguityPart> parts;
            for (std::size_t i = 0; i < catalogue.parts.size(); ++i)
              parts.push_back({catalogue.parts[i].name, catalogue.parts[i].mesh,
                               catalogue.dataset.out.models[i].symmetries.symmetries()});
            new (self)
                AmbiguitySearch(std::move(parts), camera, {options, min_displacement, turn_step_deg, most_poses});
          },
          "catalogue"_a, "intrinsics"_a, "difference"_a = AmbiguityOptions{}, "min_displacement"_a = 0.05,
          "turn_step_deg"_a = 10.0, "most_poses"_a = 40, released)
      .def_prop_ro(
          "names",
          [](const AmbiguitySearch& self) {
            std::vector<std::string> names;
            for (const auto& part : self.parts()) names.push_back(part.name);
            return names;
          },
          "Of its parts.")
      .def(
          "at",
          [](const AmbiguitySearch& self, const std::string& part, const Eigen::Isometry3d& camera_from_model) {
            std::vector<std::string> names;
            for (const auto& each : self.parts()) names.push_back(each.name);
            for (std::size_t i = 0; i < names.size(); ++i)
              if (names[i] == part) return self.at(static_cast<int>(i), camera_from_model);
            throw Error("there is no part \"{}\"; did you mean \"{}\"?", part, nearest_word(part, names));
          },
          "part"_a, "camera_from_model"_a, released, "Best first; empty when the view determines part and pose.");
}

}  // namespace

void bind_evaluation(nb::module_& parent) {
  auto evaluation = room(parent, "evaluation", "Pose errors, accuracy test, experiments, ambiguous views.");
  bind_pose_errors(evaluation);
  bind_accuracy(evaluation);
  bind_ambiguity(evaluation);
  bind_judge(evaluation);
  bind_captured_sets(evaluation);
}

}  // namespace partpose::python
