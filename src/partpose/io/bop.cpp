// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/bop.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/ply.hpp"
#include "partpose/io/png.hpp"
#include "partpose/io/text_reader.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <set>
#include <system_error>
#include <tuple>

namespace partpose {

namespace {

namespace fs = std::filesystem;

/// What other programs write as a rotation is rounded, at worst to two decimals or so.
constexpr double rotation_tolerance = 0.05;
constexpr double same_time_s = 0.001;  ///< as in the toolkit

/// A JSON value that knows where it stands. Keys that nobody asks for are ignored.
class Node {
 public:
  Node(const Json& json, const fs::path& file, std::string key = {}) : json_(json), file_(file), key_(std::move(key)) {}

  bool has(const char* key) const { return json_.is_object() && json_.contains(key); }

  Node at(const char* key) const {
    if (!json_.is_object()) fail("expected an object");
    const auto it = json_.find(key);
    if (it == json_.end()) throw Error("{}: key \"{}\" is missing", file_.string(), json_detail::key_path(key_, key));
    return {*it, file_, json_detail::key_path(key_, key)};
  }

  template <typename T>
  T as() const {
    try {
      T value{};
      json_detail::read(json_, key_, value);
      return value;
    } catch (const Error& error) {
      throw Error("{}: {}", file_.string(), error.what());
    }
  }

  template <typename T>
  T get(const char* key) const {
    return at(key).as<T>();
  }

  std::vector<Node> items() const {
    if (!json_.is_array()) fail("expected an array");
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < json_.size(); ++i) nodes.emplace_back(json_[i], file_, fmt::format("{}[{}]", key_, i));
    return nodes;
  }

  /// The members of an object whose keys are ids.
  std::map<int, Node> by_id() const {
    if (!json_.is_object()) fail("expected an object");
    std::map<int, Node> nodes;
    for (const auto& [key, value] : json_.items()) {
      const auto id = parse_count(key, std::numeric_limits<int>::max());
      const std::string path = json_detail::key_path(key_, key);
      if (!id) throw Error("{}: key \"{}\": an id (a whole number from 0) is expected", file_.string(), path);
      if (!nodes.emplace(static_cast<int>(*id), Node(value, file_, path)).second)
        throw Error("{}: key \"{}\": the id {} is given twice", file_.string(), path, *id);
    }
    return nodes;
  }

  /// Boxes of some datasets are fractions of pixels.
  template <std::size_t N>
  std::array<int, N> rounded() const {
    const auto values = as<std::array<double, N>>();
    std::array<int, N> out;
    for (std::size_t i = 0; i < N; ++i) {
      if (!(std::abs(values[i]) < 1e9)) fail("expected pixels");
      out[i] = static_cast<int>(std::lround(values[i]));
    }
    return out;
  }

  Eigen::Matrix3d matrix() const {
    const auto v = as<std::array<double, 9>>();
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.data());
  }

  Eigen::Vector3d vector() const { return Eigen::Vector3d(as<std::array<double, 3>>().data()); }

  [[noreturn]] void fail(const std::string& complaint) const {
    if (key_.empty()) throw Error("{}: {}", file_.string(), complaint);
    throw Error("{}: key \"{}\": {}", file_.string(), key_, complaint);
  }

 private:
  const Json& json_;
  const fs::path& file_;
  std::string key_;
};

bool is_rotation(const Eigen::Matrix3d& rotation) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = rotation;
  return is_rigid(matrix, rotation_tolerance);
}

Eigen::Isometry3d pose_of(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation;
  pose.translation() = translation;
  return pose;
}

Eigen::Isometry3d read_pose(const Node& node, const char* rotation, const char* translation) {
  const Node at = node.at(rotation);
  const Eigen::Matrix3d matrix = at.matrix();
  if (!is_rotation(matrix)) at.fail("not a rotation (3x3, row by row)");
  return pose_of(matrix, node.at(translation).vector());
}

std::array<double, 9> rows(const Eigen::Matrix3d& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
}

