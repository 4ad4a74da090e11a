// SPDX-License-Identifier: MIT
// Residual terms written in Python.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "batten/fitting/residual_term.h"
#include "python/core/watch.h"

namespace batten::python {

// A Python object that any thread may let go.
using Kept = std::shared_ptr<py::object>;
Kept Keep(py::object object);

// The terms of a sequence of batten.ResidualTerm. What their code raises is kept by `watch`, which
// must outlive them, and stops the work.
ResidualTerms TermsOf(const py::handle& terms, Watch& watch);

}  // namespace batten::python
