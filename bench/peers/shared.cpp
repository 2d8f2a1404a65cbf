// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared.h"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/descriptor/good.hpp"
#include "partpose/geometry/plane.hpp"
#include "partpose/io/stl.hpp"
#include "partpose/preprocess/preprocess.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iostream>
#include <map>
#include <random>

namespace {

using namespace partpose;

/// The peers have one thread each.
const ThreadLimit one_thread(1);

enum class Label : unsigned char { nothing, object, background };

struct Frame {
  Intrinsics camera;
  DepthImage depth;
  std::vector<Label> label;
  float tolerance_mm = 4;
};

constexpr int stride = 2;    ///< px of the camera for one of the verification
constexpr int margin = 20;   ///< px of the verification around the object

Intrinsics intrinsics(const PeersCamera& c) { return {c.width, c.height, c.fx, c.fy, c.cx, c.cy}; }

DepthImage depth_image(const PeersCamera& camera, const float* depth_mm) {
  DepthImage depth(camera.width, camera.height);
  std::memcpy(depth.z_mm.data(), depth_mm, depth.z_mm.size() * sizeof(float));
  return depth;
}

/// A pixel is the object's when one of its points falls into it, or beside it, at about its depth.
void label_object(Frame& frame, const float* xyz, int count) {
  constexpr float near_mm = 6;
  const int width = frame.camera.width, height = frame.camera.height;
  for (std::size_t i = 0; i < frame.label.size(); ++i)
    frame.label[i] = frame.depth.z_mm[i] <= 0 ? Label::nothing : xyz ? Label::background : Label::object;
  for (int i = 0; i < count; ++i, xyz += 3) {
    const Eigen::Vector2d px = frame.camera.project({xyz[0], xyz[1], xyz[2]});
    const int cu = static_cast<int>(std::lround(px.x())), cv = static_cast<int>(std::lround(px.y()));
    for (int v = std::max(cv - 1, 0); v <= std::min(cv + 1, height - 1); ++v)
      for (int u = std::max(cu - 1, 0); u <= std::min(cu + 1, width - 1); ++u)
        if (const float z = frame.depth.at(u, v); z > 0 && std::abs(z - xyz[2]) < near_mm)
          frame.label[static_cast<std::size_t>(v) * width + u] = Label::object;
  }
}

/// Of a difference in depth, 0 to 1.
float cost_of(float difference_mm, float tolerance_mm) {
  const float x = difference_mm / tolerance_mm;
  return std::min(x * x, 1.0f);
}

/// The smallest difference to any of the 3 x 3 pixels around that `counts`; infinite when none does.
template <typename Counts>
float nearest_difference(const DepthImage& image, int u, int v, float z, const Counts& counts) {
  float best = std::numeric_limits<float>::infinity();
  for (int y = std::max(v - 1, 0); y <= std::min(v + 1, image.height - 1); ++y)
    for (int x = std::max(u - 1, 0); x <= std::min(u + 1, image.width - 1); ++x)
      if (counts(x, y)) best = std::min(best, std::abs(image.at(x, y) - z));
  return best;
}

double two_sided_score(const TriangleMesh& mesh, const Frame& frame, const Eigen::Isometry3d& camera_from_model) {
  const DepthImage part = render(mesh, camera_from_model, frame.camera).depth;
  const auto label = [&](int u, int v) { return frame.label[static_cast<std::size_t>(v) * frame.camera.width + u]; };
  const auto is_object = [&](int u, int v) { return label(u, v) == Label::object; };
  const auto is_part = [&](int u, int v) { return part.at(u, v) > 0; };
  const float tolerance = frame.tolerance_mm;
  // A part behind what is seen may be hidden, one where nothing was measured may be there; before it, it cannot be.
  constexpr float hidden = 0.2f, unmeasured = 0.6f;
  double cost = 0;
  int pixels = 0;
  for (int v = 0; v < part.height; ++v) {
    for (int u = 0; u < part.width; ++u) {
      const float rendered = part.at(u, v), measured = frame.depth.at(u, v);
      if (rendered > 0) {
        ++pixels;
        float c = cost_of(nearest_difference(frame.depth, u, v, rendered, is_object), tolerance);
        if (label(u, v) == Label::background) c = std::min(c, rendered > measured - tolerance ? hidden : 1.0f);
        if (label(u, v) == Label::nothing) c = std::min(c, unmeasured);
        cost += c;
      }
      if (is_object(u, v)) {
        ++pixels;
        cost += cost_of(nearest_difference(part, u, v, measured, is_part), tolerance);
      }
    }
  }
  return pixels ? 1 - cost / pixels : 0;
}

/// The clusters that stand on the plane: on the camera's side, higher than what is left of a table that is not flat in
/// the frame, and not much smaller than the largest. As pcl.cpp does it with PCL.
PointCloud standing_clusters(const PointCloud& all, const Plane& plane, double least_height_mm, float cell_mm) {
  const double side = plane.offset_mm < 0 ? -1 : 1;  // the camera is at the origin
  std::vector<int> above;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (side * plane.signed_distance_mm(all.points[i]) > 0) above.push_back(static_cast<int>(i));
  const PointCloud cloud = select(all, above);
  std::map<std::array<int, 3>, int> cell_of;
  std::vector<int> cell(cloud.size());
  std::vector<std::array<int, 3>> keys;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f p = cloud.points[i] / cell_mm;
    const std::array<int, 3> key = {static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())),
                                    static_cast<int>(std::floor(p.z()))};
    const auto [it, is_new] = cell_of.emplace(key, static_cast<int>(keys.size()));
    if (is_new) keys.push_back(key);
    cell[i] = it->second;
  }
  std::vector<int> cluster(keys.size(), -1), stack;
  int clusters = 0;
  for (std::size_t seed = 0; seed < keys.size(); ++seed) {
    if (cluster[seed] >= 0) continue;
    stack = {static_cast<int>(seed)};
    cluster[seed] = clusters;
    while (!stack.empty()) {
      const auto key = keys[stack.back()];
      stack.pop_back();
      for (int n = 0; n < 27; ++n) {
        const auto it = cell_of.find({key[0] + n % 3 - 1, key[1] + n / 3 % 3 - 1, key[2] + n / 9 - 1});
        if (it == cell_of.end() || cluster[it->second] >= 0) continue;
        cluster[it->second] = clusters;
        stack.push_back(it->second);
      }
    }
    ++clusters;
  }
  std::vector<int> size(clusters, 0), kept;
  std::vector<bool> stands(clusters, false);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ++size[cluster[cell[i]]];
    if (side * plane.signed_distance_mm(cloud.points[i]) > least_height_mm) stands[cluster[cell[i]]] = true;
  }
  int largest = 0;
  for (int c = 0; c < clusters; ++c)
    if (stands[c]) largest = std::max(largest, size[c]);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (const int c = cluster[cell[i]]; stands[c] && size[c] * 10 >= largest) kept.push_back(static_cast<int>(i));
  return select(cloud, kept);
}

