// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "pcl_peers.hpp"

#include <pcl/console/print.h>
#include <pcl/features/cvfh.h>
#include <pcl/features/esf.h>
#include <pcl/features/our_cvfh.h>
#include <pcl/features/vfh.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <stdexcept>

// The types that the library is compiled for: what is timed is Debian's build of PCL, not one of our own.
using Points = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;
using Tree = pcl::search::KdTree<pcl::PointXYZ>;
using Vfhs = pcl::PointCloud<pcl::VFHSignature308>;

struct PclPeers::Clouds {
  Points::Ptr points{new Points};
  Normals::Ptr normals{new Normals};
};

PclPeers::PclPeers(const float* xyz, const float* normals, const float* curvatures, std::size_t count)
    : clouds_(new Clouds) {
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
  for (std::size_t i = 0; i < count; ++i, xyz += 3, normals += 3) {
    clouds_->points->push_back({xyz[0], xyz[1], xyz[2]});
    pcl::Normal normal(normals[0], normals[1], normals[2]);
    normal.curvature = curvatures[i];
    clouds_->normals->push_back(normal);
  }
}

PclPeers::~PclPeers() = default;
PclPeers::PclPeers(PclPeers&&) noexcept = default;

bool PclPeers::has(const std::string& descriptor) {
  return descriptor == "vfh" || descriptor == "cvfh" || descriptor == "ourcvfh" || descriptor == "esf";
}

namespace {

template <typename Estimation>
int run_clustered(const Points::Ptr& points, const Normals::Ptr& normals, const PeerOptions& options) {
  Estimation estimation;
  estimation.setInputCloud(points);
  estimation.setInputNormals(normals);
  estimation.setSearchMethod(Tree::Ptr(new Tree));
  estimation.setMinPoints(options.min_points);
  estimation.setClusterTolerance(options.tolerance);
  estimation.setEPSAngleThreshold(options.eps_angle_rad);
  estimation.setRadiusNormals(options.radius_normals);
  estimation.setCurvatureThreshold(options.curvature_threshold);
  estimation.setNormalizeBins(true);
  Vfhs histograms;
  estimation.compute(histograms);
  return static_cast<int>(histograms.size());
}

}  // namespace

int PclPeers::run(const std::string& descriptor, const PeerOptions& options) const {
  if (descriptor == "cvfh")
    return run_clustered<pcl::CVFHEstimation<pcl::PointXYZ, pcl::Normal>>(clouds_->points, clouds_->normals, options);
  if (descriptor == "ourcvfh")
    return run_clustered<pcl::OURCVFHEstimation<pcl::PointXYZ, pcl::Normal>>(clouds_->points, clouds_->normals,
                                                                             options);
  if (descriptor == "vfh") {
    pcl::VFHEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setInputCloud(clouds_->points);
    estimation.setInputNormals(clouds_->normals);
    estimation.setFillSizeComponent(true);
    estimation.setNormalizeDistance(true);
    Vfhs histograms;
    estimation.compute(histograms);
    return static_cast<int>(histograms.size());
  }
  if (descriptor == "esf") {
    pcl::ESFEstimation<pcl::PointXYZ> estimation;
    estimation.setInputCloud(clouds_->points);
    pcl::PointCloud<pcl::ESFSignature640> histograms;
    estimation.compute(histograms);
    return static_cast<int>(histograms.size());
  }
  throw std::invalid_argument("PCL has no " + descriptor);
}
