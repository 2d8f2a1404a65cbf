// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/ply.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/bytes.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/point_layout.hpp"
#include "partpose/io/text_reader.hpp"

#include <fmt/ranges.h>

#include <limits>
#include <optional>

namespace partpose {

namespace {

constexpr PointNames names = {"x", "y", "z", "nx", "ny", "nz", "curvature"};

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
constexpr std::array<std::string_view, 8> type_names = {"int8",  "uint8",  "int16",   "uint16",
                                                        "int32", "uint32", "float32", "float64"};
constexpr std::array<std::string_view, 8> old_type_names = {"char", "uchar", "short", "ushort",
                                                            "int",  "uint",  "float", "double"};
constexpr std::array<std::size_t, 8> type_sizes = {1, 1, 2, 2, 4, 4, 4, 8};
constexpr std::array<std::string_view, 3> format_names = {"ascii", "binary_little_endian", "binary_big_endian"};

std::size_t size_of(Type type) { return type_sizes[static_cast<std::size_t>(type)]; }

struct Property {
  std::string_view name;
  Type type;
  std::optional<Type> count_type;  ///< of a list
  int target = -1;                 ///< which of PointLayout's numbers it is, if any
};

struct Element {
  std::string_view name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  std::string_view format;
  std::vector<Element> elements;
  std::size_t vertex = 0;  ///< index of that element
  PointLayout layout;
  std::size_t data_begin = 0;
};

Type parse_type(const TextReader& text, std::string_view word) {
  for (const auto& known : {type_names, old_type_names})
    if (const auto found = std::ranges::find(known, word); found != known.end())
      return static_cast<Type>(found - known.begin());
  text.fail("type {}, one of {} expected", in_quotes(word), fmt::join(old_type_names, ", "));
}

std::string_view parse_format(TextReader& text) {
  const auto format = text.word_in_line();
  if (std::ranges::find(format_names, format) == format_names.end())
    text.fail("format {}, one of {} expected", in_quotes(format), fmt::join(format_names, ", "));
  if (const auto version = text.word_in_line(); version != "1.0")
    text.fail("format version {}, 1.0 expected", in_quotes(version));
  return format;
}

Element parse_element(TextReader& text) {
  Element element;
  element.name = text.word_in_line();
  if (element.name.empty()) text.fail("an element needs a name");
  constexpr std::size_t largest = std::numeric_limits<int>::max();
  const auto word = text.word_in_line();
  const auto count = parse_count(word, largest);
  if (!count) text.fail("element count {}, a number from 0 to {} expected", in_quotes(word), largest);
  element.count = *count;
  return element;
}

/// The part of a property's line behind the word "property".
Property parse_property(TextReader& text) {
  Property property;
  auto word = text.word_in_line();
  if (word == "list") {
    property.count_type = parse_type(text, text.word_in_line());
    if (*property.count_type >= Type::float32) text.fail("a list's length cannot be a float");
    word = text.word_in_line();
  }
  property.type = parse_type(text, word);
  property.name = text.word_in_line();
  if (property.name.empty()) text.fail("a property needs a name");
  return property;
}

Header parse_header(TextReader& text) {
  if (const auto word = text.word_in_line(); word != "ply")
    text.fail("{}, 'ply' expected: not a PLY file", in_quotes(word));
  text.end_line();
  Header header;
  while (true) {
    const auto keyword = text.word();
    if (keyword == "end_header") break;
    if (keyword == "comment" || keyword == "obj_info") {
      text.skip_line();
      continue;
    }
    if (keyword == "format") {
      header.format = parse_format(text);
    } else if (keyword == "element") {
      header.elements.push_back(parse_element(text));
    } else if (keyword == "property") {
      if (header.elements.empty()) text.fail("a property before the first element");
      header.elements.back().properties.push_back(parse_property(text));
    } else if (keyword.empty()) {
      text.fail("the file ends here, the header needs an end_header line: truncated");
    } else {
      text.fail("{} where one of format, element, property, comment, obj_info, end_header is expected",
                in_quotes(keyword));
    }
    text.end_line();
  }
  if (header.format.empty()) text.fail("the header ends without a format line");

  const auto vertices = std::ranges::count(header.elements, "vertex", &Element::name);
  if (vertices != 1) text.fail("the header has {} elements 'vertex', 1 expected", vertices);
  header.vertex = std::ranges::find(header.elements, "vertex", &Element::name) - header.elements.begin();
  auto& properties = header.elements[header.vertex].properties;
  std::vector<std::string_view> scalars;
  for (const auto& property : properties) scalars.push_back(property.count_type ? "" : property.name);
  header.layout = PointLayout::of(scalars, names, text.place());
  for (int target = 0; const auto column : header.layout.columns(names))
    properties[std::ranges::find(scalars, column) - scalars.begin()].target = target++;

  text.end_line();
  header.data_begin = text.offset();
  return header;
}

/// What the two bodies below share: where the reader is, for messages.
struct Place {
  std::string_view element;
  std::size_t row = 0;
  std::size_t count = 0;