int write_points(const PointCloud& cloud, int most, float* out) {
  const int count = std::min(static_cast<int>(cloud.size()), most);
  for (int i = 0; i < count; ++i, out += 6) {
    std::memcpy(out, cloud.points[i].data(), 3 * sizeof(float));
    std::memcpy(out + 3, cloud.normals[i].data(), 3 * sizeof(float));
  }
  return count;
}

}  // namespace

void* peers_load_part(const char* stl) {
  try {
    return new TriangleMesh(read_stl(stl));
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return nullptr;
  }
}

void peers_sample_surface(const void* part, int count, float* out) {
  const auto& mesh = *static_cast<const TriangleMesh*>(part);
  std::vector<double> area_to(mesh.triangles.size());
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    area += (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm();
    area_to[t] = area;
  }
  std::mt19937 random(1);
  const auto uniform = [&] { return random() / 4294967296.0; };
  for (int i = 0; i < count; ++i, out += 6) {
    const auto t = std::min<std::size_t>(
        std::upper_bound(area_to.begin(), area_to.end(), uniform() * area) - area_to.begin(), area_to.size() - 1);
    const auto& [a, b, c] = mesh.triangles[t];
    float x = static_cast<float>(uniform()), y = static_cast<float>(uniform());
    if (x + y > 1) x = 1 - x, y = 1 - y;
    const Eigen::Vector3f p = mesh.vertices[a] + x * (mesh.vertices[b] - mesh.vertices[a]) +
                              y * (mesh.vertices[c] - mesh.vertices[a]);
    const Eigen::Vector3f n = mesh.face_normal(t);
    std::memcpy(out, p.data(), 3 * sizeof(float));
    std::memcpy(out + 3, n.data(), 3 * sizeof(float));
  }
}

