// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/mesh.hpp"
#include "partpose/geometry/symmetries.hpp"
#include "partpose/geometry/symmetry_search.hpp"

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace partpose {

/// A part's symmetries with the keys of BOP's models_info.json, and two of ours that say how they were found.
struct ModelSymmetries {
  struct Continuous {
    std::array<double, 3> axis = {0, 0, 0};
    std::array<double, 3> offset = {0, 0, 0};

    static constexpr bool all_keys_required = true;
    template <typename Self, typename Visit>
    static void describe(Self& self, Visit&& visit) {
      visit("axis", self.axis, "direction of the axis, model frame");
      visit("offset", self.offset, "a point on it [mm]");
    }
  };
  std::optional<std::vector<std::array<double, 16>>> symmetries_discrete;
  std::optional<std::vector<Continuous>> symmetries_continuous;
  std::optional<double> symmetry_tolerance_mm;
  std::optional<double> symmetry_deviation_mm;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("symmetries_discrete", self.symmetries_discrete,
          "motions that map the part onto itself, 4x4 row by row [mm], model frame, without the identity");
    visit("symmetries_continuous", self.symmetries_continuous, "axes about which it may be turned by any angle");
    visit("symmetry_tolerance_mm", self.symmetry_tolerance_mm, "found in the mesh with this tolerance; absent: given");
    visit("symmetry_deviation_mm", self.symmetry_deviation_mm, "largest distance of the surface to its moved copy");
  }
  /// Throws Error when a motion is not rigid or an axis has no direction.
  void check() const;

  static ModelSymmetries of(const Symmetries& symmetries);
  static ModelSymmetries of(const SymmetrySearch& search);
  Symmetries symmetries() const;
};

/// A model's entry of models_info.json. Sizes are not needed to give symmetries.
struct ModelInfo {
  std::optional<std::string> name;  ///< ours; others know models by their number alone
  std::optional<double> diameter;   ///< largest distance of two vertices
  std::optional<double> min_x, min_y, min_z, size_x, size_y, size_z;
  ModelSymmetries symmetries;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("name", self.name, "the part's name");
    visit("diameter", self.diameter, "largest distance of two vertices [mm]");
    visit("min_x", self.min_x, "lower end of the bounding box [mm]");
    visit("min_y", self.min_y, "");
    visit("min_z", self.min_z, "");
    visit("size_x", self.size_x, "its size [mm]");
    visit("size_y", self.size_y, "");
    visit("size_z", self.size_z, "");
    ModelSymmetries::describe(self.symmetries, visit);
  }
  void check() const { symmetries.check(); }

  static ModelInfo of(const std::string& name, const TriangleMesh& mesh, const ModelSymmetries& symmetries);
};

/// A models_info.json: entries by the model's number, or, in files of ours, by its name. Throws Error naming file and
/// key; unknown keys are errors, too: a misspelt symmetry would be none.
std::map<std::string, ModelInfo> read_models_info(const std::filesystem::path& path);

}  // namespace partpose