std::array<double, 3> values(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::string in_six_digits(int id) { return fmt::format("{:06}", id); }

/// One line for each entry: what people and other tools expect of these files.
std::string lines_of(const std::vector<std::string>& entries, char open, char close) {
  std::string text = {open, '\n'};
  for (std::size_t i = 0; i < entries.size(); ++i) text += "  " + entries[i] + (i + 1 < entries.size() ? ",\n" : "\n");
  return text + close + '\n';
}

void write_entries(const fs::path& file, const std::vector<std::pair<int, Json>>& entries) {
  std::vector<std::string> lines;
  for (const auto& [id, json] : entries) lines.push_back(fmt::format("\"{}\": {}", id, json_line(json)));
  write_file_atomically(file, lines_of(lines, '{', '}'));
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error("{}: the folder cannot be made: {}", folder.string(), error.message());
}

void check_id(int id, const char* what) {
  if (id < 0) throw Error("{} {}: must be 0 or more", what, id);
}

Symmetries read_symmetries(const Node& info) {
  Symmetries symmetries;
  if (info.has("symmetries_discrete")) {
    for (const auto& item : info.at("symmetries_discrete").items()) {
      const auto values = item.as<std::array<double, 16>>();
      Eigen::Isometry3d symmetry;
      symmetry.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
      if (!is_rigid(symmetry.matrix(), rotation_tolerance)) item.fail("not a rigid transformation (4x4, row by row)");
      symmetries.discrete.push_back(symmetry);
    }
  }
  if (info.has("symmetries_continuous")) {
    for (const auto& item : info.at("symmetries_continuous").items()) {
      const Node axis = item.at("axis");
      if (!(axis.vector().norm() > 0)) axis.fail("has no direction");
      symmetries.continuous.push_back({axis.vector(), item.at("offset").vector()});
    }
  }
  return symmetries;
}

BopCamera read_image_camera(const Node& node) {
  BopCamera camera;
  const Node k = node.at("cam_K");
  camera.K = k.matrix();
  if (!(camera.K(0, 0) > 0 && camera.K(1, 1) > 0)) k.fail("the focal lengths must be positive");
  if (camera.K.row(2) != Eigen::RowVector3d(0, 0, 1)) k.fail("the last row must be 0 0 1");
  if (node.has("depth_scale")) {
    const Node scale = node.at("depth_scale");
    camera.depth_scale_mm = scale.as<double>();
    if (!(camera.depth_scale_mm > 0)) scale.fail("must be positive");
  }
  if (node.has("cam_R_w2c") && node.has("cam_t_w2c"))
    camera.camera_from_world = read_pose(node, "cam_R_w2c", "cam_t_w2c");
  return camera;
}

BopVisibility read_visibility(const Node& node) {
  BopVisibility v;
  const Node fraction = node.at("visib_fract");
  v.visib_fract = fraction.as<double>();
  if (node.has("bbox_obj")) v.bbox_obj = node.at("bbox_obj").rounded<4>();
  if (node.has("bbox_visib")) v.bbox_visib = node.at("bbox_visib").rounded<4>();
  if (node.has("px_count_all")) v.px_count_all = node.get<int>("px_count_all");
  if (node.has("px_count_valid")) v.px_count_valid = node.get<int>("px_count_valid");
  if (node.has("px_count_visib")) v.px_count_visib = node.get<int>("px_count_visib");
  return v;
}

BopDatasetCamera read_dataset_camera(const fs::path& file) {
  const Json json = read_json_file(file);
  const Node node(json, file);
  BopDatasetCamera camera;
  camera.intrinsics = {node.get<int>("width"), node.get<int>("height"), node.get<double>("fx"),
                       node.get<double>("fy"), node.get<double>("cx"),  node.get<double>("cy")};
  if (node.has("depth_scale")) camera.depth_scale_mm = node.get<double>("depth_scale");
  try {
    camera.intrinsics.check();
    if (!(camera.depth_scale_mm > 0)) throw Error("depth_scale {}: must be positive", camera.depth_scale_mm);
  } catch (const Error& error) {
    throw Error("{}: {}", file.string(), error.what());
  }
  return camera;
}

/// The scenes of a split by their ids: its subfolders whose names are numbers.
std::map<int, fs::path> scene_folders(const fs::path& split) {
  if (!fs::is_directory(split))
    throw Error("{}: no such folder; a BOP dataset has one for each split (test, train, ...)", split.string());
  std::map<int, fs::path> folders;
  for (const auto& entry : fs::directory_iterator(split)) {
    const auto id = parse_count(entry.path().filename().string(), std::numeric_limits<int>::max());
    if (!id || !entry.is_directory()) continue;
    const auto [it, added] = folders.emplace(static_cast<int>(*id), entry.path());
    if (!added) throw Error("{}: scene {} is there twice: {}", split.string(), *id, it->second.string());
  }
  if (folders.empty()) throw Error("{}: has no scenes; they are folders such as 000001", split.string());
  return folders;
}

void check_ground_truths(const BopDataset& dataset) {
  for (const auto& [scene_id, scene] : dataset.scenes)
    for (const auto& image : scene.images)
      for (std::size_t i = 0; i < image.ground_truths.size(); ++i)
        if (!dataset.models.contains(image.ground_truths[i].obj_id))
          throw Error("{}: key \"{}[{}].obj_id\": {} is none of the objects in models_info.json",
                      (scene.folder / "scene_gt.json").string(), image.id, i, image.ground_truths[i].obj_id);
}

void check_targets(const BopDataset& dataset, const fs::path& file) {
  std::set<std::tuple<int, int, int>> seen;
  for (std::size_t i = 0; i < dataset.targets.size(); ++i) {
    const auto& t = dataset.targets[i];
    try {
      dataset.scene(t.scene_id).image(t.im_id);
      if (!dataset.models.contains(t.obj_id))
        throw Error("obj_id {} is none of the objects in models_info.json", t.obj_id);
      if (!seen.insert({t.scene_id, t.im_id, t.obj_id}).second)
        throw Error("scene {}, image {}, object {} is there twice", t.scene_id, t.im_id, t.obj_id);
    } catch (const Error& error) {
      throw Error("{}: entry {}: {}", file.string(), i, error.what());
    }
  }
}

}  // namespace

