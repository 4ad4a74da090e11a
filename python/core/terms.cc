// SPDX-License-Identifier: MIT
#include "python/core/terms.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "python/core/arrays.h"

namespace batten::python {
namespace {

class PythonTerm : public ResidualTerm {
 public:
  PythonTerm(const py::handle& term, Watch& watch)
      : residuals_(Field<int>(term, "residuals")),
        control_points_(Field<std::vector<int>>(term, "control_points")),
        weights_(Field<std::vector<int>>(term, "weights")),
        needs_knots_(Field<bool>(term, "needs_knots")),
        evaluate_(Keep(term.attr("evaluate"))),
        watch_(watch) {
    if (residuals_ < 1) throw py::value_error("terms: residuals must be at least 1");
  }

  int residuals() const override { return residuals_; }
  std::vector<int> ControlPoints() const override { return control_points_; }
  std::vector<int> Weights() const override { return weights_; }
  bool needs_knots() const override { return needs_knots_; }

  bool Evaluate(std::span<const double> values,
                std::span<double> residual,
                std::span<double> jacobian) const override {
    bool usable = false;
    InPython(watch_, [&] {
      const py::array_t<double> numbers(std::ssize(values), values.data());
      const py::object answer = (*evaluate_)(numbers);
      if (answer.is_none()) return;
      const auto pair = answer.cast<std::pair<py::object, py::object>>();
      Copy(pair.first, "residual", residual);
      if (!jacobian.empty()) Copy(pair.second, "Jacobian", jacobian);
      usable = std::ranges::all_of(residual, [](double r) { return std::isfinite(r); });
    });
    return usable;
  }

 private:
  template <typename T>
  static T Field(const py::handle& term, const char* name) {
    try {
      return py::cast<T>(term.attr(name));
    } catch (const py::cast_error&) {
      throw py::value_error(std::string("terms: ") + name + " of a ResidualTerm is of no use");
    }
  }

  static void Copy(const py::object& from, const char* what, std::span<double> to) {
    const Doubles numbers = Doubles::ensure(from);
    if (!numbers) throw py::error_already_set();
    if (numbers.size() != std::ssize(to)) {
      throw py::value_error("terms: evaluate gave a " + std::string(what) + " of " +
                            std::to_string(numbers.size()) + " numbers, not " +
                            std::to_string(to.size()));
    }
    std::copy_n(numbers.data(), numbers.size(), to.begin());
  }

  int residuals_;
  std::vector<int> control_points_, weights_;
  bool needs_knots_;
  Kept evaluate_;
  Watch& watch_;
};

}  // namespace

Kept Keep(py::object object) {
  return Kept(new py::object(std::move(object)), [](py::object* kept) {
    const py::gil_scoped_acquire acquired;
    delete kept;
  });
}

ResidualTerms TermsOf(const py::handle& terms, Watch& watch) {
  ResidualTerms list;
  for (const py::handle& term : terms) list.push_back(std::make_shared<PythonTerm>(term, watch));
  return list;
}

}  // namespace batten::python
