// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/pcd.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/bytes.hpp"
#include "partpose/io/file.hpp"
#include "partpose/io/lzf.hpp"
#include "partpose/io/point_layout.hpp"
#include "partpose/io/text_reader.hpp"

#include <fmt/ranges.h>

#include <cstdint>
#include <iterator>
#include <limits>
#include <map>

namespace partpose {

namespace {

constexpr PointNames names = {"x", "y", "z", "normal_x", "normal_y", "normal_z", "curvature"};
constexpr std::array<std::string_view, 10> header_keys = {"VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
                                                          "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
constexpr std::array<std::string_view, 3> encoding_names = {"ascii", "binary", "binary_compressed"};  // as PcdEncoding

/// Of WIDTH, HEIGHT, POINTS and of the bytes of a point, so that no product of two of them overflows.
constexpr std::size_t largest = std::numeric_limits<int>::max();

struct Field {
  std::string_view name;
  std::string_view type;   ///< I, U or F
  std::size_t size = 4;    ///< bytes per value
  std::size_t count = 1;   ///< values per point
  std::size_t offset = 0;  ///< bytes of a point before it
  std::size_t first = 0;   ///< values of a point before it

  bool is_float() const { return type == "F" && (size == 4 || size == 8); }
};

struct HeaderLine {
  std::string place;
  std::vector<std::string_view> words;
};

/// A PCD file whose header is understood; views the content.
struct Pcd {
  std::string_view name;
  std::string_view bytes;
  std::size_t data_begin = 0;
  PcdEncoding encoding = PcdEncoding::ascii;
  std::vector<Field> fields;
  std::string fields_place;
  int width = 0;
  int height = 0;
  std::size_t points = 0;
  std::size_t bytes_per_point = 0;
  std::size_t values_per_point = 0;

  std::string_view data() const { return bytes.substr(data_begin); }
};

using FieldRefs = std::vector<const Field*>;

class HeaderLines {
 public:
  explicit HeaderLines(TextReader& text) {
    for (bool data = false; !data;) {
      const auto key = text.word();
      if (key.empty()) text.fail("the file ends here, the header needs a DATA line: truncated or not a PCD file");
      if (key.front() == '#') {
        text.skip_line();
        continue;
      }
      if (std::ranges::find(header_keys, key) == header_keys.end())
        text.fail("{} where one of {} is expected", in_quotes(key), fmt::join(header_keys, " "));
      const auto [line, is_new] = lines_.try_emplace(key, HeaderLine{text.place(), {}});
      if (!is_new) text.fail("a second {} line", key);
      for (auto word = text.word_in_line(); !word.empty(); word = text.word_in_line())
        line->second.words.push_back(word);
      text.skip_line();
      data = key == "DATA";
    }
    end_ = text.place_of(text.offset());
  }

  bool has(std::string_view key) const { return lines_.contains(key); }

  const HeaderLine& at(std::string_view key) const {
    const auto line = lines_.find(key);
    if (line == lines_.end()) throw Error("{}: the header ends here without a {} line", end_, key);
    return line->second;
  }

  /// The line, with as many words as it needs.
  const HeaderLine& at(std::string_view key, std::size_t words) const {
    const auto& line = at(key);
    if (line.words.size() != words)
      throw Error("{}: {} has {} entries, {} expected", line.place, key, line.words.size(), words);
    return line;
  }

  std::size_t number(std::string_view key, std::size_t smallest, std::size_t words = 1, std::size_t index = 0) const {
    const auto& line = at(key, words);
    const auto number = parse_count(line.words[index], largest);
    if (!number || *number < smallest)
      throw Error("{}: {} is {}, a number from {} to {} expected", line.place, key, in_quotes(line.words[index]),
                  smallest, largest);
    return *number;
  }

 private:
  std::map<std::string_view, HeaderLine> lines_;
  std::string end_;
};

Pcd parse_header(std::string_view bytes, std::string_view name) {
  TextReader text(bytes, name);
  const HeaderLines lines(text);
  Pcd pcd;
  pcd.name = name;
  pcd.bytes = bytes;
  pcd.data_begin = text.offset();

  const auto& field_names = lines.at("FIELDS");
  const std::size_t count = field_names.words.size();
  pcd.fields_place = field_names.place;
  for (std::size_t i = 0; i < count; ++i) {
    Field field;
    field.name = field_names.words[i];
    field.type = lines.at("TYPE", count).words[i];
    field.size = lines.number("SIZE", 1, count, i);
    if (field.size != 1 && field.size != 2 && field.size != 4 && field.size != 8)
      throw Error("{}: SIZE is {}, 1, 2, 4 or 8 expected", lines.at("SIZE").place, field.size);
    if (lines.has("COUNT")) field.count = lines.number("COUNT", 1, count, i);
    field.offset = pcd.bytes_per_point;
    field.first = pcd.values_per_point;
    pcd.bytes_per_point += field.size * field.count;
    pcd.values_per_point += field.count;
    if (pcd.bytes_per_point > largest) throw Error("{}: more than {} bytes a point", lines.at("COUNT").place, largest);
    pcd.fields.push_back(field);
  }

  pcd.width = static_cast<int>(lines.number("WIDTH", 0));
  pcd.height = static_cast<int>(lines.number("HEIGHT", 0));
  pcd.points = lines.number("POINTS", 0);
  if (std::uint64_t(pcd.width) * std::uint64_t(pcd.height) != pcd.points)
    throw Error("{}: POINTS is {}, WIDTH x HEIGHT is {} x {}", lines.at("POINTS").place, pcd.points, pcd.width,
                pcd.height);

  const auto& encoding = lines.at("DATA", 1);
  const auto known = std::ranges::find(encoding_names, encoding.words[0]);
  if (known == encoding_names.end())
    throw Error("{}: DATA is {}, one of {} expected", encoding.place, in_quotes(encoding.words[0]),
                fmt::join(encoding_names, ", "));
  pcd.encoding = static_cast<PcdEncoding>(known - encoding_names.begin());
  return pcd;
}

void expect_padding_only(const Pcd& pcd, std::size_t data_size) {
  const auto stray = pcd.data().find_first_not_of('\0', data_size);
  if (stray != std::string_view::npos)
    throw Error("{}: byte {}: data behind the last of the {} points", pcd.name, pcd.data_begin + stray, pcd.points);
}

std::string decompressed(const Pcd& pcd) {
  const auto data = pcd.data();
  if (data.size() < 8) throw Error("{}: byte {}: truncated, two sizes expected", pcd.name, pcd.bytes.size());
  const std::size_t compressed_size = load<std::uint32_t>(data, 0), size = load<std::uint32_t>(data, 4);
  if (compressed_size > data.size() - 8)
    throw Error("{}: byte {}: compressed size is {}, the file has {} bytes left: truncated", pcd.name, pcd.data_begin,
                compressed_size, data.size() - 8);
  if (size != pcd.points * pcd.bytes_per_point)
    throw Error("{}: byte {}: uncompressed size is {}, {} points of {} bytes need {}", pcd.name, pcd.data_begin + 4,
                size, pcd.points, pcd.bytes_per_point, pcd.points * pcd.bytes_per_point);
  expect_padding_only(pcd, 8 + compressed_size);
  try {
    return lzf_decompress(data.substr(8, compressed_size), size);
  } catch (const Error& error) {
    throw Error("{}: byte {}: {}", pcd.name, pcd.data_begin + 8, error.what());
  }
}

/// Calls `row(values)` for each point; `data` holds point by point, or field by field when `field_major`.
template <typename Row>
void for_each_binary_point(const Pcd& pcd, std::string_view data, bool field_major, const FieldRefs& wanted,
                           std::span<float> values, const Row& row) {
  for (std::size_t point = 0; point < pcd.points; ++point) {
    auto value = values.begin();
    for (const Field* field : wanted) {
      const std::size_t begin = field_major ? field->offset * pcd.points + point * field->size * field->count
                                            : point * pcd.bytes_per_point + field->offset;
      for (std::size_t i = 0; i < field->count; ++i) {
        const std::size_t at = begin + i * field->size;
        const auto number = field->size == 4 ? load<float>(data, at) : narrowed(load<double>(data, at));
        if (!number)
          throw Error("{}: point {}: {} is {}, too large for a 32-bit float", pcd.name, point, field->name,
                      load<double>(data, at));
        *value++ = *number;
      }
    }
    row(values);
  }
}

template <typename Row>
void for_each_ascii_point(const Pcd& pcd, const FieldRefs& wanted, std::span<float> values, const Row& row) {
  constexpr std::size_t skipped = -1;
  std::vector<std::size_t> target(pcd.values_per_point, skipped);
  for (std::size_t next = 0; const Field* field : wanted)
    for (std::size_t i = 0; i < field->count; ++i) target[field->first + i] = next++;

  TextReader text(pcd.bytes, pcd.name, pcd.data_begin);
  for (std::size_t point = 0; point < pcd.points; ++point) {
    for (std::size_t i = 0; i < target.size(); ++i) {
      const auto word = i == 0 ? text.word() : text.word_in_line();
      if (word.empty()) text.fail("point {} of {} has {} of {} values", point, pcd.points, i, target.size());
      if (target[i] == skipped) continue;
      const auto number = parse_float(word);
      if (!number) text.fail("{} where a number is expected", in_quotes(word));
      values[target[i]] = *number;
    }
    text.end_line();
    row(values);
  }
  if (!text.at_end()) text.fail("data behind the last of the {} points", pcd.points);
}

/// Calls `row(values)` for each point with the values of the wanted fields, which are floats, one field after the
/// other.
template <typename Row>
void for_each_point(const Pcd& pcd, const FieldRefs& wanted, const Row& row) {
  // What the file can hold is checked before anything of the size that its header claims is allocated.
  const std::size_t available = pcd.data().size();
  const std::size_t needed = pcd.encoding == PcdEncoding::binary ? pcd.points * pcd.bytes_per_point
                             : pcd.encoding == PcdEncoding::ascii && pcd.points > 0
                                 ? pcd.points * pcd.values_per_point * 2 - 1  // a digit and a space for each
                                 : 0;
  if (available < needed)
    throw Error("{}: byte {}: {} bytes of data, {} points need at least {}: truncated", pcd.name, pcd.data_begin,
                available, pcd.points, needed);
  const std::string unpacked = pcd.encoding == PcdEncoding::binary_compressed ? decompressed(pcd) : std::string();
  if (pcd.encoding == PcdEncoding::binary) expect_padding_only(pcd, needed);

  std::size_t size = 0;
  for (const Field* field : wanted) size += field->count;
  std::vector<float> values(pcd.points > 0 ? size : 0);
  switch (pcd.encoding) {
    case PcdEncoding::ascii:
      return for_each_ascii_point(pcd, wanted, values, row);
    case PcdEncoding::binary:
      return for_each_binary_point(pcd, pcd.data(), false, wanted, values, row);
    case PcdEncoding::binary_compressed:
      return for_each_binary_point(pcd, unpacked, true, wanted, values, row);
  }
}

const Field& float_field(const Pcd& pcd, std::string_view name) {
  const auto field = std::ranges::find(pcd.fields, name, &Field::name);
  if (field == pcd.fields.end()) {
    std::vector<std::string> there;
    for (const auto& f : pcd.fields) there.push_back(in_quotes(f.name));
    throw Error("{}: no field {}, there are {}", pcd.fields_place, in_quotes(name), fmt::join(there, ", "));
  }
  if (!field->is_float())
    throw Error("{}: field {} has TYPE {} and SIZE {}, a float (F) of 4 or 8 bytes is needed", pcd.fields_place,
                in_quotes(name), in_quotes(field->type), field->size);
  return *field;
}

/// A header of 4-byte float fields; `counts` as long as `fields`.
std::string header(std::span<const std::string_view> fields, std::span<const int> counts, int width, int height,
                   PcdEncoding encoding) {
  const std::vector<int> sizes(fields.size(), 4);
  const std::vector<char> types(fields.size(), 'F');
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\nCOUNT {}\n"
      "WIDTH {}\nHEIGHT {}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA {}\n",
      fmt::join(fields, " "), fmt::join(sizes, " "), fmt::join(types, " "), fmt::join(counts, " "), width, height,
      std::int64_t{width} * height, encoding_names[static_cast<std::size_t>(encoding)]);
}

void append_binary(std::string& out, std::span<const float> values) {
  out.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

void append_compressed(std::string& out, std::span<const float> rows, std::size_t columns, std::string_view name) {
  constexpr std::size_t largest_block = std::numeric_limits<std::uint32_t>::max();
  std::vector<float> field_major(rows.size());
  const std::size_t points = rows.size() / columns;
  for (std::size_t i = 0; i < rows.size(); ++i) field_major[i % columns * points + i / columns] = rows[i];
  std::string block;
  append_binary(block, field_major);
  const std::string compressed = lzf_compress(block);
  if (std::max(block.size(), compressed.size()) > largest_block)
    throw Error("{}: {} bytes are too many for binary_compressed, write it as binary", name, block.size());
  store(out, static_cast<std::uint32_t>(compressed.size()));
  store(out, static_cast<std::uint32_t>(block.size()));
  out += compressed;
}

void append_ascii(std::string& out, std::span<const float> rows, std::size_t columns) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    // PCL reads "nan" but not the "-nan" that fmt writes for a NaN whose sign bit is set.
    if (std::isnan(rows[i]))
      out += "nan";
    else
      fmt::format_to(std::back_inserter(out), "{}", rows[i]);  // the shortest text that reads back as the same float
    out += (i + 1) % columns == 0 ? '\n' : ' ';
  }
}

}  // namespace

