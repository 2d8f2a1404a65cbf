// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands.hpp"

#include "partpose/core/error.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace partpose::apps {

namespace {

/// An option as a shell completes it.
struct CompletedOption {
  std::vector<std::string> names;  ///< "-o", "--output"
  std::string help;
  bool takes_value = false;
  std::vector<std::string> values;  ///< the allowed ones; none: a file
};

struct CompletedCommand {
  std::string path;  ///< "bop recognize"; empty: partpose itself
  std::string help;
  std::vector<CompletedOption> options;
  std::vector<std::string> words;  ///< subcommands, or the allowed values of its argument
};

/// "{mm,m}" in the name of an option's type.
std::vector<std::string> values_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto begin = type.find('{'), end = type.find('}');
  std::vector<std::string> values;
  if (begin == std::string::npos || end == std::string::npos) return values;
  std::string value;
  for (const char c : type.substr(begin + 1, end - begin - 1)) {
    if (c == ',')
      values.push_back(std::exchange(value, ""));
    else
      value += c;
  }
  values.push_back(value);
  return values;
}

std::vector<CompletedOption> options_of(const CLI::App& app) {
  std::vector<CompletedOption> options;
  for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return o->nonpositional(); })) {
    CompletedOption completed;
    for (const auto& name : option->get_snames()) completed.names.push_back("-" + name);
    for (const auto& name : option->get_lnames()) completed.names.push_back("--" + name);
    completed.help = option->get_description();
    completed.takes_value = option->get_items_expected_max() > 0 && option->get_type_size_max() > 0;
    completed.values = values_of(*option);
    options.push_back(std::move(completed));
  }
  return options;
}

void append_commands(const CLI::App& app, const std::string& path, std::vector<CompletedCommand>& commands) {
  CompletedCommand command{path, app.get_description(), options_of(app), {}};
  // Those of partpose itself go after any command.
  if (!path.empty())
    for (auto& option : options_of(*[&] {
           const CLI::App* top = &app;
           while (top->get_parent()) top = top->get_parent();
           return top;
         }()))
      if (option.names.back() != "--help" && option.names.back() != "--version")
        command.options.push_back(std::move(option));
  const auto subcommands = app.get_subcommands([](const CLI::App*) { return true; });
  for (const CLI::App* sub : subcommands) command.words.push_back(sub->get_name());
  if (subcommands.empty())
    for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return o->get_positional(); }))
      for (const auto& value : values_of(*option)) command.words.push_back(value);
  commands.push_back(std::move(command));
  for (const CLI::App* sub : subcommands)
    append_commands(*sub, path.empty() ? sub->get_name() : path + " " + sub->get_name(), commands);
}

/// Whether what follows is a configuration's key.
bool takes_key(const CompletedOption& option) {
  return option.names.back() == "--set" || option.names.back() == "--explain";
}

/// The arguments of `partpose config` that list the keys of a command's configuration; of `config` itself those of all.
std::string keys_command(const std::string& path) {
  const bool own = path == "dataset" || path == "scenes" || path == "experiment";
  return "partpose config " + (path == "config" ? "" : own ? path + " " : "pipeline ") + "--keys 2>/dev/null";
}

std::string joined(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

/// Within '...' of any shell.
std::string quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos; at += 4) text.replace(at, 1, "'\\''");
  return "'" + text + "'";
}

std::string bash_script(const std::vector<CompletedCommand>& commands) {
  std::string options, values, words, names;
  for (const auto& command : commands) {
    std::vector<std::string> own;
    for (const auto& option : command.options) {
      own.insert(own.end(), option.names.begin(), option.names.end());
      std::string pattern;
      for (const auto& name : option.names)
        pattern += fmt::format("{}\"{}:{}\"", pattern.empty() ? "" : "|", command.path, name);
      if (!option.values.empty())
        values += fmt::format("    {}) COMPREPLY=($(compgen -W {} -- \"$word\")); return ;;\n", pattern,
                              quoted(joined(option.values)));
      else if (option.takes_value && option.names.back() == "--set")
        values += fmt::format("    {}) _partpose_keys {} =; return ;;\n", pattern, quoted(command.path));
      else if (option.takes_value && option.names.back() == "--explain")
        values += fmt::format("    {}) _partpose_keys '' ''; return ;;\n", pattern);
      else if (option.takes_value)
        values += fmt::format("    {}) _partpose_files; return ;;\n", pattern);
    }
    options += fmt::format("    \"{}\") options={} ;;\n", command.path, quoted(joined(own)));
    if (!command.words.empty())
      words += fmt::format("    \"{}\") words={} ;;\n", command.path, quoted(joined(command.words)));
    if (!command.path.empty()) names += fmt::format("    \"{}\") path=$try ;;\n", command.path);
  }
  return fmt::format(R"sh(# bash completion of partpose; made by: partpose completion bash
_partpose_keys() {{
  local kind=pipeline
  case $1 in dataset|scenes|experiment) kind=$1 ;; config|'') kind= ;; esac
  [[ $2 ]] && compopt -o nospace
  COMPREPLY=($(compgen -S "$2" -W "$("${{COMP_WORDS[0]}}" config $kind --keys 2>/dev/null | grep -v '\[\]')" -- "$word"))
}}
_partpose_files() {{
  compopt -o filenames
  mapfile -t COMPREPLY < <(compgen -f -- "$word")
}}
_partpose() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}} path= try options= words= i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    try=${{path:+$path }}${{COMP_WORDS[i]}}
    case $try in
{names}    esac
  done
  case $path:$previous in
{values}  esac
  case $path in
{options}  esac
  case $path in
{words}  esac
  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$word"))
  elif [[ $words ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$word"))
  else
    _partpose_files
  fi
}}
complete -F _partpose partpose
)sh",
                     fmt::arg("names", names), fmt::arg("values", values), fmt::arg("options", options),
                     fmt::arg("words", words));
}

