// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/verification/render_compare.hpp"

#include "partpose/camera/rasterizer.hpp"

#include <algorithm>

namespace partpose {

namespace {

/// The lowest cost of a depth against those of a pixel and its neighbours that `counts`; more than 1 when none does.
template <typename Counts>
double lowest_cost(float z_mm, int u, int v, const DepthImage& other, float tolerance_mm, const Counts& counts) {
  double lowest = 2;
  for (int vv = std::max(v - 1, 0); vv <= std::min(v + 1, other.height - 1); ++vv) {
    for (int uu = std::max(u - 1, 0); uu <= std::min(u + 1, other.width - 1); ++uu) {
      if (!counts(static_cast<std::size_t>(vv) * other.width + uu)) continue;
      const double relative = (z_mm - other.at(uu, vv)) / tolerance_mm;
      lowest = std::min(lowest, std::min(relative * relative, 1.0));
    }
  }
  return lowest;
}

}  // namespace

double RenderComparison::score() const {
  const int judged = model + object;
  return judged > 0 ? 1.0 - cost / judged : 0.0;
}

RenderComparison render_and_compare(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                                    const LabelledDepth& frame, const RenderCompareOptions& options) {
  const DepthImage rendered = render_depth(mesh, camera_from_model, frame.camera);
  const auto is_object = [&](std::size_t p) { return frame.label[p] == PixelLabel::object; };
  const auto is_model = [&](std::size_t p) { return rendered.z_mm[p] > 0; };
  RenderComparison out;
  for (int v = 0; v < rendered.height; ++v) {
    for (int u = 0; u < rendered.width; ++u) {
      const std::size_t p = static_cast<std::size_t>(v) * rendered.width + u;
      const float model_z = rendered.z_mm[p], measured_z = frame.depth.z_mm[p];
      if (is_model(p)) {
        ++out.model;
        double cost = lowest_cost(model_z, u, v, frame.depth, options.tolerance_mm, is_object);
        if (frame.label[p] == PixelLabel::background) {
          const bool before = model_z < measured_z - options.tolerance_mm;
          cost = std::min(cost, before ? 1.0 : static_cast<double>(options.hidden_cost));
          ++(before ? out.free_space : out.hidden);
        } else if (frame.label[p] == PixelLabel::nothing) {
          cost = std::min(cost, static_cast<double>(options.nothing_cost));
          ++out.nothing;
        }
        out.cost += std::min(cost, 1.0);
      }
      if (is_object(p)) {
        ++out.object;
        const double cost = lowest_cost(measured_z, u, v, rendered, options.tolerance_mm, is_model);
        out.unexplained += cost > 1;
        out.cost += std::min(cost, 1.0);
      }
    }
  }
  return out;
}

}  // namespace partpose