BopCamera BopCamera::of(const Intrinsics& intrinsics, double depth_scale_mm) {
  BopCamera camera;
  camera.K << intrinsics.fx, 0, intrinsics.cx, 0, intrinsics.fy, intrinsics.cy, 0, 0, 1;
  camera.depth_scale_mm = depth_scale_mm;
  return camera;
}

Intrinsics BopCamera::intrinsics(int width, int height) const {
  if (K(0, 1) != 0 || K(1, 0) != 0)
    throw Error("cam_K has skew ({}): only cameras without are understood here", K(0, 1));
  const Intrinsics intrinsics{width, height, K(0, 0), K(1, 1), K(0, 2), K(1, 2)};
  intrinsics.check();
  return intrinsics;
}

const BopImage& BopScene::image(int im_id) const {
  const auto it = std::ranges::lower_bound(images, im_id, {}, &BopImage::id);
  if (it == images.end() || it->id != im_id) throw Error("scene {} has no image {}", id, im_id);
  return *it;
}

fs::path BopScene::depth_path(const BopImage& image) const {
  return folder / "depth" / (in_six_digits(image.id) + ".png");
}

DepthImage BopScene::read_depth(const BopImage& image) const {
  return read_depth_png(depth_path(image), image.camera.depth_scale_mm);
}

TriangleMesh BopDataset::read_model(int obj_id) const { return read_ply_mesh(models_folder / bop_model_name(obj_id)); }

const BopScene& BopDataset::scene(int scene_id) const {
  const auto it = scenes.find(scene_id);
  if (it == scenes.end()) throw Error("there is no scene {} in {}", scene_id, (folder / split).string());
  return it->second;
}

fs::path bop_scene_folder(const fs::path& dataset, const std::string& split, int scene_id) {
  return dataset / split / in_six_digits(scene_id);
}

std::string bop_model_name(int obj_id) { return fmt::format("obj_{:06}.ply", obj_id); }

BopModelInfo bop_model_info(const TriangleMesh& mesh, Symmetries symmetries) {
  if (mesh.vertices.empty()) throw Error("a mesh without vertices has no diameter");
  return {diameter(mesh), bounding_box(mesh), std::move(symmetries)};
}

std::map<int, BopModelInfo> read_bop_models_info(const fs::path& file) {
  const Json json = read_json_file(file);
  std::map<int, BopModelInfo> models;
  for (const auto& [id, node] : Node(json, file).by_id()) {
    BopModelInfo info;
    info.diameter_mm = node.get<double>("diameter");
    if (!(info.diameter_mm > 0)) node.at("diameter").fail("must be positive");
    const Eigen::Vector3d corner(node.get<double>("min_x"), node.get<double>("min_y"), node.get<double>("min_z"));
    const Eigen::Vector3d size(node.get<double>("size_x"), node.get<double>("size_y"), node.get<double>("size_z"));
    if (!(size.minCoeff() >= 0)) node.fail("size_x, size_y, size_z must not be negative");
    info.box_mm = {corner, corner + size};
    info.symmetries = read_symmetries(node);
    models.emplace(id, std::move(info));
  }
  if (models.empty()) throw Error("{}: has no objects", file.string());
  return models;
}