  std::string words() const { return fmt::format("element {}, {} of {}", in_quotes(element), row, count); }
};

class BinaryBody {
 public:
  BinaryBody(std::string_view bytes, std::string_view name, std::size_t begin, std::endian order)
      : bytes_(bytes), name_(name), at_(begin), order_(order) {}

  void begin_row(const Place& place) { place_ = place; }
  void end_row() {}

  void skip(Type type, std::size_t count) {
    if (count > (bytes_.size() - at_) / size_of(type))
      throw Error("{}: byte {}: the file ends in {}: truncated", name_, bytes_.size(), place_.words());
    at_ += count * size_of(type);
  }

  float number(Type type) {
    const double wide = value(type);
    const auto number = narrowed(wide);
    if (!number) fail(type, fmt::format("{} is too large for a 32-bit float", wide));
    return *number;
  }

  std::size_t index(Type type, std::size_t count) {
    const double index = value(type);
    if (!(index >= 0 && index < static_cast<double>(count)))
      fail(type, fmt::format("vertex {} of {} does not exist", index, count));
    return static_cast<std::size_t>(index);
  }

  std::size_t list_length(Type type) {
    const double length = value(type);
    if (length < 0) fail(type, fmt::format("a list of {} values", length));
    return static_cast<std::size_t>(length);
  }

  void end() const {
    if (at_ != bytes_.size())
      throw Error("{}: byte {}: {} bytes behind the last element", name_, at_, bytes_.size() - at_);
  }

 private:
  /// A double holds every value of every type.
  double value(Type type) {
    const std::size_t from = at_;
    skip(type, 1);
    switch (type) {
      case Type::int8:
        return load<std::int8_t>(bytes_, from, order_);
      case Type::uint8:
        return load<std::uint8_t>(bytes_, from, order_);
      case Type::int16:
        return load<std::int16_t>(bytes_, from, order_);
      case Type::uint16:
        return load<std::uint16_t>(bytes_, from, order_);
      case Type::int32:
        return load<std::int32_t>(bytes_, from, order_);
      case Type::uint32:
        return load<std::uint32_t>(bytes_, from, order_);
      case Type::float32:
        return load<float>(bytes_, from, order_);
      case Type::float64:
        return load<double>(bytes_, from, order_);
    }
    return 0;
  }

  [[noreturn]] void fail(Type type, const std::string& complaint) const {
    throw Error("{}: byte {}: {}: {}", name_, at_ - size_of(type), place_.words(), complaint);
  }

  std::string_view bytes_, name_;
  std::size_t at_;
  std::endian order_;
  Place place_;
};

/// One row of an element is one line.
class AsciiBody {
 public:
  explicit AsciiBody(const TextReader& text) : text_(text) {}

  void begin_row(const Place& place) {
    place_ = place;
    line_begins_ = true;
  }
  void end_row() { text_.end_line(); }

  void skip(Type, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) word();
  }

  float number(Type) {
    const auto word = this->word();
    const auto number = parse_float(word);
    if (!number) text_.fail("{}: {} where a number is expected", place_.words(), in_quotes(word));
    return *number;
  }

  std::size_t index(Type, std::size_t count) {
    const auto word = this->word();
    const auto index = count > 0 ? parse_count(word, count - 1) : std::nullopt;
    if (!index) text_.fail("{}: {} where one of {} vertices is expected", place_.words(), in_quotes(word), count);
    return *index;
  }

  std::size_t list_length(Type) {
    const auto word = this->word();
    const auto length = parse_count(word, std::numeric_limits<std::uint32_t>::max());
    if (!length) text_.fail("{}: {} where a list's length is expected", place_.words(), in_quotes(word));
    return *length;
  }

  void end() const {
    if (!text_.at_end()) text_.fail("data behind the last element");
  }

 private:
  std::string_view word() {
    const auto word = line_begins_ ? text_.word() : text_.word_in_line();
    line_begins_ = false;
    if (word.empty()) text_.fail("{}: a value is missing: truncated", place_.words());
    return word;
  }

