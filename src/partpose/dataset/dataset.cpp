// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/dataset/dataset.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/hash.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/geometry/icosphere.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/pcd.hpp"
#include "partpose/io/stl.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <mutex>
#include <set>

namespace partpose {

namespace fs = std::filesystem;

void IcosahedronOptions::check() const {
  if (!(capture_distance_mm > 0) || !std::isfinite(capture_distance_mm))
    throw Error("capture_distance_mm {}: must be positive", capture_distance_mm);
  if (subdivide < 0 || subdivide > 4) throw Error("subdivide {}: must be 0 to 4", subdivide);
  if (!std::isfinite(xyz_rotation_deg)) throw Error("xyz_rotation_deg is not finite");
}

void DatasetPreparationConfig::check() const {
  virtual_depth_camera.check();
  virtual_views_icosahedron.check();
  if (symmetry_tolerance_mm && !(*symmetry_tolerance_mm > 0))
    throw Error("symmetry_tolerance_mm {}: must be positive", *symmetry_tolerance_mm);
}

std::vector<DatasetView> icosahedron_views(const IcosahedronOptions& options) {
  const double angle = radians(options.xyz_rotation_deg);
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  std::vector<DatasetView> views;
  for (const auto& direction : icosphere_directions(options.subdivide, options.use_vertices)) {
    const Eigen::Vector3d position = options.capture_distance_mm * (turn * direction);
    views.push_back({look_at(position, Eigen::Vector3d::Zero()).inverse(), static_cast<int>(views.size())});
  }
  return views;
}

Eigen::Isometry3d centred_from_model(const TriangleMesh& mesh) {
  return Eigen::Isometry3d(Eigen::Translation3d(-bounding_box(mesh).center()));
}

fs::path Dataset::model_folder(int model_id) const { return folder / "models" / fmt::format("{:04d}", model_id); }
fs::path Dataset::mesh_path(int model_id) const { return model_folder(model_id) / "mesh.stl"; }
fs::path Dataset::view_path(int model_id, int view_id) const {
  return model_folder(model_id) / "views" / fmt::format("{:04d}.pcd", view_id);
}
Eigen::Isometry3d Dataset::camera_from_model(std::size_t model_index, std::size_t view_index) const {
  return out.views[view_index].T2 * out.models[model_index].T1;
}

namespace {

const char* const dataset_file = "dataset.json";
const char* const models_info_file = "models_info.json";

template <typename T>
void check_ids(const std::vector<T>& items, const char* what, const fs::path& file) {
  if (items.empty()) throw Error("{}: has no {}", file.string(), what);
  std::set<int> ids;
  for (const auto& item : items)
    if (item.id < 0 || !ids.insert(item.id).second)
      throw Error("{}: {}: id {} is negative or given twice", file.string(), what, item.id);
}

/// Renders and writes all views of `model_indices`; those models' mesh.stl must be in place.
void write_views(const Dataset& dataset, const std::vector<std::size_t>& model_indices, const Progress& progress) {
  const auto& config = dataset.out.dataset_preparation_config;
  const std::size_t view_count = dataset.out.views.size();
  std::size_t done = 0;
  std::mutex progress_mutex;
  for (const std::size_t m : model_indices) {
    const int model_id = dataset.out.models[m].id;
    const TriangleMesh mesh = read_stl(dataset.mesh_path(model_id));
    fs::create_directories(dataset.model_folder(model_id) / "views");
    parallel_for(view_count, [&](std::size_t v) {
      const auto cloud = capture(mesh, dataset.camera_from_model(m, v), config.virtual_depth_camera, config.organized(),
                                 m * view_count + v);
      write_pcd(dataset.view_path(model_id, dataset.out.views[v].id), cloud, PcdEncoding::binary_compressed);
      const std::lock_guard lock(progress_mutex);
      ++done;
      if (progress) progress("rendering views", done, model_indices.size() * view_count);
    });
  }
}

/// What the user says of the models, by their place in the dataset.
std::map<std::size_t, ModelSymmetries> given_symmetries(const DatasetOut& out) {
  std::map<std::size_t, ModelSymmetries> given;
  if (!out.dataset_preparation_config.symmetries) return given;
  const fs::path path = *out.dataset_preparation_config.symmetries;
  std::vector<std::string> names;
  for (const auto& model : out.models) names.push_back(model.name);
  for (const auto& [key, info] : read_models_info(path)) {
    auto model = std::find_if(out.models.begin(), out.models.end(),
                              [&key = key](const DatasetModel& m) { return m.name == key; });
    if (model == out.models.end() && info.name)
      model = std::find_if(out.models.begin(), out.models.end(),
                           [&info = info](const DatasetModel& m) { return m.name == *info.name; });
    if (model == out.models.end() && !info.name)
      model = std::find_if(out.models.begin(), out.models.end(),
                           [&key = key](const DatasetModel& m) { return std::to_string(m.id) == key; });
    if (model == out.models.end()) continue;  // a file may tell of more parts than this dataset has
    auto symmetries = info.symmetries;
    if (!symmetries.symmetries_discrete && !symmetries.symmetries_continuous)
      symmetries.symmetries_discrete.emplace();  // stated: there are none
    symmetries.symmetry_tolerance_mm.reset();    // given, not found in this mesh
    symmetries.symmetry_deviation_mm.reset();
    given[model - out.models.begin()] = symmetries;
  }
  if (given.empty())
    throw Error("{}: tells of none of the models; its keys must be names such as \"{}\", or ids", path.string(),
                names[0]);
  return given;
}

void add_symmetries(Dataset& dataset, const std::vector<std::size_t>& model_indices,
                    const std::map<std::size_t, ModelSymmetries>& given, const Progress& progress) {
  std::size_t done = 0;
  std::mutex progress_mutex;
  parallel_for(model_indices.size(), [&](std::size_t i) {
    auto& model = dataset.out.models[model_indices[i]];
    if (const auto known = given.find(model_indices[i]); known != given.end()) {
      model.symmetries = known->second;
    } else {
      try {
        model.symmetries = ModelSymmetries::of(search_symmetries(
            read_stl(dataset.mesh_path(model.id)), dataset.out.dataset_preparation_config.symmetry_tolerance_mm));
      } catch (const Error& error) {
        throw Error("model \"{}\": {}", model.name, error.what());
      }
    }
    const std::lock_guard lock(progress_mutex);
    if (progress) progress("finding symmetries", ++done, model_indices.size());
  });
}

void write_models_info(const Dataset& dataset) {
  Json infos = Json::object();
  for (const auto& model : dataset.out.models)
    infos[std::to_string(model.id)] =
        to_json(ModelInfo::of(model.name, read_stl(dataset.mesh_path(model.id)), model.symmetries));
  write_json_file(dataset.folder / models_info_file, infos);
}

/// Whether a folder holds a dataset and nothing but a dataset, so that replacing it loses nothing of the user's.
bool is_only_a_dataset(const fs::path& folder) {
  static const std::set<std::string> ours = {dataset_file, models_info_file, "descriptors", "models"};
  bool found = false;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!ours.contains(name)) return false;
    found = found || name == dataset_file;
  }
  return found;
}