void* peers_open_frame(const PeersCamera* camera, const float* depth_mm, const float* object_xyz, int count,
                       double tolerance_mm) {
  const DepthImage full = depth_image(*camera, depth_mm);
  const Intrinsics k = intrinsics(*camera);
  Eigen::AlignedBox2i box;
  if (object_xyz) {
    for (int i = 0; i < count; ++i) {
      const float* p = object_xyz + 3 * i;
      box.extend(k.project({p[0], p[1], p[2]}).array().round().matrix().cast<int>());
    }
  } else {
    for (int v = 0; v < full.height; ++v)
      for (int u = 0; u < full.width; ++u)
        if (full.at(u, v) > 0) box.extend(Eigen::Vector2i(u, v));
  }
  auto frame = new Frame;
  frame->tolerance_mm = static_cast<float>(tolerance_mm);
  if (box.isEmpty()) box.extend(Eigen::Vector2i(0, 0));
  const Eigen::Vector2i from = (box.min() / stride - Eigen::Vector2i(margin, margin)).cwiseMax(0) * stride;
  const Eigen::Vector2i to = (box.max() + Eigen::Vector2i(margin, margin) * stride)
                                 .cwiseMin(Eigen::Vector2i(full.width - 1, full.height - 1));
  frame->camera = {(to.x() - from.x()) / stride + 1,    (to.y() - from.y()) / stride + 1,
                   k.fx / stride,                       k.fy / stride,
                   (k.cx - from.x()) / stride,          (k.cy - from.y()) / stride};
  frame->depth = DepthImage(frame->camera.width, frame->camera.height);
  for (int v = 0; v < frame->camera.height; ++v)
    for (int u = 0; u < frame->camera.width; ++u)
      frame->depth.at(u, v) = full.at(from.x() + u * stride, from.y() + v * stride);
  frame->label.resize(frame->depth.z_mm.size());
  label_object(*frame, object_xyz, object_xyz ? count : 0);
  return frame;
}

void peers_close_frame(void* frame) { delete static_cast<Frame*>(frame); }

double peers_two_sided(const void* part, const void* frame, const double* pose) {
  Eigen::Isometry3d camera_from_model;
  camera_from_model.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(pose);
  return two_sided_score(*static_cast<const TriangleMesh*>(part), *static_cast<const Frame*>(frame), camera_from_model);
}

int peers_good(const float* xyz, int count, int bins, double threshold_mm, int ambiguous, int most, float* histograms,
               double* frames) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) cloud.points.emplace_back(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
  GoodOptions options;
  options.num_of_bins = bins;
  options.threshold = static_cast<float>(threshold_mm);
  options.ambiguous_frames = ambiguous != 0;
  int n = 0;
  for (const auto& description : good(cloud, options)) {
    if (n == most) break;
    std::copy(description.histogram.begin(), description.histogram.end(), histograms + n * 3 * bins * bins);
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(frames + 16 * n) =
        description.camera_from_reference->matrix();
    ++n;
  }
  return n;
}

int peers_object_cloud(const PeersCamera* camera, const float* depth_mm, double plane_mm, double voxel_mm,
                       double radius_mm, int most, float* points_and_normals) {
  PreprocessOptions options;
  options.voxel_size = static_cast<float>(voxel_mm);
  if (plane_mm > 0) {
    options.xyz_filter_flag = true;
    options.xyz_limits = {-300, 300, -300, 300, 150, 1000};
    options.plane_removal_flag = true;
    options.plane_removal_distance_threshold = static_cast<float>(plane_mm);
    options.statistical_outlier_removal_flag = true;
    options.statistical_outlier_removal_num_of_k_nearest_neighbors = 20;
    options.statistical_outlier_removal_std_deviation_multiplier = 3;
  }
  auto [cloud, plane] = preprocess(to_point_cloud(depth_image(*camera, depth_mm), intrinsics(*camera)), options);
  if (plane) cloud = standing_clusters(cloud, *plane, 10, static_cast<float>(std::max(5.0, 1.5 * voxel_mm)));
  NormalEstimationOptions normals;
  normals.search_radius = static_cast<float>(radius_mm);
  return write_points(with_normals(std::move(cloud), normals), most, points_and_normals);
}
