// SPDX-License-Identifier: MIT
#include "batten/fitting/cubic_spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "fitting/core/rounding.h"
#include "fitting/interpolation/curved_ends.h"
#include "fitting/linear/banded_lu.h"
#include "fitting/linear/coefficient_order.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

template <int Dim>
using Points = Eigen::Matrix<double, Dim, Eigen::Dynamic>;
template <int Dim>
using Point = Eigen::Matrix<double, Dim, 1>;

[[noreturn]] void RefuseSpline(const std::string& reason) { throw std::invalid_argument(reason); }

template <int Dim>
void CheckSpline(const Points<Dim>& points, const Eigen::VectorXd& t, bool closed) {
  const Eigen::Index m = points.cols(), fewest = closed ? 3 : 2;
  if (m < fewest) {
    RefuseSpline("a " + std::string(closed ? "closed " : "") + "spline needs at least " +
                 std::to_string(fewest) + " points; there are " + std::to_string(m));
  }
  if (t.size() != m + (closed ? 1 : 0)) {
    RefuseSpline(std::to_string(m) + " points and " + std::to_string(t.size()) +
                 " parameters do not agree");
  }
  if (!points.allFinite() || !t.allFinite()) RefuseSpline("a point or parameter is not finite");
  for (Eigen::Index k = 1; k < t.size(); ++k) {
    if (!(t[k] > t[k - 1]))
      RefuseSpline("parameter " + std::to_string(k + 1) + " is not above the one before it");
  }
}

// Steps of the parameters and slopes of the chords; closed: the last leads back to the first point.
template <int Dim>
struct Steps {
  Eigen::VectorXd h;
  Points<Dim> d;
};

template <int Dim>
Steps<Dim> StepsOf(const Points<Dim>& points, const Eigen::VectorXd& t) {
  const Eigen::Index m = points.cols(), steps = t.size() - 1;
  Steps<Dim> result{t.tail(steps) - t.head(steps), Points<Dim>(Dim, steps)};
  for (Eigen::Index k = 0; k < steps; ++k)
    result.d.col(k) = (points.col((k + 1) % m) - points.col(k)) / result.h[k];
  return result;
}

// Rows a x_{k−1} + b x_k + c x_{k+1} = right; closed: around.
template <int Dim>
struct Tridiagonal {
  Tridiagonal(Eigen::Index size, bool closed_) : rows(size, 3), right(size, Dim), closed(closed_) {}

  void Set(Eigen::Index k, double a, double b, double c, const Point<Dim>& value) {
    rows.row(k) << a, b, c;
    right.row(k) = value.transpose();
  }

  Points<Dim> Solved() const {
    const Eigen::Index m = rows.rows(), band = closed ? 2 : 1;
    const auto place = [&](Eigen::Index k) { return closed ? DealtPlace((k + m) % m, m) : k; };
    BandedLu matrix(m, std::min(band, m - 1), std::min(band, m - 1));
    RightSides unknowns(m, Dim);
    for (Eigen::Index k = 0; k < m; ++k) {
      for (Eigen::Index side = -1; side <= 1; ++side) {
        if (closed || (k + side >= 0 && k + side < m))
          matrix.at(place(k), place(k + side)) += rows(k, side + 1);
      }
      unknowns.row(place(k)) = right.row(k);
    }
    if (matrix.Factor(0) < m) RefuseSpline("the parameters are too uneven for a cubic spline");
    matrix.Solve(unknowns);
    Points<Dim> result(Dim, m);
    for (Eigen::Index k = 0; k < m; ++k) result.col(k) = unknowns.row(place(k)).transpose();
    return result;
  }

  Eigen::MatrixX3d rows;
  Eigen::Matrix<double, Eigen::Dynamic, Dim> right;
  bool closed;
};

