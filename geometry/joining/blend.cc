// SPDX-License-Identifier: MIT
#include "batten/geometry/blend.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/clamp.h"
#include "batten/geometry/closure.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/reverse.h"
#include "geometry/editing/compatible_surfaces.h"
#include "geometry/joining/end_jet.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/nurbs/homogeneous.h"

namespace batten {
using namespace internal;
namespace {

constexpr const char* kBlend = "Blend";

void CheckOptions(const BlendOptions& options) {
  RequireThat(options.continuity >= 0 && options.continuity <= 2,
              kBlend,
              "continuity = " + std::to_string(options.continuity) + " is not 0, 1 or 2");
  constexpr double kMostFull = 100;  // beyond a few the blend loops
  for (const double fullness : options.fullness) {
    RequirePositive(kBlend, "fullness", fullness);
    RequireThat(fullness <= kMostFull,
                kBlend,
                "fullness = " + NumberText(fullness) + " is more than " + NumberText(kMostFull) +
                    " widths of the gap");
  }
}

// The mean speed of Euclidean points where homogeneous ones have these derivatives.
double MeanSpeed(const EndJet& jet) {
  const Eigen::Index dim = jet[0].rows() - 1;
  double sum = 0;
  for (Eigen::Index k = 0; k < jet[0].cols(); ++k) {
    const double w = jet[0](dim, k);
    const Eigen::VectorXd place = jet[0].col(k).head(dim) / w;
    sum += (jet[1].col(k).head(dim) - jet[1](dim, k) * place).norm() / w;
  }
  return sum / static_cast<double>(jet[0].cols());
}

double MeanGap(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::Index dim = a.rows() - 1;
  double sum = 0;
  for (Eigen::Index k = 0; k < a.cols(); ++k) {
    sum += (a.col(k).head(dim) / a(dim, k) - b.col(k).head(dim) / b(dim, k)).norm();
  }
  return sum / static_cast<double>(a.cols());
}

// λ of the weights' derivatives that leaves least of them, over the whole edge.
JoinFreedom LevelWeights(const EndJet& jet, double beta, double alpha) {
  const Eigen::Index dim = jet[0].rows() - 1;
  const auto w = jet[0].row(dim), w1 = jet[1].row(dim), w2 = jet[2].row(dim);
  JoinFreedom freedom{.alpha = alpha, .beta = beta};
  const double square = w.squaredNorm();
  freedom.eta = -alpha * beta * w1.dot(w) / square;
  freedom.eta2 = -(alpha * beta * beta * w2.dot(w) + 2 * freedom.eta * beta * w1.dot(w)) / square;
  return freedom;
}

// Homogeneous Bézier rows of degree 2k + 1 between two jets that leave their shapes.
std::vector<Eigen::MatrixXd> HermiteRows(const EndJet& a, const EndJet& b, int k) {
  const double n = 2 * k + 1;
  std::vector<Eigen::MatrixXd> rows{a[0]}, mirrored{b[0]};
  for (auto [jet, points] : {std::pair{&a, &rows}, {&b, &mirrored}}) {
    const EndJet& r = *jet;
    if (k > 0) points->push_back(r[0] + r[1] / n);
    if (k > 1) points->push_back(r[0] + 2 * r[1] / n + r[2] / (n * (n - 1)));
  }
  rows.insert(rows.end(), mirrored.rbegin(), mirrored.rend());
  return rows;
}

std::vector<Eigen::MatrixXd> BlendRows(const EndJet& a,
                                       const EndJet& b,
                                       const BlendOptions& options) {
  const double gap = MeanGap(a[0], b[0]), speed_a = MeanSpeed(a), speed_b = MeanSpeed(b);
  RequireThat(gap > 0, kBlend, "the two ends are one: there is nothing between them");
  if (options.continuity == 0) return HermiteRows(a, b, 0);
  RequireThat(
      speed_a > 0 && speed_b > 0, kBlend, "a shape rests at its end: it has no direction there");
  const Eigen::Index dim = a[0].rows() - 1;
  const double alpha = a[0].row(dim).sum() / b[0].row(dim).sum();
  return HermiteRows(
      Reparameterized(a, LevelWeights(a, options.fullness[0] * gap / speed_a, 1)),
      Reparameterized(b, LevelWeights(b, options.fullness[1] * gap / speed_b, alpha)),
      options.continuity);
}

// All rows side by side.
Eigen::MatrixXd Columns(const std::vector<Eigen::MatrixXd>& rows) {
  const Eigen::Index along = rows[0].cols();
  Eigen::MatrixXd columns(rows[0].rows(), along * std::ssize(rows));
  for (Eigen::Index k = 0; k < std::ssize(rows); ++k)
    columns.middleCols(k * along, along) = rows[k];
  return columns;
}

Eigen::VectorXd WeightsOf(const Eigen::MatrixXd& columns, bool rational) {
  return rational ? Eigen::VectorXd(columns.bottomRows<1>().transpose()) : Eigen::VectorXd();
}

SplineBasis OneSpanOf(const std::vector<Eigen::MatrixXd>& rows) {
  const double ends[] = {0, 1};
  return SplineBasis::Clamped(static_cast<int>(rows.size()) - 1, ends);
}

template <int Dim>
CurveEnds NearestEnds(const NurbsCurve<Dim>& first, const NurbsCurve<Dim>& second) {
  const auto end = [](const NurbsCurve<Dim>& curve, bool upper) {
    return curve.At(upper ? curve.basis().upper() : curve.basis().lower());
  };
  CurveEnds best;
  double least = (end(first, true) - end(second, false)).norm();
  for (const CurveEnds pair : {CurveEnds{true, true}, {false, false}, {false, true}}) {
    const double gap = (end(first, pair.first_upper) - end(second, pair.second_upper)).norm();
    if (gap < least) {
      least = gap;
      best = pair;
    }
  }
  return best;
}

constexpr int kPlaces = 33;

NurbsCurve<3> EdgeCurve(const NurbsSurface& surface, const SurfaceEdge& edge) {
  const SplineBasis& across = BasisOf(surface, edge.direction);
  return IsoCurve(surface, edge.direction, edge.upper ? across.upper() : across.lower());
}

// How far the ends of an edge are apart; 0 where it closes.
double OpenBy(const NurbsSurface& surface, const SurfaceEdge& edge) {
  const NurbsCurve<3> curve = EdgeCurve(surface, edge);
  if (Closed(curve)) return 0;
  return (curve.At(curve.basis().upper()) - curve.At(curve.basis().lower())).norm();
}

Eigen::Matrix3Xd EdgePlaces(const NurbsSurface& surface, const SurfaceEdge& edge) {
  const NurbsCurve<3> curve = EdgeCurve(surface, edge);
  const double lower = curve.basis().lower(), length = curve.basis().upper() - lower;
  Eigen::Matrix3Xd places(3, kPlaces);
  for (int k = 0; k < kPlaces; ++k) places.col(k) = curve.At(lower + k * length / (kPlaces - 1));
  return places;
}

struct EdgePair {
  SurfaceEdge first, second;
  double distance = HUGE_VAL;
  bool reversed = false;
};

EdgePair NearestEdges(const NurbsSurface& first,
                      const NurbsSurface& second,
                      const std::optional<SurfaceEdge>& first_edge,
                      const std::optional<SurfaceEdge>& second_edge) {
  constexpr SurfaceEdge kEdges[] = {
      {Direction::kU, false}, {Direction::kU, true}, {Direction::kV, false}, {Direction::kV, true}};
  const double size_1 = BoxDiagonal(first.control_points()),
               size_2 = BoxDiagonal(second.control_points());
  EdgePair best;
  double open_by = 0;  // beside a closed edge
  for (const SurfaceEdge& a : kEdges) {
    if (first_edge && !(a == *first_edge)) continue;
    const Eigen::Matrix3Xd of_a = EdgePlaces(first, a);
    if (BoxDiagonal(of_a) <= kCloses * size_1) continue;
    for (const SurfaceEdge& b : kEdges) {
      if (second_edge && !(b == *second_edge)) continue;
      const Eigen::Matrix3Xd of_b = EdgePlaces(second, b);
      if (BoxDiagonal(of_b) <= kCloses * size_2) continue;
      const double open_a = OpenBy(first, a), open_b = OpenBy(second, b);
      if ((open_a > 0) != (open_b > 0)) {
        open_by = std::max(open_a, open_b);
        continue;
      }
      const double with = (of_a - of_b).colwise().norm().mean();
      const double against = (of_a - of_b.rowwise().reverse()).colwise().norm().mean();
      const double distance = std::min(with, against);
      if (distance < best.distance) best = {a, b, distance, against < with};
    }
  }
  RequireThat(std::isfinite(best.distance) || open_by == 0,
              kBlend,
              "one edge closes and the other is open, its ends " + RoundedText(open_by) +
                  " apart: choose two that close, or two that are open");
  RequireThat(
      std::isfinite(best.distance), kBlend, "an edge is a single point: choose another one");
  return best;
}

// The surface with its edge at the upper end of u, v along it.
NurbsSurface Turned(const NurbsSurface& surface, const SurfaceEdge& edge, bool reversed) {
  NurbsSurface turned = edge.direction == Direction::kU ? surface : Swapped(surface);
  if (!edge.upper) turned = Reversed(turned, Direction::kU);
  if (reversed) turned = Reversed(turned, Direction::kV);
  return turned;
}

}  // namespace

template <int Dim>
NurbsCurve<Dim> Blend(const NurbsCurve<Dim>& first,
                      const NurbsCurve<Dim>& second,
                      const BlendOptions& options,
                      std::optional<CurveEnds> ends) {
  CheckOptions(options);
  for (const NurbsCurve<Dim>* curve : {&first, &second}) {
    RequireThat(!curve->basis().periodic(), kBlend, "a periodic curve has no end");
  }
  const CurveEnds at = ends ? *ends : NearestEnds(first, second);
  const auto rows =
      BlendRows(EndJetOf(first, at.first_upper), EndJetOf(second, at.second_upper), options);
  const Eigen::MatrixXd columns = Columns(rows);
  return NurbsCurve<Dim>(OneSpanOf(rows),
                         Places(columns, kBlend, "take less fullness"),
                         WeightsOf(columns, first.rational() || second.rational()));
}

SurfaceBlend Blend(const NurbsSurface& first,
                   const NurbsSurface& second,
                   const BlendOptions& options,
                   std::optional<SurfaceEdge> first_edge,
                   std::optional<SurfaceEdge> second_edge) {
  CheckOptions(options);
  for (const NurbsSurface* surface : {&first, &second}) {
    RefuseTrims(surface->trimmed(), kBlend, "its edges may not count");
  }
  const EdgePair pair = NearestEdges(first, second, first_edge, second_edge);
  for (const auto& [surface, edge] : {std::pair{&first, pair.first}, {&second, pair.second}}) {
    RequireThat(
        !BasisOf(*surface, edge.direction).periodic(), kBlend, "a periodic direction has no edge");
  }
  constexpr SurfaceEdge kUpper{Direction::kU, true};
  NurbsSurface a = Turned(first, pair.first, false);
  NurbsSurface b = Turned(second, pair.second, pair.reversed);
  RaiseToSameDegree(a, b, Direction::kV);
  PutOverSameKnots(a, b, Direction::kV);
  const auto rows = BlendRows(EndJetOf(a, kUpper), EndJetOf(b, kUpper), options);
  const Eigen::MatrixXd columns = Columns(rows);
  return {NurbsSurface(OneSpanOf(rows),
                       a.basis_v(),
                       Places(columns, kBlend, "take less fullness"),
                       WeightsOf(columns, first.rational() || second.rational())),
          {pair.first, pair.second},
          pair.reversed};
}

template NurbsCurve<2> Blend(const NurbsCurve<2>&,
                             const NurbsCurve<2>&,
                             const BlendOptions&,
                             std::optional<CurveEnds>);
template NurbsCurve<3> Blend(const NurbsCurve<3>&,
                             const NurbsCurve<3>&,
                             const BlendOptions&,
                             std::optional<CurveEnds>);

}  // namespace batten
