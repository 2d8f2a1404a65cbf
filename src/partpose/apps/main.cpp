// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands.hpp"
#include "interruption.hpp"
#include "terminal.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/parallel.hpp"
#include "partpose/core/text.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

namespace {

int fail(const std::string& message, int exit_code = partpose::apps::bad_input) {
  partpose::apps::complain(message);
  return exit_code;
}

/// What is wrong with the command line: a word that is no command or no option, with the nearest that is; else what the
/// parser says.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  std::string path = "partpose";
  auto rest = words.begin();
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().back();
    path += " " + command->get_name();
    rest = std::find(rest, words.end(), command->get_name());
  }
  std::vector<std::string> commands, options;
  for (const CLI::App* sub : command->get_subcommands([](const CLI::App*) { return true; }))
    commands.push_back(sub->get_name());
  for (const CLI::App* of : {command, &app})
    for (const CLI::Option* option : of->get_options([](const CLI::Option* o) { return o->nonpositional(); }))
      for (const auto& name : option->get_lnames()) options.push_back("--" + name);
  const auto unknown = [&](const char* what, const std::string& word, const std::vector<std::string>& known) {
    const std::string similar = partpose::similar_word(word, known);
    return fmt::format("there is no {} {}{} (see {} --help)", what, word,
                       similar.empty() ? "" : fmt::format("; did you mean {}?", similar), path);
  };
  if (command != &app) ++rest;
  for (; rest != words.end() && *rest != "--"; ++rest) {
    const std::string word = rest->substr(0, rest->find('='));
    if (word.starts_with("--") && std::find(options.begin(), options.end(), word) == options.end())
      return unknown("option", word, options);
    if (!commands.empty() && std::isalpha(static_cast<unsigned char>(word[0])))
      return unknown("command", word, commands);
  }
  return fmt::format("{} (see {} --help)", error.what(), path);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace partpose;
  apps::handle_signals();
  CLI::App app{"partpose: which CAD part a depth camera sees, and its 6-DoF pose"};
  apps::Common common;
  app.set_version_flag("--version", PARTPOSE_VERSION);
  auto* quiet = app.add_flag("-q,--quiet", common.quiet, "No progress, no report beyond the output asked for");
  app.add_flag("-v,--verbose", common.verbose, "Also say what is read and how long each step takes")->excludes(quiet);
  app.add_option("--threads", common.threads, "At most so many threads (0: as many as the machine has)")
      ->check(CLI::Range(0, 4096));
  app.require_subcommand(1);
  app.fallthrough();
  app.get_formatter()->column_width(36);
  app.footer(
      "Examples:\n"
      "  partpose recognize --models parts/ frame.png          # which part is it, and where\n"
      "  partpose view --models parts/ frame.png               # the same as a page to look at, in 3-D\n"
      "  partpose live realsense --models parts/               # the frames of a camera, as they come\n"
      "  partpose dataset --models parts/ --output dataset/    # views of all parts, for the commands below\n"
      "  partpose config --output pipeline.json                # every key of the pipeline, explained\n"
      "  partpose index --dataset dataset/                     # descriptors of the views\n"
      "  partpose recognize --dataset dataset/ --config pipeline.json frame.pcd\n"
      "  partpose evaluate --dataset dataset/ --test dataset/  # how often is it right on views of a dataset\n"
      "  partpose captured scenes/ --models parts/             # and on captured scenes with ground truth\n"
      "  partpose report iterations/                           # a page to look at what --output wrote\n"
      "  partpose scenes --models parts/ --output drawn/       # draw frames of parts on a table, with their poses\n"
      "  partpose bop recognize toy/ -o partpose_toy-test.csv  # and on a dataset of the BOP benchmark's format\n"
      "  partpose inspect parts/                               # size, unit, gaps, symmetry of model files\n"
      "  partpose symmetry parts/flange.stl                    # the turns that map a part onto itself\n"
      "  partpose ambiguity parts/ --camera camera.json        # views that do not tell the pose, or the part\n"
      "Exit codes: 0 done (also when nothing was recognized); 2 bad input or usage, also when only some of the files\n"
      "could not be read (a line on standard error for each; the others are used); 130 interrupted by Ctrl-C, and\n"
      "128 + n by another signal n: nothing half written is left; 1 a fault of partpose itself.");

  std::unique_ptr<ThreadLimit> limit;
  app.parse_complete_callback([&] { limit = std::make_unique<ThreadLimit>(common.threads); });
  apps::add_recognize_command(app, common);
  apps::add_view_command(app, common);
  apps::add_live_command(app, common);
  apps::add_inspect_command(app, common);
  apps::add_config_command(app);
  apps::add_dataset_commands(app, common);
  apps::add_evaluate_command(app, common);
  apps::add_experiment_command(app, common);
  apps::add_captured_command(app, common);
  apps::add_report_command(app, common);
  apps::add_sensor_command(app, common);
  apps::add_scenes_command(app, common);
  apps::add_bop_commands(app, common);
  apps::add_symmetry_command(app, common);
  apps::add_ambiguity_command(app, common);
  apps::add_completion_command(app);

  try {
    app.parse(argc, argv);
    if (const int code = apps::exit_code_of_signal()) return fail("interrupted", code);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return fail("standard output could not be written whole");
    return common.failures == 0 ? apps::done : apps::bad_input;
  } catch (const apps::Interrupted&) {
    return fail("interrupted", apps::exit_code_of_signal());
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return fail(usage_error(app, error, {argv + 1, argv + argc}));
  } catch (const Error& error) {
    return fail(error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(fmt::format("{}: {}", error.path1().string(), error.code().message()));
  } catch (const std::system_error& error) {
    return fail(error.what());
  } catch (const std::bad_alloc&) {
    return fail("out of memory: the input is too large for this machine");
  } catch (const std::exception& error) {
    return fail(fmt::format("a fault of partpose itself: {}", error.what()), apps::internal_error);
  }
}
