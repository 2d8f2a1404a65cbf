// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "described.hpp"
#include "interruptible.hpp"
#include "rooms.hpp"

#include "partpose/dataset/dataset.hpp"
#include "partpose/io/mesh_files.hpp"
#include "partpose/io/scene.hpp"
#include "partpose/pipeline/catalogue_cache.hpp"
#include "partpose/pipeline/config_file.hpp"
#include "partpose/pipeline/global_pipeline.hpp"
#include "partpose/pipeline/iteration_output.hpp"
#include "partpose/pipeline/picture.hpp"
#include "partpose/pipeline/recognizer.hpp"

#include "recognition.hpp"

#include <nanobind/stl/map.h>

namespace partpose::python {

namespace {

namespace fs = std::filesystem;
const auto released = nb::call_guard<nb::gil_scoped_release>();

void bind_dataset(nb::module_& m) {
  bind_described<IcosahedronOptions>(m, "IcosahedronOptions", "Where the virtual camera stands.");
  bind_described<DatasetPreparationConfig>(m, "DatasetPreparationConfig", "Appendix C.1.1 of the reference.");
  bind_described<ModelList>(m, "ModelList", "Appendix C.1.2: the parts' STL files.");
  bind_described<ModelSymmetries::Continuous>(m, "ContinuousSymmetry", "An axis about which a part may be turned.");
  bind_described<ModelSymmetries>(m, "ModelSymmetries", "A part's symmetries with the keys of BOP's models_info.json.")
      .def("symmetries", &ModelSymmetries::symmetries, "The same as Symmetries.");
  bind_described<ModelInfo>(m, "ModelInfo", "A model's entry of models_info.json.");
  m.def("read_models_info", &read_models_info, "path"_a, "By the model's number or name.");
  bind_described<DatasetModel>(m, "DatasetModel", "A part of a dataset.")
      .def_prop_ro(
          "symmetries", [](const DatasetModel& self) { return self.symmetries.symmetries(); },
          "As the dataset states them.");
  bind_described<DatasetView>(m, "DatasetView", "A camera of a dataset.");
  bind_described<DatasetOut>(m, "DatasetOut", "Appendix C.1.3: the dataset's dataset.json.");
  nb::class_<Dataset> dataset(m, "Dataset", "The folder of appendix C.1.4.");
  dataset.def_ro("folder", &Dataset::folder, "Where it is.")
      .def_ro("out", &Dataset::out, "What dataset.json says.")
      .def("model_folder", &Dataset::model_folder, "model_id"_a, "The folder of a model.")
      .def("mesh_path", &Dataset::mesh_path, "model_id"_a, "The mesh of a model.")
      .def("view_path", &Dataset::view_path, "model_id"_a, "view_id"_a, "The cloud of a model's view.")
      .def(
          "camera_from_model",
          [](const Dataset& self, std::size_t model, std::size_t view) {
            if (model >= self.out.models.size() || view >= self.out.views.size())
              throw Error("the dataset has {} models and {} views", self.out.models.size(), self.out.views.size());
            return self.camera_from_model(model, view);
          },
          "model_index"_a, "view_index"_a, "The pose of a model in a view.");
  dataset.attr("__repr__") = nb::cpp_function(
      [](const Dataset& self) {
        return fmt::format("Dataset('{}', {} models, {} views)", self.folder.string(), self.out.models.size(),
                           self.out.views.size());
      },
      nb::name("__repr__"), nb::scope(dataset), nb::is_method());
  m.def("icosahedron_views", &icosahedron_views, "options"_a = IcosahedronOptions{}, "The cameras of an icosahedron.");
  m.def("centred_from_model", &centred_from_model, "mesh"_a, "T1: moves the bounding box's centre to the origin.");
  m.def("open_dataset", &open_dataset, "folder"_a, "Reads and checks dataset.json.");
  m.def(
      "create_dataset",
      [](const DatasetPreparationConfig& config, const std::vector<fs::path>& paths, const fs::path& folder,
         const Callback& progress) {
        config.check();
        return interruptible(progress,
                             [&](const Progress& told) { return create_dataset(config, paths, folder, told); });
      },
      "config"_a, "model_paths"_a, "folder"_a, "progress"_a = nb::none(), released,
      "Renders the views of all models and writes the folder.");
  m.def("read_model_list", &read_model_list, "path"_a, "The paths of a model list.");
  m.def("read_dataset_config", &read_dataset_config, "path"_a, "Absent keys keep their defaults.");
}

void bind_records(nb::module_& m) {
  bind_described<Result>(m, "Result", "C.2.2. Nothing recognized is candidate_id -1.");
  bind_described<CandidateExtras>(m, "CandidateExtras", "What became of one candidate.");
  bind_described<SceneExtras>(m, "SceneExtras", "Points of the scene.");
  bind_described<MeasuredOperation>(m, "MeasuredOperation", "A step and its time.");
  bind_described<Extras>(m, "Extras", "C.2.3.");
  bind_described<Evaluation>(m, "Evaluation", "C.2.4.");
}

void bind_catalogue(nb::module_& m) {
  nb::class_<CataloguePart> part(m, "CataloguePart", "A part of a catalogue.");
  part.def_ro("id", &CataloguePart::id, "Its number in the dataset.")
      .def_ro("name", &CataloguePart::name, "As its file or its CAD product is called.")
      .def_ro("T1", &CataloguePart::T1, "centred_from_model")
      .def_ro("mesh", &CataloguePart::mesh, "Model frame.")
      .def_ro("surface", &CataloguePart::surface, "All views fused, model frame, with normals.");
  bind_repr(part, {"id", "name"});
  nb::class_<Catalogue> catalogue(m, "Catalogue", "Everything that the online stage needs to know of the parts.");
  catalogue.def_ro("dataset", &Catalogue::dataset, "The dataset that it was made of.")
      .def_prop_ro(
          "parts",
          [](nb::handle self) {
            nb::list parts;
            for (const auto& each : nb::cast<const Catalogue&>(self).parts)
              parts.append(nb::cast(&each, nb::rv_policy::reference_internal, self));
            return parts;
          },
          nb::sig("def parts(self) -> list[CataloguePart]"), "In the order of their numbers.")
      .def_ro("index", &Catalogue::index, "The descriptors of all views.")
      .def_prop_ro(
          "view_count", [](const Catalogue& self) { return self.views.size(); }, "Of all parts together.");
  catalogue.attr("__repr__") = nb::cpp_function(
      [](const Catalogue& self) {
        return fmt::format("Catalogue({} parts, {} views, {} descriptors)", self.parts.size(), self.views.size(),
                           self.index.size());
      },
      nb::name("__repr__"), nb::scope(catalogue), nb::is_method());
  m.def(
      "load_catalogue",
      [](const Dataset& dataset, const GlobalPipelineConfig& config, const Callback& progress) {
        config.check();
        return interruptible(progress, [&](const Progress& told) { return load_catalogue(dataset, config, told); });
      },
      "dataset"_a, "config"_a, "progress"_a = nb::none(), released, "The offline stage; kept in the dataset's folder.");
  m.def("without_part", &without_part, "catalogue"_a, "name"_a, released,
        "The same catalogue without one of its parts.");
  m.def("comparable_view", &comparable_view, "view"_a, "config"_a, released,
        "Points and normals of a dataset's view as a scene of it would have them.");
  m.def("default_cache_folder", &default_cache_folder, "$XDG_CACHE_HOME/partpose, or else ~/.cache/partpose.");
  m.def(
      "cached_catalogue",
      [](const std::vector<fs::path>& paths, const DatasetPreparationConfig& dataset,
         const GlobalPipelineConfig& config, const std::optional<fs::path>& cache_folder, const Callback& progress) {
        const fs::path cache = cache_folder ? *cache_folder : default_cache_folder();
        return interruptible(
            progress, [&](const Progress& told) { return cached_catalogue(paths, dataset, config, cache, told); });
      },
      "model_paths"_a, "dataset"_a, "pipeline"_a, "cache_folder"_a = nb::none(), "progress"_a = nb::none(), released,
      "The catalogue of some STL files, made on first use and kept.");
}

nb::object part_of(const Recognized& self) {
  if (self.recognition.accepted < 0) return nb::none();
  return nb::cast(self.recognition.result.model_name);
}

using Covariance = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

void bind_detections(nb::module_& m) {
  nb::class_<NamedAlternative> alternative(m, "Alternative", "Another part or pose that explains an object too.");
  alternative.def_ro("part", &NamedAlternative::part, "Its name.")
      .def_prop_ro(
          "camera_from_model", [](const NamedAlternative& self) { return self.alternative.camera_from_model; },
          "Its pose.")
      .def_prop_ro(
          "probability", [](const NamedAlternative& self) { return self.alternative.probability; }, "0 to 1.");
  bind_repr(alternative, {"part", "probability", "camera_from_model"});

  bind_described<Explanation>(m, "Explanation",
                              "How a part at its pose and a frame explain each other: what the engine's score is made "
                              "of.");
  nb::class_<NamedDetection> detection(m, "Detection", "A part found in a frame.");
  detection.def_ro("part", &NamedDetection::part, "Its name.")
      .def_prop_ro(
          "camera_from_model", [](const NamedDetection& self) { return self.detection.camera_from_model; },
          "The pose, mm.")
      .def_prop_ro(
          "score", [](const NamedDetection& self) { return self.detection.score; }, "0 to 1.")
      .def_prop_ro(
          "confidence",
          [](const NamedDetection& self) -> std::optional<double> {
            if (!self.has_confidence) return {};
            return self.detection.confidence;
          },
          "Probability that part and pose are right, up to what this camera cannot tell apart; 0 to 1. None: this "
          "recognizer states none.")
      .def_prop_ro(
          "covariance",
          [](const NamedDetection& self) -> std::optional<Covariance> {
            if (!self.has_confidence) return {};
            return Covariance(self.detection.covariance);
          },
          nb::sig("def covariance(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(6, 6))] | "
                  "None"),
          "6 x 6, of a small rotation vector [rad] and translation [mm] of the part, about its box's middle, in the "
          "camera's axes. None: this recognizer states none.")
      .def_prop_ro(
          "explanation", [](const NamedDetection& self) { return self.detection.explanation; },
          "What the score is made of. None: of another recognizer than the engine.")
      .def_ro("alternatives", &NamedDetection::alternatives,
              "Likeliest first; poses that are the same by symmetry are not listed.");
  detection.attr("__repr__") = nb::cpp_function(
      [](const NamedDetection& self) {
        const Eigen::Vector3d t = self.detection.camera_from_model.translation();
        return fmt::format("Detection({} at ({:.1f}, {:.1f}, {:.1f}) mm, score {:.3f}{}; {} alternatives)", self.part,
                           t.x(), t.y(), t.z(), self.detection.score,
                           self.has_confidence ? fmt::format(", confidence {:.3f}", self.detection.confidence) : "",
                           self.alternatives.size());
      },
      nb::name("__repr__"), nb::scope(detection), nb::is_method());
}

/// With the description that makes it a Python class like all other options.
struct DescribedRecognizerOptions : RecognizerOptions {
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("min_score", self.min_score, "a candidate whose render-and-compare score is lower is not believed, 0 to 1");
    visit("shortlist_views", self.shortlist_views, "views that go on from the matching, >= 1");
    visit("rolls", self.rolls, "turns about the line of sight that each is tried at, >= 1");
  }
};

void bind_recognition(nb::module_& m) {
  nb::class_<Recognized> recognition(m, "Recognition",
                                     "What happened to one scene; false when nothing was recognized.");
  recognition
      .def_prop_ro("part", &part_of, nb::sig("def part(self) -> str | None"), "Its name; None: nothing was recognized.")
      .def_prop_ro(
          "camera_from_model",
          [](const Recognized& self) -> std::optional<Eigen::Isometry3d> {
            if (self.recognition.accepted < 0) return {};
            return self.recognition.result.T_final;
          },
          nb::sig("def camera_from_model(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, "
                  "4))] | None"),
          "The pose, mm.")
      .def_prop_ro(
          "score",
          [](const Recognized& self) {
            const auto& r = self.recognition;
            if (r.candidates.empty()) return -1.f;
            return r.candidates[static_cast<std::size_t>(std::max(r.accepted, 0))].score;
          },
          "0 to 1, of the best candidate, accepted or not; -1: there was none.")
      .def_prop_ro(
          "confidence",
          [](const Recognized& self) -> std::optional<double> {
            if (!self.best() || !self.best()->has_confidence) return {};
            return self.best()->detection.confidence;
          },
          "Probability that part and pose are right, up to what this camera cannot tell apart; 0 to 1. None: nothing "
          "was recognized, or this recognizer states none.")
      .def_prop_ro(
          "alternatives",
          [](const Recognized& self) {
            return self.best() ? self.best()->alternatives : std::vector<NamedAlternative>();
          },
          "Other parts and poses that explain the object too, likeliest first.")
      .def_ro("detections", &Recognized::detections, "All objects that were recognized, the result first.")
      .def_prop_ro(
          "candidates", [](const Recognized& self) { return self.extras.candidate_extras; },
          "In the order of the decision, each with its pose T_final and its verdict.")
      .def_prop_ro(
          "stages", [](const Recognized& self) { return self.recognition.stages; }, "The steps and their times.")
      .def_prop_ro(
          "reason", [](const Recognized& self) { return self.recognition.reason; },
          "Why nothing was recognized; empty when something was.")
      .def_prop_ro(
          "total_ms", [](const Recognized& self) { return self.recognition.total_ms(); }, "Of all stages.")
      .def_prop_ro(
          "result", [](const Recognized& self) { return self.recognition.result; }, "C.2.2.")
      .def_ro("extras", &Recognized::extras, "C.2.3.")
      .def_ro("symmetries", &Recognized::symmetries, "Of the part recognized, model frame.")
      .def(
          "equivalent_poses",
          [](const Recognized& self, double max_step) {
            std::vector<Eigen::Isometry3d> poses;
            if (self.recognition.accepted < 0) return poses;
            for (const auto& motion : symmetry_transformations(self.symmetries, max_step))
              poses.push_back(self.recognition.result.T_final * motion);
            return poses;
          },
          "max_step"_a = 0.1,
          "All camera_from_model that look the same because of the part's symmetries, the one found first; turns about "
          "an axis so small that no point moves by more than max_step of the diameter.")
      .def("__bool__", [](const Recognized& self) { return self.recognition.accepted >= 0; })
      .def_prop_ro(
          "preprocessed", [](const Recognized& self) { return &self.recognition.preprocessed; },
          nb::rv_policy::reference_internal, "The scene after the preprocessing, camera frame.")
      .def_prop_ro(
          "with_normals", [](const Recognized& self) { return &self.recognition.with_normals; },
          nb::rv_policy::reference_internal, "The same with normals.")
      .def_prop_ro(
          "refinement_scene", [](const Recognized& self) { return &self.recognition.refinement_scene; },
          nb::rv_policy::reference_internal, "What the refinement was given.")
      .def_prop_ro(
          "num_of_points_input", [](const Recognized& self) { return self.recognition.num_of_points_input; },
          "Before the preprocessing.");
  recognition.attr("__repr__") = nb::cpp_function(
      [](const Recognized& self) {
        const auto& r = self.recognition;
        if (r.accepted < 0)
          return fmt::format("Recognition(nothing: {}; {} candidates, {:.0f} ms)", r.reason, r.candidates.size(),
                             r.total_ms());
        const Eigen::Vector3d t = r.result.T_final.translation();
        const NamedDetection& best = self.detections.front();
        return fmt::format("Recognition({} at ({:.1f}, {:.1f}, {:.1f}) mm, score {:.3f}{}; {} candidates, {:.0f} ms{})",
                           r.result.model_name, t.x(), t.y(), t.z(), r.candidates[std::size_t(r.accepted)].score,
                           best.has_confidence ? fmt::format(", confidence {:.3f}", best.detection.confidence) : "",
                           r.candidates.size(), r.total_ms(),
                           self.detections.size() > 1 ? fmt::format("; {} objects", self.detections.size()) : "");
      },
      nb::name("__repr__"), nb::scope(recognition), nb::is_method());

  nb::class_<PartRecognizer> recognizer(
      m, "PartRecognizer",
      "What recognizes the part in a scene: one of the pipelines with its catalogue. Immutable; "
      "several threads may use it at once.");
  recognizer
      .def(
          "recognize",
          [](const PartRecognizer& self, const DepthPixels& depth, const Intrinsics& camera, double depth_scale_mm) {
            return recognized(self, depth_scene(depth.image(depth_scale_mm), camera));
          },
          "depth"_a, "intrinsics"_a, "depth_scale_mm"_a = 1.0, released,
          "A full depth frame, or a part of one: pixels in units of depth_scale_mm mm, 0: no value.")
      .def(
          "recognize",
          [](const PartRecognizer& self, const DepthImage& depth, const Intrinsics& camera) {
            return recognized(self, depth_scene(depth, camera));
          },
          "depth"_a, "intrinsics"_a, released)
      .def(
          "recognize",
          [](const PartRecognizer& self, const Points& points) {
            Scene scene;
            scene.cloud.points = points.copy();
            scene.cloud.width = static_cast<int>(scene.cloud.size());
            scene.cloud.height = 1;
            return recognized(self, scene);
          },
          "points"_a, released, "Points in mm, taken by a camera at the origin that looks along z.")
      .def(
          "recognize",
          [](const PartRecognizer& self, const PointCloud& cloud) {
            Scene scene;
            scene.cloud = cloud;
            return recognized(self, scene);
          },
          "cloud"_a, released)
      .def("recognize", &recognized, "scene"_a, released)
      .def(
          "recognize",
          [](const PartRecognizer& self, const fs::path& scene) { return recognized(self, read_scene(scene)); },
          "scene"_a, released, "A scene's file, as of read_scene.")
      .def_prop_ro("catalogue", &PartRecognizer::catalogue, nb::rv_policy::reference_internal,
                   "The parts that it knows.");
  recognizer.attr("__repr__") = nb::cpp_function(
      [](nb::handle self) {
        constexpr std::size_t most = 10;
        const auto& parts = nb::cast<const PartRecognizer&>(self).catalogue().parts;
        std::string names;
        for (std::size_t i = 0; i < std::min(parts.size(), most); ++i) names += (i ? ", " : "") + parts[i].name;
        return fmt::format("{}({} part{}: {}{})", nb::str(self.type().attr("__name__")).c_str(), parts.size(),
                           parts.size() == 1 ? "" : "s", names, parts.size() > most ? ", ..." : "");
      },
      nb::name("__repr__"), nb::scope(recognizer), nb::is_method());

  bind_described<DescribedRecognizerOptions>(m, "RecognizerOptions", "What the Recognizer may be told.");

  nb::class_<Recognizer, PartRecognizer>(m, "Recognizer", "The pipeline without a configuration.")
      .def(nb::init<Catalogue, DescribedRecognizerOptions>(), "catalogue"_a, "options"_a = DescribedRecognizerOptions{},
           released)
      .def_static(
          "from_files",
          [](const Paths& paths, const DescribedRecognizerOptions& options, const std::optional<fs::path>& cache_folder,
             const Callback& progress) {
            const fs::path cache = cache_folder ? *cache_folder : default_cache_folder();
            std::vector<std::string> doubts;
            auto made = interruptible(progress, [&](const Progress& told) {
              return std::make_unique<Recognizer>(
                  cached_catalogue(read_parts(paths, doubts), DatasetPreparationConfig{},
                                   Recognizer::catalogue_config(), cache, told),
                  options);
            });
            warn(doubts);
            return made.release();
          },
          "paths"_a, "options"_a = DescribedRecognizerOptions{}, "cache_folder"_a = nb::none(),
          "progress"_a = nb::none(), released,
          "Of model files, or folders of them. The catalogue is made on first use and kept under the cache folder.")
      .def_static("catalogue_config", &Recognizer::catalogue_config,
                  "The pipeline configuration that its catalogue is to be made with.");
}

void bind_global_pipeline(nb::module_& m) {
  bind_described<VisualizeOptions>(m, "VisualizeOptions", "Which steps are drawn.");
  bind_described<DebugOptions>(m, "DebugOptions", "What is reported and saved.");
  bind_described<DatabaseOptions>(m, "DatabaseOptions", "How the views are made comparable with a scene.");
  bind_described<GlobalPipelineConfig>(m, "GlobalPipelineConfig", "Appendix C.2.1 of the reference.");
  m.def("read_pipeline_config", &read_pipeline_config, "path"_a, "Absent keys keep their defaults.");
}

void bind_outputs(nb::module_& m) {
  nb::class_<GlobalPipeline, PartRecognizer>(
      m, "GlobalPipeline", "The online stage of the reference: matches, aligns, refines and verifies.")
      .def(
          "__init__",
          [](GlobalPipeline* self, const Catalogue& catalogue, const GlobalPipelineConfig& config,
             const Callback& step_notion) {
            std::function<void(std::string_view)> notion;
            if (step_notion.wanted)
              notion = [function = step_notion.function](std::string_view step) {
                nb::gil_scoped_acquire gil;
                (*function)(nb::str(step.data(), step.size()));
              };
            new (self) GlobalPipeline(catalogue, config, notion);
          },
          "catalogue"_a, "config"_a, "step_notion"_a = nb::none(), released,
          nb::sig("def __init__(self, catalogue: Catalogue, config: GlobalPipelineConfig, step_notion: "
                  "collections.abc.Callable[[str], object] | None = None) -> None"))
      .def_prop_ro("config", &GlobalPipeline::config, nb::rv_policy::copy, "What it was made with.");
  m.def(
      "write_iteration",
      [](const fs::path& folder, const Recognized& recognition, const Scene& scene, const Catalogue& catalogue,
         const GlobalPipelineConfig& config) {
        return write_iteration(folder, recognition.recognition, scene, catalogue, config);
      },
      "folder"_a, "recognition"_a, "scene"_a, "catalogue"_a, "config"_a, released,
      "Writes the iteration output folder of the reference and returns it.");
  m.def(
      "draw_overlay",
      [](const DepthImage& depth, const Intrinsics& camera, const TriangleMesh* mesh,
         const std::optional<Eigen::Isometry3d>& camera_from_model) {
        if (depth.width != camera.width || depth.height != camera.height)
          throw Error("depth image of {} x {} px with a camera of {} x {} px", depth.width, depth.height, camera.width,
                      camera.height);
        std::vector<PlacedMesh> parts;
        if (mesh && camera_from_model) parts.push_back({*mesh, *camera_from_model});
        auto* image = new ColourImage(draw_overlay(depth, camera, parts));
        const nb::capsule owner(image, [](void* p) noexcept { delete static_cast<ColourImage*>(p); });
        return nb::ndarray<nb::numpy, std::uint8_t, nb::shape<-1, -1, 3>>(
            image->pixels.data()->data(), {std::size_t(image->height), std::size_t(image->width), 3}, owner);
      },
      "depth"_a, "intrinsics"_a, "mesh"_a = nb::none(), "camera_from_model"_a = nb::none(),
      "The measured depth as a shaded relief with the part drawn over it, height x width x 3, RGB.");
}

}  // namespace

