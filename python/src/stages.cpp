// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "described.hpp"
#include "rooms.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/camera/sensor_fit.hpp"
#include "partpose/camera/virtual_depth_camera.hpp"
#include "partpose/descriptor/crh.hpp"
#include "partpose/descriptor/descriptors.hpp"
#include "partpose/geometry/voxel_grid.hpp"
#include "partpose/matching/descriptor_index.hpp"
#include "partpose/preprocess/preprocess.hpp"
#include "partpose/preprocess/segmentation.hpp"
#include "partpose/registration/coarse_alignment.hpp"
#include "partpose/registration/icp.hpp"
#include "partpose/registration/projective_refinement.hpp"
#include "partpose/verification/greedy_verification.hpp"
#include "partpose/verification/render_compare.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/unique_ptr.h>

#include <numeric>

namespace partpose::python {

namespace {

const auto released = nb::call_guard<nb::gil_scoped_release>();

void need_normals(const PointCloud& cloud, const char* what) {
  if (!cloud.has_normals())
    throw Error("{}: the cloud has no points with normals; partpose.preprocess.with_normals estimates them", what);
}

nb::ndarray<nb::numpy, int, nb::shape<-1, -1>> int_image(std::vector<int> values, int width, int height) {
  auto* kept = new std::vector<int>(std::move(values));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<int>*>(p); });
  return {kept->data(), {std::size_t(height), std::size_t(width)}, owner};
}

void bind_camera(nb::module_& m) {
  bind_described<StereoSensorOptions>(
      m, "StereoSensorOptions", "What a stereo depth camera does to the ideal depth; the defaults resemble a D415.");
  bind_described<NoiseOptions>(m, "NoiseOptions", "What is added to the depth.");
  bind_described<VirtualDepthCameraOptions>(m, "VirtualDepthCameraOptions", "The camera that takes the views.")
      .def("intrinsics", &VirtualDepthCameraOptions::intrinsics, "Of that field of view and resolution.");

  m.def(
      "render",
      [](const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, const Intrinsics& camera) {
        Rendering rendering;
        {
          nb::gil_scoped_release release;
          rendering = render(mesh, camera_from_model, camera);
        }
        return std::pair(std::move(rendering.depth),
                         int_image(std::move(rendering.triangle), camera.width, camera.height));
      },
      "mesh"_a, "camera_from_model"_a, "intrinsics"_a,
      "The depth as an ideal pinhole camera sees it, and the triangle seen at each pixel (-1: none).");
  m.def("look_at", &look_at, "position_mm"_a, "target_mm"_a, "Pose of a camera at a position that looks at a target.");
  m.def("capture", &capture, "mesh"_a, "camera_from_model"_a, "options"_a, "organized"_a = false, "frame"_a = 0,
        released, "One frame of a mesh: the visible points in the camera frame with normals, with noise.");
  m.def(
      "stereo_capture",
      [](const DepthImage& left, const DepthImage& right, const Intrinsics& camera, const StereoSensorOptions& options,
         std::uint64_t seed) {
        StereoCapture taken;
        {
          nb::gil_scoped_release release;
          taken = stereo_capture(left, right, camera, options, seed);
        }
        return std::pair(std::move(taken.depth),
                         int_image(std::move(taken.surface_pixel), camera.width, camera.height));
      },
      "left"_a, "right"_a, "intrinsics"_a, "options"_a, "seed"_a,
      "The measured depth of what both imagers would ideally see, and the pixel whose surface was measured (-1: "
      "none).");
  m.def("right_from_left", &right_from_left, "options"_a, "Moves the left imager's coordinates to the right one's.");
  m.def("predicted_depth_noise_mm", &predicted_depth_noise_mm, "options"_a, "intrinsics"_a, "z_mm"_a,
        "Standard deviation of the depth on a surface.");

  bind_described<StereoSensorFit>(m, "StereoSensorFit", "What captures of a flat wall tell about a stereo camera.");
  m.def(
      "fit_stereo_sensor",
      [](const std::vector<DepthImage>& frames, const Intrinsics& camera, double baseline_mm,
         std::array<int, 4> region_px, double depth_unit_mm, double plane_percent) {
        return fit_stereo_sensor(frames, camera, {baseline_mm, region_px, depth_unit_mm, plane_percent});
      },
      "frames"_a, "intrinsics"_a, "baseline_mm"_a, "region_px"_a = SensorFitOptions{}.region_px,
      "depth_unit_mm"_a = 0.0, "plane_percent"_a = SensorFitOptions{}.plane_percent, released,
      "Estimates the noise figures from depth images of one flat wall.");
}

