// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0

// make_golden_esf INPUT_DIR OUTPUT [RUNS]: PCL's ESF of the points of INPUT_DIR/*.pcd, as one JSON file. PCL draws
// other triangles in every run, so it is run RUNS (100) times with seeds 1, 2, ...: the mean histogram, and how far the
// runs lie from it.

#include <pcl/features/esf.h>
#include <pcl/io/pcd_io.h>
#include <pcl/pcl_config.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

/// PCL calls srand(time(0)) before each histogram, which gives all runs within a second the same triangles. This one
/// stands before the C library's and does nothing; srandom() seeds the same generator.
extern "C" void srand(unsigned int) noexcept {}

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Histogram = std::vector<float>;

Histogram esf(const Cloud::Ptr& cloud, unsigned seed) {
  pcl::ESFEstimation<pcl::PointXYZ, pcl::ESFSignature640> estimation;
  estimation.setInputCloud(cloud);
  srandom(seed);
  pcl::PointCloud<pcl::ESFSignature640> signature;
  estimation.compute(signature);
  const auto& bins = signature.at(0).histogram;
  return {std::begin(bins), std::end(bins)};
}

double l1(const Histogram& histogram, const std::vector<double>& mean) {
  double sum = 0;
  for (std::size_t i = 0; i < mean.size(); ++i) sum += std::abs(histogram[i] - mean[i]);
  return sum;
}

void write_golden(const std::filesystem::path& input, const std::filesystem::path& output, int runs) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(input))
    if (entry.path().extension() == ".pcd") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());

  std::ofstream out(output);
  char digits[32];
  const auto number = [&digits](double value) {
    std::snprintf(digits, sizeof digits, "%.7g", value);
    return digits;
  };
  out << "{\"pcl_version\": \"" PCL_VERSION_PRETTY "\", \"runs\": " << runs << ",\n\"clouds\": [\n";
  for (const auto& path : paths) {
    const Cloud::Ptr cloud(new Cloud);
    if (pcl::io::loadPCDFile(path.string(), *cloud) != 0 || cloud->empty())
      throw std::runtime_error("cannot read " + path.string());
    std::vector<Histogram> histograms;
    for (int run = 1; run <= runs; ++run) histograms.push_back(esf(cloud, run));
    if (runs > 1 && histograms[0] == histograms[1]) throw std::runtime_error("PCL's seed is not under control");
    std::vector<double> mean(histograms[0].size(), 0.0);
    for (const auto& histogram : histograms)
      for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += histogram[i] / runs;
    double sum = 0, largest = 0;
    for (const auto& histogram : histograms) {
      sum += l1(histogram, mean);
      largest = std::max(largest, l1(histogram, mean));
    }
    out << "{\"file\": \"" << path.filename().string() << "\", \"l1_to_mean_average\": " << number(sum / runs);
    out << ", \"l1_to_mean_largest\": " << number(largest) << ",\n \"esf_mean\": [";
    for (std::size_t i = 0; i < mean.size(); ++i) out << (i > 0 ? "," : "") << number(mean[i]);
    out << (path == paths.back() ? "]}\n" : "]},\n");
  }
  out << "]}\n";
  if (!out) throw std::runtime_error("cannot write " + output.string());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::cerr << "usage: make_golden_esf INPUT_DIR OUTPUT [RUNS]\n";
    return 2;
  }
  try {
    const int runs = argc == 4 ? std::stoi(argv[3]) : 100;
    if (runs < 1) throw std::runtime_error("RUNS must be 1 or more");
    write_golden(argv[1], argv[2], runs);
  } catch (const std::exception& error) {
    std::cerr << "make_golden_esf: " << error.what() << '\n';
    return 1;
  }
}
