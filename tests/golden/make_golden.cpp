// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0

// make_golden INPUT_DIR OUTPUT: what PCL computes from the clouds (points, normals) of INPUT_DIR/*.pcd, as one JSON
// file. INPUT_DIR/pairs.txt lists the pairs for the camera roll: source file, target file, known roll in degrees or
// "-".

#include <pcl/common/centroid.h>
#include <pcl/features/crh.h>
#include <pcl/features/vfh.h>
#include <pcl/io/pcd_io.h>
#include <pcl/pcl_config.h>
#include <pcl/point_types.h>
#include <pcl/recognition/crh_alignment.h>

#include <algorithm>
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
  try {
    write_golden(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::cerr << "make_golden: " << error.what() << '\n';
    return 1;
  }
}