void bind_preprocess(nb::module_& m) {
  bind_described<PreprocessOptions>(m, "PreprocessOptions", "The steps run in the order of the keys.");
  bind_described<NormalEstimationOptions>(m, "NormalEstimationOptions", "Normals of the scene.");
  nb::class_<PreprocessedScene> scene(m, "PreprocessedScene", "What is left of a scene.");
  scene.def_ro("cloud", &PreprocessedScene::cloud, "What is left.")
      .def_ro("plane", &PreprocessedScene::plane, "The plane that was removed; None: none was.");
  bind_repr(scene, {"cloud", "plane"});
  m.def(
      "preprocess",
      [](const PointCloud& cloud, const PreprocessOptions& options) {
        options.check();
        return preprocess(cloud, options);
      },
      "scene"_a, "options"_a, released, "Points that are not finite are dropped first.");
  m.def("scaled", &scaled, "cloud"_a, "factor"_a, "All points times a factor.");
  m.def("cropped", &cropped, "cloud"_a, "xyz_limits_mm"_a, "x min, x max, y min, y max, z min, z max.");
  m.def("without_radius_outliers", &without_radius_outliers, "cloud"_a, "radius_mm"_a, "min_points"_a, released,
        "Without points that have fewer than `min_points` others within the radius.");
  m.def("without_statistical_outliers", &without_statistical_outliers, "cloud"_a, "neighbours"_a, "deviations"_a,
        released, "Without points whose mean distance to their neighbours is far above the cloud's.");
  m.def(
      "with_normals",
      [](const PointCloud& cloud, const NormalEstimationOptions& options) {
        options.check();
        return with_normals(without_missing(cloud), options);
      },
      "cloud"_a, "options"_a, released, "Normals and curvatures of a scene seen from the origin.");

  m.def(
      "segment",
      [](const DepthImage& depth, const Intrinsics& camera, float largest_part_mm, float smallest_part_mm,
         int min_pixels, int most_segments) {
        if (depth.width != camera.width || depth.height != camera.height)
          throw Error("depth image of {} x {} px with a camera of {} x {} px", depth.width, depth.height, camera.width,
                      camera.height);
        std::vector<Segment> segments;
        {
          nb::gil_scoped_release release;
          segments = segment(depth, camera, {largest_part_mm, smallest_part_mm, min_pixels, most_segments});
        }
        nb::list out;
        for (auto& each : segments) out.append(array_of(std::move(each.pixels)));
        return out;
      },
      "depth"_a, "intrinsics"_a, "largest_part_mm"_a = SegmentationOptions{}.largest_part_mm,
      "smallest_part_mm"_a = SegmentationOptions{}.smallest_part_mm, "min_pixels"_a = SegmentationOptions{}.min_pixels,
      "most_segments"_a = SegmentationOptions{}.most_segments,
      nb::sig(
          "def segment(depth: partpose.core.DepthImage, intrinsics: partpose.core.Intrinsics, largest_part_mm: float "
          "= 300, smallest_part_mm: float = 10, min_pixels: int = 60, most_segments: int = 16) -> "
          "list[typing.Annotated[numpy.typing.NDArray[numpy.int32], dict(shape=(None,))]]"),
      "What may be single objects in a frame, largest first: the indices of their pixels (v * width + u).");
}