// An end's condition as the equations take it: one that asks for pieces that are not there is that
// the third derivative vanishes, and where both ends do of one piece, the second at the last.
enum class EndRow { kNotAKnot, kFirst, kSecond, kThirdVanishes };

template <int Dim>
struct End {
  EndRow row;
  Point<Dim> value;
};

template <int Dim>
End<Dim> EndOf(const CubicEndCondition<Dim>& condition, bool room) {
  switch (condition.kind) {
    case CubicEnd::kNotAKnot:
      return {room ? EndRow::kNotAKnot : EndRow::kThirdVanishes, Point<Dim>::Zero()};
    case CubicEnd::kNatural:
      return {EndRow::kSecond, Point<Dim>::Zero()};
    case CubicEnd::kFirstDerivative:
      return {EndRow::kFirst, condition.value};
    default:
      return {EndRow::kSecond, condition.value};
  }
}

template <int Dim>
struct Ends {
  End<Dim> start, end;

  Ends(const CubicEndCondition<Dim>& from, const CubicEndCondition<Dim>& to, Eigen::Index pieces)
      : start(EndOf<Dim>(from, pieces > 1)),
        end(EndOf<Dim>(to, pieces > (from.kind == CubicEnd::kNotAKnot ? 2 : 1))) {
    const bool both = start.row == EndRow::kThirdVanishes && end.row == EndRow::kThirdVanishes;
    if (both && pieces == 1) end = {EndRow::kSecond, Point<Dim>::Zero()};
  }
};

// The row of a slope at an end; h, d of the step beside it, H, D of the next. `side` is 1 at the
// start and −1 at the end, where parameters run the other way.
template <int Dim>
struct EndEquation {
  double own, next;
  Point<Dim> value;
};

template <int Dim>
EndEquation<Dim> SlopeAtEnd(const End<Dim>& end,
                            double side,
                            double h,
                            const Point<Dim>& d,
                            double H,
                            const Point<Dim>& D) {
  switch (end.row) {
    case EndRow::kFirst:
      return {1, 0, end.value};
    case EndRow::kSecond:
      return {2, 1, 3 * d - side * h / 2 * end.value};
    case EndRow::kThirdVanishes:
      return {1, 1, 2 * d};
    default:  // [de Boor 1978, IV, eq. 15]
      return {H / (h + H), 1, ((3 * h + 2 * H) * H * d + h * h * D) / ((h + H) * (h + H))};
  }
}

template <int Dim>
Points<Dim> Slopes(const Steps<Dim>& s, const Ends<Dim>* ends) {
  const bool closed = ends == nullptr;
  const Eigen::Index pieces = s.h.size(), m = closed ? pieces : pieces + 1;
  Tridiagonal<Dim> system(m, closed);
  for (Eigen::Index k = closed ? 0 : 1; k < pieces; ++k) {
    const Eigen::Index before = (k + pieces - 1) % pieces;
    const double lambda = s.h[k] / (s.h[before] + s.h[k]),
                 mu = s.h[before] / (s.h[before] + s.h[k]);
    system.Set(k, lambda, 2, mu, 3 * (lambda * s.d.col(before) + mu * s.d.col(k)));
  }
  if (!closed) {
    const Eigen::Index last = pieces - 1, second = std::min<Eigen::Index>(1, last),
                       before = std::max<Eigen::Index>(0, last - 1);
    const auto first =
        SlopeAtEnd<Dim>(ends->start, 1, s.h[0], s.d.col(0), s.h[second], s.d.col(second));
    system.Set(0, 0, first.own, first.next, first.value);
    const auto final =
        SlopeAtEnd<Dim>(ends->end, -1, s.h[last], s.d.col(last), s.h[before], s.d.col(before));
    system.Set(pieces, final.next, final.own, 0, final.value);
  }
  return system.Solved();
}