/// Within an _arguments specification: its own signs mean nothing.
std::string zsh_text(const std::string& help) {
  std::string out;
  for (const char c : help) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_script(const std::vector<CompletedCommand>& commands) {
  std::string functions;
  for (const auto& command : commands) {
    std::string name = "_partpose" + (command.path.empty() ? "" : "_" + command.path);
    std::replace(name.begin(), name.end(), ' ', '_');
    std::string specifications;
    for (const auto& option : command.options) {
      std::string value = !option.takes_value     ? ""
                          : option.values.empty() ? ":value:_files"
                                                  : fmt::format(":value:({})", joined(option.values));
      if (takes_key(option))
        value = fmt::format(":key:{{compadd -S \"{}\" -- ${{(f)\"$({})\"}}}}",
                            option.names.back() == "--set" ? "=" : "", keys_command(command.path));
      for (const auto& spelled : option.names)
        specifications += " \\\n    " + quoted(fmt::format("*{}[{}]{}", spelled, zsh_text(option.help), value));
    }
    std::vector<const CompletedCommand*> subcommands;
    for (const auto& other : commands)
      if (!other.path.empty() && other.path != command.path &&
          other.path.substr(0, other.path.rfind(' ') == std::string::npos ? 0 : other.path.rfind(' ')) == command.path)
        subcommands.push_back(&other);
    if (subcommands.empty()) {
      const std::string argument =
          command.words.empty() ? "*:file:_files" : fmt::format("*:value:({})", joined(command.words));
      functions += fmt::format("{}() {{\n  _arguments -s{} \\\n    {}\n}}\n", name, specifications, quoted(argument));
      continue;
    }
    std::string described, calls;
    for (const auto* sub : subcommands) {
      const std::string last = sub->path.substr(sub->path.rfind(' ') + 1);
      described += fmt::format("      {}\n", quoted(last + ":" + sub->help));
      std::string function = "_partpose_" + sub->path;
      std::replace(function.begin(), function.end(), ' ', '_');
      calls += fmt::format("      {}) {} ;;\n", last, function);
    }
    functions += fmt::format(R"sh({name}() {{
  local state line
  _arguments -s -C{specifications} \
    '1: :->command' '*:: :->rest'
  case $state in
  command)
    local -a commands=(
{described}    )
    _describe command commands ;;
  rest)
    case $line[1] in
{calls}    esac ;;
  esac
}}
)sh",
                             fmt::arg("name", name), fmt::arg("specifications", specifications),
                             fmt::arg("described", described), fmt::arg("calls", calls));
  }
  return "#compdef partpose\n# zsh completion of partpose; made by: partpose completion zsh\n" + functions +
         "compdef _partpose partpose\n";
}

std::string fish_script(const std::vector<CompletedCommand>& commands) {
  std::string out = "# fish completion of partpose; made by: partpose completion fish\n";
  for (const auto& command : commands) {
    std::string condition = "__fish_use_subcommand";
    if (!command.path.empty()) {
      condition.clear();
      std::size_t at = 0;
      while (at <= command.path.size()) {
        const auto end = std::min(command.path.find(' ', at), command.path.size());
        condition += fmt::format("{}__fish_seen_subcommand_from {}", condition.empty() ? "" : "; and ",
                                 command.path.substr(at, end - at));
        at = end + 1;
      }
    }
    for (const auto& option : command.options) {
      std::string line = "complete -c partpose -n " + quoted(condition);
      for (const auto& name : option.names)
        line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (option.takes_value) line += " -r";
      if (!option.values.empty()) line += " -f -a " + quoted(joined(option.values));
      if (takes_key(option))
        line += " -f -a " + quoted(fmt::format("({}{})", keys_command(command.path),
                                               option.names.back() == "--set" ? " | string replace -r '$' =" : ""));
      out += line + " -d " + quoted(option.help) + "\n";
    }
    for (const auto& word : command.words) {
      std::string help;
      for (const auto& other : commands)
        if (other.path == (command.path.empty() ? word : command.path + " " + word)) help = other.help;
      std::string here = condition;
      if (!command.path.empty()) here += "; and not __fish_seen_subcommand_from " + joined(command.words);
      out += fmt::format("complete -c partpose -n {} -f -a {} -d {}\n", quoted(here), word, quoted(help));
    }
  }
  return out;
}

}  // namespace

void add_completion_command(CLI::App& app) {
  auto shell = std::make_shared<std::string>();
  auto* completion = app.add_subcommand("completion", "Write what a shell needs to complete commands and options");
  completion->add_option("shell", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  completion->footer(
      "Examples:\n"
      "  source <(partpose completion bash)                    # this shell; or a line of ~/.bashrc\n"
      "  source <(partpose completion zsh)                     # in ~/.zshrc, after compinit\n"
      "  partpose completion fish >~/.config/fish/completions/partpose.fish");
  completion->callback([shell, &app] {
    std::vector<CompletedCommand> commands;
    append_commands(app, "", commands);
    fmt::print("{}", *shell == "bash"  ? bash_script(commands)
                     : *shell == "zsh" ? zsh_script(commands)
                                       : fish_script(commands));
  });
}

}  // namespace partpose::apps
