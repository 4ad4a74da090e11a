// SPDX-License-Identifier: MIT
// Options of the library from a dictionary of keywords.
#pragma once

#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/fit_locally.h"
#include "batten/fitting/fit_through.h"
#include "batten/fitting/grid_options.h"
#include "batten/fitting/interpolate_cloud.h"
#include "batten/fitting/optimize.h"
#include "batten/fitting/primitive_options.h"
#include "batten/fitting/solid_options.h"
#include "batten/fitting/surface_options.h"

namespace batten::python {

namespace py = pybind11;

// The values of keywords, each checked for its kind; throws ValueError naming the keyword.
class Keywords {
 public:
  explicit Keywords(py::dict values) : values_(std::move(values)) {}

  // Whether it is there and not None.
  bool Has(const char* name) const;
  py::object Value(const char* name) const;

  double Number(const char* name) const;
  std::int64_t Whole(const char* name) const;
  bool Truth(const char* name) const;
  std::string Word(const char* name) const;
  std::vector<double> Numbers(const char* name, std::size_t count) const;
  std::vector<std::int64_t> Wholes(const char* name, std::size_t count) const;

  // As the field's own kind, where the keyword is given.
  void Take(const char* name, double& field) const;
  void Take(const char* name, int& field) const;
  void Take(const char* name, bool& field) const;
  void Take(const char* name, std::uint64_t& field) const;
  void Take(const char* name, std::optional<double>& field) const;
  void Take(const char* name, std::optional<int>& field) const;
  void Take(const char* name, Eigen::Vector3d& field) const;
  void Take(const char* name, std::optional<Eigen::Vector3d>& field) const;
  void Take(const char* name, std::optional<std::pair<int, int>>& field) const;

  int Threads() const;  // 0, for all cores, where not given

  // One of the words, else the error names those there are.
  template <typename Choice>
  void Choose(const char* name,
              std::initializer_list<std::pair<const char*, Choice>> words,
              Choice& field) const {
    if (!Has(name)) return;
    const std::string word = Word(name);
    std::string known;
    for (const auto& [text, choice] : words) {
      if (word == text) {
        field = choice;
        return;
      }
      known += (known.empty() ? "'" : ", '") + std::string(text) + "'";
    }
    Refuse(name, "'" + word + "' is none of " + known);
  }

  [[noreturn]] static void Refuse(const char* name, const std::string& rule);

 private:
  py::dict values_;
};

SurfaceFitOptions SurfaceOptionsOf(const Keywords& keywords);
CurveFitOptions CurveOptionsOf(const Keywords& keywords);
PrimitiveFitOptions PrimitiveOptionsOf(const Keywords& keywords);
GridFitOptions GridOptionsOf(const Keywords& keywords);
SolidFitOptions SolidOptionsOf(const Keywords& keywords);
LocalFitOptions LocalOptionsOf(const Keywords& keywords);
std::vector<MetPlace> PlacesOf(const Keywords& keywords);  // three or six numbers each
CloudInterpolationOptions InterpolationOptionsOf(const Keywords& keywords);
OptimizeOptions OptimizeOptionsOf(const Keywords& keywords);

}  // namespace batten::python
