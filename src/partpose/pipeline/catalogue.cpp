// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/pipeline/catalogue.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/hash.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/random.hpp"
#include "partpose/descriptor/descriptors.hpp"
#include "partpose/geometry/voxel_grid.hpp"
#include "partpose/io/json.hpp"
#include "partpose/io/pcd.hpp"
#include "partpose/io/stl.hpp"

#include <mutex>

namespace partpose {

namespace {

namespace fs = std::filesystem;

/// Raised whenever the offline stage computes something else from the same input.
constexpr int format_version = 3;

/// Which view a row of the descriptor file belongs to, in the rows' order, and what it was measured on.
struct DescriptorReference {
  int model_id = 0;
  int view_id = 0;
  int support = 0;
  bool valid = true;
  std::optional<Eigen::Isometry3d> camera_from_reference;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("model_id", self.model_id, "the part");
    visit("view_id", self.view_id, "the view");
    visit("support", self.support, "points that it was measured on");
    visit("valid", self.valid, "false: no cluster was large enough, and the whole view stands for one");
    visit("camera_from_reference", self.camera_from_reference, "the descriptor's own reference frame, 4x4 [mm]");
  }
};

/// Where a view's refinement cloud lies in the file of all of them.
struct ViewReference {
  int model_id = 0;
  int view_id = 0;
  int num_of_points = 0;
  int refinement_points = 0;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("model_id", self.model_id, "the part");
    visit("view_id", self.view_id, "the view");
    visit("num_of_points", self.num_of_points, "in the dataset");
    visit("refinement_points", self.refinement_points, "in the file of refinement clouds, after the views before it");
  }
};

struct References {
  std::vector<DescriptorReference> descriptors;
  std::vector<ViewReference> views;

  static constexpr bool all_keys_required = true;
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("descriptors", self.descriptors, "one for each row of the descriptor file");
    visit("views", self.views, "one for each view");
  }
};

/// All that the stored result depends on; it is used again only when this is the same to the letter.
Json dependencies(const Dataset& dataset, const GlobalPipelineConfig& config) {
  const Json full = to_json(config);
  Json json;
  json["format_version"] = format_version;
  json["global_descriptor"] = config.global_descriptor;
  json["options"] = full[config.global_descriptor];
  json["options"].erase("k_nn");  // of the search, not of the descriptor
  json["database"] = full["database"];
  json["normal_estimation"] = full["normal_estimation"];
  for (const char* key : {"voxel_grid_flag", "voxel_size"}) json["preprocessing"][key] = full["preprocessing"][key];
  for (const char* key : {"voxelize_view", "voxel_size"}) json["pose_refinement"][key] = full["pose_refinement"][key];
  json["dataset_hash"] = content_hash(to_json(dataset.out).dump());
  return json;
}

struct Files {
  fs::path descriptors, config, references, views;
  Files(const Dataset& dataset, const std::string& name) {
    const fs::path folder = dataset.folder / "descriptors";
    descriptors = folder / (name + ".pcd");
    config = folder / (name + "_config.json");
    references = folder / (name + "_references.json");
    views = folder / (name + "_views.pcd");
  }
};

/// The offline result before it is joined with the parts.
struct Stored {
  References references;
  std::vector<std::vector<float>> histograms;
  PointCloud clouds;  ///< the refinement clouds of all views, one behind the other
};

/// Independent Gaussian noise along the ray of each point.
PointCloud with_noise(PointCloud cloud, float sigma_mm, Random random) {
  for (auto& p : cloud.points) p += static_cast<float>(sigma_mm * random.normal_pair().first) * p.normalized();
  return cloud;
}