BopScene read_bop_scene(const fs::path& scene_folder, int scene_id) {
  const fs::path camera_file = scene_folder / "scene_camera.json", truth_file = scene_folder / "scene_gt.json",
                 info_file = scene_folder / "scene_gt_info.json";
  BopScene scene{scene_id, scene_folder, fs::exists(truth_file), {}};
  const Json cameras = read_json_file(camera_file);
  for (const auto& [im_id, node] : Node(cameras, camera_file).by_id())
    scene.images.push_back({im_id, read_image_camera(node), {}});
  if (!scene.has_ground_truth) return scene;

  const auto image_of = [&](int im_id, const Node& node) -> BopImage& {
    const auto it = std::ranges::lower_bound(scene.images, im_id, {}, &BopImage::id);
    if (it == scene.images.end() || it->id != im_id) node.fail("there is no such image in scene_camera.json");
    return *it;
  };
  const Json truths = read_json_file(truth_file);
  for (const auto& [im_id, node] : Node(truths, truth_file).by_id())
    for (const auto& item : node.items())
      image_of(im_id, node)
          .ground_truths.push_back({item.get<int>("obj_id"), read_pose(item, "cam_R_m2c", "cam_t_m2c"), {}});
  if (!fs::exists(info_file)) return scene;

  const Json infos = read_json_file(info_file);
  for (const auto& [im_id, node] : Node(infos, info_file).by_id()) {
    auto& ground_truths = image_of(im_id, node).ground_truths;
    const auto items = node.items();
    if (items.size() != ground_truths.size())
      node.fail(fmt::format("{} entries, but scene_gt.json has {}", items.size(), ground_truths.size()));
    for (std::size_t i = 0; i < items.size(); ++i) ground_truths[i].visibility = read_visibility(items[i]);
  }
  return scene;
}

std::vector<BopTarget> read_bop_targets(const fs::path& file) {
  const Json json = read_json_file(file);
  std::vector<BopTarget> targets;
  for (const auto& node : Node(json, file).items()) {
    targets.push_back(
        {node.get<int>("scene_id"), node.get<int>("im_id"), node.get<int>("obj_id"), node.get<int>("inst_count")});
    if (targets.back().inst_count < 1) node.at("inst_count").fail("must be 1 or more");
  }
  return targets;
}

BopDataset read_bop_dataset(const fs::path& folder, const std::string& split) {
  if (!fs::is_directory(folder)) throw Error("{}: no such folder", folder.string());
  BopDataset dataset;
  dataset.folder = folder;
  dataset.split = split;
  if (fs::exists(folder / "camera.json")) dataset.camera = read_dataset_camera(folder / "camera.json");
  dataset.models_folder = folder / (fs::is_directory(folder / "models_eval") ? "models_eval" : "models");
  dataset.models = read_bop_models_info(dataset.models_folder / "models_info.json");
  for (const auto& [id, scene_folder] : scene_folders(folder / split))
    dataset.scenes.emplace(id, read_bop_scene(scene_folder, id));
  check_ground_truths(dataset);
  if (const fs::path file = folder / "test_targets_bop19.json"; fs::exists(file) && split.starts_with("test")) {
    dataset.targets = read_bop_targets(file);
    check_targets(dataset, file);
  } else {
    std::vector<BopScene> scenes;
    for (const auto& [id, scene] : dataset.scenes) scenes.push_back(scene);
    dataset.targets = bop_targets_of(scenes, 0);
  }
  return dataset;
}

void write_bop_model(const fs::path& models_folder, int obj_id, const TriangleMesh& mesh) {
  check_id(obj_id, "obj_id");
  make_folder(models_folder);
  write_ply_mesh(models_folder / bop_model_name(obj_id), mesh);
}

void write_bop_models_info(const fs::path& models_folder, const std::map<int, BopModelInfo>& models) {
  make_folder(models_folder);
  std::vector<std::pair<int, Json>> entries;
  for (const auto& [id, info] : models) {
    check_id(id, "obj_id");
    const Eigen::Vector3d corner = info.box_mm.min(), size = info.box_mm.sizes();
    Json json = {{"diameter", info.diameter_mm}, {"min_x", corner.x()}, {"min_y", corner.y()}, {"min_z", corner.z()},
                 {"size_x", size.x()},           {"size_y", size.y()},  {"size_z", size.z()}};
    for (const auto& symmetry : info.symmetries.discrete) {
      Json numbers = Json::array();
      for (int i = 0; i < 16; ++i) numbers.push_back(symmetry.matrix()(i / 4, i % 4));
      json["symmetries_discrete"].push_back(numbers);
    }
    for (const auto& [axis, offset_mm] : info.symmetries.continuous)
      json["symmetries_continuous"].push_back({{"axis", values(axis)}, {"offset", values(offset_mm)}});
    entries.emplace_back(id, json);
  }
  write_entries(models_folder / "models_info.json", entries);
}

