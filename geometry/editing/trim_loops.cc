// SPDX-License-Identifier: MIT
#include "batten/geometry/trim_loops.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/geometry/reverse.h"
#include "geometry/bezier/bernstein.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/editing/loop_nesting.h"
#include "geometry/numeric/adaptive_sum.h"
#include "geometry/numeric/gauss_rule.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

// ∫ (x dy − y dx)/2 over a piece, about its origin.
double SweptBy(const CurvePiece& piece, const GaussRule& rule) {
  double sum = 0;
  for (Eigen::Index k = 0; k < rule.nodes.size(); ++k) {
    const CurvePieceJet jet = JetOf(piece, rule.nodes[k]);
    sum += rule.weights[k] * (jet.point[0] * jet.first[1] - jet.point[1] * jet.first[0]) / 2;
  }
  return sum;
}

// A part of a rational piece.
struct SweptPart {
  CurvePiece piece;
  CellIntegral integral;
};

class SweptAreas {
 public:
  SweptPart Measured(CurvePiece piece) const {
    const double fine = SweptBy(piece, fine_);
    const double error = std::abs(fine - SweptBy(piece, coarse_));
    return {std::move(piece), {fine, error}};
  }
  std::vector<SweptPart> Halves(const SweptPart& part) const {
    const auto [first, second] = SplitBernstein(part.piece.points, 0.5);
    CurvePiece low = part.piece, high = part.piece;
    low.points = first;
    high.points = second;
    return {Measured(std::move(low)), Measured(std::move(high))};
  }

 private:
  GaussRule fine_ = GaussLegendre(16), coarse_ = GaussLegendre(11);
};

double RationalArea(const NurbsCurve<2>& loop, const Eigen::Vector3d& origin) {
  constexpr double kTolerance = 1e-13;
  constexpr size_t kMostSplits = 10000;
  const SweptAreas areas;
  std::vector<SweptPart> parts;
  for (const int span : loop.basis().Spans()) {
    parts.push_back(areas.Measured(PieceOf(loop, span, origin)));
  }
  RefineUntilExact(
      parts, kTolerance, 0, kMostSplits, [&](const SweptPart& part) { return areas.Halves(part); });
  CarriedSum sum;
  for (const SweptPart& part : parts) sum.Add(part.integral.value);
  return sum.value();
}

double PolynomialArea(const NurbsCurve<2>& loop, const Eigen::Vector3d& origin) {
  const GaussRule rule = GaussLegendre(loop.basis().degree());  // of degree 2p − 1
  CarriedSum sum;
  for (const int span : loop.basis().Spans()) sum.Add(SweptBy(PieceOf(loop, span, origin), rule));
  return sum.value();
}

// How far the control points are from the chord between the first and the last.
double DistanceFromChord(const Eigen::Matrix4Xd& net) {
  const auto point = [&](Eigen::Index i) {
    return Eigen::Vector2d(net.col(i).head<2>() / net(3, i));
  };
  const Eigen::Vector2d start = point(0), chord = point(net.cols() - 1) - start;
  const double squared = chord.squaredNorm();
  double most = 0;
  for (Eigen::Index i = 1; i + 1 < net.cols(); ++i) {
    const Eigen::Vector2d reach = point(i) - start;
    const double along = squared > 0 ? std::clamp(reach.dot(chord) / squared, 0.0, 1.0) : 0;
    most = std::max(most, (reach - along * chord).norm());
  }
  return most;
}

struct Vertices {
  std::vector<double> parameters;
  std::vector<Eigen::Vector2d> points;
};