void bind_descriptor(nb::module_& m) {
  bind_described<VfhOptions>(m, "VfhOptions", "Viewpoint Feature Histogram (Rusu et al. 2010).");
  bind_described<CvfhOptions>(m, "CvfhOptions", "Clustered Viewpoint Feature Histogram (Aldoma et al. 2011).");
  bind_described<OurCvfhOptions>(m, "OurCvfhOptions", "Oriented, Unique and Repeatable CVFH (Aldoma et al. 2012).");
  bind_described<EsfOptions>(m, "EsfOptions", "Ensemble of Shape Functions (Wohlkinger and Vincze 2011).");
  bind_described<GoodOptions>(m, "GoodOptions", "Global Orthographic Object Descriptor (Kasaei et al. 2016).");
  bind_described<DescriptorOptions>(m, "DescriptorOptions", "The options of every global descriptor.");
  m.def("descriptor_names", &descriptor_names, "The names that a configuration may give.");

  nb::class_<Description> description(m, "Description", "One histogram of a cloud, and what it was measured on.");
  description
      .def_prop_ro(
          "histogram", [](nb::handle self) { return view_of(nb::cast<const Description&>(self).histogram, self); },
          nb::sig("def histogram(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None,))]"))
      .def_ro("centroid_mm", &Description::centroid_mm, "Of the points described.")
      .def_ro("support", &Description::support, "How many points are described.")
      .def_ro("valid", &Description::valid, "False: nothing can be said of these points.")
      .def_ro("camera_from_reference", &Description::camera_from_reference,
              "The descriptor's reference frame; None: it has none.");
  bind_repr(description, {"histogram", "centroid_mm", "support", "valid"});
  nb::class_<GlobalDescriptor>(m, "GlobalDescriptor", "A descriptor of a whole, segmented cloud with normals.")
      .def("bins", &GlobalDescriptor::bins, "The length of its histograms.")
      .def(
          "describe",
          [](const GlobalDescriptor& self, const PointCloud& cloud) {
            if (!cloud.empty()) need_normals(cloud, "describe");
            return self.describe(cloud);
          },
          "cloud"_a, released, "Nothing for a cloud that it is not defined for.");
  m.def("make_global_descriptor", &make_global_descriptor, "name"_a, "options"_a = DescriptorOptions{},
        "By its name in the configuration.");
  m.def("neighbours_of", &neighbours_of, "name"_a, "options"_a = DescriptorOptions{},
        "How many nearest neighbours the configuration asks for.");
  m.def(
      "camera_roll_histogram",
      [](const PointCloud& cloud) {
        need_normals(cloud, "camera_roll_histogram");
        const auto histogram = camera_roll_histogram(cloud, centroid(cloud).cast<double>());
        return array_of(std::vector<float>(histogram.begin(), histogram.end()));
      },
      "cloud"_a, "90 bins of 4 degrees about the line of sight to the centroid (Aldoma et al. 2011).");
}

void bind_matching(nb::module_& m) {
  nb::class_<DescriptorIndex>(m, "DescriptorIndex", "Histograms of equal length, searched exhaustively by L1 distance.")
      .def(
          "__init__",
          [](DescriptorIndex* self, int bins) {
            if (bins < 1) throw Error("bins: must be 1 or more, got {}", bins);
            new (self) DescriptorIndex(bins);
          },
          "bins"_a)
      .def(
          "add", [](DescriptorIndex& self, const Floats& histogram) { self.add(histogram.span()); }, "histogram"_a,
          "A row more.")
      .def("bins", &DescriptorIndex::bins, "The length of a row.")
      .def("__len__", &DescriptorIndex::size)
      .def(
          "row",
          [](const DescriptorIndex& self, int index) {
            if (index < 0 || index >= self.size()) throw Error("there is no row {}, there are {}", index, self.size());
            const auto row = self.row(index);
            return array_of(std::vector<float>(row.begin(), row.end()));
          },
          "index"_a, "A copy of one histogram.")
      .def(
          "nearest",
          [](const DescriptorIndex& self, const Floats& histogram, int k) {
            if (static_cast<int>(histogram.span().size()) != self.bins())
              throw Error("a histogram of {} bins is expected, got {}", self.bins(), histogram.span().size());
            if (k < 1) throw Error("k: must be 1 or more, got {}", k);
            std::vector<int> rows;
            std::vector<float> distances;
            for (const auto& match : self.nearest(histogram.span(), k)) {
              rows.push_back(match.row);
              distances.push_back(match.distance);
            }
            return std::pair(array_of(std::move(rows)), array_of(std::move(distances)));
          },
          "histogram"_a, "k"_a, "Rows and distances, nearest first.");
}

