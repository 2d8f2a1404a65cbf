// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "rooms.hpp"

#include "partpose/core/error.hpp"

#include <nanobind/nanobind.h>

namespace partpose::python {

nanobind::module_ room(nanobind::module_& parent, const char* name, const char* doc) {
  nanobind::module_ module = parent.def_submodule(name, doc);
  // The classes' home is partpose.NAME, which a person imports; python/partpose/NAME.py takes all from here.
  module.attr("__name__") = (std::string("partpose.") + name).c_str();
  return module;
}

}  // namespace partpose::python

NB_MODULE(_partpose, module) {
  using namespace partpose::python;
  nanobind::set_leak_warnings(false);  // tables of properties live as long as the process
  module.attr("__version__") = PARTPOSE_VERSION;
  bind_core(module);
  bind_io(module);
  bind_stages(module);
  bind_pipeline(module);
  bind_engine(module);
  bind_synthesis(module);
  bind_evaluation(module);
  bind_bop(module);
  bind_report(module);
}
