// SPDX-License-Identifier: MIT
// Points, derivatives, normals, curvature and nearest places at many parameters.
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "batten/geometry/curvature.h"
#include "batten/geometry/points_into.h"
#include "batten/geometry/thread_pool.h"
#include "batten/geometry/trim_region.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/body.h"
#include "python/core/watch.h"

namespace batten::python {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Parameters that a thread takes at once.
constexpr py::ssize_t kBlock = 512;

// Below so many parameters the start of threads costs more than they save.
constexpr py::ssize_t kWorthThreads = 20000;

// work(pool), for so many parameters, without the interpreter's lock.
template <typename Work>
void WithPool(py::ssize_t count, int threads, const Work& work) {
  const py::gil_scoped_release released;
  ThreadPool pool(count < kWorthThreads ? 1 : threads);
  work(pool);
}

// work(begin, end) over blocks of [0, count), likewise.
template <typename Work>
void InBlocks(py::ssize_t count, int threads, const Work& work) {
  WithPool(count, threads, [&](ThreadPool& pool) { pool.For(count, kBlock, work); });
}

void RequireNumbers(const Doubles& parameters, const char* name) {
  if (std::any_of(parameters.data(), parameters.data() + parameters.size(), [](double at) {
        return std::isnan(at);
      }))
    throw py::value_error(std::string(name) + ": not a number");
}

// u and v of each, which have the same size.
void RequirePairs(const Doubles& u, const Doubles& v) {
  if (u.size() != v.size()) throw py::value_error("u, v: sizes differ");
  RequireNumbers(u, "u");
  RequireNumbers(v, "v");
}

template <int Dim>
py::array CurvePoints(const Body& body, const Doubles& u, int threads) {
  RequireNumbers(u, "u");
  py::array_t<double> points(Shape{u.size(), Dim});
  double* const out = points.mutable_data();
  const double* const in = u.data();
  InBlocks(u.size(), threads, [&](py::ssize_t begin, py::ssize_t end) {
    thread_local typename NurbsCurve<Dim>::Points block;
    const auto size = static_cast<std::size_t>(end - begin);
    body.curve_evaluator<Dim>().Points(std::span(in + begin, size), block);
    std::copy_n(block.data(), block.size(), out + Dim * begin);
  });
  return points;
}

py::array PointsAt(const Body& body,
                   const Doubles& u,
                   const std::optional<Doubles>& v,
                   int threads) {
  if (!body.is_surface()) {
    return body.dimension() == 2 ? CurvePoints<2>(body, u, threads)
                                 : CurvePoints<3>(body, u, threads);
  }
  RequirePairs(u, v.value());
  py::array_t<double> points(Shape{u.size(), 3});
  const auto count = static_cast<std::size_t>(u.size());
  const std::span us(u.data(), count), vs(v->data(), count);
  const std::span out(points.mutable_data(), 3 * count);
  WithPool(u.size(), threads, [&](ThreadPool& pool) {
    PointsInto(body.evaluator(), us, vs, out, pool);
  });
  return points;
}

// order + 1 × N × Dim
template <int Dim>
py::array CurveDerivatives(const Body& body, const Doubles& u, int order, int threads) {
  RequireNumbers(u, "u");
  py::array_t<double> values(Shape{order + 1, u.size(), Dim});
  auto out = values.mutable_unchecked<3>();
  const double* const in = u.data();
  const auto& curve = std::get<NurbsCurve<Dim>>(body.geometry());
  InBlocks(u.size(), threads, [&](py::ssize_t begin, py::ssize_t end) {
    for (py::ssize_t n = begin; n < end; ++n) {
      const typename NurbsCurve<Dim>::Points columns = curve.Derivatives(in[n], order);
      for (int k = 0; k <= order; ++k)
        for (int d = 0; d < Dim; ++d) out(k, n, d) = columns(d, k);
    }
  });
  return values;
}

// order + 1 × order + 1 × N × 3, NaN beyond the total order
py::array SurfaceDerivativesAt(
    const Body& body, const Doubles& u, const Doubles& v, int order, int threads) {
  RequirePairs(u, v);
  py::array_t<double> values(Shape{order + 1, order + 1, u.size(), 3});
  auto out = values.mutable_unchecked<4>();
  const double *const in_u = u.data(), *const in_v = v.data();
  const auto put = [&](int k, int l, py::ssize_t n, const Eigen::Vector3d& value) {
    for (int d = 0; d < 3; ++d) out(k, l, n, d) = value[d];
  };
  const NurbsSurface& surface = body.surface();
  InBlocks(u.size(), threads, [&](py::ssize_t begin, py::ssize_t end) {
    for (py::ssize_t n = begin; n < end; ++n) {
      if (order <= 2) {
        const SurfaceJet jet = body.evaluator().JetAt(in_u[n], in_v[n]);
        put(0, 0, n, jet.point);
        if (order > 0) {
          put(1, 0, n, jet.du);
          put(0, 1, n, jet.dv);
          put(1, 1, n, order > 1 ? jet.duv : Eigen::Vector3d::Constant(kNaN));
        }
        if (order > 1) {
          put(2, 0, n, jet.duu);
          put(0, 2, n, jet.dvv);
          for (const auto& [k, l] : {std::pair{1, 2}, {2, 1}, {2, 2}})
            put(k, l, n, Eigen::Vector3d::Constant(kNaN));
        }
        continue;
      }
      const SurfaceDerivatives all = surface.Derivatives(in_u[n], in_v[n], order);
      for (int k = 0; k <= order; ++k)
        for (int l = 0; l <= order; ++l)
          put(k, l, n, k + l <= order ? all(k, l) : Eigen::Vector3d::Constant(kNaN));
    }
  });
  return values;
}

py::array Derivatives(
    const Body& body, const Doubles& u, const std::optional<Doubles>& v, int order, int threads) {
  constexpr int kHighest = 100;
  if (order < 0 || order > kHighest) {
    throw py::value_error("order: " + std::to_string(order) + " is not in [0, " +
                          std::to_string(kHighest) + "]");
  }
  if (body.is_surface()) return SurfaceDerivativesAt(body, u, v.value(), order, threads);
  return body.dimension() == 2 ? CurveDerivatives<2>(body, u, order, threads)
                               : CurveDerivatives<3>(body, u, order, threads);
}

py::array Normals(const Body& body, const Doubles& u, const Doubles& v, int threads) {
  RequirePairs(u, v);
  py::array_t<double> normals(Shape{u.size(), 3});
  auto out = normals.mutable_unchecked<2>();
  const double *const in_u = u.data(), *const in_v = v.data();
  body.surface();
  InBlocks(u.size(), threads, [&](py::ssize_t begin, py::ssize_t end) {
    for (py::ssize_t n = begin; n < end; ++n) {
      const auto normal = body.evaluator().NormalAt(in_u[n], in_v[n]);
      for (int d = 0; d < 3; ++d) out(n, d) = normal ? (*normal)[d] : kNaN;
    }
  });
  return normals;
}

// Surfaces N × 4: Gaussian, mean, least, greatest; curves N × 2: curvature, torsion.
py::array Curvatures(const Body& body,
                     const Doubles& u,
                     const std::optional<Doubles>& v,
                     int threads) {
  const bool surface = body.is_surface();
  if (surface) {
    RequirePairs(u, v.value());
  } else {
    RequireNumbers(u, "u");
  }
  py::array_t<double> values(Shape{u.size(), surface ? 4 : 2});
  auto out = values.mutable_unchecked<2>();
  const double *const in_u = u.data(), *const in_v = surface ? v->data() : nullptr;
  InBlocks(u.size(), threads, [&](py::ssize_t begin, py::ssize_t end) {
    for (py::ssize_t n = begin; n < end; ++n) {
      if (surface) {
        const auto at = CurvatureAt(body.surface(), in_u[n], in_v[n]);
        out(n, 0) = at ? at->gaussian : kNaN;
        out(n, 1) = at ? at->mean : kNaN;
        out(n, 2) = at ? at->principal_low : kNaN;
        out(n, 3) = at ? at->principal_high : kNaN;
        continue;
      }
      const auto at = body.dimension() == 2
                          ? CurvatureAt(std::get<NurbsCurve<2>>(body.geometry()), in_u[n])
                          : CurvatureAt(std::get<NurbsCurve<3>>(body.geometry()), in_u[n]);
      out(n, 0) = at ? at->curvature : kNaN;
      out(n, 1) = at ? at->torsion : kNaN;
    }
  });
  return values;
}

py::array Contains(const Body& body, const Doubles& u, const Doubles& v, int threads) {
  RequirePairs(u, v);
  py::array_t<bool> inside(Shape{u.size()});
  bool* const out = inside.mutable_data();
  const double *const in_u = u.data(), *const in_v = v.data();
  const TrimRegion region(body.surface());
  InBlocks(u.size(), threads, [&](py::ssize_t begin, py::ssize_t end) {
    for (py::ssize_t n = begin; n < end; ++n) out[n] = region.Contains(in_u[n], in_v[n]);
  });
  return inside;
}

struct Feet {
  Eigen::MatrixXd parameters;
  Eigen::Matrix3Xd points;
  Eigen::VectorXd distances, bounds;
  Eigen::Array<bool, Eigen::Dynamic, 1> certified;
};

template <typename Foot>
Feet Collected(const std::vector<Foot>& found) {
  constexpr int kParameters = std::is_same_v<Foot, SurfaceFoot> ? 2 : 1;
  const auto count = std::ssize(found);
  Feet feet{Eigen::MatrixXd(kParameters, count),
            Eigen::Matrix3Xd(3, count),
            Eigen::VectorXd(count),
            Eigen::VectorXd(count),
            Eigen::Array<bool, Eigen::Dynamic, 1>(count)};
  for (py::ssize_t k = 0; k < count; ++k) {
    const Foot& foot = found[static_cast<std::size_t>(k)];
    feet.parameters(0, k) = foot.u;
    if constexpr (kParameters == 2) feet.parameters(1, k) = foot.v;
    feet.points.col(k) = foot.point;
    feet.distances[k] = foot.distance;
    feet.bounds[k] = foot.lower_bound;
    feet.certified[k] = foot.certified;
  }
  return feet;
}

// As search.Nearest(points, pool), piece by piece, so that it ends soon when asked to.
template <typename Search>
auto NearestOf(const Search& search,
               const Eigen::Matrix3Xd& points,
               ThreadPool& pool,
               Watch& watch) {
  constexpr Eigen::Index kPiece = 10000;
  auto found =
      search.Nearest(Eigen::Matrix3Xd(points.leftCols(std::min(kPiece, points.cols()))), pool);
  for (Eigen::Index begin = kPiece; begin < points.cols(); begin += kPiece) {
    if (watch.stopped()) throw Cancelled();
    const Eigen::Index size = std::min(kPiece, points.cols() - begin);
    const auto piece = search.Nearest(Eigen::Matrix3Xd(points.middleCols(begin, size)), pool);
    found.insert(found.end(), piece.begin(), piece.end());
  }
  return found;
}

// (parameters, points, distances, lower bounds, certified)
py::tuple Closest(const BodyPtr& body, const Doubles& array, int threads) {
  Eigen::Matrix3Xd points;
  if (array.ndim() == 2 && array.shape(1) == 2) {
    points = Eigen::Matrix3Xd::Zero(3, array.shape(0));
    points.topRows<2>() = Columns<2>(array, "points");
  } else {
    points = Columns<3>(array, "points");
  }
  if (!points.allFinite()) throw py::value_error("points: not all are finite");
  Feet feet = Watched([body, points = std::move(points), threads](Watch& watch) {
    ThreadPool pool(threads);
    if (body->is_surface()) return Collected(NearestOf(body->feet(), points, pool, watch));
    return body->dimension() == 2
               ? Collected(NearestOf(body->curve_feet<2>(), points, pool, watch))
               : Collected(NearestOf(body->curve_feet<3>(), points, pool, watch));
  });
  const py::ssize_t count = feet.distances.size();
  const bool surface = body->is_surface();
  return py::make_tuple(Owned(std::move(feet.parameters), surface ? Shape{count, 2} : Shape{count}),
                        Owned(std::move(feet.points), {count, 3}),
                        Owned(std::move(feet.distances), {count}),
                        Owned(std::move(feet.bounds), {count}),
                        Owned(std::move(feet.certified), {count}));
}

}  // namespace

void BindEvaluation(py::module_& m) {
  m.def("points", &PointsAt);
  m.def("derivatives", &Derivatives);
  m.def("normals", &Normals);
  m.def("curvatures", &Curvatures);
  m.def("contains", &Contains);
  m.def("closest", &Closest);
}

}  // namespace batten::python
