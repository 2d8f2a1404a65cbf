// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// partpose's Engine as a peer, as the experiments construct it. A frame without a table is the protocol's cloud.
#include "peer.hpp"

#include "partpose/core/parallel.hpp"
#include "partpose/engine/engine.hpp"
#include "partpose/io/mesh_files.hpp"
#include "partpose/io/pcd.hpp"

namespace {

partpose::Scene load(const peers::Json& frame) {
  partpose::Scene scene;
  if (!frame.at("cloud").is_null()) {
    scene.path = frame.at("cloud").get<std::string>();
    scene.cloud = partpose::read_pcd(scene.path);
    return scene;
  }
  scene.path = frame.at("depth").get<std::string>();
  scene.depth.emplace(frame.at("width").get<int>(), frame.at("height").get<int>());
  scene.depth->z_mm = peers::read_depth(frame);
  scene.intrinsics = partpose::Intrinsics{frame.at("width"), frame.at("height"), frame.at("fx"),
                                          frame.at("fy"),    frame.at("cx"),     frame.at("cy")};
  scene.cloud = partpose::to_point_cloud(*scene.depth, *scene.intrinsics);
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "peers_partpose setup.json\n";
    return 2;
  }
  try {
    const partpose::ThreadLimit one_thread(1);
    const double began = peers::wall_ms();
    const peers::Json setup = peers::read_json(argv[1]);
    std::vector<partpose::NamedMesh> parts;
    for (const auto& part : setup.at("parts")) {
      parts.push_back(partpose::read_meshes(part.at("stl").get<std::string>()).at(0));
      parts.back().name = part.at("name").get<std::string>();
    }
    const partpose::Engine engine(parts);
    peers::answer_frames(
        load,
        [&](const partpose::Scene& scene) -> std::optional<peers::Found> {
          const partpose::Recognition r = engine.recognize(scene);
          if (r.accepted < 0) return std::nullopt;
          return peers::Found{r.result.model_name, r.result.T_final, r.candidates[r.accepted].score};
        },
        began);
  } catch (const std::exception& error) {
    std::cerr << "peers_partpose: " << error.what() << '\n';
    return 1;
  }
}