Stored compute(const Dataset& dataset, const GlobalPipelineConfig& config, const Progress& progress) {
  const auto descriptor = make_global_descriptor(config.global_descriptor, config.descriptors);
  const std::size_t view_count = dataset.out.views.size(), count = dataset.out.models.size() * view_count;
  struct OfView {
    std::vector<Description> descriptions;
    PointCloud cloud;
    int num_of_points = 0;
  };
  std::vector<OfView> of_view(count);
  std::size_t done = 0;
  std::mutex progress_mutex;
  parallel_for(count, [&](std::size_t i) {
    const PointCloud view =
        read_pcd(dataset.view_path(dataset.out.models[i / view_count].id, dataset.out.views[i % view_count].id));
    OfView& out = of_view[i];
    const auto& levels = config.database.noise_levels_mm;
    for (std::size_t level = 0; level < levels.size(); ++level) {
      const PointCloud noisy = levels[level] > 0 ? with_noise(view, levels[level], Random(level, i)) : view;
      auto descriptions = descriptor->describe(comparable_view(noisy, config));
      std::move(descriptions.begin(), descriptions.end(), std::back_inserter(out.descriptions));
    }
    PointCloud prepared = comparable_view(view, config);
    out.num_of_points = static_cast<int>(without_missing(view).size());
    out.cloud = config.pose_refinement.voxelize_view ? voxel_grid(prepared, config.pose_refinement.voxel_size)
                                                     : std::move(prepared);
    const std::lock_guard lock(progress_mutex);
    ++done;
    if (progress) progress("describing views", done, count);
  });

  Stored stored;
  for (std::size_t i = 0; i < count; ++i) {
    const int model_id = dataset.out.models[i / view_count].id, view_id = dataset.out.views[i % view_count].id;
    for (auto& description : of_view[i].descriptions) {
      stored.histograms.push_back(std::move(description.histogram));
      stored.references.descriptors.push_back(
          {model_id, view_id, description.support, description.valid, description.camera_from_reference});
    }
    stored.references.views.push_back(
        {model_id, view_id, of_view[i].num_of_points, static_cast<int>(of_view[i].cloud.size())});
    append(stored.clouds, of_view[i].cloud);
    of_view[i].cloud = {};
  }
  if (stored.histograms.empty())
    throw Error("{}: no view has any points: are the parts in millimetres and smaller than the capture distance?",
                dataset.folder.string());
  return stored;
}

void save(const Stored& stored, const Files& files, const GlobalPipelineConfig& config, const Json& depends_on) {
  fs::create_directories(files.config.parent_path());
  fs::remove(files.config);  // it is written last: without it the others do not count
  write_pcd_histograms(files.descriptors, config.global_descriptor, static_cast<int>(stored.histograms[0].size()),
                       stored.histograms);
  write_pcd(files.views, stored.clouds, PcdEncoding::binary_compressed);
  write_json(files.references, stored.references);
  write_json_file(files.config, depends_on);
}

bool is_current(const Files& files, const Json& depends_on) {
  if (!fs::exists(files.config)) return false;
  try {
    return read_json_file(files.config) == depends_on;
  } catch (const Error&) {
    return false;  // a damaged file is computed again
  }
}

/// Without their surfaces.
std::vector<CataloguePart> parts_of(const Dataset& dataset) {
  std::vector<CataloguePart> parts;
  for (const auto& model : dataset.out.models)
    parts.push_back({model.id, model.name, model.T1, read_stl(dataset.mesh_path(model.id)), {}});
  return parts;
}

Catalogue join(Dataset dataset, const GlobalPipelineConfig& config, Stored stored) {
  Catalogue catalogue;
  catalogue.parts = parts_of(dataset);
  std::map<int, int> part_of_id;
  for (const auto& part : catalogue.parts) part_of_id.emplace(part.id, static_cast<int>(part_of_id.size()));
  std::map<int, Eigen::Isometry3d> T2_of_id;
  for (const auto& view : dataset.out.views) T2_of_id[view.id] = view.T2;

  std::map<std::pair<int, int>, int> view_of_ids;
  std::size_t first = 0;
  for (const auto& reference : stored.references.views) {
    CatalogueView view;
    view.part = part_of_id.at(reference.model_id);
    view.id = reference.view_id;
    view.T2 = T2_of_id.at(reference.view_id);
    view.num_of_points = reference.num_of_points;
    std::vector<int> indices(reference.refinement_points);
    std::iota(indices.begin(), indices.end(), static_cast<int>(first));
    first += indices.size();
    if (first > stored.clouds.size()) throw Error("{}: the stored views are damaged", dataset.folder.string());
    view.cloud = select(stored.clouds, indices);
    if (view.cloud.has_normals()) view.features = alignment_features(view.cloud);
    view_of_ids[{reference.model_id, reference.view_id}] = static_cast<int>(catalogue.views.size());
    catalogue.views.push_back(std::move(view));
  }

  catalogue.index = DescriptorIndex(static_cast<int>(stored.histograms.at(0).size()));
  for (const auto& histogram : stored.histograms) catalogue.index.add(histogram);
  for (const auto& reference : stored.references.descriptors)
    catalogue.descriptions.push_back(
        {view_of_ids.at({reference.model_id, reference.view_id}), reference.camera_from_reference});

  const float voxel = config.hypothesis_verification.model_representation_voxel_size;
  parallel_for(catalogue.parts.size(), [&](std::size_t p) {
    auto& part = catalogue.parts[p];
    for (const auto& view : catalogue.views)
      if (view.part == static_cast<int>(p))
        append(part.surface, transformed(view.cloud, (view.T2 * part.T1).inverse()));
    part.surface = voxel_grid(part.surface, voxel);
  });
  catalogue.dataset = std::move(dataset);
  return catalogue;
}

}  // namespace

