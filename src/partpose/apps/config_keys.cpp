// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "config_keys.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>

namespace partpose::apps {

namespace config_detail {

namespace {

std::vector<Step> path_of(const std::string& key, const std::string& given) {
  std::vector<Step> path;
  for (std::size_t at = 0; at <= key.size();) {
    const std::size_t end = std::min(key.find('.', at), key.size());
    std::string name = key.substr(at, end - at);
    const std::size_t bracket = std::min(name.find('['), name.size());
    std::string items = name.substr(bracket);
    name.resize(bracket);
    if (name.empty()) throw Error("--set {}: a name is missing; keys are written like a.b or a[0].b", given);
    path.push_back({std::move(name), {}});
    while (!items.empty()) {
      std::size_t item = 0;
      const auto [rest, error] = std::from_chars(items.data() + 1, items.data() + items.size(), item);
      if (items[0] != '[' || error != std::errc() || rest == items.data() + items.size() || *rest != ']')
        throw Error("--set {}: \"{}\" is no item of a list; write [0] for the first", given, items);
      path.push_back({{}, item});
      items.erase(0, static_cast<std::size_t>(rest - items.data()) + 1);
    }
    at = end + 1;
  }
  return path;
}

std::string last_name(const std::string& path) { return path.substr(path.rfind('.') + 1); }

}  // namespace

Override::Override(const std::string& given) {
  const std::size_t equals = given.find('=');
  if (equals == std::string::npos || equals == 0) throw Error("--set {}: expected KEY=VALUE, like vfh.k_nn=9", given);
  key = given.substr(0, equals);
  value = given.substr(equals + 1);
  path = path_of(key, given);
}

void unknown_key(const std::string& key, const std::vector<ConfigKey>& keys) {
  // Who gives a name without its section is told in which sections there is one like it.
  const bool whole_path = key.find('.') != std::string::npos;
  std::vector<std::string> words;
  for (const auto& k : keys) words.push_back(whole_path ? k.path : last_name(k.path));
  const std::string nearest = similar_word(key, words);
  if (nearest.empty()) throw Error("unknown key \"{}\"; partpose config --keys lists all", key);
  std::vector<std::string> meant;
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (words[i] == nearest) meant.push_back(fmt::format("\"{}\"", keys[i].path));
  throw Error("unknown key \"{}\"; did you mean {}?", key, fmt::join(meant, " or "));
}

std::string comment_of(const std::string& help, int indent) {
  const std::string margin = std::string(static_cast<std::size_t>(indent), ' ') + "// ";
  constexpr std::size_t width = 110;
  std::string out, line = margin;
  for (std::size_t at = 0; at < help.size();) {
    const std::size_t end = std::min(help.find(' ', at), help.size());
    const std::string word = help.substr(at, end - at);
    if (line.size() + word.size() > width && line.size() > margin.size()) {
      line.back() = '\n';
      out += line;
      line = margin;
    }
    line += word + ' ';
    at = end + 1;
  }
  line.back() = '\n';
  return out + line;
}

std::string comment_of(const ConfigKey& item, int indent) {
  const std::string standard = item.section ? "" : item.optional ? ", absent" : ", " + json_line(item.standard);
  return comment_of(fmt::format("{} ({}{}): {}", item.path, item.type, standard, item.help), indent);
}

}  // namespace config_detail

void add_set_option(CLI::App& command, std::vector<std::string>& overrides) {
  command
      .add_option("-s,--set", overrides,
                  "Change a key of the configuration: KEY=VALUE, like vfh.k_nn=9; may be given more than once "
                  "(partpose config --explain KEY)")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

}  // namespace partpose::apps