void write_bop_camera(const fs::path& dataset, const BopDatasetCamera& camera) {
  make_folder(dataset);
  const auto& k = camera.intrinsics;
  write_json_file(dataset / "camera.json", {{"cx", k.cx},
                                            {"cy", k.cy},
                                            {"depth_scale", camera.depth_scale_mm},
                                            {"fx", k.fx},
                                            {"fy", k.fy},
                                            {"height", k.height},
                                            {"width", k.width}});
}

void write_bop_depth(const fs::path& scene_folder, int im_id, const DepthImage& depth, double depth_scale_mm) {
  check_id(im_id, "im_id");
  make_folder(scene_folder / "depth");
  write_depth_png(scene_folder / "depth" / (in_six_digits(im_id) + ".png"), depth, depth_scale_mm);
}

void write_bop_scene(const BopScene& scene) {
  std::vector<std::pair<int, Json>> cameras, truths, infos;
  bool all_visibilities_known = true;
  for (const auto& image : scene.images) {
    check_id(image.id, "im_id");
    Json camera = {{"cam_K", rows(image.camera.K)}, {"depth_scale", image.camera.depth_scale_mm}};
    if (const auto& world = image.camera.camera_from_world) {
      camera["cam_R_w2c"] = rows(world->linear());
      camera["cam_t_w2c"] = values(world->translation());
    }
    Json truth = Json::array(), info = Json::array();
    for (const auto& gt : image.ground_truths) {
      truth.push_back({{"cam_R_m2c", rows(gt.camera_from_model.linear())},
                       {"cam_t_m2c", values(gt.camera_from_model.translation())},
                       {"obj_id", gt.obj_id}});
      const BopVisibility v = gt.visibility.value_or(BopVisibility{});
      all_visibilities_known &= gt.visibility.has_value();
      info.push_back({{"bbox_obj", v.bbox_obj},
                      {"bbox_visib", v.bbox_visib},
                      {"px_count_all", v.px_count_all},
                      {"px_count_valid", v.px_count_valid},
                      {"px_count_visib", v.px_count_visib},
                      {"visib_fract", v.visib_fract}});
    }
    cameras.emplace_back(image.id, camera);
    truths.emplace_back(image.id, truth);
    infos.emplace_back(image.id, info);
  }
  make_folder(scene.folder);
  write_entries(scene.folder / "scene_camera.json", cameras);
  if (!scene.has_ground_truth) return;
  write_entries(scene.folder / "scene_gt.json", truths);
  if (all_visibilities_known) write_entries(scene.folder / "scene_gt_info.json", infos);
}

void write_bop_targets(const fs::path& dataset, std::span<const BopTarget> targets) {
  make_folder(dataset);
  std::vector<std::string> lines;
  for (const auto& t : targets)
    lines.push_back(
        json_line({{"im_id", t.im_id}, {"inst_count", t.inst_count}, {"obj_id", t.obj_id}, {"scene_id", t.scene_id}}));
  write_file_atomically(dataset / "test_targets_bop19.json", lines_of(lines, '[', ']'));
}

std::vector<BopTarget> bop_targets_of(std::span<const BopScene> scenes, double min_visib_fract) {
  std::vector<BopTarget> targets;
  for (const auto& scene : scenes) {
    for (const auto& image : scene.images) {
      std::map<int, int> count;
      for (const auto& gt : image.ground_truths)
        if (!gt.visibility || gt.visibility->visib_fract >= min_visib_fract) ++count[gt.obj_id];
      for (const auto& [obj_id, instances] : count) targets.push_back({scene.id, image.id, obj_id, instances});
    }
  }
  return targets;
}

namespace {

constexpr std::string_view results_header = "scene_id,im_id,obj_id,score,R,t,time";

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const auto at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// A row's cells, with the column's name for errors.
class Row {
 public:
  Row(std::string_view line, std::string place) : cells_(split(line, ',')), place_(std::move(place)) {
    if (cells_.size() != columns_.size())
      throw Error("{}: {} comma-separated values, {} expected: {}", place_, cells_.size(), columns_.size(),
                  results_header);
  }

