// SPDX-License-Identifier: MIT
#include "geometry/editing/monotone_arcs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/bezier/bernstein.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

constexpr double kLeastPart = 0x1p-46;  // of a piece, between two cuts

// Value and slope of a polynomial in Bernstein form, by de Casteljau's corner cutting. [Piegl &
// Tiller 1997, A1.5]
struct ValueAndSlope {
  double value, slope;
};
ValueAndSlope Evaluate(const double* coefficients, int p, double t) {
  double f[2 * kMaxDegree + 1];
  std::copy(coefficients, coefficients + p + 1, f);
  for (int last = p; last > 1; --last) {
    for (int i = 0; i < last; ++i) f[i] += t * (f[i + 1] - f[i]);
  }
  if (p == 0) return {f[0], 0};
  return {f[0] + t * (f[1] - f[0]), p * (f[1] - f[0])};
}

// The zero of f, which changes its sign once in [0, 1].
double ZeroOf(const double* f, int p) {
  const bool rises = f[p] > f[0];
  double low = 0, high = 1, t = f[0] / (f[0] - f[p]), step = 1;
  constexpr int kMostSteps = 100;
  for (int k = 0; k < kMostSteps; ++k) {
    const ValueAndSlope at = Evaluate(f, p, t);
    if (at.value == 0) return t;
    ((at.value < 0) == rises ? low : high) = t;
    double next = t - at.value / at.slope;
    const bool slow = std::abs(next - t) > step / 2;
    if (!(next > low && next < high) || slow) next = (low + high) / 2;
    step = std::abs(next - t);
    t = next;
    if (step <= kEpsilon * std::max(t, kEpsilon)) break;
  }
  return t;
}

// The places in (0, 1) where a polynomial changes its sign, by halving pieces whose coefficients do
// not decide. Coefficients below `negligible` have no sign.
void FindSignChanges(const Eigen::RowVectorXd& f,
                     double negligible,
                     double low,
                     double high,
                     std::vector<double>& found) {
  int changes = 0;
  double last = 0;
  for (const double c : f) {
    if (std::abs(c) <= negligible) continue;
    if (last != 0 && (c > 0) != (last > 0)) ++changes;
    last = c;
  }
  if (changes == 0) return;
  const double middle = (low + high) / 2;
  const Eigen::Index p = f.size() - 1;
  if (high - low <= kLeastPart) {
    if (changes % 2 == 1) found.push_back(middle);
    return;
  }
  const bool ends_differ =
      std::min(std::abs(f[0]), std::abs(f[p])) > negligible && (f[0] > 0) != (f[p] > 0);
  if (changes == 1 && ends_differ) {
    found.push_back(low + (high - low) * ZeroOf(f.data(), static_cast<int>(p)));
    return;
  }
  const auto [first, second] = SplitBernstein(f, 0.5);
  FindSignChanges(first, negligible, low, middle, found);
  const double at_middle = second(0, 0);
  if (std::abs(at_middle) <= negligible && changes > 0) found.push_back(middle);
  FindSignChanges(second, negligible, middle, high, found);
}

// The numerator of the derivative of one coordinate.
Eigen::RowVectorXd SlopeOf(const Eigen::Matrix3Xd& net, int axis, bool rational) {
  const Eigen::MatrixXd f = net.row(axis);
  if (!rational) return BernsteinDerivative(f);
  const Eigen::MatrixXd w = net.row(2);
  return BernsteinProduct(BernsteinDerivative(f), w.row(0)) -
         BernsteinProduct(f, BernsteinDerivative(w).row(0));
}

// Where a piece has to be cut, 0 and 1 included.
std::vector<double> CutsOf(const Eigen::Matrix3Xd& net, bool rational) {
  std::vector<double> cuts{0, 1};
  for (const int axis : {0, 1}) {
    if (net.cols() == 2) continue;  // a straight piece, with whatever weights
    const double size = (net.row(axis).array() / net.row(2).array()).cwiseAbs().maxCoeff();
    const double negligible = 16 * kEpsilon * static_cast<double>(net.cols()) *
                              std::max(size, 1.0) * net.row(2).maxCoeff() *
                              (rational ? net.row(2).maxCoeff() : 1);
    FindSignChanges(SlopeOf(net, axis, rational), negligible, 0, 1, cuts);
  }
  std::sort(cuts.begin(), cuts.end());
  std::vector<double> apart{0};
  for (const double cut : cuts) {
    if (cut - apart.back() > kLeastPart && 1 - cut > kLeastPart) apart.push_back(cut);
  }
  apart.push_back(1);
  return apart;
}

// The net of a span over the unit domain.
Eigen::Matrix3Xd UnitNet(const CurvePiece& piece, const UnitDomain& domain) {
  Eigen::Matrix3Xd net(3, piece.points.cols());
  net.row(2) = piece.points.row(3) / piece.points.row(3).maxCoeff();
  for (const int axis : {0, 1}) {
    const Eigen::ArrayXd local = piece.points.row(axis).array() / piece.points.row(3).array();
    const double shift = piece.origin[axis] - domain.lower[axis];
    net.row(axis) = ((local + shift) / domain.length[axis]).transpose() * net.row(2).array();
  }
  return net;
}

Eigen::Vector2d Projected(const Eigen::Vector3d& h) { return h.head<2>() / h[2]; }

// From the arc's points level with the place and plumb with it. Where it is far from both along an
// arc that is nearly flat, rounding decides.
int SideByCrossings(const MonotoneArc& arc, const Eigen::Vector2d& place, double near) {
  const Eigen::Vector2d level = arc.At(arc.Where(1, place[1])) - place;
  const Eigen::Vector2d plumb = arc.At(arc.Where(0, place[0])) - place;
  if (std::min(level.cwiseAbs().maxCoeff(), plumb.cwiseAbs().maxCoeff()) <= near) return 0;
  return level[0] > 0 ? -1 : 1;
}

}  // namespace

