// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace partpose::apps {

/// What partpose returns; 128 + n when signal n (130: Ctrl-C) ended it. docs/command_line.md.
enum ExitCode { done = 0, internal_error = 1, bad_input = 2 };

/// What every command understands.
struct Common {
  bool quiet = false, verbose = false;
  int threads = 0;
  mutable int failures = 0;  ///< files that could not be read; each was reported
};

// Each adds its subcommands to the app; what they do runs as their callback.
void add_ambiguity_command(CLI::App& app, const Common& common);
void add_bop_commands(CLI::App& app, const Common& common);
void add_captured_command(CLI::App& app, const Common& common);
void add_completion_command(CLI::App& app);
void add_config_command(CLI::App& app);
void add_dataset_commands(CLI::App& app, const Common& common);
void add_evaluate_command(CLI::App& app, const Common& common);
void add_experiment_command(CLI::App& app, const Common& common);
void add_inspect_command(CLI::App& app, const Common& common);
void add_live_command(CLI::App& app, const Common& common);
void add_recognize_command(CLI::App& app, const Common& common);
void add_report_command(CLI::App& app, const Common& common);
void add_scenes_command(CLI::App& app, const Common& common);
void add_sensor_command(CLI::App& app, const Common& common);
void add_symmetry_command(CLI::App& app, const Common& common);
void add_view_command(CLI::App& app, const Common& common);

}  // namespace partpose::apps