// Second derivatives at the beginning of every piece, and at the end of the last.
template <int Dim>
Points<Dim> MomentsOf(const Steps<Dim>& s, const Points<Dim>& slopes) {
  const Eigen::Index m = slopes.cols();
  Points<Dim> moments(Dim, m);
  for (Eigen::Index k = 0; k < m; ++k) {
    if (k < s.h.size()) {
      moments.col(k) = (6 * s.d.col(k) - 4 * slopes.col(k) - 2 * slopes.col((k + 1) % m)) / s.h[k];
    } else {
      moments.col(k) =
          (2 * slopes.col(k - 1) + 4 * slopes.col(k) - 6 * s.d.col(k - 1)) / s.h[k - 1];
    }
  }
  return moments;
}

template <int Dim>
Points<Dim> SlopesOf(const Steps<Dim>& s, const Points<Dim>& moments) {
  const Eigen::Index m = moments.cols();
  Points<Dim> slopes(Dim, m);
  for (Eigen::Index k = 0; k < m; ++k) {
    if (k < s.h.size()) {
      slopes.col(k) = s.d.col(k) - s.h[k] / 6 * (2 * moments.col(k) + moments.col((k + 1) % m));
    } else {
      slopes.col(k) = s.d.col(k - 1) + s.h[k - 1] / 6 * (moments.col(k - 1) + 2 * moments.col(k));
    }
  }
  return slopes;
}

// Not-a-knot: h₁ M₀ = (h₀ + h₁) M₁ − h₀ M₂, put into the row of M₁, which then lacks M₀.
struct Eliminated {
  double own, other;  // M₀ = own M₁ + other M₂
  Eliminated(double h, double H) : own((h + H) / H), other(-h / H) {}
};

template <int Dim>
EndEquation<Dim> MomentAtEnd(const End<Dim>& end, double side, double h, const Point<Dim>& d) {
  switch (end.row) {
    case EndRow::kFirst:
      return {2, 1, side * 6 / h * (d - end.value)};
    case EndRow::kSecond:
      return {1, 0, end.value};
    default:  // the third derivative vanishes; M₀ of a knot that is none is found afterwards
      return {1, end.row == EndRow::kThirdVanishes ? -1.0 : 0.0, Point<Dim>::Zero()};
  }
}

template <int Dim>
Points<Dim> Moments(const Steps<Dim>& s, const Ends<Dim>* ends) {
  const bool closed = ends == nullptr;
  const Eigen::Index pieces = s.h.size(), m = closed ? pieces : pieces + 1, last = pieces - 1;
  const bool drops_first = !closed && ends->start.row == EndRow::kNotAKnot,
             drops_last = !closed && ends->end.row == EndRow::kNotAKnot;
  Tridiagonal<Dim> system(m, closed);
  for (Eigen::Index k = closed ? 0 : 1; k < pieces; ++k) {
    const Eigen::Index before = (k + pieces - 1) % pieces;
    const double sum = s.h[before] + s.h[k];
    double a = s.h[before] / sum, b = 2, c = s.h[k] / sum;
    if (k == 1 && drops_first) {
      const Eliminated m0(s.h[0], s.h[1]);
      b += a * m0.own;
      c += a * m0.other;
      a = 0;
    }
    if (k == last && drops_last) {
      const Eliminated m0(s.h[last], s.h[last - 1]);
      b += c * m0.own;
      a += c * m0.other;
      c = 0;
    }
    system.Set(k, a, b, c, 6 / sum * (s.d.col(k) - s.d.col(before)));
  }
  if (!closed) {
    const auto first = MomentAtEnd<Dim>(ends->start, 1, s.h[0], s.d.col(0));
    system.Set(0, 0, first.own, first.next, first.value);
    const auto final = MomentAtEnd<Dim>(ends->end, -1, s.h[last], s.d.col(last));
    system.Set(pieces, final.next, final.own, 0, final.value);
  }
  Points<Dim> moments = system.Solved();
  if (drops_first) {
    const Eliminated m0(s.h[0], s.h[1]);
    moments.col(0) = m0.own * moments.col(1) + m0.other * moments.col(2);
  }
  if (drops_last) {
    const Eliminated m0(s.h[last], s.h[last - 1]);
    moments.col(pieces) = m0.own * moments.col(last) + m0.other * moments.col(last - 1);
  }
  return moments;
}

