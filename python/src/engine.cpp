// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "described.hpp"
#include "interruptible.hpp"
#include "rooms.hpp"

#include "partpose/engine/engine.hpp"
#include "partpose/pipeline/catalogue_cache.hpp"
#include "partpose/pipeline/recognizer.hpp"

namespace partpose::python {

namespace {

/// With the description that makes it a Python class like all other options.
struct DescribedEngineOptions : EngineOptions {
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("min_score", self.min_score, "least probability that a part is what is seen for it to be believed, 0 to 1");
  }
};

}  // namespace

void bind_engine(nb::module_& parent) {
  namespace fs = std::filesystem;
  auto m = room(parent, "engine", "The engine: templates, a distance field and render-and-compare.");
  const auto released = nb::call_guard<nb::gil_scoped_release>();

  bind_described<DescribedEngineOptions>(m, "EngineOptions", "What the Engine may be told.");

  nb::class_<Engine, PartRecognizer>(m, "Engine",
                                     "Recognizes parts by their shape alone: depth templates find them, a distance "
                                     "field and rendering decide. All objects of a frame are in the detections.")
      .def(nb::init<Catalogue, DescribedEngineOptions>(), "catalogue"_a, "options"_a = DescribedEngineOptions{},
           released)
      .def_static(
          "from_files",
          [](const std::vector<fs::path>& paths, const DescribedEngineOptions& options,
             const std::optional<fs::path>& cache_folder, const Callback& progress) {
            const fs::path cache = cache_folder ? *cache_folder : default_cache_folder();
            return interruptible(progress, [&](const Progress& told) {
              return new Engine(
                  cached_catalogue(paths, DatasetPreparationConfig{}, Recognizer::catalogue_config(), cache, told),
                  options);
            });
          },
          "paths"_a, "options"_a = DescribedEngineOptions{}, "cache_folder"_a = nb::none(), "progress"_a = nb::none(),
          released,
          "Of model files, or folders of them. The catalogue is made on first use and kept under the cache folder.");
}

}  // namespace partpose::python
