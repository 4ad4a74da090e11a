// SPDX-License-Identifier: MIT
// Residual terms written in Python.
#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <memory>
#include <utility>

#include "batten/fitting/residual_term.h"
#include "python/core/watch.h"

namespace batten::python {

// A Python object that any thread may let go.
using Kept = std::shared_ptr<py::object>;
Kept Keep(py::object object);

// f() with the interpreter's lock, and whether it came to its end: what it raises is kept by
// `watch` and stops the work.
template <typename Function>
bool InPython(Watch& watch, const Function& f) {
  if (watch.stopped()) return false;
  const py::gil_scoped_acquire acquired;
  try {
    f();
    return true;
  } catch (py::error_already_set& error) {
    watch.KeepError(std::move(error));
  } catch (const std::exception& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
    watch.KeepError(py::error_already_set());
  }
  return false;
}

// The terms of a sequence of batten.ResidualTerm. What their code raises is kept by `watch`, which
// must outlive them, and stops the work.
ResidualTerms TermsOf(const py::handle& terms, Watch& watch);

}  // namespace batten::python