void bind_registration(nb::module_& m) {
  bind_described<CoarseAlignmentOptions>(m, "CoarseAlignmentOptions", "First guess of a candidate's pose.");
  bind_described<PoseRefinementOptions>(m, "PoseRefinementOptions", "Iterative closest points.");
  m.def(
      "coarse_alignments",
      [](const PointCloud& view, const PointCloud& scene, const CoarseAlignmentOptions& options) {
        need_normals(view, "view");
        need_normals(scene, "scene");
        options.check();
        return coarse_alignments(alignment_features(view), alignment_features(scene), {}, options);
      },
      "view"_a, "scene"_a, "options"_a = CoarseAlignmentOptions{}, released,
      "The transformations that may bring a view onto the scene, at least one.");
  nb::class_<IcpResult> result(m, "IcpResult", "What icp found.");
  result.def_ro("target_from_source", &IcpResult::target_from_source, "The motion found.")
      .def_ro("converged", &IcpResult::converged, "Whether the motion got as small as asked for.")
      .def_ro("iterations", &IcpResult::iterations, "How many were made.")
      .def_ro("pairs", &IcpResult::pairs, "In the last iteration.");
  bind_repr(result, {"target_from_source", "converged", "iterations", "pairs"});
  m.def(
      "icp",
      [](const PointCloud& source, const PointCloud& target, const PoseRefinementOptions& options) {
        if (!source.empty()) need_normals(source, "source");
        if (!target.empty()) need_normals(target, "target");
        options.check();
        const PointCloud s = without_missing(source), t = without_missing(target);
        return icp(s, t, KdTree(t.points), options);
      },
      "source"_a, "target"_a, "options"_a = PoseRefinementOptions{}, released,
      "Registers source to target, both with normals, starting from where the source lies.");
  nb::class_<ProjectiveRefinement> refined(m, "ProjectiveRefinement", "What refine_projectively found.");
  refined.def_ro("camera_from_model", &ProjectiveRefinement::camera_from_model, "The pose found.")
      .def_ro("pixels", &ProjectiveRefinement::pixels, "That were compared last.")
      .def_ro("rms_mm", &ProjectiveRefinement::rms_mm, "Of their distances.");
  bind_repr(refined, {"camera_from_model", "pixels", "rms_mm"});
  m.def(
      "refine_projectively",
      [](const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, const DepthImage& depth,
         const Intrinsics& camera, float gate_mm, int max_iterations, float converged_mm) {
        if (depth.width != camera.width || depth.height != camera.height)
          throw Error("depth image of {} x {} px with a camera of {} x {} px", depth.width, depth.height, camera.width,
                      camera.height);
        if (!(gate_mm > 0) || max_iterations < 1) throw Error("gate_mm and max_iterations must be positive");
        return refine_projectively(mesh, camera_from_model, depth, camera, {gate_mm, max_iterations, converged_mm});
      },
      "mesh"_a, "camera_from_model"_a, "depth"_a, "intrinsics"_a, "gate_mm"_a = ProjectiveRefinementOptions{}.gate_mm,
      "max_iterations"_a = ProjectiveRefinementOptions{}.max_iterations,
      "converged_mm"_a = ProjectiveRefinementOptions{}.converged_mm, released,
      "Moves a part so that its rendered surface meets the measured depth.");
}

