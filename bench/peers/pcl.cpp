// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// The reference's pipeline written with PCL 1.13, as a peer: with the settings of its appendix D as written, or with
// the same blocks set competently ("tuned"). GOOD, which PCL lacks, is partpose's.
#include "peer.hpp"
#include "shared.h"

#include <pcl/common/centroid.h>
#include <pcl/console/print.h>
#include <pcl/features/crh.h>
#include <pcl/features/cvfh.h>
#include <pcl/features/normal_3d.h>
#include <pcl/features/vfh.h>
#include <pcl/filters/crop_box.h>
#include <pcl/filters/extract_indices.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/io/pcd_io.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>
#include <pcl/recognition/crh_alignment.h>
#include <pcl/registration/icp.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <map>

namespace {

using peers::Json;
using Points = pcl::PointCloud<pcl::PointXYZ>;
using Oriented = pcl::PointCloud<pcl::PointNormal>;
using Roll = pcl::PointCloud<pcl::Histogram<90>>;
using Vfhs = pcl::PointCloud<pcl::VFHSignature308>;

struct Setting {
  std::string descriptor;  ///< "vfh", "cvfh", "good"
  bool tuned = false;

  int candidates() const { return tuned ? 12 : 6; }
};

struct Description {
  std::vector<float> histogram;
  std::optional<Eigen::Isometry3d> camera_from_reference;
};

struct Part {
  std::string name;
  void* shared = nullptr;
  Points::Ptr surface{new Points};  ///< all views fused, model frame
};

struct View {
  int part = 0;
  Eigen::Isometry3d camera_from_model;
  Oriented::Ptr cloud;  ///< for the refinement
  Roll::Ptr roll{new Roll};
  Eigen::Vector3f centroid;
  std::vector<Description> descriptions;
};

struct Candidate {
  const View* view = nullptr;
  std::vector<Eigen::Matrix4f> scene_from_view;  ///< coarse alignments to try, best first
  Eigen::Isometry3d camera_from_model;
  double fitness = 0;
};

struct Loaded {
  Json frame, pipeline;
  bool table = false;
  double tolerance_mm = 4;
  PeersCamera camera;
  std::vector<float> depth;
};

// --- PCL's blocks, each by itself

template <typename Cloud>
typename Cloud::Ptr voxel_grid(const typename Cloud::Ptr& cloud, float size) {
  pcl::VoxelGrid<typename Cloud::PointType> filter;
  filter.setInputCloud(cloud);
  filter.setLeafSize(size, size, size);
  typename Cloud::Ptr out(new Cloud);
  filter.filter(*out);
  return out;
}

Points::Ptr cropped(const Points::Ptr& cloud, const Json& limits) {
  pcl::CropBox<pcl::PointXYZ> filter;
  filter.setInputCloud(cloud);
  filter.setMin({limits[0].get<float>(), limits[2].get<float>(), limits[4].get<float>(), 1});
  filter.setMax({limits[1].get<float>(), limits[3].get<float>(), limits[5].get<float>(), 1});
  Points::Ptr out(new Points);
  filter.filter(*out);
  return out;
}

/// Without the points of the dominant plane, whose coefficients (ax + by + cz + d = 0) are left in `plane`.
Points::Ptr without_plane(const Points::Ptr& cloud, double threshold_mm, pcl::ModelCoefficients& plane) {
  pcl::SACSegmentation<pcl::PointXYZ> segmentation;
  segmentation.setModelType(pcl::SACMODEL_PLANE);
  segmentation.setMethodType(pcl::SAC_RANSAC);
  segmentation.setOptimizeCoefficients(true);
  segmentation.setMaxIterations(1000);
  segmentation.setDistanceThreshold(threshold_mm);
  segmentation.setInputCloud(cloud);
  pcl::PointIndices::Ptr inliers(new pcl::PointIndices);
  segmentation.segment(*inliers, plane);
  pcl::ExtractIndices<pcl::PointXYZ> extract;
  extract.setInputCloud(cloud);
  extract.setIndices(inliers);
  extract.setNegative(true);
  Points::Ptr out(new Points);
  extract.filter(*out);
  return out;
}

Points::Ptr without_outliers(const Points::Ptr& cloud, int neighbours, double deviations) {
  pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
  filter.setInputCloud(cloud);
  filter.setMeanK(neighbours);
  filter.setStddevMulThresh(deviations);
  Points::Ptr out(new Points);
  filter.filter(*out);
  return out;
}

/// The clusters that stand on the plane: on the camera's side, higher than what is left of a table that is not flat in
/// the frame, and not much smaller than the largest.
Points::Ptr standing_clusters(const Points::Ptr& cloud, const pcl::ModelCoefficients& plane, float least_height_mm) {
  if (plane.values.size() != 4) return cloud;
  Eigen::Vector4f up(plane.values.data());
  if (up[3] < 0) up = -up;  // the camera is at the origin
  const auto height = [&](const pcl::PointXYZ& p) { return up.head<3>().dot(p.getVector3fMap()) + up[3]; };
  Points::Ptr above(new Points);
  for (const auto& p : *cloud)
    if (height(p) > 0) above->push_back(p);
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  tree->setInputCloud(above);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setInputCloud(above);
  extraction.setSearchMethod(tree);
  extraction.setClusterTolerance(6);
  extraction.setMinClusterSize(50);
  std::vector<pcl::PointIndices> clusters;
  extraction.extract(clusters);  // the largest first
  Points::Ptr out(new Points);
  std::size_t largest = 0;
  for (const auto& cluster : clusters) {
    const bool stands = std::any_of(cluster.indices.begin(), cluster.indices.end(),
                                    [&](int i) { return height((*above)[i]) > least_height_mm; });
    if (!stands || cluster.indices.size() * 10 < largest) continue;
    largest = std::max(largest, cluster.indices.size());
    for (const int i : cluster.indices) out->push_back((*above)[i]);
  }
  return out;
}

Oriented::Ptr with_normals(const Points::Ptr& cloud, const Json& options) {
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(cloud);
  estimation.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
  estimation.setRadiusSearch(options.at("search_radius").get<double>());
  pcl::PointCloud<pcl::Normal> normals;
  estimation.compute(normals);
  const double least = std::cos(options.at("normal_to_view_angle_deviation_degrees").get<double>() * M_PI / 180);
  Oriented::Ptr out(new Oriented);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    const auto& n = normals[i];
    if (!std::isfinite(n.normal_x) || -n.normal_z < least) continue;
    pcl::PointNormal p;
    p.getVector4fMap() = (*cloud)[i].getVector4fMap();
    p.getNormalVector4fMap() = n.getNormalVector4fMap();
    p.curvature = n.curvature;
    out->push_back(p);
  }
  return out;
}

