// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/synthesis/synthetic_scene.hpp"

#include "partpose/camera/rasterizer.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"

#include "tests/shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace partpose {
namespace {

std::vector<ScenePart> catalogue() {
  return {{"bracket", shapes::l_bracket()},
          {"box", shapes::box(Eigen::Vector3f(60, 40, 20))},
          {"shaft", shapes::cylinder(12, 90, 32)}};
}

std::vector<ScenePart> unknown() { return {{"ball", shapes::sphere(18, 24, 12)}}; }

SceneOptions busy() {
  SceneOptions options;
  options.camera.intrinsics = {320, 240, 307, 308, 159.5, 119.5};
  options.parts = {1, 3};
  options.unknown_parts = {0, 1};
  options.clutter = {0, 3};
  options.clutter_size_mm = {15, 60};
  options.least_visible_fraction = 0.25;
  return options;
}

bool is_part(const ScenePiece& piece) {
  return piece.kind == ScenePiece::Kind::part || piece.kind == ScenePiece::Kind::unknown_part;
}

bool is_ground(const ScenePiece& piece) {
  return piece.kind == ScenePiece::Kind::table || piece.kind == ScenePiece::Kind::floor;
}

Eigen::Isometry3d table_from_model(const SyntheticScene& scene, const ScenePiece& piece) {
  return scene.camera_from_table.inverse() * piece.camera_from_model;
}

double lowest(const TriangleMesh& mesh, const Eigen::Isometry3d& table_from_model) {
  double z = 1e300;
  for (const auto& v : mesh.vertices) z = std::min(z, (table_from_model * v.cast<double>()).z());
  return z;
}

bool same(const SyntheticScene& a, const SyntheticScene& b) {
  if (a.pieces.size() != b.pieces.size()) return false;
  for (std::size_t i = 0; i < a.pieces.size(); ++i)
    if (a.pieces[i].camera_from_model.matrix() != b.pieces[i].camera_from_model.matrix() ||
        a.pieces[i].visible_px != b.pieces[i].visible_px || a.pieces[i].name != b.pieces[i].name)
      return false;
  return shapes::same_bits(a.depth.z_mm, b.depth.z_mm) && a.piece_at == b.piece_at;
}

TEST(SyntheticScene, EverythingLiesOnTheTableAndNothingInAnother) {
  const SceneGenerator generator(catalogue(), unknown(), busy());
  // From 100 m above, a pixel is a millimetre and the view is all but parallel: what one covers no other may.
  const Intrinsics above{600, 600, 1e5, 1e5, 299.5, 299.5};
  Eigen::Isometry3d above_from_table(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  above_from_table.pretranslate(Eigen::Vector3d(0, 0, 1e5));
  for (int frame = 0; frame < 30; ++frame) {
    const auto scene = generator.generate(frame);
    std::vector<int> covered(600 * 600, 0);
    int pieces = 0;
    for (const auto& piece : scene.pieces) {
      if (is_ground(piece)) continue;
      ++pieces;
      const auto pose = table_from_model(scene, piece);
      EXPECT_NEAR(lowest(*piece.mesh, pose), 0, 1e-3) << piece.name;
      const auto shadow = render(*piece.mesh, above_from_table * pose, above);
      for (std::size_t p = 0; p < covered.size(); ++p) covered[p] += shadow.triangle[p] >= 0;
    }
    EXPECT_GE(pieces, 1);
    EXPECT_EQ(*std::max_element(covered.begin(), covered.end()), 1) << "frame " << frame;
  }
}

/// Corners and points 10 mm apart on the edges and faces, in the table's frame.
std::vector<Eigen::Vector3d> surface_samples(const TriangleMesh& mesh, const Eigen::Isometry3d& table_from_model) {
  std::vector<Eigen::Vector3d> out;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>(), ab = mesh.vertices[t[1]].cast<double>() - a,
                          ac = mesh.vertices[t[2]].cast<double>() - a;
    const int n = static_cast<int>(std::ceil(std::max(ab.norm(), ac.norm()) / 10));
    for (int i = 0; i <= n; ++i)
      for (int k = 0; k <= n - i; ++k) out.emplace_back(table_from_model * (a + ab * i / n + ac * k / n));
  }
  return out;
}

/// How deep a corner of one is in the other; of convex parts.
double overlap_mm(const ScenePiece& a, const ScenePiece& b) {
  const auto depth_in = [&](const ScenePiece& of, const ScenePiece& in) {
    double deepest = -1e300;
    const Eigen::Isometry3d in_from_of = in.camera_from_model.inverse() * of.camera_from_model;
    for (const auto& v : of.mesh->vertices) {
      const Eigen::Vector3d p = in_from_of * v.cast<double>();
      double depth = 1e300;
      for (const auto& t : in.mesh->triangles) {
        const Eigen::Vector3d q = in.mesh->vertices[t[0]].cast<double>();
        const Eigen::Vector3d normal =
            (in.mesh->vertices[t[1]].cast<double>() - q).cross(in.mesh->vertices[t[2]].cast<double>() - q).normalized();
        depth = std::min(depth, -normal.dot(p - q));
      }
      deepest = std::max(deepest, depth);
    }
    return deepest;
  };
  return std::max(depth_in(a, b), depth_in(b, a));
}

TEST(SyntheticScene, TouchingThingsMeetWithoutInterpenetrating) {
  SceneOptions options = busy();
  options.parts = {4, 6};
  options.unknown_parts = options.clutter = {0, 0};
  options.contact = "touching";
  options.least_visible_fraction = 0;
  const SceneGenerator generator(
      {{"box", shapes::box(Eigen::Vector3f(60, 40, 20))}, {"shaft", shapes::cylinder(12, 90, 32)}}, {}, options);
  int hidden = 0;
  for (int frame = 0; frame < 3; ++frame) {
    const auto scene = generator.generate(frame);
    std::vector<ScenePiece> parts;
    for (const auto& piece : scene.pieces)
      if (is_part(piece)) parts.push_back(piece);
    ASSERT_GE(parts.size(), 4u);
    for (std::size_t i = 1; i < parts.size(); ++i) {
      const auto& part = parts[i];
      EXPECT_NEAR(lowest(*part.mesh, table_from_model(scene, part)), 0, 1e-3);
      double nearest = 1e300;  // over those there before it
      for (std::size_t k = 0; k < i; ++k) {
        EXPECT_LT(overlap_mm(part, parts[k]), 0.3) << frame;
        const auto ours = surface_samples(*part.mesh, table_from_model(scene, part));
        const auto others = surface_samples(*parts[k].mesh, table_from_model(scene, parts[k]));
        for (const auto& a : ours)
          for (const auto& b : others) nearest = std::min(nearest, (a - b).norm());
      }
      EXPECT_LT(nearest, 11) << frame;  // of samples 10 mm apart
      hidden += part.visible_fraction() < 0.95;
    }
  }
  EXPECT_GT(hidden, 0);
  options.contact = "glued";
  EXPECT_THROW(options.check(), Error);
}

TEST(SyntheticScene, DepthAndVisibilityAreThoseOfThePiecesAtTheirPoses) {
  const SceneGenerator generator(catalogue(), unknown(), busy());
  int hidden_in_part = 0;
  for (int frame = 0; frame < 12; ++frame) {
    const auto scene = generator.generate(frame);
    const Intrinsics& camera = scene.intrinsics;
    std::vector<Rendering> alone;
    for (const auto& piece : scene.pieces) alone.push_back(render(*piece.mesh, piece.camera_from_model, camera));
    std::vector<int> visible(scene.pieces.size(), 0);
    int different = 0;
    for (std::size_t p = 0; p < scene.depth.z_mm.size(); ++p) {
      int nearest = -1;
      for (std::size_t i = 0; i < alone.size(); ++i) {
        const float z = alone[i].depth.z_mm[p];
        if (z > 0 && (nearest < 0 || z < alone[nearest].depth.z_mm[p])) nearest = static_cast<int>(i);
      }
      if (nearest >= 0) ++visible[nearest];
      if (nearest >= 0 && alone[nearest].depth.z_mm[p] > scene.farthest_mm) nearest = -1;
      different += nearest != scene.piece_at[p];  // where a part touches the table, rounding decides
      const float z = nearest < 0 ? 0 : alone[nearest].depth.z_mm[p];
      EXPECT_NEAR(scene.depth.z_mm[p], z, 0.02) << frame;
    }
    EXPECT_LE(different, 3);
    // Silhouettes on a canvas of three images by three.
    Intrinsics wide = camera;
    wide.width *= 3;
    wide.height *= 3;
    wide.cx += camera.width;
    wide.cy += camera.height;
    for (std::size_t i = 0; i < scene.pieces.size(); ++i) {
      const auto& piece = scene.pieces[i];
      if (!is_part(piece)) continue;
      const auto silhouette = render(*piece.mesh, piece.camera_from_model, wide);
      const auto all =
          std::count_if(silhouette.triangle.begin(), silhouette.triangle.end(), [](int t) { return t >= 0; });
      EXPECT_NEAR(piece.silhouette_px, all, 2);
      EXPECT_NEAR(piece.visible_px, visible[i], 3);
      EXPECT_GE(piece.visible_fraction(), 0.25);
      hidden_in_part += piece.visible_fraction() < 0.97;
    }
  }
  EXPECT_GT(hidden_in_part, 0);  // or this tested little
}

TEST(SyntheticScene, IsTheSameInAnyOrderAndForAnyNumberOfThreads) {
  const SceneGenerator generator(catalogue(), unknown(), busy());
  std::vector<SyntheticScene> forwards(8), backwards(8);
  {
    const ThreadLimit one(1);
    for (int i = 0; i < 8; ++i) forwards[i] = generator.generate(i);
  }
  const SceneGenerator another(catalogue(), unknown(), busy());
  parallel_for(8, [&](std::size_t i) { backwards[7 - i] = another.generate(7 - i); });
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(same(forwards[i], backwards[i])) << i;
  EXPECT_FALSE(same(forwards[0], forwards[3]));
  auto options = busy();
  options.seed = 2;
  EXPECT_FALSE(same(forwards[0], SceneGenerator(catalogue(), unknown(), options).generate(0)));
}

TEST(SyntheticScene, ThePartIsHiddenByTheShareAskedFor) {
  for (const auto& elevation : {std::array{25.0, 45.0}, std::array{80.0, 90.0}}) {
    auto options = busy();
    options.parts = {1, 2};
    options.clutter = {0, 1};
    options.camera.elevation_deg = elevation;
    options.hidden_fraction = {0.35, 0.45};
    const SceneGenerator generator(catalogue(), {}, [&] {
      auto without_unknown = options;
      without_unknown.unknown_parts = {0, 0};
      return without_unknown;
    }());
    int plates = 0, standing = 0;
    for (int frame = 0; frame < 12; ++frame) {
      const auto scene = generator.generate(frame);
      EXPECT_EQ(scene.pieces[0].index, frame % 3);
      EXPECT_GE(scene.pieces[0].visible_fraction(), 0.55);
      EXPECT_LE(scene.pieces[0].visible_fraction(), 0.65);
      for (const auto& piece : scene.pieces) {
        if (piece.kind != ScenePiece::Kind::occluder) continue;
        ++plates;
        const double low = lowest(*piece.mesh, table_from_model(scene, piece));
        standing += std::abs(low) < 1e-3;
        if (std::abs(low) < 1e-3) continue;
        for (const auto& other : scene.pieces)  // held over everything
          if (&other != &piece && !is_ground(other)) {
            for (const auto& v : other.mesh->vertices)
              EXPECT_GT(low, (table_from_model(scene, other) * v.cast<double>()).z());
          }
      }
    }
    EXPECT_GE(plates, 8);
    EXPECT_EQ(standing == 0, elevation[0] == 80);
  }
}

TEST(SyntheticScene, PartsComeToRestAsOftenAsTheyShould) {
  SceneOptions options;
  options.camera.intrinsics = {80, 60, 77, 77, 39.5, 29.5};
  options.camera.elevation_deg = {60, 90};
  for (const bool natural : {true, false}) {
    options.poses = natural ? "natural" : "uniform";
    const SceneGenerator generator({{"box", shapes::box(Eigen::Vector3f(60, 40, 20))}}, {}, options);
    constexpr int frames = 600;
    std::vector<int> count(6, 0);
    for (int frame = 0; frame < frames; ++frame) ++count.at(generator.generate(frame).pieces[0].resting_pose);
    for (int i = 0; i < 6; ++i) {
      const double p = natural ? generator.resting_poses(0).poses[i].probability : 1 / 6.0;
      EXPECT_NEAR(count[i], frames * p, 4 * std::sqrt(frames * p * (1 - p))) << i;
    }
  }
}

TEST(SyntheticScene, TheCameraStandsWhereItIsTold) {
  auto options = busy();
  options.camera.distance_mm = {600, 650};
  options.camera.elevation_deg = {40, 45};
  options.camera.aim_radius_mm = 0;
  options.camera.roll_deg = {0, 0};
  const SceneGenerator generator(catalogue(), unknown(), options);
  for (int frame = 0; frame < 10; ++frame) {
    const auto scene = generator.generate(frame);
    const Eigen::Isometry3d table_from_camera = scene.camera_from_table.inverse();
    const Eigen::Vector3d at = table_from_camera.translation();
    EXPECT_GE(at.norm(), 600);
    EXPECT_LE(at.norm(), 650);
    EXPECT_GE(degrees(std::asin(at.z() / at.norm())), 40);
    EXPECT_LE(degrees(std::asin(at.z() / at.norm())), 45);
    EXPECT_LT(shapes::angle_deg(table_from_camera.linear().col(2), -at), 1e-6);  // looks at the middle
    EXPECT_NEAR(table_from_camera.linear()(2, 0), 0, 1e-9);                      // x is level
    EXPECT_LT(table_from_camera.linear()(2, 1), 0);                              // y points down
  }
}

TEST(SyntheticScene, GaussianRaySensorAddsItsDeviationAlongTheRay) {
  const SceneGenerator generator(catalogue(), unknown(), busy());
  const auto scene = generator.generate(1);
  const auto sensor = gaussian_ray_sensor(2);
  const DepthImage measured = sensor(scene, 5);
  EXPECT_TRUE(shapes::same_bits(measured.z_mm, sensor(scene, 5).z_mm));
  EXPECT_FALSE(shapes::same_bits(measured.z_mm, sensor(scene, 6).z_mm));
  double sum = 0, squares = 0, count = 0;
  for (int v = 0; v < measured.height; ++v)
    for (int u = 0; u < measured.width; ++u) {
      if (scene.depth.at(u, v) == 0 || measured.at(u, v) == 0) continue;
      const double along = scene.intrinsics.unproject(u, v, measured.at(u, v)).cast<double>().norm() -
                           scene.intrinsics.unproject(u, v, scene.depth.at(u, v)).cast<double>().norm();
      sum += along;
      squares += along * along;
      ++count;
    }
  EXPECT_NEAR(sum / count, 0, 5 * 2 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), 2, 0.03);
  EXPECT_TRUE(shapes::same_bits(ideal_sensor()(scene, 5).z_mm, scene.depth.z_mm));
}

