// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/camera/virtual_depth_camera.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/random.hpp"
#include "partpose/core/text.hpp"
#include "partpose/geometry/normals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace partpose {

void NoiseOptions::check() const {
  static const std::vector<std::string> models = {"none", "gaussian", "gaussianray", "stereo"};
  if (std::find(models.begin(), models.end(), model) == models.end())
    throw Error("model \"{}\": must be \"none\", \"gaussian\", \"gaussianray\" or \"stereo\"; did you mean \"{}\"?",
                model, nearest_word(model, models));
  if (!(standard_deviation_mm >= 0) || !std::isfinite(standard_deviation_mm))
    throw Error("standard_deviation_mm {}: must be 0 or more", standard_deviation_mm);
  if (stereo) stereo->check();
}

void VirtualDepthCameraOptions::check() const {
  noise.check();
  if (normals != "mesh" && normals != "estimated")
    throw Error("normals \"{}\": must be \"mesh\" or \"estimated\"", normals);
  if (!(normal_estimation_radius_mm > 0))
    throw Error("normal_estimation_radius_mm {}: must be positive", normal_estimation_radius_mm);
  for (const int side : resolution_px)
    if (side < 1 || side > 8192) throw Error("resolution_px {}: must be 1 to 8192 px a side", side);
  intrinsics();
}

Intrinsics VirtualDepthCameraOptions::intrinsics() const {
  return Intrinsics::from_field_of_view(resolution_px[0], resolution_px[1], field_of_view_deg[0], field_of_view_deg[1]);
}

Eigen::Isometry3d look_at(const Eigen::Vector3d& position_mm, const Eigen::Vector3d& target_mm) {
  const Eigen::Vector3d forward = (target_mm - position_mm).normalized();
  Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ());
  right = right.norm() > 1e-9 ? right.normalized() : Eigen::Vector3d::UnitX();
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
  base_from_camera.linear() << right, forward.cross(right), forward;
  base_from_camera.translation() = position_mm;
  return base_from_camera;
}

namespace {

void add_noise(PointCloud& cloud, const std::vector<std::size_t>& pixel, const NoiseOptions& noise,
               Random frame_random) {
  const std::uint64_t frame_seed = frame_random.next();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    Random random(frame_seed, pixel[i]);
    const auto [a, b] = random.normal_pair();
    Eigen::Vector3d offset;
    if (noise.model == "gaussianray") {
      offset = cloud.points[i].cast<double>().normalized() * a;
    } else {
      offset = {a, b, random.normal_pair().first};
    }
    cloud.points[i] += (noise.standard_deviation_mm * offset).cast<float>();
  }
}

PointCloud organize(const PointCloud& cloud, const std::vector<std::size_t>& pixel, const Intrinsics& camera) {
  const Eigen::Vector3f missing = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  PointCloud out;
  const std::size_t count = static_cast<std::size_t>(camera.width) * camera.height;
  out.points.assign(count, missing);
  out.normals.assign(count, missing);
  out.curvatures.assign(count, missing.x());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    out.points[pixel[i]] = cloud.points[i];
    out.normals[pixel[i]] = cloud.normals[i];
    out.curvatures[pixel[i]] = cloud.curvatures[i];
  }
  out.width = camera.width;
  out.height = camera.height;
  return out;
}

}  // namespace

PointCloud capture(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                   const VirtualDepthCameraOptions& options, bool organized, std::uint64_t frame) {
  const Intrinsics camera = options.intrinsics();
  const Rendering rendering = render(mesh, camera_from_model, camera);

  std::optional<StereoCapture> measured;
  if (options.noise.model == "stereo") {
    const auto sensor = options.noise.stereo.value_or(StereoSensorOptions{});
    const DepthImage right = sensor.occlusion_shadow
                                 ? render(mesh, right_from_left(sensor) * camera_from_model, camera).depth
                                 : DepthImage{};
    measured = stereo_capture(rendering.depth, right, camera, sensor, Random(options.noise_seed, frame).next());
  }

  PointCloud cloud;
  std::vector<std::size_t> pixel;
  const Eigen::Matrix3f rotation = camera_from_model.linear().cast<float>();
  for (std::size_t p = 0; p < rendering.triangle.size(); ++p) {
    const int seen = measured ? measured->surface_pixel[p] : static_cast<int>(p);
    if (seen < 0 || rendering.triangle[seen] < 0) continue;
    const auto point = camera.unproject(static_cast<double>(p % camera.width), static_cast<double>(p / camera.width),
                                        measured ? measured->depth.z_mm[p] : rendering.depth.z_mm[p]);
    const Eigen::Vector3f normal = rotation * mesh.face_normal(rendering.triangle[seen]);
    cloud.points.push_back(point);
    // What the camera sees faces the camera, even where the mesh's winding says otherwise.
    cloud.normals.push_back(normal.dot(point) > 0 ? Eigen::Vector3f(-normal) : normal);
    pixel.push_back(p);
  }
  cloud.curvatures.assign(cloud.size(), 0.0f);
  cloud.width = static_cast<int>(cloud.size());
  cloud.height = 1;
  if (options.noise.model.starts_with("gaussian") && options.noise.standard_deviation_mm > 0)
    add_noise(cloud, pixel, options.noise, Random(options.noise_seed, frame));
  if (options.normals == "estimated") estimate_normals(cloud, options.normal_estimation_radius_mm);
  return organized ? organize(cloud, pixel, camera) : cloud;
}

}  // namespace partpose