enum class Unknowns { kSlopes, kMoments };

template <int Dim>
SplineDerivatives<Dim> Solved(const Steps<Dim>& s, const Ends<Dim>* ends, Unknowns unknowns) {
  if (unknowns == Unknowns::kSlopes) {
    Points<Dim> slopes = Slopes<Dim>(s, ends);
    Points<Dim> moments = MomentsOf<Dim>(s, slopes);
    return {std::move(slopes), std::move(moments)};
  }
  Points<Dim> moments = Moments<Dim>(s, ends);
  Points<Dim> slopes = SlopesOf<Dim>(s, moments);
  return {std::move(slopes), std::move(moments)};
}

// Solves with the second derivatives that make the curvatures in place of those.
template <int Dim>
SplineDerivatives<Dim> WithEnds(const Steps<Dim>& s,
                                const CubicEndCondition<Dim>& start,
                                const CubicEndCondition<Dim>& end,
                                Unknowns unknowns) {
  const std::array<CubicEndCondition<Dim>, 2> given{start, end};
  EndCurvatures<Dim> curved;
  for (const int side : {0, 1}) {
    const auto& [kind, value] = given[side];
    if (!value.allFinite()) RefuseSpline("an end's value is not finite");
    const bool of_function = kind == CubicEnd::kFunctionCurvature;
    if (of_function || kind == CubicEnd::kCurvature) curved[side] = {value, of_function};
  }
  using Seconds = typename EndSlopes<Dim>::Seconds;
  const auto solved = [&](const Steps<Dim>& steps,
                          std::array<CubicEndCondition<Dim>, 2> now,
                          const Seconds& seconds) {
    for (const int side : {0, 1})
      if (curved[side]) now[side] = {CubicEnd::kSecondDerivative, seconds[side]};
    const Ends<Dim> ends(now[0], now[1], steps.h.size());
    return Solved<Dim>(steps, &ends, unknowns);
  };
  const Seconds none = {Point<Dim>::Zero(), Point<Dim>::Zero()};
  SplineDerivatives<Dim> result = solved(s, given, none);
  if (!curved[0] && !curved[1]) return result;

  EndSlopes<Dim> slopes;
  const Eigen::Index last = s.h.size();
  const Steps<Dim> still{s.h, Points<Dim>::Zero(Dim, last)};
  slopes.own = {result.slopes.col(0), result.slopes.col(last)};
  for (const int side : {0, 1}) {
    if (!curved[side]) continue;
    Seconds one = none;
    one[side][1] = 1;
    const auto moved = solved(still, {CubicEndCondition<Dim>{given[0].kind}, {given[1].kind}}, one);
    for (const int at : {0, 1}) slopes.by(at, side) = moved.slopes(1, at * last);
  }
  // An end that runs so much faster than all chords is a solution on paper only.
  const double wild = 1e3 * s.d.colwise().norm().maxCoeff();
  const auto seconds = SecondsOfCurvatures<Dim>(curved, slopes, wild);
  if (!seconds) {
    RefuseSpline(
        "no spline with the curvatures given at its ends was found: take smaller ones, give a "
        "tangent in place of one, or points nearer to one another there");
  }
  return solved(s, given, *seconds);
}

// The control point whose knots are b − before, b and b + behind, at a point b of the spline.
template <int Dim>
Point<Dim> Blossom(const Point<Dim>& q,
                   const Point<Dim>& slope,
                   const Point<Dim>& moment,
                   double before,
                   double behind) {
  return q + (behind - before) / 3 * slope - before * behind / 6 * moment;
}

