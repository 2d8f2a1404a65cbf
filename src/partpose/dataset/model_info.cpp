// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/dataset/model_info.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/io/json.hpp"

#include <cmath>

namespace partpose {

namespace {

Eigen::Matrix4d matrix_of(const std::array<double, 16>& row_by_row) {
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(row_by_row.data());
}

/// To a nanometre or 1e-9, without the noise of the last digits and without minus zero.
double tidy(double value) { return std::round(value * 1e9) / 1e9 + 0.0; }

std::array<double, 3> tidy(const Eigen::Vector3d& v) { return {tidy(v.x()), tidy(v.y()), tidy(v.z())}; }

}  // namespace

void ModelSymmetries::check() const {
  // Files are written with few digits: what is nearly a rotation is made one when it is used.
  constexpr double tolerance = 1e-3;
  for (const auto& values : symmetries_discrete.value_or(std::vector<std::array<double, 16>>{}))
    if (!is_rigid(matrix_of(values), tolerance))
      throw Error("symmetries_discrete: not a rigid motion: expected 4x4 row by row, a rotation without reflection");
  for (const auto& entry : symmetries_continuous.value_or(std::vector<Continuous>{}))
    if (!(Eigen::Vector3d(entry.axis.data()).norm() > 1e-9))
      throw Error("symmetries_continuous: an axis without direction");
}

ModelSymmetries ModelSymmetries::of(const Symmetries& symmetries) {
  ModelSymmetries out;
  for (const auto& motion : symmetries.discrete) {
    if (!out.symmetries_discrete) out.symmetries_discrete.emplace();
    auto& values = out.symmetries_discrete->emplace_back();
    for (int i = 0; i < 16; ++i) values[i] = tidy(motion.matrix()(i / 4, i % 4));
  }
  for (const auto& [axis, offset_mm] : symmetries.continuous) {
    if (!out.symmetries_continuous) out.symmetries_continuous.emplace();
    out.symmetries_continuous->push_back({tidy(axis), tidy(offset_mm)});
  }
  return out;
}

ModelSymmetries ModelSymmetries::of(const SymmetrySearch& search) {
  ModelSymmetries out = of(search.found.symmetries);
  out.symmetry_tolerance_mm = tidy(search.tolerance_mm);
  out.symmetry_deviation_mm = tidy(search.found.largest_deviation_mm());
  return out;
}

Symmetries ModelSymmetries::symmetries() const {
  Symmetries out;
  for (const auto& values : symmetries_discrete.value_or(std::vector<std::array<double, 16>>{}))
    out.discrete.push_back(nearest_rigid(matrix_of(values)));
  for (const auto& [axis, offset] : symmetries_continuous.value_or(std::vector<Continuous>{}))
    out.continuous.push_back({Eigen::Vector3d(axis.data()).normalized(), Eigen::Vector3d(offset.data())});
  return out;
}

ModelInfo ModelInfo::of(const std::string& name, const TriangleMesh& mesh, const ModelSymmetries& symmetries) {
  const auto box = bounding_box(mesh);
  return {name,          partpose::diameter(mesh),  box.min().x(),   box.min().y(),
          box.min().z(), box.sizes().x(), box.sizes().y(), box.sizes().z(),
          symmetries};
}

std::map<std::string, ModelInfo> read_models_info(const std::filesystem::path& path) {
  const Json json = read_json_file(path);
  if (!json.is_object()) throw Error("{}: expected an object with a model's number or name as key", path.string());
  std::map<std::string, ModelInfo> infos;
  for (const auto& [key, value] : json.items()) {
    try {
      infos[key] = from_json<ModelInfo>(value);
    } catch (const Error& error) {
      throw Error("{}: {}: {}", path.string(), key, error.what());
    }
  }
  return infos;
}

}  // namespace partpose