std::vector<float> coordinates(const Oriented& cloud) {
  std::vector<float> xyz;
  for (const auto& p : cloud) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  return xyz;
}

std::vector<Description> describe(const Oriented::Ptr& cloud, const Setting& setting, const Json& pipeline) {
  std::vector<Description> out;
  if (setting.descriptor == "good") {
    constexpr int most = 8;
    const int bins = pipeline.at("good").at("num_of_bins").get<int>();
    std::vector<float> histograms(static_cast<std::size_t>(most) * 3 * bins * bins);
    std::vector<double> frames(most * 16);
    const auto xyz = coordinates(*cloud);
    const int n = peers_good(xyz.data(), static_cast<int>(cloud->size()), bins,
                             setting.tuned ? 5.0 : pipeline.at("good").at("threshold").get<double>(), setting.tuned,
                             most, histograms.data(), frames.data());
    const std::ptrdiff_t size = 3 * bins * bins;
    for (int i = 0; i < n; ++i) {
      Eigen::Isometry3d frame;
      frame.matrix() = Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(frames.data() + 16 * i);
      out.push_back({{histograms.begin() + i * size, histograms.begin() + (i + 1) * size}, frame});
    }
    return out;
  }
  Vfhs signatures;
  if (setting.descriptor == "vfh") {
    const Json& options = pipeline.at("vfh");
    pcl::VFHEstimation<pcl::PointNormal, pcl::PointNormal> estimation;
    estimation.setInputCloud(cloud);
    estimation.setInputNormals(cloud);
    estimation.setNormalizeBins(options.at("use_normalized_bins").get<bool>());
    estimation.setFillSizeComponent(options.at("use_fill_size_component").get<bool>());
    estimation.setNormalizeDistance(true);  // PCL's own steps are 10 mm for clouds in metres: no use in mm
    estimation.compute(signatures);
  } else {
    const Json& options = pipeline.at("cvfh");
    pcl::CVFHEstimation<pcl::PointNormal, pcl::PointNormal> estimation;
    estimation.setInputCloud(cloud);
    estimation.setInputNormals(cloud);
    estimation.setSearchMethod(pcl::search::KdTree<pcl::PointNormal>::Ptr(new pcl::search::KdTree<pcl::PointNormal>));
    estimation.setMinPoints(options.at("min_points").get<std::size_t>());
    estimation.setClusterTolerance(options.at("cluster_tolerance_distance").get<float>());
    const auto angle_deg = options.at("eps_angle_threshold_deg").get<float>();
    estimation.setEPSAngleThreshold(angle_deg * static_cast<float>(M_PI) / 180);
    estimation.setRadiusNormals(options.at("radius_normals").get<float>());
    estimation.setCurvatureThreshold(0.03f);
    estimation.setNormalizeBins(options.at("use_normalized_bins").get<bool>());
    estimation.compute(signatures);
  }
  for (const auto& s : signatures) out.push_back({{s.histogram, s.histogram + 308}, std::nullopt});
  return out;
}

