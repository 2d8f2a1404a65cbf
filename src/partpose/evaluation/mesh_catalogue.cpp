// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/evaluation/mesh_catalogue.hpp"

#include "partpose/camera/virtual_depth_camera.hpp"

#include <utility>

namespace partpose {

Catalogue mesh_catalogue(std::vector<NamedMesh> parts) {
  Catalogue catalogue;
  for (auto& part : parts) {
    CataloguePart entry;
    entry.id = static_cast<int>(catalogue.parts.size()) + 1;
    entry.name = std::move(part.name);
    const Eigen::AlignedBox3d box = bounding_box(part.mesh);
    entry.T1.translation() = -box.center();
    entry.mesh = std::move(part.mesh);
    CatalogueView view;
    view.part = static_cast<int>(catalogue.parts.size());
    view.T2 = look_at({5 * box.diagonal().norm(), 0, 0}, Eigen::Vector3d::Zero()).inverse();
    catalogue.views.push_back(std::move(view));
    catalogue.parts.push_back(std::move(entry));
  }
  return catalogue;
}

}  // namespace partpose