TEST(SyntheticScene, StereoSensorSeesShadowsBesideTheParts) {
  auto options = busy();
  options.camera.intrinsics = {640, 480, 615, 615, 319.5, 239.5};
  options.camera.elevation_deg = {60, 80};
  options.camera.farthest_mm = 2000;
  options.floor_below_mm = 0;
  options.parts = {2, 2};
  options.table_size_mm = {3000, 3000};
  const SceneGenerator generator(catalogue(), unknown(), options);
  const auto scene = generator.generate(2);
  StereoSensorOptions none;  // geometry alone
  none.disparity_noise_px = none.subpixel_wave_px = none.static_pattern_percent = 0;
  none.smoothing_px = 0;
  none.fattening_px = none.fattening_jitter_px = 0;
  none.mixed_pixel_probability = none.edge_loss_probability = none.hole_share = 0;
  none.disparity_step_px = none.depth_step_mm = 0;
  none.grazing_drop_deg = {89.5, 90};
  const DepthImage measured = stereo_scene_sensor(none)(scene, 1);
  // Where the right imager, drawn by hand, sees the same surface there is depth; elsewhere there is none.
  Eigen::Isometry3d right_from_left = Eigen::Isometry3d::Identity();
  right_from_left.translation().x() = -55;
  const DepthImage right = render_scene(scene, right_from_left, scene.intrinsics);
  int hidden = 0, wrongly_seen = 0, seen = 0, wrongly_missing = 0;
  for (int v = 0; v < measured.height; ++v)
    for (int u = 0; u < measured.width; ++u) {
      const float z = scene.depth.at(u, v);
      if (z == 0) continue;
      const double u_right = u - 615 * 55 / z;
      if (u_right < 1 || u_right > 638) continue;
      const float nearest = std::min(right.at(int(u_right), v), right.at(int(u_right) + 1, v));
      const float farthest = std::max(right.at(int(u_right), v), right.at(int(u_right) + 1, v));
      if (farthest < z - 15) {
        ++hidden;
        wrongly_seen += measured.at(u, v) > 0;
      } else if (nearest > z - 1) {
        ++seen;
        wrongly_missing += measured.at(u, v) == 0;
        if (measured.at(u, v) > 0) {
          EXPECT_NEAR(measured.at(u, v), z, 0.1);
        }
      }
    }
  EXPECT_GT(hidden, 300);
  EXPECT_LT(wrongly_seen, hidden / 10);
  EXPECT_LT(wrongly_missing, seen / 100);
  for (int v = 0; v < measured.height; ++v) EXPECT_EQ(measured.at(10, v), 0) << "the band without overlap";
}