  int id(std::size_t column) const {
    const auto value = parse_count(trimmed(cells_[column]), std::numeric_limits<int>::max());
    if (!value) fail(column, "an id (a whole number from 0)");
    return static_cast<int>(*value);
  }

  double number(std::size_t column) const { return number(column, trimmed(cells_[column])); }

  template <std::size_t N>
  std::array<double, N> numbers(std::size_t column) const {
    std::array<double, N> out;
    std::size_t found = 0;
    for (const auto word : split(trimmed(cells_[column]), ' ')) {
      if (word.empty()) continue;
      if (found == N) fail(column, fmt::format("{} numbers", N));
      out[found++] = number(column, word);
    }
    if (found != N) fail(column, fmt::format("{} numbers", N));
    return out;
  }

  [[noreturn]] void fail(std::size_t column, const std::string& expected) const {
    throw Error("{}: {}: {} where {} is expected", place_, columns_[column], in_quotes(trimmed(cells_[column])),
                expected);
  }

 private:
  double number(std::size_t column, std::string_view word) const {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);  // from_chars knows no plus sign
    double value = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || stop != word.data() + word.size() || !std::isfinite(value)) fail(column, "a number");
    return value;
  }

  static inline const std::vector<std::string_view> columns_ = split(results_header, ',');
  std::vector<std::string_view> cells_;
  std::string place_;
};

/// What makes a results file that the toolkit refuses, or misunderstands; `place_of` names a row.
template <typename PlaceOf>
void check_results(std::span<const BopEstimate> estimates, const PlaceOf& place_of) {
  std::map<std::pair<int, int>, double> time_of_image;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const auto& e = estimates[i];
    const auto fail = [&](const std::string& complaint) { throw Error("{}: {}", place_of(i), complaint); };
    if (e.scene_id < 0 || e.im_id < 0 || e.obj_id < 0) fail("an id is negative");
    if (!std::isfinite(e.score)) fail("the score is not finite");
    if (!is_rotation(e.camera_from_model.linear())) fail("R is not a rotation (3x3, row by row)");
    if (!e.camera_from_model.translation().allFinite()) fail("t is not finite");
    if (!(e.time_s >= 0 || e.time_s == -1))
      fail(fmt::format("time {}: seconds for the whole image are expected, or -1", e.time_s));
    const double time_s = time_of_image.emplace(std::pair{e.scene_id, e.im_id}, e.time_s).first->second;
    if (std::abs(time_s - e.time_s) > same_time_s)
      fail(fmt::format(
          "time {}, but {} in an earlier row of scene {}, image {}: one time for the whole image is expected", e.time_s,
          time_s, e.scene_id, e.im_id));
  }
}

}  // namespace

std::vector<BopEstimate> read_bop_results(const fs::path& file) {
  const std::string text = read_file(file);
  std::vector<BopEstimate> estimates;
  std::vector<std::size_t> line_of;
  const auto place = [&](std::size_t line) { return fmt::format("{}: line {}", file.string(), line); };
  std::size_t number = 0;
  for (const auto line : split(text, '\n')) {
    ++number;
    if (trimmed(line).empty() || (number == 1 && trimmed(line) == results_header)) continue;
    const Row row(line, place(number));
    const auto rotation = row.numbers<9>(4);
    const auto translation = row.numbers<3>(5);
    BopEstimate e{row.id(0), row.id(1), row.id(2), row.number(3), {}, row.number(6)};
    e.camera_from_model = pose_of(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data()),
                                  Eigen::Vector3d(translation.data()));
    estimates.push_back(e);
    line_of.push_back(number);
  }
  check_results(estimates, [&](std::size_t i) { return place(line_of[i]); });
  return estimates;
}

void write_bop_results(const fs::path& file, std::span<const BopEstimate> estimates) {
  check_results(estimates, [&](std::size_t i) { return fmt::format("{}: estimate {}", file.string(), i); });
  std::string text = std::string(results_header) + '\n';
  for (const auto& e : estimates) {
    const auto r = rows(e.camera_from_model.linear());
    const auto t = values(e.camera_from_model.translation());
    text += fmt::format("{},{},{},{},{},{},{}\n", e.scene_id, e.im_id, e.obj_id, e.score, fmt::join(r, " "),
                        fmt::join(t, " "), e.time_s);
  }
  write_file_atomically(file, text);
}

}  // namespace partpose
