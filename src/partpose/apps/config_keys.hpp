// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/io/json.hpp"

#include <span>
#include <string>
#include <vector>

namespace CLI {
class App;
}

/// What the structs that describe themselves (io/json.hpp) say of their keys, for `partpose config` and `--set`.
namespace partpose::apps {

/// A key of a configuration file.
struct ConfigKey {
  std::string path;       ///< "preprocessing.voxel_size"; of what is in a list "groups[].name"
  std::string type;       ///< "bool", "int", "float", "str", "2 x float", "float[]", "4x4"; of a section "object"
  Json standard;          ///< the default; null for what is absent unless it is given, and for sections
  bool optional = false;  ///< absent unless it is given
  bool section = false;   ///< has keys of its own
  bool required = false;  ///< a file without it is refused
  std::string help;
};

namespace config_detail {

using json_detail::Described;

template <typename T>
struct TypeName;
template <>
struct TypeName<bool> {
  static std::string name() { return "bool"; }
};
template <std::integral T>
struct TypeName<T> {
  static std::string name() { return "int"; }
};
template <std::floating_point T>
struct TypeName<T> {
  static std::string name() { return "float"; }
};
template <>
struct TypeName<std::string> {
  static std::string name() { return "str"; }
};
template <>
struct TypeName<Eigen::Isometry3d> {
  static std::string name() { return "4x4"; }
};
template <Described T>
struct TypeName<T> {
  static std::string name() { return "object"; }
};
template <typename T>
struct TypeName<std::optional<T>> : TypeName<T> {};
template <typename T>
struct TypeName<std::vector<T>> {
  static std::string name() { return TypeName<T>::name() + "[]"; }
};
template <typename T, std::size_t N>
struct TypeName<std::array<T, N>> {
  static std::string name() { return fmt::format("{} x {}", N, TypeName<T>::name()); }
};

template <typename T>
struct IsList : std::false_type {};
template <typename T>
struct IsList<std::vector<T>> : std::true_type {};
template <typename T, std::size_t N>
struct IsList<std::array<T, N>> : std::true_type {};

/// The struct whose keys a field has, if any: its own, or that of what is optional or in a list.
template <typename T>
struct Inner {
  using Type = T;
};
template <typename T>
struct Inner<std::optional<T>> : Inner<T> {};
template <typename T>
struct Inner<std::vector<T>> : Inner<T> {};

template <Described T>
void append_keys(const T& object, const std::string& parent, std::vector<ConfigKey>& keys) {
  T::describe(object, [&]<typename Field>(const char* name, const Field& field, const char* help) {
    using json_detail::IsOptional;
    constexpr bool section = Described<typename Inner<Field>::Type>;
    ConfigKey key;
    key.path = parent + name;
    key.type = TypeName<Field>::name();
    key.optional = IsOptional<Field>::value;
    key.section = section;
    key.required = json_detail::all_keys_required<T>() && !key.optional;
    key.help = help;
    if constexpr (IsOptional<Field>::value) {
      if (!section && field) key.standard = to_json(*field);
    } else if constexpr (!section) {
      key.standard = to_json(field);
    }
    keys.push_back(std::move(key));
    if constexpr (Described<Field>)
      append_keys(field, parent + name + ".", keys);
    else if constexpr (section && IsOptional<Field>::value)
      append_keys(field.value_or(typename Inner<Field>::Type{}), parent + name + ".", keys);
    else if constexpr (section)
      append_keys(typename Inner<Field>::Type{}, parent + name + "[].", keys);
  });
}

/// `text` as the JSON that a field of this type is read from: strings need no quotes, lists no brackets.
template <typename T>
Json value_of(const std::string& text) {
  const auto parsed = [](const std::string& json) { return Json::parse(json, nullptr, false); };
  if constexpr (std::same_as<T, std::string>) {
    const Json quoted = text.starts_with('"') ? parsed(text) : Json(text);
    return quoted.is_string() ? quoted : Json(text);
  } else if constexpr (IsList<T>::value) {
    if (text.starts_with('[')) {
      const Json list = parsed(text);
      return list.is_discarded() ? Json(text) : list;
    }
    Json list = Json::array();
    for (std::size_t begin = 0; begin <= text.size() && !text.empty();) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      list.push_back(value_of<typename T::value_type>(text.substr(begin, end - begin)));
      begin = end + 1;
    }
    return list;
  } else {
    const Json value = parsed(text);
    return value.is_discarded() ? Json(text) : value;
  }
}

/// One step of a path: a key's name, or the number of an item in a list.
struct Step {
  std::string name;
  std::optional<std::size_t> item;
};

/// Reads `text` into what `path` leads to. False: there is no such key. Throws Error for a value of another type.
template <typename T>
bool set_value(T& field, std::span<const Step> path, const std::string& key, const std::string& text) {
  if constexpr (json_detail::IsOptional<T>::value) {
    if (path.empty() && text == "null") {
      field.reset();
      return true;
    }
    if (!field) field.emplace();
    return set_value(*field, path, key, text);
  } else if (path.empty()) {
    json_detail::read(value_of<T>(text), key, field);
    return true;
  } else if constexpr (Described<T>) {
    bool found = false;
    T::describe(field, [&](const char* name, auto& inner, const char*) {
      if (!found && !path[0].item && path[0].name == name) found = set_value(inner, path.subspan(1), key, text);
    });
    return found;
  } else if constexpr (IsList<T>::value) {
    if (!path[0].item) return false;
    if (*path[0].item >= field.size())
      throw Error("\"{}\": there is no item {}, the list has {} (the first is 0)", key, *path[0].item, field.size());
    return set_value(field[*path[0].item], path.subspan(1), key, text);
  } else {
    return false;
  }
}

/// KEY=VALUE, as --set takes it. Throws Error for anything else.
struct Override {
  explicit Override(const std::string& given);
  std::string key, value;
  std::vector<Step> path;
};

[[noreturn]] void unknown_key(const std::string& key, const std::vector<ConfigKey>& keys);

/// `help` as comment lines.
std::string comment_of(const std::string& help, int indent);
std::string comment_of(const ConfigKey& item, int indent);

template <Described T>
std::string commented(const T& object, int indent) {
  const std::string margin(static_cast<std::size_t>(indent) + 2, ' ');
  std::string out = "{\n";
  bool first = true;
  T::describe(object, [&]<typename Field>(const char* name, const Field& field, const char* help) {
    using json_detail::IsOptional;
    constexpr bool section = Described<typename Inner<Field>::Type>;
    if (!first) out += section && indent == 0 ? ",\n\n" : ",\n";
    first = false;
    std::string said = help;
    if (IsOptional<Field>::value) said += fmt::format(" ({}; null: absent)", TypeName<Field>::name());
    out += comment_of(said, indent + 2);
    if constexpr (section && !Described<Field>) {
      std::vector<ConfigKey> keys;
      append_keys(typename Inner<Field>::Type{}, IsOptional<Field>::value ? "." : "[].", keys);
      for (const auto& key : keys) out += comment_of(key, indent + 2);
    }
    out += fmt::format("{}\"{}\": ", margin, name);
    if constexpr (Described<Field>) {
      out += commented(field, indent + 2);
    } else if constexpr (IsOptional<Field>::value && section) {
      out += field ? commented(*field, indent + 2) : "null";
    } else if constexpr (IsOptional<Field>::value) {
      out += field ? json_line(to_json(*field)) : "null";
    } else {
      out += json_line(to_json(field));
    }
  });
  return out + "\n" + std::string(static_cast<std::size_t>(indent), ' ') + "}";
}

}  // namespace config_detail

