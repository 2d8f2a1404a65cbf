// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// What PCL 1.13 offers under the names of our descriptors. Nothing of PCL is in this header.
#pragma once

#include <memory>
#include <string>

/// The options that both sides are given; lengths in mm.
struct PeerOptions {
  int min_points = 200;
  float tolerance = 9;
  float eps_angle_rad = 0.35f;
  float radius_normals = 9;
  float curvature_threshold = 0.03f;
};

/// One cloud in PCL's own layout, so that the conversion is not timed.
class PclPeers {
 public:
  /// `xyz` and `normals` have three numbers a point.
  PclPeers(const float* xyz, const float* normals, const float* curvatures, std::size_t count);
  ~PclPeers();
  PclPeers(PclPeers&&) noexcept;
  static bool has(const std::string& descriptor);
  /// Computes the descriptor once and returns how many histograms there are.
  int run(const std::string& descriptor, const PeerOptions& options) const;

 private:
  struct Clouds;
  std::unique_ptr<Clouds> clouds_;
};