PointCloud comparable_view(const PointCloud& view, const GlobalPipelineConfig& config) {
  PointCloud cloud = without_missing(view);
  if (config.database.normals == "mesh") {
    if (!cloud.empty() && !cloud.has_normals())
      throw Error("database.normals is \"mesh\", but the views have no normals");
    return cloud;
  }
  if (config.preprocessing.voxel_grid_flag) cloud = voxel_grid(cloud, config.preprocessing.voxel_size);
  return with_normals(std::move(cloud), config.normal_estimation);
}

Catalogue load_catalogue(Dataset dataset, const GlobalPipelineConfig& config, const Progress& progress) {
  config.check();
  refresh_dataset(dataset, progress);
  const Files files(dataset, config.global_descriptor);
  const Json depends_on = dependencies(dataset, config);
  if (is_current(files, depends_on)) {
    try {
      Stored stored{read_json<References>(files.references),
                    read_pcd_histograms(files.descriptors, config.global_descriptor), read_pcd(files.views)};
      if (stored.histograms.size() == stored.references.descriptors.size() && !stored.histograms.empty())
        return join(dataset, config, std::move(stored));
    } catch (const std::exception&) {
      // Damaged since it was written: computed again below.
    }
  }
  Stored stored = compute(dataset, config, progress);
  save(stored, files, config, depends_on);
  return join(std::move(dataset), config, std::move(stored));
}

Catalogue mesh_catalogue(Dataset dataset) {
  Catalogue catalogue;
  catalogue.parts = parts_of(dataset);
  for (std::size_t p = 0; p < catalogue.parts.size(); ++p)
    for (const auto& [T2, id] : dataset.out.views) catalogue.views.push_back({static_cast<int>(p), id, T2, {}, {}});
  catalogue.dataset = std::move(dataset);
  return catalogue;
}

Catalogue without_part(const Catalogue& catalogue, const std::string& name) {
  Catalogue out;
  out.dataset = catalogue.dataset;
  std::vector<int> part_of(catalogue.parts.size(), -1), view_of(catalogue.views.size(), -1);
  for (std::size_t p = 0; p < catalogue.parts.size(); ++p) {
    if (catalogue.parts[p].name == name) continue;
    part_of[p] = static_cast<int>(out.parts.size());
    out.parts.push_back(catalogue.parts[p]);
  }
  if (out.parts.size() == catalogue.parts.size()) throw Error("the catalogue has no part \"{}\"", name);
  if (out.parts.empty()) throw Error("\"{}\" is the catalogue's only part", name);
  for (std::size_t v = 0; v < catalogue.views.size(); ++v) {
    if (part_of[catalogue.views[v].part] < 0) continue;
    view_of[v] = static_cast<int>(out.views.size());
    out.views.push_back(catalogue.views[v]);
    out.views.back().part = part_of[catalogue.views[v].part];
  }
  out.index = DescriptorIndex(catalogue.index.bins());
  for (std::size_t row = 0; row < catalogue.descriptions.size(); ++row) {
    CatalogueDescription description = catalogue.descriptions[row];
    description.view = view_of[description.view];
    if (description.view < 0) continue;
    out.descriptions.push_back(description);
    out.index.add(catalogue.index.row(static_cast<int>(row)));
  }
  return out;
}

}  // namespace partpose
