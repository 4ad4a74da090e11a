// SPDX-License-Identifier: MIT
// Between numpy's arrays and Eigen's matrices.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace batten::python {

namespace py = pybind11;

// What functions of the module take: the package has made it C-contiguous doubles beforehand.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Shape = std::vector<py::ssize_t>;

// Numbers that belong to `owner`, which lives as long as the array; no copy, read-only.
template <typename T>
py::array View(const T* numbers, Shape shape, const py::handle& owner) {
  py::array_t<T> view(std::move(shape), numbers, owner);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

// A matrix or vector that the array takes over; no copy.
template <typename Matrix>
py::array Owned(Matrix&& matrix, Shape shape) {
  using Kept = std::remove_cvref_t<Matrix>;
  auto kept = std::make_unique<Kept>(std::forward<Matrix>(matrix));
  const auto* numbers = kept->data();
  const py::capsule owner(kept.get(), [](void* matrix) { delete static_cast<Kept*>(matrix); });
  kept.release();
  return py::array_t<typename Kept::Scalar>(std::move(shape), numbers, owner);
}

// The rows of an m × columns array as the columns of a matrix. Throws ValueError naming the
// argument for another shape.
template <int Rows>
Eigen::Matrix<double, Rows, Eigen::Dynamic> Columns(const Doubles& array, const char* name) {
  if (array.ndim() != 2 || array.shape(1) != Rows) {
    throw py::value_error(std::string(name) + ": an array of shape (N, " + std::to_string(Rows) +
                          ") is needed");
  }
  return Eigen::Map<const Eigen::Matrix<double, Rows, Eigen::Dynamic>>(
      array.data(), Rows, array.shape(0));
}

inline Eigen::VectorXd Vector(const Doubles& array) {
  return Eigen::Map<const Eigen::VectorXd>(array.data(), array.size());
}

inline std::vector<double> Numbers(const Doubles& array) {
  return {array.data(), array.data() + array.size()};
}

inline py::tuple Triple(const Eigen::Vector3d& v) { return py::make_tuple(v[0], v[1], v[2]); }

}  // namespace batten::python