// The points that are knots.
std::vector<Eigen::Index> KnotPlaces(Eigen::Index m, bool drop_second, bool drop_last_but_one) {
  std::vector<Eigen::Index> places;
  for (Eigen::Index k = 0; k < m; ++k) {
    const bool dropped = m > 2 && ((k == 1 && drop_second) || (k == m - 2 && drop_last_but_one));
    if (!dropped) places.push_back(k);
  }
  return places;
}

// The spline with knots at these of its points.
template <int Dim>
NurbsCurve<Dim> CurveOf(const Points<Dim>& points,
                        const Eigen::VectorXd& t,
                        const SplineDerivatives<Dim>& derivatives,
                        const std::vector<Eigen::Index>& places) {
  std::vector<double> breaks;
  for (const Eigen::Index k : places) breaks.push_back(t[k]);
  SplineBasis basis = SplineBasis::Clamped(3, breaks);
  Points<Dim> control(Dim, basis.size());
  const auto last = static_cast<Eigen::Index>(places.size()) - 1;
  control.col(0) = points.col(0);
  control.col(last + 2) = points.col(points.cols() - 1);
  for (Eigen::Index k = 0; k <= last; ++k) {
    const Eigen::Index at = places[static_cast<size_t>(k)];
    const double before = k > 0 ? t[at] - breaks[static_cast<size_t>(k) - 1] : 0;
    const double behind = k < last ? breaks[static_cast<size_t>(k) + 1] - t[at] : 0;
    control.col(k + 1) = Blossom<Dim>(
        points.col(at), derivatives.slopes.col(at), derivatives.moments.col(at), before, behind);
  }
  return NurbsCurve<Dim>(std::move(basis), std::move(control));
}

}  // namespace

template <int Dim>
SplineDerivatives<Dim> SplineBySlopes(const Points<Dim>& points,
                                      const Eigen::VectorXd& t,
                                      const CubicEndCondition<Dim>& start,
                                      const CubicEndCondition<Dim>& end) {
  CheckSpline<Dim>(points, t, false);
  return WithEnds<Dim>(StepsOf<Dim>(points, t), start, end, Unknowns::kSlopes);
}

template <int Dim>
SplineDerivatives<Dim> SplineByMoments(const Points<Dim>& points,
                                       const Eigen::VectorXd& t,
                                       const CubicEndCondition<Dim>& start,
                                       const CubicEndCondition<Dim>& end) {
  CheckSpline<Dim>(points, t, false);
  return WithEnds<Dim>(StepsOf<Dim>(points, t), start, end, Unknowns::kMoments);
}

template <int Dim>
SplineDerivatives<Dim> ClosedSplineBySlopes(const Points<Dim>& points, const Eigen::VectorXd& t) {
  CheckSpline<Dim>(points, t, true);
  return Solved<Dim>(StepsOf<Dim>(points, t), nullptr, Unknowns::kSlopes);
}

template <int Dim>
SplineDerivatives<Dim> ClosedSplineByMoments(const Points<Dim>& points, const Eigen::VectorXd& t) {
  CheckSpline<Dim>(points, t, true);
  return Solved<Dim>(StepsOf<Dim>(points, t), nullptr, Unknowns::kMoments);
}

template <int Dim>
NurbsCurve<Dim> CubicSplineCurve(const Points<Dim>& points,
                                 const Eigen::VectorXd& t,
                                 const CubicEndCondition<Dim>& start,
                                 const CubicEndCondition<Dim>& end) {
  const SplineDerivatives<Dim> derivatives = SplineBySlopes<Dim>(points, t, start, end);
  const std::vector<Eigen::Index> places =
      KnotPlaces(points.cols(), start.kind == CubicEnd::kNotAKnot, end.kind == CubicEnd::kNotAKnot);
  return CurveOf<Dim>(points, t, derivatives, places);
}