UnitDomain::UnitDomain(const NurbsSurface& surface)
    : lower(surface.basis_u().lower(), surface.basis_v().lower()),
      length(surface.basis_u().upper() - lower[0], surface.basis_v().upper() - lower[1]) {}

Eigen::Vector2d MonotoneArc::At(double t) const {
  if (t <= 0) return from;
  if (t >= 1) return to;
  const int p = degree();
  Eigen::Vector3d h[kMaxDegree + 1];
  for (int i = 0; i <= p; ++i) h[i] = net.col(i);
  for (int last = p; last > 0; --last) {
    for (int i = 0; i < last; ++i) h[i] += t * (h[i + 1] - h[i]);
  }
  return Projected(h[0]);
}

double MonotoneArc::Where(int axis, double value) const {
  const bool rises = to[axis] > from[axis];
  if (rises ? value <= from[axis] : value >= from[axis]) return 0;
  if (rises ? value >= to[axis] : value <= to[axis]) return 1;
  const int p = degree();
  double f[kMaxDegree + 1];
  for (int i = 0; i <= p; ++i) f[i] = net(axis, i) - value * net(2, i);
  if (rises ? f[0] >= 0 : f[0] <= 0) return 0;  // ends are shared: to rounding only
  if (rises ? f[p] <= 0 : f[p] >= 0) return 1;
  return p == 1 ? f[0] / (f[0] - f[1]) : ZeroOf(f, p);
}

MonotoneArc::Rise MonotoneArc::RiseAt(double t) const {
  const int p = degree();
  double x[kMaxDegree + 1], y[kMaxDegree + 1], w[kMaxDegree + 1];
  for (int i = 0; i <= p; ++i) {
    const double* column = net.data() + 3 * i;
    x[i] = column[0];
    y[i] = column[1];
    w[i] = column[2];
  }
  for (int last = p; last > 1; --last) {
    for (int i = 0; i < last; ++i) {
      x[i] += t * (x[i + 1] - x[i]);
      y[i] += t * (y[i + 1] - y[i]);
      w[i] += t * (w[i + 1] - w[i]);
    }
  }
  const double weight = w[0] + t * (w[1] - w[0]), place = (y[0] + t * (y[1] - y[0])) / weight;
  return {(x[0] + t * (x[1] - x[0])) / weight,
          place,
          p * ((y[1] - y[0]) - place * (w[1] - w[0])) / weight};
}

int MonotoneArc::SideOf(const Eigen::Vector2d& place, double near) const {
  const double slant = (to[0] > from[0]) == (to[1] > from[1]) ? 1 : -1;
  const bool rises = to[1] > from[1];
  double low = 0, high = 1, t = (place[1] - from[1]) / (to[1] - from[1]);
  if (!(t > 0 && t < 1)) t = 0.5;
  constexpr int kMostSteps = 12;
  for (int k = 0; k < kMostSteps; ++k) {
    const Rise at = RiseAt(t);
    const double dx = place[0] - at.x, dy = place[1] - at.y;
    if (dx > near && slant * dy < -near) return 1;
    if (dx < -near && slant * dy > near) return -1;
    if (std::abs(dx) <= near && std::abs(dy) <= near) return 0;
    ((dy > 0) == rises ? low : high) = t;
    t += dy / at.slope_y;
    if (!(t > low && t < high)) t = (low + high) / 2;
  }
  return SideByCrossings(*this, place, near);
}

std::vector<MonotoneArc> MonotoneArcs(const std::vector<NurbsCurve<2>>& loops,
                                      const UnitDomain& domain) {
  std::vector<MonotoneArc> arcs;
  for (size_t k = 0; k < loops.size(); ++k) {
    const size_t first = arcs.size();
    const bool rational = loops[k].rational();
    for (const CurvePiece& piece : PiecesOf(loops[k])) {
      const Eigen::Matrix3Xd whole = UnitNet(piece, domain);
      const std::vector<double> cuts = CutsOf(whole, rational);
      for (size_t i = 0; i + 1 < cuts.size(); ++i) {
        const auto parameter = [&](double t) {
          return t == 1 ? piece.u1 : piece.u0 + t * (piece.u1 - piece.u0);
        };
        MonotoneArc arc{static_cast<int>(k),
                        parameter(cuts[i]),
                        parameter(cuts[i + 1]),
                        {},
                        {},
                        rational,
                        RestrictedBernstein(whole, cuts[i], cuts[i + 1])};
        arc.from = arcs.size() > first ? arcs.back().to : Projected(arc.net.col(0));
        arc.to = Projected(arc.net.rightCols<1>());
        arcs.push_back(std::move(arc));
      }
    }
    arcs.back().to = arcs[first].from;
  }
  return arcs;
}

// Along an arc each side of the box holds over one stretch of t.
bool Meets(const MonotoneArc& arc, const Eigen::AlignedBox2d& box) {
  double begin = 0, end = 1;
  for (const int axis : {0, 1}) {
    if (arc.Low(axis) > box.max()[axis] || arc.High(axis) < box.min()[axis]) return false;
    if (arc.from[axis] == arc.to[axis]) continue;
    const bool rises = arc.to[axis] > arc.from[axis];
    const double enters = rises ? box.min()[axis] : box.max()[axis];
    const double leaves = rises ? box.max()[axis] : box.min()[axis];
    begin = std::max(begin, arc.Where(axis, enters));
    end = std::min(end, arc.Where(axis, leaves));
  }
  return begin <= end;
}

}  // namespace batten::internal
