// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/off.hpp"

#include "partpose/io/file.hpp"
#include "partpose/io/text_reader.hpp"

#include <cmath>
#include <limits>
#include <string>

namespace partpose {

namespace {

constexpr std::size_t largest_count = std::numeric_limits<int>::max();

std::string without_comments(std::string text) {
  bool in_comment = false;
  for (char& c : text) {
    if (c == '\n') in_comment = false;
    if (c == '#') in_comment = true;
    if (in_comment) c = ' ';  // so that bytes stay what they are
  }
  return text;
}

std::string_view needed(TextReader& text, const char* what) {
  const auto word = text.word();
  if (word.empty()) text.fail("the file ends here, {} expected: truncated", what);
  return word;
}

std::size_t read_count(TextReader& text, const char* what, std::size_t largest = largest_count) {
  const auto word = needed(text, what);
  const auto count = parse_count(word, largest);
  if (!count) text.fail("{}, {} from 0 to {} expected", in_quotes(word), what, largest);
  return *count;
}

}  // namespace

TriangleMesh read_off(const std::filesystem::path& path) {
  const std::string bytes = without_comments(read_file(path));
  const std::string name = path.string();
  TextReader text(bytes, name);
  const auto header = needed(text, "'OFF'");
  bool known = false;
  for (const char* kind : {"OFF", "COFF", "NOFF", "CNOFF"}) known = known || header == kind;
  if (!known) text.fail("{} where 'OFF' is expected", in_quotes(header));
  const std::size_t vertices = read_count(text, "the number of vertices");
  const std::size_t faces = read_count(text, "the number of faces");
  text.skip_line();  // the number of edges, which nobody counts

  TriangleMesh mesh;
  for (std::size_t v = 0; v < vertices; ++v) {
    Eigen::Vector3f& vertex = mesh.vertices.emplace_back();
    for (float& coordinate : vertex) {
      const auto word = needed(text, "a coordinate");
      const auto mm = parse_float(word);
      if (!mm || !std::isfinite(*mm)) text.fail("{} where a coordinate is expected", in_quotes(word));
      coordinate = *mm;
    }
    text.skip_line();
  }
  for (std::size_t f = 0; f < faces; ++f) {
    const std::size_t corners = read_count(text, "the number of corners");
    std::array<int, 3> triangle{};
    for (std::size_t k = 0; k < corners; ++k) {
      const auto word = needed(text, "a corner");
      const auto corner = parse_count(word, largest_count);
      if (!corner || *corner >= vertices)
        text.fail("{} where a corner from 0 to {} is expected: there are {} vertices", in_quotes(word),
                  vertices == 0 ? 0 : vertices - 1, vertices);
      triangle[std::min<std::size_t>(k, 2)] = static_cast<int>(*corner);
      if (k < 2) continue;
      mesh.triangles.push_back(triangle);
      triangle[1] = triangle[2];
    }
    text.skip_line();
  }
  if (mesh.triangles.empty()) throw Error("{}: has no triangles", name);
  return with_merged_vertices(mesh);
}

}  // namespace partpose