// Adds the start of a part of a piece and what has to come between it and the end.
void AddPart(const Eigen::Matrix4Xd& net,
             const Eigen::Vector3d& origin,
             double s0,
             double s1,
             double tolerance,
             int depth,
             Vertices& vertices) {
  constexpr int kMostHalvings = 20;
  if (depth >= kMostHalvings || (depth >= 0 && DistanceFromChord(net) <= tolerance)) {
    vertices.parameters.push_back(s0);
    vertices.points.push_back(origin.head<2>() + net.col(0).head<2>() / net(3, 0));
    return;
  }
  const auto [first, second] = SplitBernstein(net, 0.5);
  const double middle = s0 + (s1 - s0) / 2;
  AddPart(first, origin, s0, middle, tolerance, depth + 1, vertices);
  AddPart(second, origin, middle, s1, tolerance, depth + 1, vertices);
}

}  // namespace

double SignedArea(const NurbsCurve<2>& loop) {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  origin.head<2>() = loop.control_points().col(0);
  const double swept = loop.rational() ? RationalArea(loop, origin) : PolynomialArea(loop, origin);
  const Eigen::Vector2d start = loop.At(loop.basis().lower()) - origin.head<2>();
  const Eigen::Vector2d end = loop.At(loop.basis().upper()) - origin.head<2>();
  return swept + (end[0] * start[1] - end[1] * start[0]) / 2;
}

std::vector<NurbsCurve<2>> TurnedLoops(std::vector<NurbsCurve<2>> loops) {
  if (loops.empty()) return loops;
  std::vector<double> areas;
  for (const NurbsCurve<2>& loop : loops) areas.push_back(SignedArea(loop));
  const auto outer = std::max_element(
      areas.begin(), areas.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  for (size_t k = 0; k < loops.size(); ++k) {
    const bool wanted = k == static_cast<size_t>(outer - areas.begin());
    if ((areas[k] > 0) != wanted) loops[k] = Reversed(loops[k]);
  }
  const auto first = loops.begin() + (outer - areas.begin());
  std::rotate(loops.begin(), first, first + 1);
  return loops;
}

std::vector<std::vector<NurbsCurve<2>>> LoopsByRegion(const NurbsSurface& surface) {
  const std::vector<NurbsCurve<2>>& loops = surface.trims();
  std::vector<Eigen::Matrix2Xd> polygons;
  for (const NurbsCurve<2>& loop : loops) polygons.push_back(NestingPolygon(loop));
  const std::vector<int> enclosing = EnclosingPolygons(polygons);
  std::vector<std::vector<NurbsCurve<2>>> regions;
  std::vector<int> region_of(loops.size(), -1);
  const auto is_outer = [&](size_t k) { return k == 0 || PolygonArea(polygons[k]) > 0; };
  for (size_t k = 0; k < loops.size(); ++k) {
    if (!is_outer(k)) continue;
    region_of[k] = static_cast<int>(regions.size());
    regions.push_back({loops[k]});
  }
  for (size_t k = 0; k < loops.size(); ++k) {
    if (is_outer(k)) continue;
    int outer = enclosing[k];
    while (outer >= 0 && region_of[outer] < 0) outer = enclosing[outer];
    regions[outer < 0 ? 0 : region_of[outer]].push_back(loops[k]);
  }
  return regions;
}

Polygon LoopPolyline(const NurbsCurve<2>& loop, double tolerance) {
  if (!(tolerance > 0)) {
    throw std::invalid_argument("LoopPolyline: tolerance " + NumberText(tolerance) +
                                " is not positive");
  }
  Vertices vertices;
  for (const CurvePiece& piece : PiecesOf(loop)) {
    const bool straight = piece.degree() == 1;
    AddPart(piece.points, piece.origin, piece.u0, piece.u1, tolerance, straight ? 0 : -2, vertices);
  }
  const Eigen::Index count = static_cast<Eigen::Index>(vertices.points.size());
  Polygon polygon{Eigen::Map<Eigen::VectorXd>(vertices.parameters.data(), count),
                  Eigen::Matrix2Xd(2, count)};
  for (Eigen::Index k = 0; k < count; ++k) polygon.points.col(k) = vertices.points[k];
  return polygon;
}

}  // namespace batten
