// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/stl.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/bytes.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/text_reader.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

namespace partpose {

namespace {

constexpr std::size_t header_bytes = 80;
constexpr std::size_t first_triangle = 84;  // behind the header and the 32-bit number of triangles
constexpr std::size_t triangle_bytes = 50;  // normal and three corners, 3 floats each, and a 16-bit attribute
constexpr std::size_t normal_bytes = 12;
constexpr float largest_mm = 1e6f;

struct Facets {
  std::vector<Eigen::Vector3f> corners;  ///< three in a row are a triangle
  std::vector<Eigen::Vector3f> normals;  ///< as stored, NaN where there is no number
};

/// Why a coordinate cannot be used, or nothing.
std::string complaint_about(float mm) {
  if (!std::isfinite(mm)) return fmt::format("coordinate {} is not finite", mm);
  if (std::abs(mm) > largest_mm) return fmt::format("coordinate {} mm is beyond {} mm: wrong units?", mm, largest_mm);
  return {};
}

TriangleMesh mesh_from(std::vector<Eigen::Vector3f> corners, std::string_view name) {
  if (corners.size() > std::numeric_limits<int>::max())
    throw Error("{}: {} triangles, at most {} can be read", name, corners.size() / 3,
                std::numeric_limits<int>::max() / 3);
  TriangleMesh mesh;
  mesh.vertices = std::move(corners);
  mesh.triangles.resize(mesh.vertices.size() / 3);
  for (int next = 0; auto& triangle : mesh.triangles)
    for (int& index : triangle) index = next++;
  mesh = with_merged_vertices(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (!mesh.face_normal(t).isZero()) return mesh;
  throw Error("{}: none of the {} triangles has an area", name, mesh.triangles.size());
}

std::uint64_t binary_size(std::uint32_t triangles) {
  return first_triangle + triangle_bytes * std::uint64_t{triangles};
}

Facets parse_binary(std::string_view bytes, std::string_view name) {
  if (bytes.size() < first_triangle)
    throw Error(
        "{}: byte {}: the file ends here, a binary STL has at least {} bytes and an ASCII one begins with 'solid'",
        name, bytes.size(), first_triangle);
  const auto count = load<std::uint32_t>(bytes, header_bytes);
  if (bytes.size() != binary_size(count))
    throw Error("{}: byte {}: header says {} triangles ({} bytes), the file has {} bytes: {} or not an STL", name,
                header_bytes, count, binary_size(count), bytes.size(),
                bytes.size() < binary_size(count) ? "truncated" : "too long");
  if (count == 0) throw Error("{}: byte {}: empty, header says 0 triangles", name, header_bytes);

  Facets facets;
  facets.corners.reserve(3 * std::size_t{count});
  facets.normals.reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    Eigen::Vector3f& normal = facets.normals.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis)
      normal[axis] = load<float>(bytes, first_triangle + triangle_bytes * t + 4 * axis);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Eigen::Vector3f& vertex = facets.corners.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t offset = first_triangle + triangle_bytes * t + normal_bytes + 12 * corner + 4 * axis;
        vertex[axis] = load<float>(bytes, offset);
        if (const auto complaint = complaint_about(vertex[axis]); !complaint.empty())
          throw Error("{}: byte {}: triangle {}: {}", name, offset, t, complaint);
      }
    }
  }
  return facets;
}

bool is_ascii(std::string_view bytes) {
  // Some binary files' headers begin with "solid", too; their size, and zero bytes that no text has, tell.
  constexpr std::size_t sample = 512;
  if (bytes.size() >= first_triangle && bytes.size() == binary_size(load<std::uint32_t>(bytes, header_bytes)))
    return false;
  return equal_ignoring_case(TextReader(bytes, "").word(), "solid") &&
         bytes.substr(0, sample).find('\0') == std::string_view::npos;
}

void expect(TextReader& text, std::string_view keyword) {
  const auto word = text.word();
  if (word.empty()) text.fail("the file ends here, '{}' expected: truncated", keyword);
  if (!equal_ignoring_case(word, keyword)) text.fail("{} where '{}' is expected", in_quotes(word), keyword);
}

