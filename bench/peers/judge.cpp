// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// Judges the answers of all peers by the same code: peers_judge WORK <answers.jsonl >judged.jsonl
#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/evaluation/pose_judge.hpp"
#include "partpose/io/json.hpp"
#include "partpose/pipeline/recognizer.hpp"

#include <fstream>
#include <iostream>
#include <map>

namespace partpose {
namespace {

Eigen::Isometry3d pose_of(const Json& numbers) {
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = numbers.at(i).get<double>();
  return nearest_rigid(matrix);
}

DepthImage read_depth(const Json& frame) {
  DepthImage depth(frame.at("width").get<int>(), frame.at("height").get<int>());
  std::ifstream in(frame.at("depth").get<std::string>(), std::ios::binary);
  in.read(reinterpret_cast<char*>(depth.z_mm.data()),
          static_cast<std::streamsize>(depth.z_mm.size() * sizeof(float)));
  if (!in) throw Error("{}: too short", frame.at("depth").get<std::string>());
  return depth;
}

void judge(const std::filesystem::path& work) {
  const Json setup = read_json_file(work / "setup.json"), truths = read_json_file(work / "truths.json");
  std::map<std::string, Json> frames;
  for (const auto& frame : read_json_file(work / "frames.json")) frames[frame.at("name")] = frame;
  const PoseJudge judge(
      load_catalogue(open_dataset(setup.at("database").get<std::string>()), Recognizer::catalogue_config()));

  std::string line;
  while (std::getline(std::cin, line)) {
    Json answer = Json::parse(line);
    const Json &frame = frames.at(answer.at("frame")), &stated = truths.at(answer.at("frame").get<std::string>());
    const GroundTruth truth{stated.at("part"), pose_of(stated.at("T")), 0, 0};
    const Intrinsics camera{frame.at("width"), frame.at("height"), frame.at("fx"),
                            frame.at("fy"),    frame.at("cx"),     frame.at("cy")};
    const JudgedFrame judged{camera, read_depth(frame), from_json<AmbiguityOptions>(stated.at("noise"))};
    Result result;
    if (!answer.at("part").is_null()) {
      result.candidate_id = 0;
      result.model_name = answer.at("part");
      result.T_final = pose_of(answer.at("T"));
    }
    const Evaluation e = judge.judge(result, truth, judged);
    const bool accepted = result.candidate_id >= 0, right = e.recognized_correctly;
    const bool same_to_the_camera = accepted && e.indistinguishable.value_or(false);
    answer["truth"] = truth.model_name;
    answer["recognized"] = right;
    answer["wrong"] = accepted && !right;
    answer["pose_right"] = same_to_the_camera || (right && mssd_below(e, 0.10));
    answer["mssd_below_10"] = right && mssd_below(e, 0.10);
    answer["mssd_below_5"] = right && mssd_below(e, 0.05);
    answer["within_15_deg_15_mm"] = right && e.rotation_error_deg < 15 && e.translation_error_mm < 15;
    if (e.mssd_mm) answer["mssd_mm"] = *e.mssd_mm;
    answer["rotation_error_deg"] = e.rotation_error_deg;
    answer["translation_error_mm"] = e.translation_error_mm;
    std::cout << json_line(answer) << '\n';
  }
}

}  // namespace
}  // namespace partpose

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "peers_judge WORK <answers.jsonl >judged.jsonl\n";
    return 2;
  }
  try {
    partpose::judge(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << "peers_judge: " << error.what() << '\n';
    return 1;
  }
}
