// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0

// make_golden INPUT_DIR OUTPUT: what PCL computes from the clouds (points, normals) of INPUT_DIR/*.pcd, as one JSON
// file. INPUT_DIR/pairs.txt lists the pairs for the camera roll: source file, target file, known roll in degrees or
// "-".

#include <pcl/common/centroid.h>
#include <pcl/console/print.h>
#include <pcl/features/crh.h>
#include <pcl/features/cvfh.h>
#include <pcl/features/normal_3d.h>
#include <pcl/features/our_cvfh.h>
#include <pcl/features/vfh.h>
#include <pcl/io/pcd_io.h>
#include <pcl/pcl_config.h>
#include <pcl/point_types.h>
#include <pcl/recognition/crh_alignment.h>
#include <pcl/search/kdtree.h>
#include <pcl/features/impl/cvfh.hpp>
#include <pcl/features/impl/our_cvfh.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {
/// Whether the search trees that PCL makes give sorted neighbours even when asked for unsorted ones.
bool always_sorted = false;
}  // namespace

/// The constructor of the trees that CVFH and OUR-CVFH make for themselves, in place of the library's. They ask for
/// unsorted neighbours and then skip the first as if it were the point itself, so that each point misses some
/// neighbour, which one being up to the tree. With `always_sorted` the point itself comes first, and PCL does what its
/// rule says.
template <>
pcl::search::KdTree<pcl::PointNormal, pcl::KdTreeFLANN<pcl::PointNormal>>::KdTree(bool sorted)
    : Search<pcl::PointNormal>("KdTree", sorted || always_sorted),
      tree_(new pcl::KdTreeFLANN<pcl::PointNormal>(sorted || always_sorted)) {}

namespace {

using Cloud = pcl::PointCloud<pcl::PointNormal>;
using CameraRollHistogram = pcl::PointCloud<pcl::Histogram<90>>;

Cloud::Ptr read_cloud(const std::filesystem::path& path) {
  Cloud::Ptr cloud(new Cloud);
  if (pcl::io::loadPCDFile(path.string(), *cloud) != 0 || cloud->empty())
    throw std::runtime_error("cannot read " + path.string());
  return cloud;
}

struct VfhSettings {
  bool normalize_bins = true;
  bool size_component = false;
  bool normalize_distances = false;
};

std::vector<float> vfh(const Cloud::Ptr& cloud, const VfhSettings& settings) {
  pcl::VFHEstimation<pcl::PointNormal, pcl::PointNormal, pcl::VFHSignature308> estimation;
  estimation.setInputCloud(cloud);
  estimation.setInputNormals(cloud);
  estimation.setViewPoint(0, 0, 0);
  estimation.setNormalizeBins(settings.normalize_bins);
  estimation.setFillSizeComponent(settings.size_component);
  estimation.setNormalizeDistance(settings.normalize_distances);
  pcl::PointCloud<pcl::VFHSignature308> signature;
  estimation.compute(signature);
  const auto& bins = signature.at(0).histogram;
  return {std::begin(bins), std::end(bins)};
}

CameraRollHistogram crh(const Cloud::Ptr& cloud) {
  Eigen::Vector4f centroid;
  pcl::compute3DCentroid(*cloud, centroid);
  pcl::CRHEstimation<pcl::PointNormal, pcl::PointNormal, pcl::Histogram<90>> estimation;
  estimation.setInputCloud(cloud);
  estimation.setInputNormals(cloud);
  estimation.setViewPoint(0, 0, 0);
  estimation.setCentroid(centroid);
  CameraRollHistogram histogram;
  estimation.compute(histogram);
  return histogram;
}

std::vector<float> roll_angles_deg(CameraRollHistogram source, CameraRollHistogram target) {
  pcl::CRHAlignment<pcl::PointNormal, 90> alignment;
  std::vector<float> angles;
  alignment.computeRollAngle(source, target, angles);
  return angles;
}

using Transforms = std::vector<Eigen::Matrix4f, Eigen::aligned_allocator<Eigen::Matrix4f>>;
using Vectors = std::vector<Eigen::Vector3f, Eigen::aligned_allocator<Eigen::Vector3f>>;
using Components = std::vector<std::vector<int>>;

/// Options of CVFH and OUR-CVFH; lengths in mm, whatever the unit that PCL gets.
struct ClusterSettings {
  const char* name;
  bool in_metres;  ///< PCL gets cloud and lengths in metres: only then its buried 0.01 is 10 mm
  int min_points;
  float tolerance, eps_angle_deg, radius_normals;
  bool normalize_bins;
  float curvature_threshold, refine_clusters, axis_ratio, min_axis_value;