PointCloud read_pcd(const std::filesystem::path& path) {
  const std::string bytes = read_file(path), name = path.string();
  const Pcd pcd = parse_header(bytes, name);
  std::vector<std::string_view> columns;
  for (const auto& field : pcd.fields) columns.push_back(field.name);
  const auto layout = PointLayout::of(columns, names, pcd.fields_place);
  FieldRefs wanted;
  for (const auto column : layout.columns(names)) {
    wanted.push_back(&float_field(pcd, column));
    if (wanted.back()->count != 1)
      throw Error("{}: field {} has COUNT {}, 1 is needed", pcd.fields_place, column, wanted.back()->count);
  }
  PointCloud cloud;
  for_each_point(pcd, wanted, [&](std::span<const float> values) { layout.append(cloud, values); });
  if (!cloud.empty()) {
    cloud.width = pcd.width;
    cloud.height = pcd.height;
  }
  return cloud;
}

void write_pcd(const std::filesystem::path& path, const PointCloud& cloud, PcdEncoding encoding) {
  const auto layout = PointLayout::of(cloud);
  const auto columns = layout.columns(names);
  const auto rows = layout.rows(cloud);
  const std::vector<int> counts(columns.size(), 1);
  const bool organized = cloud.is_organized();
  std::string bytes = header(columns, counts, organized ? cloud.width : static_cast<int>(cloud.size()),
                             organized ? cloud.height : 1, encoding);
  switch (encoding) {
    case PcdEncoding::ascii:
      append_ascii(bytes, rows, columns.size());
      break;
    case PcdEncoding::binary:
      append_binary(bytes, rows);
      break;
    case PcdEncoding::binary_compressed:
      append_compressed(bytes, rows, columns.size(), path.string());
      break;
  }
  write_file_atomically(path, bytes);
}

