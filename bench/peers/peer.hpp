// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// How a peer is asked: it reads setup.json, says {"ready": ...} and answers each frame, one JSON line on standard input
// with the scene's keys, by one JSON line on standard output. See README.md.
#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace peers {

using Json = nlohmann::json;

inline Json read_json(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path + ": cannot be read");
  return Json::parse(in);
}

inline Eigen::Isometry3d pose_of(const Json& json) {
  Eigen::Isometry3d pose;
  for (int i = 0; i < 16; ++i) pose.matrix()(i / 4, i % 4) = json.at(i).get<double>();
  return pose;
}

inline std::vector<float> read_depth(const Json& frame) {
  const auto path = frame.at("depth").get<std::string>();
  std::vector<float> depth(frame.at("width").get<std::size_t>() * frame.at("height").get<std::size_t>());
  std::ifstream in(path, std::ios::binary);
  in.read(reinterpret_cast<char*>(depth.data()), static_cast<std::streamsize>(depth.size() * sizeof(float)));
  if (!in) throw std::runtime_error(path + ": not the depth image of " + frame.at("name").get<std::string>());
  return depth;
}

struct Found {
  std::string part;
  Eigen::Isometry3d camera_from_model;
  double score = 0;
};

inline double wall_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Of the whole process: threads that a library starts of its own accord count as well.
inline double cpu_ms() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Answers until standard input ends. `load(frame)` is not timed, `recognize(loaded)` is: three times where that takes
/// no more than about a second, and the median counts.
template <typename Load, typename Recognize>
void answer_frames(const Load& load, const Recognize& recognize, double setup_began_ms) {
  std::cout << Json{{"ready", true}, {"setup_s", (wall_ms() - setup_began_ms) / 1e3}} << std::endl;
  std::string line;
  while (std::getline(std::cin, line)) {
    const Json frame = Json::parse(line);
    auto loaded = load(frame);
    std::vector<double> wall, cpu;
    std::optional<Found> found;
    double spent = 0;
    for (int run = 0; run < 3 && spent < 500; ++run) {
      const double wall_begin = wall_ms(), cpu_begin = cpu_ms();
      std::optional<Found> result = recognize(loaded);
      wall.push_back(wall_ms() - wall_begin);
      cpu.push_back(cpu_ms() - cpu_begin);
      spent += wall.back();
      if (run == 0) found = std::move(result);
    }
    Json answer = {{"frame", frame.at("name")}, {"part", nullptr}, {"ms", median(wall)}, {"cpu_ms", median(cpu)}};
    if (found) {
      answer["part"] = found->part;
      answer["score"] = found->score;
      for (int i = 0; i < 16; ++i) answer["T"].push_back(found->camera_from_model.matrix()(i / 4, i % 4));
    }
    std::cout << answer << std::endl;
  }
}

}  // namespace peers
