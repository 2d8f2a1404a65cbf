// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nanobind/nanobind.h>

/// Each function binds rooms of the library into modules of the same names; in the order of this list.
namespace partpose::python {

nanobind::module_ room(nanobind::module_& parent, const char* name, const char* doc);

void bind_core(nanobind::module_& parent);       // core, geometry
void bind_io(nanobind::module_& parent);         // io
void bind_stages(nanobind::module_& parent);     // camera, preprocess, descriptor, matching, registration, verification
void bind_pipeline(nanobind::module_& parent);   // dataset, pipeline
void bind_engine(nanobind::module_& parent);     // engine
void bind_synthesis(nanobind::module_& parent);  // synthesis
void bind_evaluation(nanobind::module_& parent);  // evaluation
void bind_bop(nanobind::module_& parent);         // the BOP benchmark's part of io, evaluation and synthesis
void bind_report(nanobind::module_& parent);      // report

}  // namespace partpose::python
