// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/pose_error.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/geometry/symmetries.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <random>

namespace partpose {
namespace {

namespace fs = std::filesystem;
using Poses = std::vector<Eigen::Isometry3d>;

const fs::path golden_folder = fs::path(PARTPOSE_SOURCE_DIR) / "tests/bop_golden";
const Poses no_symmetry = {Eigen::Isometry3d::Identity()};

template <typename T>
T get(const Json& json, const char* key) {
  return from_json<T>(json.at(key));
}

Eigen::Matrix3d matrix(const Json& json) {
  const auto v = from_json<std::array<double, 9>>(json);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.data());
}

Eigen::Isometry3d pose(const Json& rotation, const Json& translation) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = matrix(rotation);
  out.translation() = Eigen::Vector3d(from_json<std::array<double, 3>>(translation).data());
  return out;
}

Symmetries symmetries_of(const Json& info) {
  Symmetries out;
  if (info.contains("symmetries_discrete"))
    for (const auto& values : get<std::vector<std::array<double, 16>>>(info, "symmetries_discrete"))
      out.discrete.emplace_back(
          Eigen::Matrix4d(Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data())));
  if (info.contains("symmetries_continuous"))
    for (const auto& item : info["symmetries_continuous"])
      out.continuous.push_back({Eigen::Vector3d(get<std::array<double, 3>>(item, "axis").data()),
                                Eigen::Vector3d(get<std::array<double, 3>>(item, "offset").data())});
  return out;
}

struct GoldenObject {
  TriangleMesh mesh;
  Poses symmetries;
  double diameter_mm;
};

std::map<int, GoldenObject> golden_objects(const Json& golden) {
  std::map<int, GoldenObject> out;
  for (const auto& [id, info] : golden["models_info"].items()) {
    GoldenObject object{{}, symmetry_transformations(symmetries_of(info)), get<double>(info, "diameter")};
    for (const auto& v : get<std::vector<std::array<float, 3>>>(golden["vertices_mm"], id.c_str()))
      object.mesh.vertices.emplace_back(v[0], v[1], v[2]);
    object.mesh.triangles = get<std::vector<std::array<int, 3>>>(golden["triangles"], id.c_str());
    out[std::stoi(id)] = object;
  }
  return out;
}

TEST(GoldenPoseErrors, AllAreReproduced) {
  const Json golden = read_json_file(golden_folder / "golden.json");
  const auto objects = golden_objects(golden);
  ASSERT_EQ(golden["cases"].size(), 101);
  for (const auto& item : golden["cases"]) {
    SCOPED_TRACE(item["name"].get<std::string>());
    const auto& [mesh, symmetries, diameter_mm] = objects.at(get<int>(item, "obj_id"));
    const auto& vertices = mesh.vertices;
    const auto estimate = pose(item["R_est"], item["t_est"]), truth = pose(item["R_gt"], item["t_gt"]);
    const Eigen::Matrix3d K = matrix(item["K"]);
    const Json& expected = item["expected"];
    const double angle = get<double>(expected, "re_deg"), pixels = mspd_px(vertices, estimate, truth, symmetries, K);
    EXPECT_NEAR(translation_error_mm(estimate, truth), get<double>(expected, "te_mm"), 1e-9);
    EXPECT_NEAR(rotation_error_deg(estimate, truth), angle, angle > 0.01 && angle < 179.99 ? 1e-9 : 4e-6);
    EXPECT_NEAR(add_mm(vertices, estimate, truth), get<double>(expected, "add_mm"), 1e-9);
    EXPECT_NEAR(adi_mm(vertices, estimate, truth), get<double>(expected, "adi_mm"), 1e-9);
    EXPECT_NEAR(mssd_mm(vertices, estimate, truth, symmetries), get<double>(expected, "mssd_mm"), 1e-9);
    EXPECT_NEAR(pixels, get<double>(expected, "mspd_px"), 1e-9);
    EXPECT_NEAR(pixels * bop_pixel_factor(get<int>(item, "image_width")), get<double>(expected, "mspd_px_640"), 1e-9);
    EXPECT_NEAR(projection_error_px(vertices, estimate, truth, K), get<double>(expected, "proj_px"), 1e-9);
    EXPECT_EQ(symmetries.size(), get<std::size_t>(expected, "n_symmetries"));
    EXPECT_EQ(spheres_overlap(estimate, truth, diameter_mm), get<bool>(expected, "spheres_overlap"));
    EXPECT_EQ(sphere_projections_overlap(estimate, truth, diameter_mm),
              get<bool>(expected, "sphere_projections_overlap"));
  }
}

