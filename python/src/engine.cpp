// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "described.hpp"
#include "interruptible.hpp"
#include "recognition.hpp"
#include "rooms.hpp"

#include "partpose/core/parallel.hpp"
#include "partpose/engine/engine.hpp"
#include "partpose/geometry/symmetry_search.hpp"

#include <mutex>

namespace partpose::python {

namespace {

/// With the description that makes it a Python class like all other options.
struct DescribedEngineOptions : EngineOptions {
  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("min_score", self.min_score, "least probability that a part is what is seen for it to be believed, 0 to 1");
  }
};

/// What an Engine needs, and the parts' symmetries, by which a Recognition knows the poses that look the same.
Catalogue engine_catalogue(const std::vector<NamedMesh>& parts, const Progress& progress) {
  Catalogue catalogue = mesh_catalogue(parts);
  std::size_t done = 0;
  std::mutex mutex;
  parallel_for(catalogue.parts.size(), [&](std::size_t i) {
    try {
      catalogue.dataset.out.models[i].symmetries = ModelSymmetries::of(search_symmetries(catalogue.parts[i].mesh));
    } catch (const Error&) {
      // A mesh that cannot be searched has none that are known.
    }
    const std::lock_guard lock(mutex);
    progress("finding symmetries", ++done, catalogue.parts.size());
  });
  return catalogue;
}

}  // namespace

void bind_engine(nb::module_& parent) {
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
          [](const Paths& paths, const DescribedEngineOptions& options, const Callback& progress) {
            std::vector<std::string> doubts;
            auto made = interruptible(progress, [&](const Progress& told) {
              return std::make_unique<Engine>(engine_catalogue(read_parts(paths, doubts), told), options);
            });
            warn(doubts);
            return made.release();
          },
          "paths"_a, "options"_a = DescribedEngineOptions{}, "progress"_a = nb::none(), released,
          "Of model files, or folders of them. Nothing is kept on disk.")
      .def("add", &Engine::add, "part"_a, released,
           "One more part; the others are not touched. Raises Error when there is one of that name. Not while another "
           "thread recognizes.")
      .def("remove", &Engine::remove, "name"_a, released,
           "Raises Error when there is no part of that name, or no other. Not while another thread recognizes.");
}

}  // namespace partpose::python