template <int Dim>
NurbsCurve<Dim> PeriodicFunctionCurve(const Points<Dim>& points, const Eigen::VectorXd& t) {
  CheckSpline<Dim>(points, t, false);
  const Eigen::Index last = points.cols() - 1;
  const auto values = points.template bottomRows<Dim - 1>();
  const double gap = (values.col(last) - values.col(0)).stableNorm();
  const double extent = (values.rowwise().maxCoeff() - values.rowwise().minCoeff()).stableNorm();
  if (!(gap <= kRelativelyEqual * extent)) {
    RefuseSpline("a periodic function ends at the value it begins with: the last point is " +
                 RoundedText(gap) + " off the first; make them the same, or take other ends");
  }
  Points<Dim> round = points.leftCols(last), all = points;
  round.row(0).setZero();
  SplineDerivatives<Dim> derivatives = ClosedSplineBySlopes<Dim>(round, t);
  for (Points<Dim>* one : {&derivatives.slopes, &derivatives.moments}) {
    one->conservativeResize(Dim, last + 1);
    one->col(last) = one->col(0);
  }
  derivatives.slopes.row(0).setOnes();  // x is the parameter
  derivatives.moments.row(0).setZero();
  all.col(last).template tail<Dim - 1>() = values.col(0);
  return CurveOf<Dim>(all, t, derivatives, KnotPlaces(last + 1, false, false));
}

template <int Dim>
NurbsCurve<Dim> ClosedCubicSplineCurve(const Points<Dim>& points, const Eigen::VectorXd& t) {
  const SplineDerivatives<Dim> derivatives = ClosedSplineBySlopes<Dim>(points, t);
  SplineBasis basis = PeriodicKnots(3, std::vector<double>(t.begin(), t.end()));
  const Eigen::Index m = points.cols();
  Points<Dim> control(Dim, basis.size());
  for (Eigen::Index i = 0; i < control.cols(); ++i) {
    // The knots of control point i are those before, at and behind point i − 1.
    const Eigen::Index at = (i + m - 1) % m;
    const double behind = t[at + 1] - t[at], before = at > 0 ? t[at] - t[at - 1] : t[m] - t[m - 1];
    control.col(i) = Blossom<Dim>(
        points.col(at), derivatives.slopes.col(at), derivatives.moments.col(at), before, behind);
  }
  return NurbsCurve<Dim>(std::move(basis), std::move(control));
}

#define BATTEN_SPLINES(D)                                                                          \
  template SplineDerivatives<D> SplineBySlopes<D>(const Points<D>&,                                \
                                                  const Eigen::VectorXd&,                          \
                                                  const CubicEndCondition<D>&,                     \
                                                  const CubicEndCondition<D>&);                    \
  template SplineDerivatives<D> SplineByMoments<D>(const Points<D>&,                               \
                                                   const Eigen::VectorXd&,                         \
                                                   const CubicEndCondition<D>&,                    \
                                                   const CubicEndCondition<D>&);                   \
  template SplineDerivatives<D> ClosedSplineBySlopes<D>(const Points<D>&, const Eigen::VectorXd&); \
  template SplineDerivatives<D> ClosedSplineByMoments<D>(const Points<D>&,                         \
                                                         const Eigen::VectorXd&);                  \
  template NurbsCurve<D> CubicSplineCurve<D>(const Points<D>&,                                     \
                                             const Eigen::VectorXd&,                               \
                                             const CubicEndCondition<D>&,                          \
                                             const CubicEndCondition<D>&);                         \
  template NurbsCurve<D> ClosedCubicSplineCurve<D>(const Points<D>&, const Eigen::VectorXd&);      \
  template NurbsCurve<D> PeriodicFunctionCurve<D>(const Points<D>&, const Eigen::VectorXd&);
BATTEN_SPLINES(2)
BATTEN_SPLINES(3)
#undef BATTEN_SPLINES

}  // namespace batten