std::vector<std::vector<float>> read_pcd_histograms(const std::filesystem::path& path, const std::string& field_name) {
  const std::string bytes = read_file(path), name = path.string();
  const Pcd pcd = parse_header(bytes, name);
  std::vector<std::vector<float>> rows;
  for_each_point(pcd, {&float_field(pcd, field_name)},
                 [&](std::span<const float> values) { rows.emplace_back(values.begin(), values.end()); });
  return rows;
}

void write_pcd_histograms(const std::filesystem::path& path, const std::string& field_name, int bins,
                          const std::vector<std::vector<float>>& rows) {
  if (field_name.empty() || field_name.find_first_of(" \t\r\n\v\f") != std::string::npos)
    throw Error("{}: field name {}: must be one word", path.string(), in_quotes(field_name));
  if (bins < 1) throw Error("{}: {} bins, at least 1 is needed", path.string(), bins);
  const std::array<std::string_view, 1> fields = {field_name};
  std::string bytes = header(fields, {&bins, 1}, static_cast<int>(rows.size()), 1, PcdEncoding::binary);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].size() != bins)
      throw Error("{}: histogram {} has {} values, {} expected", path.string(), i, rows[i].size(), bins);
    append_binary(bytes, rows[i]);
  }
  write_file_atomically(path, bytes);
}

}  // namespace partpose