Scene depth_scene(DepthImage depth, const Intrinsics& camera) {
  camera.check();
  if (depth.width != camera.width || depth.height != camera.height)
    throw Error("depth image of {} x {} px with a camera of {} x {} px", depth.width, depth.height, camera.width,
                camera.height);
  Scene scene;
  scene.cloud = to_point_cloud(depth, camera);
  scene.depth = std::move(depth);
  scene.intrinsics = camera;
  return scene;
}

std::vector<NamedMesh> read_parts(const Paths& paths, std::vector<std::string>& doubts) {
  const auto* one = std::get_if<fs::path>(&paths);
  std::vector<NamedMesh> parts = one ? read_meshes(*one) : read_meshes(std::get<std::vector<fs::path>>(paths));
  for (const auto& part : parts)
    if (std::string doubt = doubt_about_unit(part); !doubt.empty()) doubts.push_back(std::move(doubt));
  return parts;
}

void warn(const std::vector<std::string>& doubts) {
  const nb::gil_scoped_acquire gil;
  for (const auto& doubt : doubts)
    if (PyErr_WarnEx(PyExc_UserWarning, doubt.c_str(), 1) != 0) throw nb::python_error();
}

Recognized recognized(const PartRecognizer& recognizer, const Scene& scene) {
  Recognized out{recognizer.recognize(scene), {}, {}, {}};
  const Catalogue& catalogue = recognizer.catalogue();
  const auto name_of = [&](int part) { return catalogue.parts.at(static_cast<std::size_t>(part)).name; };
  const Recognition& r = out.recognition;
  out.extras = extras_of(r, catalogue);
  for (const Detection& detection : r.detections) {
    NamedDetection named{name_of(detection.part), detection,
                         detection.confidence > 0 || !detection.covariance.isZero(0)};
    for (const auto& each : detection.alternatives) named.alternatives.push_back({name_of(each.part), each});
    out.detections.push_back(std::move(named));
  }
  if (out.detections.empty() && r.accepted >= 0) {
    Detection only;
    only.camera_from_model = r.result.T_final;
    only.score = r.candidates[static_cast<std::size_t>(r.accepted)].score;
    out.detections.push_back({r.result.model_name, only});
  }
  for (const auto& model : catalogue.dataset.out.models)
    if (out.recognition.accepted >= 0 && model.id == out.recognition.result.model_id)
      out.symmetries = model.symmetries.symmetries();
  return out;
}

void bind_pipeline(nb::module_& parent) {
  auto dataset = room(parent, "dataset", "Partial views of the parts and their folder.");
  bind_dataset(dataset);
  auto pipeline = room(parent, "pipeline", "Offline stage, online stage, recognizer.");
  bind_records(pipeline);
  bind_global_pipeline(pipeline);
  bind_catalogue(pipeline);
  bind_detections(pipeline);
  bind_recognition(pipeline);
  bind_outputs(pipeline);
}

}  // namespace partpose::python