Eigen::Vector3f centroid_of(const Oriented& cloud) {
  Eigen::Vector4f c;
  pcl::compute3DCentroid(cloud, c);
  return c.head<3>();
}

Roll::Ptr roll_histogram(const Oriented::Ptr& cloud, const Eigen::Vector3f& centroid) {
  pcl::CRHEstimation<pcl::PointNormal, pcl::PointNormal, pcl::Histogram<90>> estimation;
  estimation.setInputCloud(cloud);
  estimation.setInputNormals(cloud);
  Eigen::Vector4f c(centroid[0], centroid[1], centroid[2], 1);
  estimation.setCentroid(c);
  Roll::Ptr out(new Roll);
  estimation.compute(*out);
  return out;
}

std::vector<Eigen::Matrix4f> roll_alignments(const View& view, const Roll::Ptr& scene_roll,
                                             Eigen::Vector3f scene_centroid) {
  pcl::CRHAlignment<pcl::PointNormal, 90> alignment;
  Eigen::Vector3f view_centroid = view.centroid;
  alignment.setInputAndTargetCentroids(view_centroid, scene_centroid);
  alignment.align(*view.roll, *scene_roll);
  std::vector<Eigen::Matrix4f, Eigen::aligned_allocator<Eigen::Matrix4f>> transforms;
  alignment.getTransforms(transforms);
  return {transforms.begin(), transforms.end()};
}

/// Mean distance of some of the view's points to the scene.
double mean_distance(const Oriented& view, const Eigen::Matrix4f& scene_from_view,
                     const pcl::KdTreeFLANN<pcl::PointNormal>& tree) {
  const std::size_t step = std::max<std::size_t>(view.size() / 150, 1);
  double sum = 0;
  int count = 0;
  pcl::Indices index(1);
  std::vector<float> squared(1);
  for (std::size_t i = 0; i < view.size(); i += step, ++count) {
    pcl::PointNormal p = view[i];
    p.getVector4fMap() = scene_from_view * p.getVector4fMap();
    tree.nearestKSearch(p, 1, index, squared);
    sum += std::sqrt(squared[0]);
  }
  return sum / count;
}

