// SPDX-License-Identifier: MIT
// batten._core: the library as the package batten calls it. Arguments come checked for their kind
// by the package; what the library refuses becomes ValueError, FitRefused, ReadError or WriteError.
#include <pybind11/pybind11.h>

#include "python/core/bind.h"
#include "python/core/errors.h"
#include "python/core/watch.h"

PYBIND11_MODULE(_core, m) {
  using namespace batten::python;
  m.attr("version") = BATTEN_VERSION;
  BindErrors();
  BindBodies(m);
  BindEvaluation(m);
  BindEditing(m);
  BindShaping(m);
  BindMaking(m);
  BindJoining(m);
  BindConstructions(m);
  BindMeasures(m);
  BindSections(m);
  BindMeets(m);
  BindClouds(m);
  BindFiles(m);
  BindFits(m);
  BindResults(m);
  BindSolids(m);
  BindComparison(m);
  BindOptimize(m);
  m.def("await_all", &AwaitAll);
  pybind11::module_::import("atexit").attr("register")(m.attr("await_all"));
}
