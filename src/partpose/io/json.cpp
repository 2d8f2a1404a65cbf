// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/json.hpp"

#include "partpose/core/pose.hpp"
#include "partpose/io/file.hpp"

#include <algorithm>
#include <set>

namespace partpose {

Json read_json_file(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  std::vector<std::set<std::string>> keys_of_open_objects;
  const auto watch_keys = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) keys_of_open_objects.emplace_back();
    if (event == Json::parse_event_t::object_end) keys_of_open_objects.pop_back();
    if (event == Json::parse_event_t::key && !keys_of_open_objects.back().insert(parsed.get<std::string>()).second)
      throw Error("{}: key \"{}\" is given twice", path.string(), parsed.get<std::string>());
    return true;
  };
  try {
    return Json::parse(text, watch_keys, true, true);
  } catch (const Json::parse_error& error) {
    const std::string before = text.substr(0, error.byte > 0 ? error.byte - 1 : 0);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t line_start = before.rfind('\n') + 1;  // 0 where there is none
    throw Error("{}: line {}, column {}: not valid JSON here", path.string(), line, before.size() - line_start + 1);
  } catch (const Json::exception& error) {
    throw Error("{}: not valid JSON: {}", path.string(), error.what());
  }
}

void write_json_file(const std::filesystem::path& path, const Json& json) {
  std::string text;
  try {
    text = json.dump(2) + "\n";
  } catch (const Json::exception&) {
    throw Error("{}: cannot be written: a text in it is not UTF-8", path.string());
  }
  write_file_atomically(path, text);
}

std::string json_line(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

namespace json_detail {

std::string what_it_is(const Json& json) {
  if (json.is_null()) return "null";
  std::string text = json_line(json);
  if (text.size() > 40) {
    std::size_t cut = 37;
    while (cut > 0 && (static_cast<unsigned char>(text[cut]) & 0xC0) == 0x80) --cut;  // not within a UTF-8 letter
    text = text.substr(0, cut) + "...";
  }
  return fmt::format("{} {}", json.type_name(), text);
}

void wrong_type(const std::string& key, const char* expected, const Json& json) {
  if (key.empty()) throw Error("expected {}, got {}", expected, what_it_is(json));
  throw Error("key \"{}\": expected {}, got {}", key, expected, what_it_is(json));
}

std::string key_path(const std::string& parent, const std::string& key) {
  return parent.empty() ? key : parent + "." + key;
}

void read_value(const Json& json, const std::string& key, Eigen::Isometry3d& out) {
  std::array<std::array<double, 4>, 4> rows;
  read(json, key, rows);
  Eigen::Matrix4d matrix;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) matrix(r, c) = rows[r][c];
  if (!is_rigid(matrix)) throw Error("key \"{}\": not a rigid transformation (rotation and translation, 4x4)", key);
  out.matrix() = matrix;
}

Json write_float(float value) {
  if (!std::isfinite(value)) return nullptr;
  const Json shortest = Json::parse(fmt::format("{}", value));
  const bool reads_back = shortest.is_number_float() && static_cast<float>(shortest.get<double>()) == value;
  return reads_back ? shortest : Json(static_cast<double>(value));
}

Json write_value(const Eigen::Isometry3d& pose) {
  Json rows = Json::array();
  for (int r = 0; r < 4; ++r) {
    Json row = Json::array();
    for (int c = 0; c < 4; ++c) row.push_back(pose.matrix()(r, c));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace json_detail

}  // namespace partpose