TEST(GoldenPoseErrors, SymmetriesAreEnumeratedInTheSameOrder) {
  const Json golden = read_json_file(golden_folder / "golden.json");
  ASSERT_EQ(golden["symmetry_enumeration"].size(), 12);
  for (const auto& item : golden["symmetry_enumeration"]) {
    SCOPED_TRACE(item["name"].get<std::string>());
    const auto all =
        symmetry_transformations(symmetries_of(item["model_info"]), get<double>(item, "max_sym_disc_step"));
    ASSERT_EQ(all.size(), get<std::size_t>(item, "count"));
    for (const auto& expected : item["transformations"]) {
      const auto right = pose(expected["R"], expected["t"]);
      EXPECT_LT((all[get<std::size_t>(expected, "index")].matrix() - right.matrix()).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

TEST(GoldenPoseErrors, DiametersAreThoseOfTheMeshes) {
  for (const auto& [id, object] : golden_objects(read_json_file(golden_folder / "golden.json")))
    EXPECT_NEAR(diameter(object.mesh), object.diameter_mm, 1e-12);
}

/// A NumPy 1.0 file of little-endian float32, C order.
DepthImage read_npy(const std::string& name, int width, int height) {
  const std::string bytes = read_file(golden_folder / "vsd" / name);
  DepthImage depth(width, height);
  constexpr std::size_t begin = 128;
  if (bytes.size() != begin + depth.z_mm.size() * sizeof(float)) throw Error("{}: wrong size", name);
  std::memcpy(depth.z_mm.data(), bytes.data() + begin, bytes.size() - begin);
  return depth;
}

TEST(GoldenVsd, AllCasesAreMetExactly) {
  const Json golden = read_json_file(golden_folder / "vsd/vsd.json");
  ASSERT_EQ(golden["cases"].size(), 24);
  for (const auto& item : golden["cases"]) {
    SCOPED_TRACE(item["name"].get<std::string>());
    const Eigen::Matrix3d K = matrix(item["K"]);
    const auto image = [&](const char* key) {
      return distance_image(read_npy(get<std::string>(item, key), get<int>(item, "width"), get<int>(item, "height")),
                            K);
    };
    const auto taus = get<std::vector<double>>(item, "taus");
    const double diameter_mm = item["diameter_mm"].is_null() ? 1 : get<double>(item, "diameter_mm");
    const auto out =
        visible_surface_discrepancy(image("depth_test"), image("depth_est"), image("depth_gt"), diameter_mm, taus,
                                    {.delta_mm = get<double>(item, "delta_mm"),
                                     .normalized_by_diameter = get<bool>(item, "normalized_by_diameter")});
    const Json& expected = item["expected"];
    EXPECT_EQ(out.vsd, get<std::vector<double>>(expected, "vsd"));
    EXPECT_EQ(out.visible_gt, get<int>(expected["pixels"], "visible_gt"));
    EXPECT_EQ(out.visible_estimate, get<int>(expected["pixels"], "visible_est"));
    EXPECT_EQ(out.intersection_px, get<int>(expected["pixels"], "intersection"));
    EXPECT_EQ(out.union_px, get<int>(expected["pixels"], "union"));
    if (!item["R_est"].is_null() && !expected["sphere_projections_overlap"].is_null()) {
      EXPECT_EQ(
          sphere_projections_overlap(pose(item["R_est"], item["t_est"]), pose(item["R_gt"], item["t_gt"]), diameter_mm),
          get<bool>(expected, "sphere_projections_overlap"));
    }
  }
}

TEST(GoldenVsd, OurRenderingsAreThoseOfTheRayCaster) {
  const auto objects = golden_objects(read_json_file(golden_folder / "golden.json"));
  const Json golden = read_json_file(golden_folder / "vsd/vsd.json");
  int compared = 0;
  for (const auto& item : golden["cases"]) {
    if (item["obj_id"].is_null()) continue;
    SCOPED_TRACE(item["name"].get<std::string>());
    const Eigen::Matrix3d K = matrix(item["K"]);
    const Intrinsics camera{get<int>(item, "width"), get<int>(item, "height"), K(0, 0), K(1, 1), K(0, 2), K(1, 2)};
    const DepthImage right = read_npy(get<std::string>(item, "depth_gt"), camera.width, camera.height);
    const DepthImage ours =
        render(objects.at(get<int>(item, "obj_id")).mesh, pose(item["R_gt"], item["t_gt"]), camera).depth;
    int different = 0;
    for (std::size_t i = 0; i < right.z_mm.size(); ++i)
      different += (right.z_mm[i] > 0) != (ours.z_mm[i] > 0) || std::abs(right.z_mm[i] - ours.z_mm[i]) > 0.01f;
    EXPECT_LE(different, 2);  // pixel centres to within rounding on an edge
    ++compared;
  }
  EXPECT_GE(compared, 20);
}

// From here on: truth by analysis.

Eigen::Isometry3d moved(double x, double y, double z) { return Eigen::Isometry3d(Eigen::Translation3d(x, y, z)); }

const std::vector<Eigen::Vector3f> corners = [] {  // of a box 40 x 20 x 10 mm
  std::vector<Eigen::Vector3f> out;
  for (int i = 0; i < 8; ++i) out.emplace_back(i & 1 ? 20.f : -20.f, i & 2 ? 10.f : -10.f, i & 4 ? 5.f : -5.f);
  return out;
}();

TEST(PoseError, OfATranslationIsItsLength) {
  const auto truth = moved(1, 2, 600), estimate = moved(4, 6, 612);
  EXPECT_NEAR(add_mm(corners, estimate, truth), 13, 1e-12);
  EXPECT_NEAR(mssd_mm(corners, estimate, truth, no_symmetry), 13, 1e-12);
}

TEST(PoseError, OfATurnOfATwofoldAxisIsZeroWhereSymmetryCounts) {
  const Eigen::Isometry3d half_turn(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()));
  const auto truth = moved(10, 20, 500), estimate = truth * half_turn;
  const Eigen::Matrix3d K = Eigen::Vector3d(600, 600, 1).asDiagonal();
  const auto symmetries = symmetry_transformations({{half_turn}, {}});
  const double to_opposite = 2 * std::hypot(20, 10);
  EXPECT_NEAR(add_mm(corners, estimate, truth), to_opposite, 1e-9);
  EXPECT_NEAR(adi_mm(corners, estimate, truth), 0, 1e-9);
  EXPECT_NEAR(ad_mm(corners, estimate, truth, true), 0, 1e-9);
  EXPECT_NEAR(ad_mm(corners, estimate, truth, false), to_opposite, 1e-9);
  EXPECT_NEAR(mssd_mm(corners, estimate, truth, no_symmetry), to_opposite, 1e-9);
  EXPECT_NEAR(mssd_mm(corners, estimate, truth, symmetries), 0, 1e-9);
  EXPECT_NEAR(mspd_px(corners, estimate, truth, symmetries, K), 0, 1e-9);
  EXPECT_NEAR(mspd_px(corners, estimate, truth, no_symmetry, K), 600 * to_opposite / 495, 1e-9);  // of the near corners
}

TEST(PoseError, AdiIsThatOfBruteForceInEitherDirection) {
  std::mt19937 random(20261122);
  std::uniform_real_distribution<float> coordinate(-30, 30);
  std::vector<Eigen::Vector3f> vertices;
  for (int i = 0; i < 300; ++i)
    vertices.emplace_back(coordinate(random), coordinate(random), 0.3f * coordinate(random));
  for (int k = 0; k < 20; ++k) {
    const auto any_pose = [&] {
      Eigen::Isometry3d pose = moved(coordinate(random), coordinate(random), 500);
      return pose.rotate(Eigen::AngleAxisd(coordinate(random), Eigen::Vector3d(1, 2, coordinate(random)).normalized()));
    };
    const Eigen::Isometry3d estimate = any_pose(), truth = any_pose();
    double sum = 0;
    for (const auto& v : vertices) {
      double nearest = 1e300;
      for (const auto& w : vertices)
        nearest = std::min(nearest, (truth * v.cast<double>() - estimate * w.cast<double>()).norm());
      sum += nearest;
    }
    EXPECT_NEAR(adi_mm(vertices, estimate, truth), sum / 300, 1e-10);
  }
}

TEST(PoseError, WithoutVerticesOrSymmetriesIsAnError) {
  const auto pose = moved(0, 0, 500);
  EXPECT_THROW(add_mm({}, pose, pose), Error);
  EXPECT_THROW(adi_mm({}, pose, pose), Error);
  EXPECT_THROW(mssd_mm({}, pose, pose, no_symmetry), Error);
  EXPECT_THROW(mssd_mm(corners, pose, pose, {}), Error);
  EXPECT_THROW(mspd_px(corners, pose, pose, {}, Eigen::Matrix3d::Identity()), Error);
}

TEST(PoseError, OfAPoseThatIsNoNumberIsInfinite) {
  const auto truth = moved(0, 0, 500), estimate = moved(std::numeric_limits<double>::quiet_NaN(), 0, 500);
  EXPECT_EQ(mssd_mm(corners, estimate, truth, no_symmetry), std::numeric_limits<double>::infinity());
}

TEST(Vsd, OfAPlaneMovedAlongTheAxis) {
  const Eigen::Matrix3d K = Eigen::Vector3d(1e12, 1e12, 1).asDiagonal();  // distance is depth
  const auto plane = [&](float z_mm) {
    DepthImage depth(4, 3);
    std::fill(depth.z_mm.begin(), depth.z_mm.end(), z_mm);
    return distance_image(depth, K);
  };
  const std::vector<double> taus = {0.05, 0.1, 0.2};
  // 10 mm before the truth, of a part of 100 mm: apart at tau 0.05 and, by equality, at 0.1.
  EXPECT_EQ(visible_surface_discrepancy(plane(500), plane(490), plane(500), 100, taus).vsd,
            (std::vector<double>{1, 1, 0}));
  // Hidden in the true pose and in the estimated one: nothing is visible.
  EXPECT_EQ(visible_surface_discrepancy(plane(400), plane(490), plane(500), 100, taus).vsd,
            (std::vector<double>{1, 1, 1}));
  EXPECT_THROW(visible_surface_discrepancy(plane(500), plane(490), {}, 100, taus), Error);
  EXPECT_THROW(visible_surface_discrepancy(plane(500), plane(490), plane(500), 0, taus), Error);
}

TEST(Thresholds, AreThoseOfNumpy) {
  // numpy.arange takes i steps from the start: 0.05 + 2 * 0.05 is not 0.15. volatile: no contraction to one rounding.
  for (int i = 0; i < 10; ++i) {
    const volatile double steps = i * 0.05;
    EXPECT_EQ(bop_fractions()[i], 0.05 + steps);
    EXPECT_EQ(bop_pixels()[i], 5 + 5 * i);
  }
  EXPECT_NE(bop_fractions()[2], 0.15);
}

TEST(SymmetryTransformations, RejectWhatIsNoAxisOrStep) {
  EXPECT_THROW(symmetry_transformations({{}, {{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}}}), Error);
  EXPECT_THROW(symmetry_transformations({}, 0), Error);
  EXPECT_THROW(symmetry_transformations({}, std::numeric_limits<double>::quiet_NaN()), Error);
  EXPECT_EQ(symmetry_transformations({}).size(), 1);
}

}  // namespace
}  // namespace partpose