// --- the greedy verification of appendix D

/// z-buffer of points: the nearest depth in each cell of directions about `cell` wide (a tangent).
class ZBuffer {
 public:
  ZBuffer(const Points& cloud, double cell) : cell_(cell) {
    for (const auto& p : cloud) {
      const auto [it, is_new] = nearest_.emplace(key(p), p.z);
      if (!is_new) it->second = std::min(it->second, p.z);
    }
  }
  bool hides(const pcl::PointXYZ& p, double threshold_mm) const {
    const auto it = nearest_.find(key(p));
    return it != nearest_.end() && p.z - it->second > threshold_mm;
  }

 private:
  std::pair<int, int> key(const pcl::PointXYZ& p) const {
    return {static_cast<int>(std::floor(p.x / p.z / cell_)), static_cast<int>(std::floor(p.y / p.z / cell_))};
  }
  double cell_;
  std::map<std::pair<int, int>, float> nearest_;
};

bool greedy_accepts(const Part& part, const Eigen::Isometry3d& camera_from_model, const Points::Ptr& scene,
                    const ZBuffer& scene_depth, const Json& options) {
  const double inlier = options.at("inlier_threshold").get<double>();
  const double occlusion = options.at("occlusion_threshold").get<double>();
  Points placed;
  for (const auto& p : *part.surface) {
    const Eigen::Vector3f q = camera_from_model.cast<float>() * p.getVector3fMap();
    placed.push_back({q.x(), q.y(), q.z()});
  }
  const ZBuffer own_depth(placed, options.at("resolution").get<double>() / 700);
  Points::Ptr visible(new Points);
  for (const auto& p : placed)
    if (!own_depth.hides(p, occlusion) && !scene_depth.hides(p, occlusion)) visible->push_back(p);
  if (visible->empty()) return false;

  pcl::KdTreeFLANN<pcl::PointXYZ> scene_tree, part_tree;
  scene_tree.setInputCloud(scene);
  part_tree.setInputCloud(visible);
  pcl::Indices index(1);
  std::vector<float> squared(1);
  const auto near = [&](const auto& tree, const auto& p) {
    return tree.nearestKSearch(p, 1, index, squared) > 0 && squared[0] <= inlier * inlier;
  };
  const auto explained = std::count_if(scene->begin(), scene->end(), [&](const auto& p) { return near(part_tree, p); });
  const auto unexplained =
      std::count_if(visible->begin(), visible->end(), [&](const auto& p) { return !near(scene_tree, p); });
  return static_cast<double>(explained) > options.at("regularizer").get<double>() * static_cast<double>(unexplained);
}

// --- the pipeline

class PclPipeline {
 public:
  PclPipeline(const Json& setup, Setting setting) : setup_(setup), setting_(std::move(setting)) {
    for (const auto& protocol : setup.at("protocols"))
      pipelines_.push_back(peers::read_json(protocol.at("pipeline").get<std::string>()));
    for (const auto& part : setup.at("parts")) {
      const auto stl = part.at("stl").get<std::string>();
      parts_.push_back({part.at("name").get<std::string>(), peers_load_part(stl.c_str())});
      if (!parts_.back().shared) throw std::runtime_error(parts_.back().name + ": no mesh");
    }
    for (const auto& view : setup.at("views")) add_view(view);
    const double resolution = pipelines_[0].at("hypothesis_verification").at("resolution").get<double>();
    for (auto& part : parts_) part.surface = voxel_grid<Points>(part.surface, static_cast<float>(resolution));
  }