  TextReader text_;
  Place place_;
  bool line_begins_ = true;
};

bool is_corners(const Element& element, const Property& property) {
  return element.name == "face" && property.count_type &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// Polygons become fans of triangles.
template <typename Body>
void read_polygon(Body& body, const Property& property, std::size_t vertices,
                  std::vector<std::array<int, 3>>& triangles) {
  const std::size_t corners = body.list_length(*property.count_type);
  std::array<int, 3> fan = {};
  for (std::size_t k = 0; k < corners; ++k) {
    fan[std::min<std::size_t>(k, 2)] = static_cast<int>(body.index(property.type, vertices));
    if (k < 2) continue;
    triangles.push_back(fan);
    fan[1] = fan[2];
  }
}

/// `triangles` takes the polygons of the element "face"; may be null.
template <typename Body>
PointCloud read_body(const Header& header, Body body, std::size_t bytes,
                     std::vector<std::array<int, 3>>* triangles = nullptr) {
  PointCloud cloud;
  const auto& vertex = header.elements[header.vertex];
  cloud.points.reserve(std::min(vertex.count, bytes / 3));  // a vertex has 3 bytes or more, whatever the header claims
  std::vector<float> numbers(header.layout.columns(names).size());
  for (const auto& element : header.elements) {
    if (element.properties.empty()) continue;
    for (std::size_t row = 0; row < element.count; ++row) {
      body.begin_row({element.name, row, element.count});
      for (const auto& property : element.properties) {
        if (triangles && is_corners(element, property))
          read_polygon(body, property, vertex.count, *triangles);
        else if (property.count_type)
          body.skip(property.type, body.list_length(*property.count_type));
        else if (property.target < 0)
          body.skip(property.type, 1);
        else
          numbers[property.target] = body.number(property.type);
      }
      body.end_row();
      if (&element == &vertex) header.layout.append(cloud, numbers);
    }
  }
  body.end();
  if (!cloud.empty()) {
    cloud.width = static_cast<int>(cloud.size());
    cloud.height = 1;
  }
  return cloud;
}

}  // namespace

namespace {

PointCloud read(const std::filesystem::path& path, std::vector<std::array<int, 3>>* triangles) {
  const std::string bytes = read_file(path), name = path.string();
  TextReader text(bytes, name);
  const Header header = parse_header(text);
  if (header.format == "ascii") return read_body(header, AsciiBody(text), bytes.size(), triangles);
  const auto order = header.format == "binary_big_endian" ? std::endian::big : std::endian::little;
  return read_body(header, BinaryBody(bytes, name, header.data_begin, order), bytes.size(), triangles);
}

}  // namespace

PointCloud read_ply(const std::filesystem::path& path) { return read(path, nullptr); }

TriangleMesh read_ply_mesh(const std::filesystem::path& path) {
  TriangleMesh mesh;
  mesh.vertices = read(path, &mesh.triangles).points;
  if (mesh.triangles.empty())
    throw Error(
        "{}: has no triangles, is it a point cloud? Of a model an element 'face' with a list 'vertex_indices' is "
        "needed",
        path.string());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!mesh.vertices[i].allFinite())
      throw Error("{}: element 'vertex', {} of {}: a coordinate is not finite", path.string(), i, mesh.vertices.size());
  return mesh;
}

void write_ply_mesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> normals(mesh.vertices.size(), Eigen::Vector3d::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Eigen::Vector3d, 3> corner;
    for (int k = 0; k < 3; ++k) {
      const int index = mesh.triangles[t][k];
      if (index < 0 || static_cast<std::size_t>(index) >= mesh.vertices.size())
        throw Error("{}: triangle {} has vertex {} of {}", path.string(), t, index, mesh.vertices.size());
      corner[k] = mesh.vertices[index].cast<double>();
    }
    const Eigen::Vector3d area = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    for (const int index : mesh.triangles[t]) normals[index] += area;
  }
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment millimetres\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(), mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f& p = mesh.vertices[i];
    if (!p.allFinite()) throw Error("{}: vertex {} is not finite", path.string(), i);
    const Eigen::Vector3f n = normals[i].normalized().cast<float>();  // of no area: zero
    text += fmt::format("{} {} {} {} {} {}\n", p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
  }
  for (const auto& [a, b, c] : mesh.triangles) text += fmt::format("3 {} {} {}\n", a, b, c);
  write_file_atomically(path, text);
}

void write_ply(const std::filesystem::path& path, const PointCloud& cloud, const PlyOptions& options) {
  const auto& colours = options.colours;
  if (!colours.empty() && colours.size() != cloud.size())
    throw Error("{}: {} colours for {} points", path.string(), colours.size(), cloud.size());
  const auto layout = PointLayout::of(cloud);
  const auto columns = layout.columns(names);
  std::string bytes =
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment millimetres\nelement vertex {}\n", cloud.size());
  for (const auto column : columns) bytes += fmt::format("property float {}\n", column);
  if (!colours.empty()) bytes += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  bytes += "end_header\n";
  const auto rows = layout.rows(cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t k = 0; k < columns.size(); ++k) store(bytes, rows[i * columns.size() + k]);
    if (!colours.empty()) store(bytes, colours[i]);
  }
  write_file_atomically(path, bytes);
}

}  // namespace partpose
