// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include <partpose/partpose.hpp>

#include <iostream>

/// consumer PARTS_FOLDER SCENE CACHE_FOLDER: prints the part's name.
int main(int argc, char** argv) {
  if (argc != 4) return 1;
  const partpose::Recognizer recognizer(partpose::cached_catalogue(
      partpose::model_files(argv[1]), {}, partpose::Recognizer::catalogue_config(), argv[3]));
  const partpose::Scene scene = partpose::read_scene(argv[2]);
  const auto recognition = recognizer.recognize(*scene.depth, *scene.intrinsics);
  std::cout << recognition.result.model_name << "\n" << recognition.result.T_final.matrix() << "\n";
  return recognition.result.model_name == "bracket" ? 0 : 1;
}