  Loaded load(const Json& frame) const {
    Loaded l{frame, pipelines_.at(frame.at("protocol").get<std::size_t>()), false, 4, {}, peers::read_depth(frame)};
    const Json& protocol = setup_.at("protocols").at(frame.at("protocol").get<std::size_t>());
    l.table = protocol.at("table").get<bool>();
    l.tolerance_mm = protocol.at("tolerance_mm").get<double>();
    l.camera = {frame.at("width"), frame.at("height"), frame.at("fx"), frame.at("fy"), frame.at("cx"), frame.at("cy")};
    return l;
  }

  std::optional<peers::Found> recognize(const Loaded& frame) const {
    const Points::Ptr object = preprocess(frame);
    if (object->size() < 50) return std::nullopt;
    const Oriented::Ptr scene = with_normals(object, frame.pipeline.at("normal_estimation"));
    if (scene->size() < 50) return std::nullopt;
    const Eigen::Vector3f centroid = centroid_of(*scene);
    const auto voxel = frame.pipeline.at("pose_refinement").at("voxel_size").get<float>();
    const Oriented::Ptr target = voxel_grid<Oriented>(scene, voxel);
    auto candidates = match(scene, frame.pipeline);
    align(candidates, scene, centroid, target);
    for (auto& candidate : candidates) refine(candidate, target, centroid, frame.pipeline);
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto& a, const auto& b) { return a.fitness < b.fitness; });
    return setting_.tuned ? best_of_two_sided(candidates, *object, frame) : first_of_greedy(candidates, object, frame);
  }

 private:
  void add_view(const Json& json) {
    View view;
    view.part = json.at("part").get<int>();
    view.camera_from_model = peers::pose_of(json.at("camera_from_model"));
    Oriented::Ptr raw(new Oriented);
    const auto path = json.at("pcd").get<std::string>();
    if (pcl::io::loadPCDFile(path, *raw) != 0) throw std::runtime_error(path + ": cannot be read");
    Points::Ptr points(new Points);
    for (const auto& p : *raw) points->push_back({p.x, p.y, p.z});
    // As written, the views keep the normals of the mesh's triangles; tuned, they are estimated as a scene's are.
    const Json& pipeline = pipelines_[0];
    const Oriented::Ptr described =
        setting_.tuned ? with_normals(voxel_grid<Points>(points, 1), pipeline.at("normal_estimation")) : raw;
    view.cloud = voxel_grid<Oriented>(described, pipeline.at("pose_refinement").at("voxel_size").get<float>());
    view.centroid = centroid_of(*described);
    view.roll = roll_histogram(described, view.centroid);
    view.descriptions = describe(described, setting_, pipeline);
    const Eigen::Isometry3f model_from_camera = view.camera_from_model.inverse().cast<float>();
    for (const auto& p : *view.cloud) {
      const Eigen::Vector3f q = model_from_camera * p.getVector3fMap();
      parts_[view.part].surface->push_back({q.x(), q.y(), q.z()});
    }
    views_.push_back(std::move(view));
  }

  Points::Ptr preprocess(const Loaded& frame) const {
    Points::Ptr cloud(new Points);
    for (int v = 0; v < frame.camera.height; ++v)
      for (int u = 0; u < frame.camera.width; ++u)
        if (const float z = frame.depth[static_cast<std::size_t>(v) * frame.camera.width + u]; z > 0)
          cloud->push_back({static_cast<float>((u - frame.camera.cx) / frame.camera.fx) * z,
                            static_cast<float>((v - frame.camera.cy) / frame.camera.fy) * z, z});
    const Json& options = frame.pipeline.at("preprocessing");
    if (options.at("xyz_filter_flag").get<bool>()) cloud = cropped(cloud, options.at("xyz_limits"));
    if (options.at("voxel_grid_flag").get<bool>())
      cloud = voxel_grid<Points>(cloud, options.at("voxel_size").get<float>());
    pcl::ModelCoefficients plane;
    if (options.at("plane_removal_flag").get<bool>())
      cloud = without_plane(
          cloud, setting_.tuned ? 4.0 : options.at("plane_removal_distance_threshold").get<double>(), plane);
    if (options.at("statistical_outlier_removal_flag").get<bool>())
      cloud = without_outliers(cloud, options.at("statistical_outlier_removal_num_of_k_nearest_neighbors").get<int>(),
                               options.at("statistical_outlier_removal_std_deviation_multiplier").get<double>());
    if (setting_.tuned && frame.table) cloud = standing_clusters(cloud, plane, 10);
    return cloud;
  }

  /// The views nearest by L1, best first, each with the alignments of its best matching reference frames.
  std::vector<Candidate> match(const Oriented::Ptr& scene, const Json& pipeline) const {
    struct Pair {
      float distance;
      const View* view;
      const Description *of_view, *of_scene;
    };
    const auto descriptions = describe(scene, setting_, pipeline);
    std::vector<Pair> pairs;
    for (const auto& mine : descriptions) {
      for (const auto& view : views_) {
        for (const auto& theirs : view.descriptions) {
          float distance = 0;
          for (std::size_t i = 0; i < mine.histogram.size(); ++i)
            distance += std::abs(mine.histogram[i] - theirs.histogram[i]);
          pairs.push_back({distance, &view, &theirs, &mine});
        }
      }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.distance < b.distance; });
    std::vector<Candidate> candidates;
    for (const auto& pair : pairs) {
      auto it = std::find_if(candidates.begin(), candidates.end(), [&](const auto& c) { return c.view == pair.view; });
      if (it == candidates.end()) {
        if (static_cast<int>(candidates.size()) == setting_.candidates()) continue;
        it = candidates.insert(candidates.end(), Candidate{pair.view, {}, {}, 0});
      }
      if (pair.of_view->camera_from_reference && it->scene_from_view.size() < 4)
        it->scene_from_view.push_back((*pair.of_scene->camera_from_reference *
                                       pair.of_view->camera_from_reference->inverse())
                                          .matrix()
                                          .cast<float>());
    }
    return candidates;
  }

  void align(std::vector<Candidate>& candidates, const Oriented::Ptr& scene, const Eigen::Vector3f& centroid,
             const Oriented::Ptr& target) const {
    const Roll::Ptr roll = roll_histogram(scene, centroid);
    pcl::KdTreeFLANN<pcl::PointNormal> tree;
    tree.setInputCloud(target);
    for (auto& candidate : candidates) {
      auto& alignments = candidate.scene_from_view;
      if (alignments.empty() || setting_.tuned) {
        const auto rolls = roll_alignments(*candidate.view, roll, centroid);
        alignments.insert(alignments.end(), rolls.begin(), rolls.end());
      }
      if (!setting_.tuned || alignments.size() == 1) continue;
      const auto best = std::min_element(alignments.begin(), alignments.end(), [&](const auto& a, const auto& b) {
        return mean_distance(*candidate.view->cloud, a, tree) < mean_distance(*candidate.view->cloud, b, tree);
      });
      std::swap(alignments[0], *best);
    }
  }

  void refine(Candidate& candidate, const Oriented::Ptr& target, const Eigen::Vector3f& centroid,
              const Json& pipeline) const {
    const Json& options = pipeline.at("pose_refinement");
    Eigen::Matrix4f coarse =
        candidate.scene_from_view.empty() ? Eigen::Matrix4f::Identity() : candidate.scene_from_view[0];
    // PCL solves the symmetric objective on the coordinates as they are: tuned, the clouds are moved to the origin.
    Eigen::Matrix4f centred_from_camera = Eigen::Matrix4f::Identity();
    if (setting_.tuned) centred_from_camera.block<3, 1>(0, 3) = -centroid;
    Oriented::Ptr source(new Oriented), centred_target(new Oriented);
    pcl::transformPointCloudWithNormals(*candidate.view->cloud, *source, Eigen::Matrix4f(centred_from_camera * coarse));
    pcl::transformPointCloudWithNormals(*target, *centred_target, centred_from_camera);

    pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal> icp;
    icp.setEnforceSameDirectionNormals(options.at("enforce_same_direction_normals").get<bool>());
    icp.setUseSymmetricObjective(options.at("use_symmetric_objective").get<bool>());
    icp.setInputSource(source);
    icp.setInputTarget(centred_target);
    if (setting_.tuned) {
      icp.setMaxCorrespondenceDistance(15);
      icp.setMaximumIterations(100);
      icp.setTransformationEpsilon(1e-4);             // mm^2
      icp.setTransformationRotationEpsilon(1 - 1e-6);  // a cosine: 0.08 degrees
      icp.setEuclideanFitnessEpsilon(1e-5);           // relative
    } else {
      icp.setMaxCorrespondenceDistance(options.at("max_correspondence_distance").get<double>());
      icp.setMaximumIterations(options.at("max_iterations").get<int>());
      icp.setTransformationEpsilon(options.at("transformation_epsilon").get<double>());
      icp.setEuclideanFitnessEpsilon(options.at("euclidean_fitness_epsilon").get<double>());
    }
    Oriented aligned;
    icp.align(aligned);
    candidate.fitness = icp.getFitnessScore();
    Eigen::Isometry3d scene_from_view;
    scene_from_view.matrix() =
        (centred_from_camera.inverse() * icp.getFinalTransformation() * centred_from_camera * coarse).cast<double>();
    candidate.camera_from_model = scene_from_view * candidate.view->camera_from_model;
  }

  /// PCL 1.13's GreedyVerification reads memory that it never wrote; this is its rule, with a z-buffer that is cleared.
  std::optional<peers::Found> first_of_greedy(const std::vector<Candidate>& candidates, const Points::Ptr& object,
                                              const Loaded& frame) const {
    const Json& options = frame.pipeline.at("hypothesis_verification");
    const auto resolution = options.at("resolution").get<float>();
    const Points::Ptr scene = voxel_grid<Points>(object, resolution);
    const ZBuffer depth(*object, resolution / 700);
    for (const auto& candidate : candidates) {
      const Part& part = parts_[candidate.view->part];
      if (greedy_accepts(part, candidate.camera_from_model, scene, depth, options))
        return peers::Found{part.name, candidate.camera_from_model, -candidate.fitness};
    }
    return std::nullopt;
  }

  std::optional<peers::Found> best_of_two_sided(const std::vector<Candidate>& candidates, const Points& object,
                                                const Loaded& frame) const {
    std::vector<float> xyz;
    for (const auto& p : object) xyz.insert(xyz.end(), {p.x, p.y, p.z});
    void* seen = peers_open_frame(&frame.camera, frame.depth.data(), frame.table ? xyz.data() : nullptr,
                                  static_cast<int>(object.size()), frame.tolerance_mm);
    peers::Found best;
    for (const auto& candidate : candidates) {
      const Part& part = parts_[candidate.view->part];
      const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> pose = candidate.camera_from_model.matrix();
      const double score = peers_two_sided(part.shared, seen, pose.data());
      if (score > best.score) best = {part.name, candidate.camera_from_model, score};
    }
    peers_close_frame(seen);
    if (best.score < 0.4) return std::nullopt;
    return best;
  }

  const Json& setup_;
  Setting setting_;
  std::vector<Json> pipelines_;
  std::vector<Part> parts_;
  std::vector<View> views_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "peers_pcl setup.json as-written|tuned vfh|cvfh|good\n";
    return 2;
  }
  try {
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
    const double began = peers::wall_ms();
    const Json setup = peers::read_json(argv[1]);
    const PclPipeline pipeline(setup, {argv[3], std::string(argv[2]) == "tuned"});
    peers::answer_frames([&](const Json& frame) { return pipeline.load(frame); },
                         [&](const Loaded& frame) { return pipeline.recognize(frame); }, began);
  } catch (const std::exception& error) {
    std::cerr << "peers_pcl: " << error.what() << '\n';
    return 1;
  }
}
