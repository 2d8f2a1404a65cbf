// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/verification/render_compare.hpp"

#include "partpose/camera/rasterizer.hpp"

#include <algorithm>

namespace partpose {

double RenderComparison::score() const {
  const double judged = explained + cost;
  return judged > 0 ? explained / judged : 0.0;
}

RenderComparison render_and_compare(const TriangleMesh& mesh, const Eigen::Isometry3d& camera_from_model,
                                    const LabelledDepth& frame, const RenderCompareOptions& options) {
  const DepthImage rendered = render(mesh, camera_from_model, frame.camera).depth;
  RenderComparison out;
  for (std::size_t p = 0; p < rendered.z_mm.size(); ++p) {
    const float model_z = rendered.z_mm[p], measured_z = frame.depth.z_mm[p];
    const PixelLabel label = frame.label[p];
    if (model_z > 0) {
      if (label == PixelLabel::object) {
        const double relative = (model_z - measured_z) / options.tolerance_mm;
        const double cost = std::min(relative * relative, 1.0);
        ++out.both;
        out.cost += cost;
        out.explained += 1 - cost;
      } else if (label == PixelLabel::background) {
        if (model_z < measured_z - options.tolerance_mm) {
          ++out.free_space;
          out.cost += 1;
        } else {
          ++out.hidden;
        }
      } else {
        ++out.nothing;
        out.cost += options.nothing_cost;
      }
    } else if (label == PixelLabel::object) {
      ++out.unexplained;
      out.cost += 1;
    }
  }
  return out;
}

}  // namespace partpose
