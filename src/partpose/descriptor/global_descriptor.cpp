// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/global_descriptor.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/text.hpp"
#include "partpose/descriptor/vfh.hpp"

#include <array>

namespace partpose {

namespace {

void check_neighbours(int k_nn) {
  if (k_nn < 1) throw Error("k_nn {}: must be 1 or more", k_nn);
}

class Vfh final : public GlobalDescriptor {
 public:
  explicit Vfh(const VfhOptions& options) : options_(options) {}
  int bins() const override { return vfh_bins; }
  std::vector<Description> describe(const PointCloud& cloud) const override {
    if (cloud.empty()) return {};
    return {Description{vfh(cloud, options_)}};
  }

 private:
  VfhOptions options_;
};

const std::array<std::string, 5> names = {"vfh", "cvfh", "ourcvfh", "good", "esf"};

}  // namespace

void VfhOptions::check() const { check_neighbours(k_nn); }

void CvfhOptions::check() const {
  check_neighbours(k_nn);
  if (min_points < 1) throw Error("min_points {}: must be 1 or more", min_points);
  if (!(cluster_tolerance_distance > 0))
    throw Error("cluster_tolerance_distance {}: must be positive", cluster_tolerance_distance);
  if (!(eps_angle_threshold_deg > 0)) throw Error("eps_angle_threshold_deg {}: must be positive", eps_angle_threshold_deg);
  if (!(radius_normals > 0)) throw Error("radius_normals {}: must be positive", radius_normals);
}

void EsfOptions::check() const { check_neighbours(k_nn); }

void GoodOptions::check() const {
  check_neighbours(k_nn);
  if (num_of_bins < 1) throw Error("num_of_bins {}: must be 1 or more", num_of_bins);
  if (!(threshold >= 0)) throw Error("threshold {}: must be 0 or more", threshold);
}

std::unique_ptr<GlobalDescriptor> make_global_descriptor(const std::string& name, const DescriptorOptions& options) {
  if (name == "vfh") return std::make_unique<Vfh>(options.vfh);
  for (const auto& known : names)
    if (name == known) throw Error("global_descriptor \"{}\" is not in this version yet; use \"vfh\"", name);
  throw Error("global_descriptor \"{}\" is unknown; did you mean \"{}\"?", name, nearest_word(name, names));
}

int neighbours_of(const std::string& name, const DescriptorOptions& options) {
  if (name == "cvfh") return options.cvfh.k_nn;
  if (name == "ourcvfh") return options.ourcvfh.k_nn;
  if (name == "esf") return options.esf.k_nn;
  if (name == "good") return options.good.k_nn;
  return options.vfh.k_nn;
}

}  // namespace partpose
