// SPDX-License-Identifier: MIT
// Point clouds from arrays and back; their spacing, noise, outliers and parts; samples of shapes.
#include <pybind11/stl.h>

#include <optional>

#include "batten/fitting/cloud_parts.h"
#include "batten/fitting/cloud_rows.h"
#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/sample_geometry.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/body.h"
#include "python/core/cloud.h"
#include "python/core/errors.h"
#include "python/core/watch.h"

namespace batten::python {
namespace {

// Whether numbers of an array lie whole numbers apart, in increasing order: what Eigen maps.
bool Steps(const py::array& array) {
  for (py::ssize_t d = 0; d < array.ndim(); ++d)
    if (array.strides(d) < 0 || array.strides(d) % array.itemsize() != 0) return false;
  return true;
}

template <typename Scalar>
PointCloud FromRows(const py::array& rows) {
  const auto* numbers = static_cast<const Scalar*>(rows.data());
  const auto dimension = static_cast<int>(rows.shape(1));
  if (rows.flags() & py::array::c_style) {
    const py::gil_scoped_release released;
    return CloudFromCoordinates(std::span(numbers, static_cast<std::size_t>(rows.size())),
                                dimension);
  }
  using Rows = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  using Step = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;
  const Step step(rows.strides(1) / rows.itemsize(), rows.strides(0) / rows.itemsize());
  const Eigen::Map<const Rows, Eigen::Unaligned, Step> map(numbers, rows.shape(0), dimension, step);
  const py::gil_scoped_release released;
  return CloudFromRows(map);
}

PointCloud FromArray(const py::array& rows) {
  if (rows.ndim() != 2 || (rows.shape(1) != 2 && rows.shape(1) != 3))
    throw py::value_error("points: an array of shape (N, 2) or (N, 3) is needed");
  if (rows.dtype().is(py::dtype::of<double>()) && Steps(rows)) return FromRows<double>(rows);
  if (rows.dtype().is(py::dtype::of<float>()) && Steps(rows)) return FromRows<float>(rows);
  return FromRows<double>(Doubles::ensure(rows));
}

constexpr double kFarthest = 1e18;  // as for files

// Throws ValueError of the first row that holds something that is not finite or too far, if any.
void RequireNear(const std::string& name, const py::array& rows) {
  const Doubles doubles = Doubles::ensure(rows);
  const auto numbers = doubles.unchecked<2>();
  for (py::ssize_t k = 0; k < numbers.shape(0); ++k) {
    for (py::ssize_t d = 0; d < numbers.shape(1); ++d) {
      if (std::abs(numbers(k, d)) <= kFarthest) continue;
      const std::string row = name + ": row " + std::to_string(k);
      if (std::isfinite(numbers(k, d))) {
        throw py::value_error(row + ": the number " +
                              py::str(py::float_(numbers(k, d))).cast<std::string>() +
                              " is beyond ±1e18");
      }
      throw py::value_error(row + " is not finite; keep " + name + "[numpy.isfinite(" + name +
                            ").all(axis=1)]");
    }
  }
}

PointsPtr FromArrays(const std::string& name,
                     const py::array& points,
                     const std::optional<Doubles>& normals,
                     const std::optional<Doubles>& weights,
                     const std::optional<py::array_t<std::uint8_t, py::array::c_style>>& colours,
                     const std::optional<Doubles>& parameters) {
  auto made = std::make_shared<Points>();
  try {
    made->cloud = FromArray(points);
  } catch (const std::invalid_argument&) {
    RequireNear(name, points);
    throw;
  }
  PointCloud& cloud = made->cloud;
  if (cloud.size() > 0 && !(cloud.points().cwiseAbs().maxCoeff() < kFarthest / 2 &&
                            cloud.origin().cwiseAbs().maxCoeff() < kFarthest / 2)) {
    RequireNear(name, points);
  }
  const auto set = [](const char* name, const auto& put) {
    try {
      put();
    } catch (const std::invalid_argument& error) {
      throw py::value_error(std::string(name) + ": " + Reason(error.what()));
    }
  };
  if (normals) set("normals", [&] { cloud.set_normals(Columns<3>(*normals, "normals")); });
  if (weights) set("weights", [&] { cloud.set_weights(Vector(*weights)); });
  if (colours) {
    set("colours", [&] {
      if (colours->ndim() != 2 || colours->shape(1) != 3)
        throw std::invalid_argument("an array of shape (N, 3) is needed");
      cloud.set_colours(
          Eigen::Map<const PointCloud::Colours>(colours->data(), 3, colours->shape(0)));
    });
  }
  if (parameters) {
    set("parameters", [&] {
      if (parameters->ndim() == 1) {  // of a curve
        Eigen::Matrix2Xd both = Eigen::Matrix2Xd::Zero(2, parameters->size());
        both.row(0) = Vector(*parameters);
        return cloud.set_parameters(std::move(both));
      }
      cloud.set_parameters(Columns<2>(*parameters, "parameters"));
    });
  }
  return made;
}

// In world coordinates: the numbers themselves where the origin is zero, else a copy.
py::array WorldPoints(const py::object& self) {
  const PointCloud& cloud = self.cast<const Points&>().cloud;
  const int dimension = cloud.dimension();
  if (cloud.origin().isZero(0) && dimension == 3)
    return View(cloud.points().data(), {cloud.size(), 3}, self);
  Eigen::MatrixXd world = (cloud.points().colwise() + cloud.origin()).topRows(dimension);
  return Owned(std::move(world), {cloud.size(), dimension});
}

template <typename Matrix>
py::object Attribute(const Matrix& matrix, const py::object& self) {
  if (matrix.size() == 0) return py::none();
  if (matrix.rows() == 1 || matrix.cols() == 1)
    return View(
        matrix.data(),
        Matrix::RowsAtCompileTime > 1 ? Shape{matrix.cols(), matrix.rows()} : Shape{matrix.size()},
        self);
  return View(matrix.data(), {matrix.cols(), matrix.rows()}, self);
}

// (spacing, noise, outliers)
py::tuple Statistics(const PointsPtr& points, int threads, std::uint64_t seed) {
  CloudStatistics found = Watched([=](Watch& watch) {
    ThreadPool pool(threads);
    const MergedCloud merged = MergeDuplicates(points->cloud);
    CloudStatisticsOptions options;
    options.seed = seed;
    const auto& places = merged.cloud.points();
    CloudStatistics statistics = MeasureCloud(
        places, NeighbourIndex(places), options, pool, [&](const char* stage, double fraction) {
          return watch.Go(stage, fraction);
        });
    PointMask every(points->cloud.size());
    for (Eigen::Index k = 0; k < every.size(); ++k) {
      every[k] = statistics.outliers.size() > 0 &&
                 statistics.outliers[merged.place[static_cast<std::size_t>(k)]];
    }
    statistics.outliers = std::move(every);
    return statistics;
  });
  const py::ssize_t count = found.outliers.size();
  return py::make_tuple(found.spacing, found.noise, Owned(std::move(found.outliers), {count}));
}

std::vector<py::array> PartsOf(const PointsPtr& points, int threads) {
  const CloudParts found = Watched([=](Watch&) {
    ThreadPool pool(threads);
    return FindCloudParts(points->cloud, pool);
  });
  std::vector<py::array> parts;
  for (const CloudPart& part : found.parts)
    parts.push_back(py::array_t<Eigen::Index>(std::ssize(part.points), part.points.data()));
  return parts;
}

PointsPtr Sample(
    const Body& body, Eigen::Index count, double noise, double outliers, std::uint64_t seed) {
  auto made = std::make_shared<Points>();
  const py::gil_scoped_release released;
  made->cloud = std::visit(
      [&](const auto& shape) {
        return SampleGeometry(shape, {count, noise, outliers, seed});
      },
      body.geometry());
  return made;
}

}  // namespace

void BindClouds(py::module_& m) {
  const auto of = [](const py::object& self) -> const PointCloud& {
    return self.cast<const Points&>().cloud;
  };
  py::class_<Points, PointsPtr>(m, "Points")
      .def_property_readonly("size", [](const Points& p) { return p.cloud.size(); })
      .def_property_readonly("dimension", [](const Points& p) { return p.cloud.dimension(); })
      .def_property_readonly("points", &WorldPoints)
      .def_property_readonly("origin", [](const Points& p) { return Triple(p.cloud.origin()); })
      .def_property_readonly("normals",
                             [=](const py::object& s) { return Attribute(of(s).normals(), s); })
      .def_property_readonly("weights",
                             [=](const py::object& s) { return Attribute(of(s).weights(), s); })
      .def_property_readonly("colours",
                             [=](const py::object& s) { return Attribute(of(s).colours(), s); })
      .def_property_readonly("parameters",
                             [=](const py::object& s) { return Attribute(of(s).parameters(), s); })
      .def_readonly("files", &Points::files)
      .def_readonly("fields", &Points::fields)
      .def_readonly("remarks", &Points::remarks)
      .def_readonly("missing", &Points::missing)
      .def_readonly("points_in_file", &Points::points_in_file)
      .def_readonly("non_finite", &Points::non_finite)
      .def_readonly("filtered", &Points::filtered);
  m.def("points_from_arrays", &FromArrays);
  m.def("pick", [](const Points& points, const std::vector<Eigen::Index>& indices) {
    auto made = std::make_shared<Points>();
    made->cloud = points.cloud.Picked(indices);
    return made;
  });
  m.def("statistics", &Statistics);
  m.def("parts", &PartsOf);
  m.def("sample", &Sample);
}

}  // namespace batten::python