/// All keys of a configuration, sections before what is in them, with the values of `defaults` as defaults.
template <json_detail::Described T>
std::vector<ConfigKey> keys_of(const T& defaults = {}) {
  std::vector<ConfigKey> keys;
  config_detail::append_keys(defaults, "", keys);
  return keys;
}

/// Sets keys from texts like "vfh.k_nn=9", "xyz_limits=0,1,0,1,0,1" or "groups[0].name=screws". Throws Error, naming
/// the text, for an unknown key (with the nearest one) and a wrong type. What the struct checks of its values is left
/// out.
template <json_detail::Described T>
void set_keys(T& config, const std::vector<std::string>& overrides) {
  for (const auto& given : overrides) {
    const config_detail::Override change(given);
    try {
      if (!config_detail::set_value(config, change.path, change.key, change.value))
        config_detail::unknown_key(change.key, keys_of(T{}));
    } catch (const Error& error) {
      throw Error("--set {}: {}", given, error.what());
    }
  }
}

/// The same, and throws Error for a value out of range.
template <json_detail::Described T>
void apply_overrides(T& config, const std::vector<std::string>& overrides) {
  set_keys(config, overrides);
  if (overrides.empty()) return;
  try {
    config = from_json<T>(to_json(config));  // what the structs check of their values together
  } catch (const Error& error) {
    throw Error("--set {}: {}", overrides.size() == 1 ? overrides[0] : "", error.what());
  }
}

/// The configuration as JSON with each key's meaning in a comment before it. It can be read back.
template <json_detail::Described T>
std::string commented_json(const T& config) {
  return config_detail::commented(config, 0) + "\n";
}

/// -s, --set.
void add_set_option(CLI::App& command, std::vector<std::string>& overrides);

}  // namespace partpose::apps