/// A part that the cameras would stand in, or would not see, is in another unit than it should be.
void check_size(const TriangleMesh& mesh, const DatasetPreparationConfig& config, const fs::path& path) {
  const double diagonal_mm = bounding_box_diagonal(mesh);
  const double distance_mm = config.virtual_views_icosahedron.capture_distance_mm;
  if (diagonal_mm / 2 >= distance_mm)
    throw Error(
        "{}: is {:.4g} mm large, too large for cameras at {:.4g} mm: is it in millimetres? If so, raise "
        "capture_distance_mm",
        path.string(), diagonal_mm, distance_mm);
  constexpr double fewest_px = 3;
  if (diagonal_mm * config.virtual_depth_camera.intrinsics().fx / distance_mm < fewest_px)
    throw Error("{}: is {:.4g} mm large, too small to be seen from {:.4g} mm: is it in millimetres?", path.string(),
                diagonal_mm, distance_mm);
}

/// What killed processes left half-written beside a dataset.
void remove_leftovers(const fs::path& target) {
  const std::string prefix = target.filename().string() + ".partial-";
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(target.parent_path(), ignored)) {
    const std::string name = entry.path().filename().string();
    const int process = name.starts_with(prefix) ? std::atoi(name.c_str() + prefix.size()) : 0;
    if (process > 0 && kill(process, 0) != 0) fs::remove_all(entry.path(), ignored);
  }
}

void check_replaceable(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) throw Error("{}: exists and is not a folder", folder.string());
  if (!fs::is_empty(folder) && !is_only_a_dataset(folder))
    throw Error("{}: exists and holds other things than a dataset; give another folder", folder.string());
}

}  // namespace