TEST(SyntheticScene, RefusesWhatCannotBe) {
  const auto error = [](auto change, std::vector<ScenePart> parts = catalogue()) {
    SceneOptions options;
    change(options);
    return shapes::error_of([&] { SceneGenerator(parts, {}, options).generate(0); });
  };
  EXPECT_PRED2(shapes::mentions, error([](auto& o) { o.parts = {3, 2}; }), "parts [3, 2]");
  EXPECT_PRED2(shapes::mentions, error([](auto& o) { o.unknown_parts = {0, 1}; }), "no unknown parts");
  EXPECT_PRED2(shapes::mentions, error([](auto&) {}, {}), "no catalogue parts");
  EXPECT_PRED2(shapes::mentions, error([](auto& o) { o.camera.elevation_deg = {0, 90}; }), "elevation_deg [0, 90]");
  EXPECT_PRED2(shapes::mentions, error([](auto& o) { o.camera.distance_mm[1] = std::nan(""); }), "distance_mm");
  EXPECT_PRED2(shapes::mentions, error([](auto& o) { o.hidden_fraction = {0.4, 0.4}; }), "0.005 wide");
  EXPECT_PRED2(shapes::mentions, error([](auto& o) { o.poses = "any"; }), "natural");
  EXPECT_PRED2(shapes::mentions, error([](auto& o) { o.floor_below_mm = 10; }), "floor_below_mm 10");
  // Metres taken for millimetres, and the other way round.
  EXPECT_PRED2(shapes::mentions, error([](auto&) {}, {{"tiny", shapes::box(Eigen::Vector3f(0.06f, 0.04f, 0.02f))}}),
               "too small to be seen");
  EXPECT_PRED2(shapes::mentions, error([](auto&) {}, {{"huge", shapes::box(Eigen::Vector3f(6000, 4000, 2000))}}),
               "too large for the table");
  EXPECT_PRED2(shapes::mentions, error([](auto&) {}, {{"nothing", shapes::plane_patch(60, 0)}}), "part \"nothing\"");
}

}  // namespace
}  // namespace partpose
