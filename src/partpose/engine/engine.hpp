// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/mesh_files.hpp"
#include "partpose/pipeline/recognition.hpp"

#include <memory>
#include <string>
#include <vector>

namespace partpose {

/// What the Engine may be told; the defaults are meant for all parts and cameras.
struct EngineOptions {
  /// A part is believed when the probability that it is what is seen, by how they explain each other, is at least this,
  /// 0 to 1.
  float min_score = 0.5f;

  void check() const;
};

/// Recognizes parts by their shape alone, within a camera's frame time: the frame's objects are compared as small depth
/// templates with every view of every part at every turn, the best are put onto the surface by its distance field, and
/// rendering them decides, by the noise that the frame itself shows (docs/engine.md). `recognize` is thread-safe.
class Engine final : public PartRecognizer {
 public:
  /// Of a catalogue only the parts' meshes are used, and its views to say from which side a part is seen.
  explicit Engine(Catalogue catalogue, EngineOptions options = {});
  /// All that is needed is made of the meshes, in some hundredths of a second for each.
  explicit Engine(const std::vector<NamedMesh>& parts, EngineOptions options = {});
  ~Engine() override;

  /// One more part; the others are not touched. Throws Error when there is one of that name. Not while another thread
  /// recognizes.
  void add(const NamedMesh& part);
  /// Throws Error when there is no part of that name, or no other. Not while another thread recognizes.
  void remove(const std::string& name);

  /// A full depth frame, or a part of one.
  Recognition recognize(const DepthImage& depth, const Intrinsics& camera) const;
  /// A cloud in mm, taken by a camera at the origin that looks along z: the part alone, or with the table in it.
  Recognition recognize(const PointCloud& cloud) const;
  /// The depth image where the scene has one, its cloud otherwise.
  Recognition recognize(const Scene& scene) const override;

  const Catalogue& catalogue() const override;

  /// What one part takes in memory beside its mesh.
  std::size_t memory_bytes(int part) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A catalogue of meshes alone, each with one view, from the front: what an Engine needs.
Catalogue mesh_catalogue(const std::vector<NamedMesh>& parts);

}  // namespace partpose