Dataset open_dataset(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw Error("{}: no such dataset folder", folder.string());
  const fs::path file = folder / dataset_file;
  if (!fs::exists(file))
    throw Error("{}: has no {}; make a dataset with 'partpose dataset'", folder.string(), dataset_file);
  Dataset dataset{folder, read_json<DatasetOut>(file)};
  check_ids(dataset.out.models, "models", file);
  check_ids(dataset.out.views, "views", file);
  for (const auto& model : dataset.out.models)
    if (!fs::exists(dataset.mesh_path(model.id)))
      throw Error("{}: is missing; make the dataset again", dataset.mesh_path(model.id).string());
  return dataset;
}

Dataset create_dataset(const DatasetPreparationConfig& config, const std::vector<fs::path>& model_paths,
                       const fs::path& folder, const Progress& progress) {
  config.check();
  if (model_paths.empty()) throw Error("no models given: a dataset needs at least one model file");
  check_replaceable(folder);
  return create_dataset(config, read_meshes(model_paths), folder, progress);
}

Dataset create_dataset(const DatasetPreparationConfig& config, const std::vector<NamedMesh>& parts,
                       const fs::path& folder, const Progress& progress) {
  config.check();
  if (parts.empty()) throw Error("no models given: a dataset needs at least one part");
  check_names_differ(parts);
  check_replaceable(folder);

  fs::path target = fs::absolute(folder).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  remove_leftovers(target);
  Dataset dataset{target.string() + fmt::format(".partial-{}", getpid()), {}};
  dataset.out.dataset_preparation_config = config;
  dataset.out.views = icosahedron_views(config.virtual_views_icosahedron);
  struct RemoveUnlessRenamed {
    fs::path path;
    ~RemoveUnlessRenamed() {
      std::error_code ignored;
      if (!path.empty()) fs::remove_all(path, ignored);
    }
  } guard{dataset.folder};

  std::vector<std::size_t> all;
  for (const auto& part : parts) {
    check_size(part.mesh, config, part.file);
    DatasetModel model{centred_from_model(part.mesh), static_cast<int>(all.size()), part.name, {}, {}};
    fs::create_directories(dataset.model_folder(model.id));
    write_stl(dataset.mesh_path(model.id), part.mesh);
    model.mesh_hash = content_hash(read_file(dataset.mesh_path(model.id)));
    all.push_back(all.size());
    dataset.out.models.push_back(std::move(model));
  }
  add_symmetries(dataset, all, given_symmetries(dataset.out), progress);
  write_models_info(dataset);
  write_views(dataset, all, progress);
  fs::create_directories(dataset.folder / "descriptors");
  write_json(dataset.folder / dataset_file, dataset.out);

  check_replaceable(target);
  const fs::path old = target.string() + fmt::format(".old-{}", getpid());
  if (fs::exists(target)) fs::rename(target, old);
  fs::rename(dataset.folder, target);
  guard.path.clear();
  fs::remove_all(old);
  dataset.folder = folder;
  return dataset;
}

int refresh_dataset(Dataset& dataset, const Progress& progress) {
  std::vector<std::size_t> changed;
  for (std::size_t m = 0; m < dataset.out.models.size(); ++m) {
    auto& model = dataset.out.models[m];
    if (!model.mesh_hash) continue;
    const std::string bytes = read_file(dataset.mesh_path(model.id));
    const std::string hash = content_hash(bytes);
    if (hash == *model.mesh_hash) continue;
    model.T1 = centred_from_model(parse_stl(bytes, dataset.mesh_path(model.id).string()));
    model.mesh_hash = hash;
    changed.push_back(m);
  }
  if (!changed.empty()) {
    std::vector<std::size_t> searched;
    for (const std::size_t m : changed)
      if (const auto& s = dataset.out.models[m].symmetries;
          s.symmetry_tolerance_mm || !(s.symmetries_discrete || s.symmetries_continuous))
        searched.push_back(m);
    add_symmetries(dataset, searched, {}, progress);
    write_models_info(dataset);
    write_views(dataset, changed, progress);
    write_json(dataset.folder / dataset_file, dataset.out);
  }
  return static_cast<int>(changed.size());
}

std::vector<fs::path> read_model_list(const fs::path& path) {
  std::vector<fs::path> paths;
  for (const auto& model : read_json<ModelList>(path).model_paths) paths.push_back(path.parent_path() / model);
  return paths;
}

}  // namespace partpose