float read_coordinate(TextReader& text) {
  const auto word = text.word();
  if (word.empty()) text.fail("the file ends here, a coordinate expected: truncated");
  const auto mm = parse_float(word);
  if (!mm) text.fail("{} where a coordinate is expected", in_quotes(word));
  if (const auto complaint = complaint_about(*mm); !complaint.empty()) text.fail("{}", complaint);
  return *mm;
}

/// The part of a facet behind the word "facet".
void parse_facet(TextReader& text, Facets& facets) {
  expect(text, "normal");
  Eigen::Vector3f& normal = facets.normals.emplace_back();
  for (float& component : normal)  // whatever it is
    component = parse_float(text.word()).value_or(std::numeric_limits<float>::quiet_NaN());
  expect(text, "outer");
  expect(text, "loop");
  for (int corner = 0; corner < 3; ++corner) {
    expect(text, "vertex");
    Eigen::Vector3f& vertex = facets.corners.emplace_back();
    for (float& coordinate : vertex) coordinate = read_coordinate(text);
  }
  expect(text, "endloop");
  expect(text, "endfacet");
}

Facets parse_ascii(std::string_view bytes, std::string_view name) {
  Facets facets;
  TextReader text(bytes, name);
  do {
    expect(text, "solid");
    text.skip_line();  // the solid's name may have spaces
    while (true) {
      const auto word = text.word();
      if (word.empty()) text.fail("the file ends here, 'facet' or 'endsolid' expected: truncated");
      if (equal_ignoring_case(word, "endsolid")) break;
      if (!equal_ignoring_case(word, "facet")) text.fail("{} where 'facet' or 'endsolid' is expected", in_quotes(word));
      parse_facet(text, facets);
    }
    text.skip_line();
  } while (!text.at_end());
  if (facets.corners.empty()) throw Error("{}: empty, no facet before the end of the file", text.place());
  return facets;
}

Facets parse(std::string_view bytes, std::string_view name) {
  return is_ascii(bytes) ? parse_ascii(bytes, name) : parse_binary(bytes, name);
}

}  // namespace

TriangleMesh read_stl(const std::filesystem::path& path) { return parse_stl(read_file(path), path.string()); }

TriangleMesh parse_stl(std::string_view bytes, std::string_view name) {
  return mesh_from(parse(bytes, name).corners, name);
}

StlNormals stl_normals(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  Facets facets = parse(bytes, path.string());
  const auto normals = std::move(facets.normals);
  const TriangleMesh mesh = mesh_from(std::move(facets.corners), path.string());
  StlNormals found;
  for (std::size_t t = 0; t < normals.size(); ++t) {
    const Eigen::Vector3f by_winding = mesh.face_normal(t);
    if (by_winding.isZero()) continue;
    if (!normals[t].allFinite() || normals[t].isZero(0))
      ++found.missing;
    else
      found.against += normals[t].cast<double>().dot(by_winding.cast<double>()) < 0;
  }
  return found;
}

void write_stl(const std::filesystem::path& path, const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw Error("{}: a mesh without triangles cannot be written as STL", path.string());
  std::string bytes = "binary STL, millimetres";
  bytes.resize(header_bytes, ' ');
  bytes.reserve(binary_size(mesh.triangles.size()));
  store(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const int index : mesh.triangles[t])
      if (index < 0 || index >= mesh.vertices.size())
        throw Error("{}: triangle {} has vertex {}, the mesh has {} vertices", path.string(), t, index,
                    mesh.vertices.size());
    store(bytes, mesh.face_normal(t));
    for (const int index : mesh.triangles[t]) {
      for (const float mm : mesh.vertices[index])
        if (const auto complaint = complaint_about(mm); !complaint.empty())
          throw Error("{}: triangle {}: {}", path.string(), t, complaint);
      store(bytes, mesh.vertices[index]);
    }
    store(bytes, std::uint16_t{0});
  }
  write_file_atomically(path, bytes);
}

}  // namespace partpose