  float unit() const { return in_metres ? 1e-3f : 1.f; }
  float eps_angle() const { return eps_angle_deg * static_cast<float>(M_PI) / 180; }
};

const ClusterSettings cluster_settings[] = {
    {"appendix_d", true, 200, 9, 20, 9, true, 0.03f, 1, 0.8f, 0.925f},
    {"small", true, 40, 8, 12, 9, true, 0.05f, 1, 0.8f, 0.925f},
    {"points", false, 60, 12, 15, 12, false, 0.04f, 0.8f, 0.6f, 0.7f},
};

struct Described {
  Eigen::Vector3f centroid_mm;
  std::vector<float> histogram;
  Eigen::Matrix4f reference_from_camera;  ///< OUR-CVFH, in the unit of the settings
};

template <typename Estimation>
void set_common(Estimation& estimation, const Cloud::Ptr& cloud, const ClusterSettings& s) {
  estimation.setInputCloud(cloud);
  estimation.setInputNormals(cloud);
  estimation.setSearchMethod(pcl::search::KdTree<pcl::PointNormal>::Ptr(new pcl::search::KdTree<pcl::PointNormal>));
  estimation.setViewPoint(0, 0, 0);
  estimation.setClusterTolerance(s.tolerance * s.unit());
  estimation.setEPSAngleThreshold(s.eps_angle());
  estimation.setCurvatureThreshold(s.curvature_threshold);
  estimation.setMinPoints(s.min_points);
  estimation.setRadiusNormals(s.radius_normals * s.unit());
  estimation.setNormalizeBins(s.normalize_bins);
}

std::vector<float> bins_of(const pcl::VFHSignature308& signature) {
  return {std::begin(signature.histogram), std::end(signature.histogram)};
}

std::vector<Described> cvfh(const Cloud::Ptr& cloud, const ClusterSettings& s) {
  pcl::CVFHEstimation<pcl::PointNormal, pcl::PointNormal> estimation;
  set_common(estimation, cloud, s);
  pcl::PointCloud<pcl::VFHSignature308> signatures;
  estimation.compute(signatures);
  Vectors centroids;
  estimation.getCentroidClusters(centroids);
  std::vector<Described> all;
  for (std::size_t i = 0; i < signatures.size(); ++i)
    all.push_back({centroids.at(i) / s.unit(), bins_of(signatures[i]), Eigen::Matrix4f::Identity()});
  return all;
}

std::vector<Described> our_cvfh(const Cloud::Ptr& cloud, const ClusterSettings& s, Components& clusters) {
  pcl::OURCVFHEstimation<pcl::PointNormal, pcl::PointNormal> estimation;
  set_common(estimation, cloud, s);
  estimation.setRefineClusters(s.refine_clusters);
  estimation.setAxisRatio(s.axis_ratio);
  estimation.setMinAxisValue(s.min_axis_value);
  pcl::PointCloud<pcl::VFHSignature308> signatures;
  estimation.compute(signatures);
  Vectors centroids;
  Transforms transforms;
  std::vector<short> axes;
  std::vector<pcl::PointIndices> indices;
  estimation.getCentroidClusters(centroids);
  estimation.getTransforms(transforms);
  estimation.getClusterAxes(axes);
  estimation.getClusterIndices(indices);
  clusters.clear();
  for (const auto& cluster : indices) clusters.emplace_back(cluster.indices.begin(), cluster.indices.end());
  if (clusters.empty()) axes = {1};
  std::vector<Described> all;
  for (std::size_t c = 0; c < axes.size(); ++c)
    for (int a = 0; a < axes[c]; ++a) {
      const std::size_t i = all.size();
      all.push_back({centroids.at(c) / s.unit(), bins_of(signatures.at(i)), transforms.at(i)});
    }
  return all;
}

/// The clusters that PCL's rule means, by trying all pairs: its own search leaves out one neighbour of each point (it
/// takes the first of an unsorted list for the point itself), and its acos of a product of two unit vectors above 1 is
/// no number, so that points with equal normals may not be joined. Indices into `cloud`, each cluster refined.
Components plain_clusters(const Cloud& cloud, const ClusterSettings& s, double tolerance, double eps,
                          double refined_eps, Vectors& centroids) {
  Cloud::Ptr smooth(new Cloud);
  std::vector<int> original;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (!(cloud[i].curvature > s.curvature_threshold)) {
      smooth->push_back(cloud[i]);
      original.push_back(static_cast<int>(i));
    }
  centroids.clear();
  if (smooth->size() < static_cast<std::size_t>(s.min_points)) return {};
  pcl::NormalEstimation<pcl::PointNormal, pcl::PointNormal> estimation;
  estimation.setRadiusSearch(s.radius_normals * s.unit());
  estimation.setInputCloud(smooth);
  estimation.compute(*smooth);
  const auto normal = [&](int i) {
    return Eigen::Vector3d((*smooth)[i].getNormalVector3fMap().cast<double>().normalized());
  };
  const auto point = [&](int i) { return Eigen::Vector3d((*smooth)[i].getVector3fMap().cast<double>()); };
  const int n = static_cast<int>(smooth->size());
  Components clusters;
  std::vector<bool> taken(n, false);
  for (int seed = 0; seed < n; ++seed) {
    if (taken[seed]) continue;
    taken[seed] = true;
    std::vector<int> members = {seed};
    for (std::size_t next = 0; next < members.size(); ++next)
      for (int j = 0; j < n; ++j)
        if (!taken[j] && (point(j) - point(members[next])).norm() <= tolerance &&
            normal(j).dot(normal(members[next])) > std::cos(eps)) {
          taken[j] = true;
          members.push_back(j);
        }
    if (members.size() < static_cast<std::size_t>(s.min_points)) continue;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero(), centroid = Eigen::Vector3d::Zero();
    for (const int i : members) mean += normal(i), centroid += point(i);
    std::vector<int> kept;
    for (const int i : members)
      if (normal(i).dot(mean.normalized()) > std::cos(refined_eps)) kept.push_back(original[i]);
    std::sort(kept.begin(), kept.end());
    centroids.push_back((centroid / static_cast<double>(members.size()) / s.unit()).cast<float>());
    clusters.push_back(kept);
  }
  return clusters;
}

/// Whether PCL's clusters, refined (OUR-CVFH) and not (CVFH), are what its rule means, and no threshold is so near that
/// rounding decides.
bool well_defined(const Cloud& cloud, const ClusterSettings& s, const Components& refined,
                  const std::vector<Described>& whole) {
  const double tolerance = s.tolerance * s.unit(), eps = s.eps_angle();
  Vectors centroids;
  const auto is_it = [&](double sign) {
    const double nearly = eps + sign * 2e-5;
    if (plain_clusters(cloud, s, tolerance * (1 + sign * 2e-6), nearly, nearly * s.refine_clusters, centroids) !=
        refined)
      return false;
    if (centroids.empty()) return true;
    if (centroids.size() != whole.size()) return false;
    for (std::size_t c = 0; c < whole.size(); ++c)
      if ((centroids[c] - whole[c].centroid_mm).norm() > 2e-3f) return false;
    return true;
  };
  return is_it(0) && is_it(-1) && is_it(1);
}

Cloud::Ptr in_unit(const Cloud& cloud, float unit) {
  Cloud::Ptr scaled(new Cloud(cloud));
  for (auto& point : *scaled) point.getVector3fMap() *= unit;
  return scaled;
}

template <typename Numbers>
std::string json(const Numbers& numbers) {
  std::string text = "[";
  char digits[32];
  for (const float number : numbers) {
    std::snprintf(digits, sizeof digits, "%.9g", number);
    text += (text.size() > 1 ? "," : "") + std::string(digits);
  }
  return text + "]";
}

std::string json(const ClusterSettings& s) {
  std::ostringstream text;
  text << std::boolalpha << "{\"in_metres\": " << s.in_metres << ", \"min_points\": " << s.min_points
       << ", \"cluster_tolerance_distance\": " << s.tolerance << ", \"eps_angle_threshold_deg\": " << s.eps_angle_deg
       << ", \"radius_normals\": " << s.radius_normals << ", \"use_normalized_bins\": " << s.normalize_bins
       << ", \"curvature_threshold\": " << s.curvature_threshold << ", \"refine_clusters\": " << s.refine_clusters
       << ", \"axis_ratio\": " << s.axis_ratio << ", \"min_axis_value\": " << s.min_axis_value << "}";
  return text.str();
}

std::string json(const std::vector<Described>& descriptions, const ClusterSettings* frames_of = nullptr) {
  std::string text = "[";
  for (const auto& d : descriptions) {
    text += (text.size() > 1 ? ",\n  " : "\n  ") + std::string("{\"centroid_mm\": ") +
            json(std::vector<float>(d.centroid_mm.data(), d.centroid_mm.data() + 3));
    if (frames_of) {
      Eigen::Matrix<float, 4, 4, Eigen::RowMajor> rows = d.reference_from_camera;
      rows.block<3, 1>(0, 3) /= frames_of->unit();
      text += ", \"reference_from_camera\": " + json(std::vector<float>(rows.data(), rows.data() + 16));
    }
    text += ", \"histogram\": " + json(d.histogram) + "}";
  }
  return text + "]";
}

/// CVFH and OUR-CVFH of one cloud with all settings; where PCL is not well defined, only that it is not.
std::string clustered(const std::string& file, const Cloud& cloud_mm) {
  std::string text;
  for (const auto& s : cluster_settings) {
    const Cloud::Ptr cloud = in_unit(cloud_mm, s.unit());
    Components clusters;
    std::vector<Described> whole, oriented;
    bool defined = false;
    for (const bool sorted : {false, true}) {
      if (defined) break;
      always_sorted = sorted;
      whole = cvfh(cloud, s);
      oriented = our_cvfh(cloud, s, clusters);
      defined = well_defined(*cloud, s, clusters, whole);
    }
    text += (text.empty() ? "" : ",\n") + std::string("{\"file\": \"") + file + "\", \"settings\": \"" + s.name +
            "\", \"clusters\": " + std::to_string(clusters.size()) +
            ", \"well_defined\": " + (defined ? "true" : "false") +
            ", \"search_mended\": " + (always_sorted ? "true" : "false");
    if (defined) text += ",\n \"cvfh\": " + json(whole) + ",\n \"ourcvfh\": " + json(oriented, &s);
    text += "}";
  }
  return text;
}

void write_golden(const std::filesystem::path& input, const std::filesystem::path& output) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(input))
    if (entry.path().extension() == ".pcd") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());

  std::ofstream out(output);
  out << "{\"pcl_version\": \"" PCL_VERSION_PRETTY "\",\n\"clouds\": [\n";
  std::map<std::string, CameraRollHistogram> histograms;
  for (const auto& path : paths) {
    const std::string file = path.filename().string();
    const Cloud::Ptr cloud = read_cloud(path);
    const CameraRollHistogram& histogram = histograms[file] = crh(cloud);
    out << "{\"file\": \"" << file << "\",\n \"vfh_default\": " << json(vfh(cloud, {}))
        << ",\n \"vfh_size_component\": " << json(vfh(cloud, {true, true, true}))
        << ",\n \"vfh_raw\": " << json(vfh(cloud, {false, false, false}))
        << ",\n \"crh\": " << json(histogram[0].histogram) << (path == paths.back() ? "}\n" : "},\n");
  }
  out << "],\n\"cluster_settings\": {";
  for (const auto& s : cluster_settings)
    out << (&s == cluster_settings ? "\n\"" : ",\n\"") << s.name << "\": " << json(s);
  out << "},\n\"clustered\": [\n";
  std::string comma;
  for (const auto& path : paths) {
    const std::string file = path.filename().string();
    // Not the clouds without noise: the acos of a product of equal normals is then no number for every other point, and
    // OUR-CVFH crashes on a cluster of which one point is left.
    const auto is = [&file](const char* kind) { return file.find(kind) != std::string::npos; };
    if (is("_metres") || is("_mesh") || is("_exact")) continue;
    out << comma << clustered(file, *read_cloud(path));
    comma = ",\n";
  }
  out << "],\n\"crh_alignment\": [\n";

  std::ifstream pairs(input / "pairs.txt");
  std::string line, source, target, known, separator;
  while (std::getline(pairs, line)) {
    if (!(std::istringstream(line) >> source >> target >> known))
      throw std::runtime_error("pairs.txt: bad line: " + line);
    out << separator << "{\"source\": \"" << source << "\", \"target\": \"" << target
        << "\", \"known_roll_deg\": " << (known == "-" ? "null" : known)
        << ", \"roll_angles_deg\": " << json(roll_angles_deg(histograms.at(source), histograms.at(target))) << "}";
    separator = ",\n";
  }
  out << "\n]}\n";
  if (!out) throw std::runtime_error("cannot write " + output.string());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: make_golden INPUT_DIR OUTPUT\n";
    return 2;
  }
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
  try {
    write_golden(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::cerr << "make_golden: " << error.what() << '\n';
    return 1;
  }
}
