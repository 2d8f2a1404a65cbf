// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/error.hpp"
#include "partpose/core/text.hpp"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <concepts>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

/// JSON of any struct that describes itself:
///
///     struct Options {
///       float size_mm = 1;
///       template <typename Self, typename Visit>
///       static void describe(Self& self, Visit&& visit) { visit("size_mm", self.size_mm, "edge length [mm], > 0"); }
///       void check() const;                          // optional, throws Error
///       static constexpr bool all_keys_required = true;  // optional: for records rather than options
///     };
///
/// Reading is strict: an unknown key, a wrong type or a missing required key is an Error that names the key by its
/// path. Keys that are absent keep their defaults.
namespace partpose {

using Json = nlohmann::ordered_json;

/// Parses a file; comments (// and /* */) count as space. Throws Error naming the file, and the byte where it stops being JSON. A key given twice is an Error.
Json read_json_file(const std::filesystem::path& path);
/// One line of text; bytes that are not UTF-8 (in a file's name) are replaced by the replacement character.
std::string json_line(const Json& json);
/// Writes with two spaces of indentation, atomically. Throws Error when a string is not UTF-8.
void write_json_file(const std::filesystem::path& path, const Json& json);

namespace json_detail {

inline constexpr auto any_field = [](const char*, auto&, const char*) {};

template <typename T>
concept Described = requires(T& value) {
  T::describe(value, any_field);
};

template <typename T>
constexpr bool all_keys_required() {
  if constexpr (requires { T::all_keys_required; })
    return T::all_keys_required;
  else
    return false;
}

template <typename T>
struct IsOptional : std::false_type {};
template <typename T>
struct IsOptional<std::optional<T>> : std::true_type {};

/// "a number, got the string "abc"" for error messages.
std::string what_it_is(const Json& json);
[[noreturn]] void wrong_type(const std::string& key, const char* expected, const Json& json);
std::string key_path(const std::string& parent, const std::string& key);

template <typename T>
void read(const Json& json, const std::string& key, T& out);

template <typename T>
requires std::integral<T> &&
    (!std::same_as<T, bool>)void read_integer(const Json& json, const std::string& key, T& out) {
  if (!json.is_number_integer()) wrong_type(key, "a whole number", json);
  const bool fits =
      json.is_number_unsigned()
          ? json.get<std::uint64_t>() <= static_cast<std::uint64_t>(std::numeric_limits<T>::max())
          : std::is_signed_v<T> && json.get<std::int64_t>() >= std::int64_t{std::numeric_limits<T>::min()};
  if (!fits) wrong_type(key, "a whole number in range", json);
  out = json.get<T>();
}

template <Described T>
void read_object(const Json& json, const std::string& key, T& out) {
  if (!json.is_object()) wrong_type(key, "an object", json);
  std::vector<std::string> known;
  T::describe(out, [&](const char* name, auto& field, const char*) {
    known.emplace_back(name);
    const auto it = json.find(name);
    if (it != json.end()) {
      read(*it, key_path(key, name), field);
    } else if constexpr (all_keys_required<T>() && !IsOptional<std::remove_cvref_t<decltype(field)>>::value) {
      throw Error("key \"{}\" is missing", key_path(key, name));
    }
  });
  for (const auto& [name, value] : json.items()) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error("unknown key \"{}\"; did you mean \"{}\"?", key_path(key, name), nearest_word(name, known));
  }
  if constexpr (requires { out.check(); }) {
    try {
      out.check();
    } catch (const Error& error) {
      if (key.empty()) throw;
      throw Error("{}: {}", key, error.what());
    }
  }
}

template <typename T, std::size_t N>
void read_value(const Json& json, const std::string& key, std::array<T, N>& out) {
  if (!json.is_array() || json.size() != N) wrong_type(key, fmt::format("an array of {}", N).c_str(), json);
  for (std::size_t i = 0; i < N; ++i) read(json[i], fmt::format("{}[{}]", key, i), out[i]);
}

template <typename T>
void read_value(const Json& json, const std::string& key, std::vector<T>& out) {
  if (!json.is_array()) wrong_type(key, "an array", json);
  out.assign(json.size(), T{});
  for (std::size_t i = 0; i < json.size(); ++i) read(json[i], fmt::format("{}[{}]", key, i), out[i]);
}

template <typename T>
void read_value(const Json& json, const std::string& key, std::optional<T>& out) {
  if (json.is_null()) {
    out.reset();
  } else {
    read(json, key, out.emplace());
  }
}

void read_value(const Json& json, const std::string& key, Eigen::Isometry3d& out);
Json write_value(const Eigen::Isometry3d& pose);
/// The shortest decimal that reads back to the same float, not its long form as a double; null when it is not finite.
Json write_float(float value);

template <typename T>
void read(const Json& json, const std::string& key, T& out) {
  if constexpr (std::same_as<T, bool>) {
    if (!json.is_boolean()) wrong_type(key, "true or false", json);
    out = json.get<bool>();
  } else if constexpr (std::integral<T>) {
    read_integer(json, key, out);
  } else if constexpr (std::floating_point<T>) {
    if (!json.is_number()) wrong_type(key, "a number", json);
    out = json.get<T>();
    if (!std::isfinite(out)) wrong_type(key, "a number in range", json);
  } else if constexpr (std::same_as<T, std::string>) {
    if (!json.is_string()) wrong_type(key, "a string", json);
    out = json.get<std::string>();
  } else if constexpr (Described<T>) {
    read_object(json, key, out);
  } else {
    read_value(json, key, out);
  }
}

template <typename T>
Json write(const T& value) {
  if constexpr (Described<T>) {
    Json json = Json::object();
    T::describe(value, [&](const char* name, const auto& field, const char*) {
      if constexpr (IsOptional<std::remove_cvref_t<decltype(field)>>::value) {
        if (field) json[name] = write(*field);
      } else {
        json[name] = write(field);
      }
    });
    return json;
  } else if constexpr (std::same_as<T, Eigen::Isometry3d>) {
    return write_value(value);
  } else if constexpr (std::same_as<T, float>) {
    return write_float(value);
  } else if constexpr (std::same_as<T, std::string> || std::is_arithmetic_v<T>) {
    return value;
  } else {
    Json json = Json::array();
    for (const auto& item : value) json.push_back(write<std::remove_cvref_t<decltype(item)>>(item));
    return json;
  }
}

}  // namespace json_detail

template <typename T>
Json to_json(const T& value) {
  return json_detail::write(value);
}

/// Throws Error whose message names the key; callers that know the file put its name before it.
template <typename T>
T from_json(const Json& json) {
  T value{};
  json_detail::read(json, "", value);
  return value;
}

/// Throws Error naming file and key.
template <typename T>
T read_json(const std::filesystem::path& path) {
  const Json json = read_json_file(path);
  try {
    return from_json<T>(json);
  } catch (const Error& error) {
    throw Error("{}: {}", path.string(), error.what());
  }
}

template <typename T>
void write_json(const std::filesystem::path& path, const T& value) {
  write_json_file(path, to_json(value));
}

}  // namespace partpose