void bind_verification(nb::module_& m) {
  bind_described<HypothesisVerificationOptions>(m, "HypothesisVerificationOptions", "Which candidates are believed.");
  nb::class_<Verification> verification(m, "Verification",
                                        "How well a model at a pose and a scene explain each other.");
  verification.def_ro("accepted", &Verification::accepted, "Whether the candidate is believed.")
      .def_ro("visible_model_points", &Verification::visible_model_points, "Of the model, not hidden by itself.")
      .def_ro("unexplained_model_points", &Verification::unexplained_model_points,
              "Of them: the scene has nothing there.")
      .def_ro("scene_points", &Verification::scene_points, "Of the scene.")
      .def_ro("explained_scene_points", &Verification::explained_scene_points, "Of them: the model is there.")
      .def_ro("reason", &Verification::reason, "Why it was not accepted, empty when it was.");
  bind_repr(verification, {"accepted", "visible_model_points", "unexplained_model_points", "scene_points",
                           "explained_scene_points", "reason"});
  m.def(
      "verify_greedy",
      [](const TriangleMesh& mesh, const PointCloud& surface, const Eigen::Isometry3d& camera_from_model,
         const PointCloud& scene, const HypothesisVerificationOptions& options) {
        options.check();
        const PointCloud thinned = voxel_grid(surface, options.voxel_mm());
        return verify_greedy({mesh, thinned, camera_from_model}, scene, voxel_grid(scene, options.voxel_mm()), options);
      },
      "mesh"_a, "surface"_a, "camera_from_model"_a, "scene"_a, "options"_a = HypothesisVerificationOptions{}, released,
      "Greedy hypothesis verification (Aldoma et al. 2012) of one candidate against a segmented scene. `surface`: the "
      "part's points, model frame.");
  nb::class_<RenderComparison> comparison(m, "RenderComparison", "Counts of pixels, in both directions.");
  comparison.def_ro("model", &RenderComparison::model, "Pixels where the part is rendered.")
      .def_ro("free_space", &RenderComparison::free_space, "Of them: before a background that was seen.")
      .def_ro("hidden", &RenderComparison::hidden, "Of them: behind or at the background.")
      .def_ro("nothing", &RenderComparison::nothing, "Of them: nothing was measured.")
      .def_ro("object", &RenderComparison::object, "Pixels of the object.")
      .def_ro("unexplained", &RenderComparison::unexplained, "Of them: no part is rendered at or beside them.")
      .def_ro("cost", &RenderComparison::cost, "The lower the better.")
      .def_prop_ro("score", &RenderComparison::score, "1: they explain each other; 0: nothing in common.");
  bind_repr(comparison, {"model", "free_space", "hidden", "nothing", "object", "unexplained", "cost", "score"});
  m.def(
      "render_and_compare",
      [](const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model, const DepthImage& depth,
         const Intrinsics& camera, const std::optional<std::vector<int>>& object_pixels, float tolerance_mm,
         float nothing_cost, float hidden_cost) {
        LabelledDepth frame{camera, depth, {}};
        if (depth.width != camera.width || depth.height != camera.height)
          throw Error("depth image of {} x {} px with a camera of {} x {} px", depth.width, depth.height, camera.width,
                      camera.height);
        if (!(tolerance_mm > 0)) throw Error("tolerance_mm: must be positive, got {}", tolerance_mm);
        const PixelLabel measured = object_pixels ? PixelLabel::background : PixelLabel::object;
        frame.label.resize(depth.z_mm.size());
        for (std::size_t i = 0; i < frame.label.size(); ++i)
          frame.label[i] = depth.z_mm[i] > 0 ? measured : PixelLabel::nothing;
        if (object_pixels)
          for (const int i : *object_pixels) {
            if (i < 0 || static_cast<std::size_t>(i) >= frame.label.size())
              throw Error("object_pixels: there is no pixel {}, there are {}", i, frame.label.size());
            if (depth.z_mm[i] > 0) frame.label[i] = PixelLabel::object;
          }
        return render_and_compare(mesh, camera_from_model, frame, {tolerance_mm, nothing_cost, hidden_cost});
      },
      "mesh"_a, "camera_from_model"_a, "depth"_a, "intrinsics"_a, "object_pixels"_a = nb::none(),
      "tolerance_mm"_a = RenderCompareOptions{}.tolerance_mm, "nothing_cost"_a = RenderCompareOptions{}.nothing_cost,
      "hidden_cost"_a = RenderCompareOptions{}.hidden_cost, released,
      "Renders the part at a pose and compares its depth with what was measured. `object_pixels` (v * width + u): "
      "those "
      "of the object, as `segment` gives them; None: all that was measured.");
}

}  // namespace

void bind_stages(nb::module_& parent) {
  auto camera = room(parent, "camera", "Virtual depth camera and sensor noise.");
  bind_camera(camera);
  auto preprocess =
      room(parent, "preprocess", "Scale, crop, voxel grid, plane and outlier removal, normals, segments.");
  bind_preprocess(preprocess);
  auto descriptor = room(parent, "descriptor", "Global descriptors: VFH, CVFH, OUR-CVFH, ESF, GOOD; CRH.");
  bind_descriptor(descriptor);
  auto matching = room(parent, "matching", "Descriptor index.");
  bind_matching(matching);
  auto registration = room(parent, "registration", "Coarse alignment and refinement.");
  bind_registration(registration);
  auto verification = room(parent, "verification", "Greedy verification, render-and-compare.");
  bind_verification(verification);
}

}  // namespace partpose::python
