// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands.hpp"
#include "interruption.hpp"
#include "output.hpp"
#include "recognition_output.hpp"
#include "recognizer_choice.hpp"
#include "scene_reader.hpp"

#include "partpose/core/error.hpp"
#include "partpose/pipeline/iteration_output.hpp"
#include "partpose/report/report.hpp"

#include <CLI/CLI.hpp>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <memory>

namespace partpose::apps {

namespace {

namespace fs = std::filesystem;

struct ViewArguments : RecognizerArguments {
  fs::path scene, camera, output;
  std::string units = "mm";
  bool no_open = false, json = false;
};

/// A folder of its own that goes when this does.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "partpose-view-XXXXXX").string();
    if (!mkdtemp(name.data())) throw Error("{}: no temporary folder can be made", name);
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

bool has_display() {
  const auto set = [](const char* name) {
    const char* value = std::getenv(name);
    return value && *value;
  };
  return set("DISPLAY") || set("WAYLAND_DISPLAY");
}

/// Gives the page to the desktop's browser. False: there is no program for that, or it says no.
bool open_page(const fs::path& page) {
  const std::string path = fs::absolute(page).string();
  const pid_t child = fork();
  if (child < 0) return false;
  if (child == 0) {
    if (const int nowhere = open("/dev/null", O_RDWR); nowhere >= 0)
      for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
    setsid();  // the browser outlives this terminal
    execlp("xdg-open", "xdg-open", path.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// The report of a scene that is recognized now, or of the frame that an output folder holds.
fs::path write_page(const ViewArguments& arguments, const Common& common, Json& said) {
  check_file_can_be_written(arguments.output);
  ReportOptions options;
  options.title = arguments.scene.filename().string();
  if (fs::is_directory(arguments.scene)) {
    if (!fs::exists(arguments.scene / "result.json"))
      throw Error("{}: has no result.json; give a scene, or one frame's output folder (partpose report shows many)",
                  arguments.scene.string());
    const fs::path page = arguments.output.empty() ? arguments.scene / "report.html" : arguments.output;
    write_report(arguments.scene, page, options);
    return page;
  }
  const Unfinished folder;
  const SceneReading reading = {arguments.camera, arguments.units};
  check_scenes(reading, {arguments.scene});
  ChosenRecognizer chosen = choose_recognizer("view", arguments, common);
  chosen.config.debug.save_extras_json = chosen.config.debug.save_point_clouds = true;
  if (arguments.units == "m" && chosen.config.preprocessing.scale_flag)
    throw Error("view: --units m and the configuration's preprocessing.scale_flag would both scale the scene");
  const Scene scene = SceneReader(reading).read(arguments.scene);
  const Recognition recognition = named_after(arguments.scene, [&] { return chosen.recognizer->recognize(scene); });
  check_not_interrupted();
  const TemporaryFolder temporary;
  const Catalogue& catalogue = chosen.recognizer->catalogue();
  const fs::path iteration = write_iteration(temporary.path(), recognition, scene, catalogue, chosen.config);
  const fs::path page =
      arguments.output.empty() ? fs::path(arguments.scene.stem().string() + ".report.html") : arguments.output;
  write_report(iteration, page, options);
  said = line_of(arguments.scene, recognition, catalogue);
  if (!common.quiet && !arguments.json) print_for_people(arguments.scene, recognition, catalogue);
  return page;
}

void view(const ViewArguments& arguments, const Common& common) {
  Json said = {{"scene", arguments.scene.string()}};
  const fs::path page = write_page(arguments, common, said);
  const bool opened = !arguments.no_open && has_display() && open_page(page);
  said["report"] = page.string();
  said["opened"] = opened;
  if (arguments.json)
    print_json(said);
  else if (opened && !common.quiet)
    fmt::print("{}: opened in the browser\n", page.string());
  else if (!opened)
    fmt::print("{}: open it in a browser\n", page.string());
}

}  // namespace

void add_view_command(CLI::App& app, const Common& common) {
  auto arguments = std::make_shared<ViewArguments>();
  auto* view_command = app.add_subcommand("view", "Recognize one scene and look at it in 3-D, step by step");
  view_command
      ->add_option("scene", arguments->scene,
                   "A scene as of recognize, or the folder that its --output wrote of one frame")
      ->required();
  add_recognizer_arguments(*view_command, *arguments);
  view_command->add_option("--camera", arguments->camera, "Camera JSON of the depth image");
  view_command->add_option("--units", arguments->units, "Unit of a cloud's coordinates: mm or m")
      ->check(CLI::IsMember({"mm", "m"}))
      ->capture_default_str();
  view_command->add_option("-o,--output", arguments->output,
                           "Page to write (default: SCENE.report.html in this folder)");
  view_command->add_flag("--no-open", arguments->no_open, "Only write the page and say where it is");
  view_command->add_flag("--json", arguments->json, "Print the result and the page's place as JSON");
  view_command->footer(
      "Examples:\n"
      "  partpose view --models parts/ scenes/bracket.png\n"
      "  partpose view --dataset dataset/ --config pipeline.json --output why.html scene.pcd\n"
      "  partpose view iterations/2026-01-31_14-05-09_123 --no-open\n"
      "The page needs no network. It is opened by xdg-open where there is a display.");
  view_command->callback([arguments, &common] { view(*arguments, common); });
}

}  // namespace partpose::apps
