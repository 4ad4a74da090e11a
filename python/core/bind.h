// SPDX-License-Identifier: MIT
// What the parts of the module add to it.
#pragma once

#include <pybind11/pybind11.h>

namespace batten::python {

void BindBodies(pybind11::module_& m);
void BindEvaluation(pybind11::module_& m);
void BindEditing(pybind11::module_& m);
void BindShaping(pybind11::module_& m);
void BindMaking(pybind11::module_& m);
void BindJoining(pybind11::module_& m);
void BindConstructions(pybind11::module_& m);
void BindMeasures(pybind11::module_& m);
void BindSections(pybind11::module_& m);
void BindMeets(pybind11::module_& m);
void BindClouds(pybind11::module_& m);
void BindFiles(pybind11::module_& m);
void BindFits(pybind11::module_& m);
void BindSolids(pybind11::module_& m);
void BindResults(pybind11::module_& m);
void BindComparison(pybind11::module_& m);
void BindOptimize(pybind11::module_& m);

}  // namespace batten::python
