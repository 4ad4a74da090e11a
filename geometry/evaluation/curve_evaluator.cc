// SPDX-License-Identifier: MIT
#include "batten/geometry/curve_evaluator.h"

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/evaluation/evaluation_kernels.h"
#include "geometry/evaluation/evaluation_table.h"

namespace batten {
using namespace internal;
namespace {

constexpr std::ptrdiff_t kCurveBlock = 4096;  // parameters that a thread takes at a time

void CheckOrder(int order, int most) {
  if (order >= 0 && order <= most) return;
  throw std::invalid_argument("CurveEvaluator::Derivatives: order " + std::to_string(order) +
                              " is not in [0, " + std::to_string(most) + "]");
}

}  // namespace

template <int Dim>
struct CurveEvaluator<Dim>::State {
  explicit State(NurbsCurve<Dim> given) : curve(std::move(given)), storage(curve) {}
  NurbsCurve<Dim> curve;
  CurveStorage<Dim> storage;
};

template <int Dim>
CurveEvaluator<Dim>::CurveEvaluator(NurbsCurve<Dim> curve)
    : state_(std::make_shared<const State>(std::move(curve))) {}

template <int Dim>
const NurbsCurve<Dim>& CurveEvaluator<Dim>::curve() const {
  return state_->curve;
}

template <int Dim>
const CurveTable& CurveEvaluator<Dim>::table() const {
  return state_->storage.table();
}

template <int Dim>
typename CurveEvaluator<Dim>::Point CurveEvaluator<Dim>::At(double u) const {
  Point point;
  EvaluateCurve(table(), &u, 1, 0, point.data());
  return point;
}

template <int Dim>
CurveJet<Dim> CurveEvaluator<Dim>::JetAt(double u) const {
  static_assert(sizeof(CurveJet<Dim>) == 4 * Dim * sizeof(double));  // as the kernel writes it
  CurveJet<Dim> jet;
  EvaluateCurve(table(), &u, 1, kMaxOrder, reinterpret_cast<double*>(&jet));
  return jet;
}

template <int Dim>
void CurveEvaluator<Dim>::Points(std::span<const double> parameters, PointColumns& points) const {
  Derivatives(parameters, 0, points);
}

template <int Dim>
void CurveEvaluator<Dim>::Points(std::span<const double> parameters,
                                 PointColumns& points,
                                 ThreadPool& pool) const {
  Derivatives(parameters, 0, points, pool);
}

template <int Dim>
void CurveEvaluator<Dim>::Derivatives(std::span<const double> parameters,
                                      int order,
                                      PointColumns& columns) const {
  CheckOrder(order, kMaxOrder);
  columns.resize(Dim, static_cast<Eigen::Index>(parameters.size()) * (order + 1));
  EvaluateCurve(table(), parameters.data(), parameters.size(), order, columns.data());
}

template <int Dim>
void CurveEvaluator<Dim>::Derivatives(std::span<const double> parameters,
                                      int order,
                                      PointColumns& columns,
                                      ThreadPool& pool) const {
  CheckOrder(order, kMaxOrder);
  const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(parameters.size());
  columns.resize(Dim, count * (order + 1));
  pool.For(count, kCurveBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    EvaluateCurve(table(),
                  parameters.data() + begin,
                  static_cast<size_t>(end - begin),
                  order,
                  columns.data() + begin * (order + 1) * Dim);
  });
}

template class CurveEvaluator<2>;
template class CurveEvaluator<3>;

}  // namespace batten
