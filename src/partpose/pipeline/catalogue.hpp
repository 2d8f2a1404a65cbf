// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"
#include "partpose/core/progress.hpp"
#include "partpose/dataset/dataset.hpp"
#include "partpose/matching/descriptor_index.hpp"
#include "partpose/pipeline/config.hpp"

#include <optional>
#include <string>
#include <vector>

namespace partpose {

struct CataloguePart {
  int id = 0;
  std::string name;
  Eigen::Isometry3d T1 = Eigen::Isometry3d::Identity();  ///< centred_from_model
  TriangleMesh mesh;                                     ///< model frame
  PointCloud surface;                                    ///< all views fused, model frame, with normals
};

struct CatalogueView {
  int part = 0;                                          ///< index into Catalogue::parts
  int id = 0;                                            ///< of the dataset's view
  Eigen::Isometry3d T2 = Eigen::Isometry3d::Identity();  ///< camera_from_centred
  PointCloud cloud;                                      ///< for the refinement, camera frame, with normals
  AlignmentFeatures features;                            ///< of `cloud`
  int num_of_points = 0;                                 ///< of the view in the dataset
};

/// One row of the index: a descriptor of a view. A clustered descriptor has several for a view.
struct CatalogueDescription {
  int view = 0;                                            ///< index into Catalogue::views
  std::optional<Eigen::Isometry3d> camera_from_reference;  ///< the descriptor's reference frame in the view, if any
};

/// Everything that the online stage needs to know of the parts, in memory.
struct Catalogue {
  Dataset dataset;
  std::vector<CataloguePart> parts;
  std::vector<CatalogueView> views;
  DescriptorIndex index{1};
  std::vector<CatalogueDescription> descriptions;  ///< one for each row of the index
};

/// The offline stage: descriptors and refinement clouds of all views, kept in the dataset's descriptors/ folder and
/// used again while nothing that they depend on has changed: the configuration's sections concerned, the dataset, the
/// meshes. Views of a changed mesh.stl are rendered again first.
Catalogue load_catalogue(Dataset dataset, const GlobalPipelineConfig& config, const Progress& progress = {});

/// The dataset's meshes, and from where its views were taken: what the Engine needs. Nothing is described or kept.
Catalogue mesh_catalogue(Dataset dataset);

/// The same catalogue without one of its parts. Throws Error when it has no part of that name, or no other.
Catalogue without_part(const Catalogue& catalogue, const std::string& name);

/// Points and normals of a dataset's view as a scene of it would have them (`database.normals`), camera frame.
PointCloud comparable_view(const PointCloud& view, const GlobalPipelineConfig& config);

}  // namespace partpose
