// SPDX-License-Identifier: MIT
#include "batten/geometry/composition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/bezier/bezier_span.h"
#include "geometry/editing/composed_blossom.h"
#include "geometry/nurbs/homogeneous.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kSameEnds = 1e-12;  // of the domain: what f may miss its ends by

// The greater of the length of the domain and its ends: what its rounding is relative to.
double DomainSize(const SplineBasis& basis) {
  return std::max(
      {basis.upper() - basis.lower(), std::abs(basis.lower()), std::abs(basis.upper())});
}

// The value gained in one round.
double Gain(const ScalarSpline& f) { return f.At(f.basis.upper()) - f.At(f.basis.lower()); }

void CheckCoefficients(const ScalarSpline& f, const char* name) {
  if (f.coefficients.size() != f.basis.size()) {
    Reject("Composed",
           std::to_string(f.coefficients.size()) + " coefficients of " + name +
               " do not fit a basis of " + std::to_string(f.basis.size()) + " functions");
  }
  if (!f.coefficients.allFinite())
    Reject("Composed", "a coefficient of " + std::string(name) + " is not finite");
  if (!f.basis.periodic()) return;
  const int p = f.basis.degree();
  const Eigen::ArrayXd steps = f.coefficients.tail(p) - f.coefficients.head(p);
  if ((steps - Gain(f)).abs().maxCoeff() <= kSameEnds * f.coefficients.cwiseAbs().maxCoeff())
    return;
  Reject("Composed",
         "the last " + std::to_string(p) + " coefficients of " + name +
             ", over a periodic basis, are not the first ones plus what a round gains");
}

// Whether the polynomial with these Bézier coefficients never falls, to rounding; halved where the
// signs of the differences do not tell. [Piegl & Tiller 1997, §1.3 for the hodograph]
bool NeverFalls(const Eigen::VectorXd& b, double slack, int halvings) {
  const Eigen::Index q = b.size() - 1;
  const Eigen::VectorXd steps = b.tail(q) - b.head(q);
  if (steps.minCoeff() >= -slack) return true;
  if (halvings == 0 || steps[0] < -slack || steps[q - 1] < -slack) return false;
  Eigen::VectorXd d = b, left(q + 1), right(q + 1);
  for (Eigen::Index k = 0; k <= q; ++k) {
    left[k] = d[0];
    right[q - k] = d[q - k];
    for (Eigen::Index j = 0; j < q - k; ++j) d[j] = (d[j] + d[j + 1]) / 2;
  }
  return NeverFalls(left, slack, halvings - 1) && NeverFalls(right, slack, halvings - 1);
}

void CheckMap(const ScalarSpline& f, const SplineBasis& domain) {
  CheckCoefficients(f, "f");
  const int q = f.basis.degree(), degree = domain.degree() * q;
  if (degree > kMaxDegree) {
    Reject("Composed",
           "the result would have degree " + std::to_string(domain.degree()) + "·" +
               std::to_string(q) + " = " + std::to_string(degree) + "; at most " +
               std::to_string(kMaxDegree) + " is possible");
  }
  const double a = f.At(f.basis.lower()), b = f.At(f.basis.upper());
  const double allowed = kSameEnds * DomainSize(domain);
  if (!(std::abs(a - domain.lower()) <= allowed && std::abs(b - domain.upper()) <= allowed)) {
    Reject("Composed",
           "f maps its domain " + IntervalText(f.basis.lower(), f.basis.upper()) + " to " +
               IntervalText(a, b) + " and not onto the domain " +
               IntervalText(domain.lower(), domain.upper()));
  }
  constexpr int kMostHalvings = 40;
  for (const int span : f.basis.Spans()) {
    const Eigen::VectorXd bezier =
        BezierSpanMatrix(f.basis, span) * f.coefficients.segment(span - q, q + 1);
    const double slack = 4 * kEpsilon * bezier.cwiseAbs().maxCoeff();
    if (bezier[q] > bezier[0] && NeverFalls(bezier, slack, kMostHalvings)) continue;
    Reject("Composed",
           "f can't be shown to increase strictly between " + NumberText(f.basis.knots()[span]) +
               " and " + NumberText(f.basis.knots()[span + 1]));
  }
}

// A spline function of any number of rows; a round over a periodic basis adds `gain`.
struct Outer {
  SplineBasis basis;
  Eigen::MatrixXd columns;
  Eigen::VectorXd gain;
  int block;  // rows block − 1, 2·block − 1, … are weights; 0 if there are none
};

// A knot inside the domain of the result, or its start, and how many pieces of f and C end there.
struct ResultKnot {
  double s;
  int multiplicity, f_pieces, c_pieces;
};

// A piece of the result, and the spans of f and C that it is made of.
struct ResultPiece {
  double a, b;
  int f_span, c_span;
};

// Multiplicities of both knots that meet at a place, 0 if there is none.
struct Meeting {
  double s;
  int in_f, in_c, f_pieces, c_pieces;
};

// A place inside the domain where knots stand, and how many pieces of the spline end there. Knots
// nearer than `resolution` to each other, or to the lower end, are one place; near the upper end
// they are none.
struct Place {
  double value;
  int multiplicity, pieces;
};

std::vector<Place> InnerPlaces(const SplineBasis& basis, double resolution) {
  std::vector<Place> places;
  double last = basis.lower();
  for (const double knot : basis.knots()) {
    if (knot <= basis.lower() || knot >= basis.upper() - resolution) continue;
    if (places.empty() && knot - basis.lower() <= resolution) {
      places.push_back({basis.lower(), 0, 0});
    } else if (places.empty() || knot - places.back().value > resolution) {
      places.push_back({knot, 0, 0});
    }
    ++places.back().multiplicity;
    if (knot > last) ++places.back().pieces;
    last = knot;
  }
  return places;
}

int SeamMultiplicity(const SplineBasis& basis) {
  return std::max(basis.Multiplicity(basis.lower()), basis.Multiplicity(basis.upper()));
}

// Whether splines over the basis go on continuously after a round.
bool JoinsItself(const SplineBasis& basis) {
  return basis.periodic() && SeamMultiplicity(basis) <= basis.degree();
}

class Composer {
 public:
  Composer(const Outer& outer, const ScalarSpline& f)
      : outer_(outer),
        f_(f),
        p_(outer.basis.degree()),
        q_(f.basis.degree()),
        periodic_(JoinsItself(outer.basis) && JoinsItself(f.basis)),
        c_knots_(outer.basis.knots()),
        largest_(outer.columns.cwiseAbs().rowwise().maxCoeff()) {
    if (outer.block > 0) least_weight_ = SmallestWeight(outer.columns);
    // Far from zero, values of f are kept relative to the lower end; such differences are exact.
    const double lower = outer.basis.lower(), upper = outer.basis.upper();
    if (std::min(std::abs(lower), std::abs(upper)) < upper - lower) return;
    for (double& knot : c_knots_) knot -= lower;
    f_.coefficients.array() -= lower;
    shift_ = lower;
  }

  Outer Result() {
    std::vector<ResultKnot> knots = Knots(Meetings());
    constexpr int kMostRounds = 24;
    const size_t most_knots = 64 * (knots.size() + 1);
    for (int round = 0;; ++round) {
      std::vector<size_t> bad;
      Outer result = Over(knots, bad);
      if (bad.empty()) return result;
      if (round == kMostRounds || knots.size() > most_knots) {
        Reject("Composed", "the control points of the result can't be kept near the shape");
      }
      knots = Refined(knots, round == 0 ? std::vector<size_t>() : bad);
    }
  }

 private:
  // The place that f maps to `value`, by bisection.
  double Preimage(double value) const {
    double a = f_.basis.lower(), b = f_.basis.upper();
    for (int k = 0; k < 100; ++k) {
      const double s = a + (b - a) / 2;
      if (s <= a || s >= b) break;
      (f_.At(s) < value ? a : b) = s;
    }
    return b;
  }

  // Where pieces of f and C end. A knot of f whose value is a knot of C to rounding is one place.
  std::vector<Meeting> Meetings() const {
    std::vector<Meeting> meetings;
    for (const Place& place : InnerPlaces(f_.basis, 0)) {
      meetings.push_back({place.value, place.multiplicity, 0, place.pieces, 0});
    }
    std::vector<double> values;
    for (const Meeting& meeting : meetings) values.push_back(f_.At(meeting.s));
    const SplineBasis& C = outer_.basis;
    // Pieces of C that the values of f can't resolve are passed over.
    const double first = f_.At(f_.basis.lower()), last = f_.At(f_.basis.upper());
    const double missed =
        std::max(std::abs(first - (C.lower() - shift_)), std::abs(last - (C.upper() - shift_)));
    const double resolution =
        std::max(16 * kEpsilon * std::max(std::abs(first), std::abs(last)), 4 * missed);
    const std::vector<Place> of_c = InnerPlaces(C, resolution);
    for (size_t k = 0; k < of_c.size(); ++k) {
      const double before = k == 0 ? C.lower() : of_c[k - 1].value, at = of_c[k].value;
      const double after = k + 1 == of_c.size() ? C.upper() : of_c[k + 1].value;
      const double near =
          std::min({16 * kEpsilon * DomainSize(C), (at - before) / 4, (after - at) / 4});
      const auto distance = [&](double value) { return std::abs(value - (at - shift_)); };
      const auto nearest = std::min_element(values.begin(), values.end(), [&](double x, double y) {
        return distance(x) < distance(y);
      });
      if (at == C.lower()) {
        meetings.push_back({f_.basis.lower(), 0, of_c[k].multiplicity, 0, of_c[k].pieces});
      } else if (nearest != values.end() && distance(*nearest) <= near) {
        Meeting& meeting = meetings[static_cast<size_t>(nearest - values.begin())];
        meeting.in_c = of_c[k].multiplicity;
        meeting.c_pieces = of_c[k].pieces;
      } else {
        meetings.push_back({Preimage(at - shift_), 0, of_c[k].multiplicity, 0, of_c[k].pieces});
      }
    }
    std::sort(meetings.begin(), meetings.end(), [](const Meeting& x, const Meeting& y) {
      return x.s < y.s;
    });
    return meetings;
  }

  int Multiplicity(int in_f, int in_c) const {
    int continuity = p_ * q_;
    if (in_f > 0) continuity = std::min(continuity, q_ - in_f);
    if (in_c > 0) continuity = std::min(continuity, p_ - in_c);
    return p_ * q_ - std::max(continuity, 0);
  }

  // Knots from the start on; those that fall together in rounding are one.
  std::vector<ResultKnot> Knots(const std::vector<Meeting>& meetings) const {
    const int start = periodic_
                          ? Multiplicity(SeamMultiplicity(f_.basis), SeamMultiplicity(outer_.basis))
                          : p_ * q_ + 1;
    std::vector<ResultKnot> knots(1, {f_.basis.lower(), start, 0, 0});
    int in_f = 0, in_c = 0;
    for (const Meeting& meeting : meetings) {
      if (meeting.s >= f_.basis.upper()) break;
      if (meeting.s > knots.back().s) {
        knots.push_back({meeting.s, 0, 0, 0});
        in_f = in_c = 0;
      }
      ResultKnot& knot = knots.back();
      knot.f_pieces += meeting.f_pieces;
      knot.c_pieces += meeting.c_pieces;
      if (knots.size() == 1) continue;
      in_f += meeting.in_f, in_c += meeting.in_c;
      knot.multiplicity = Multiplicity(in_f, in_c);
    }
    return knots;
  }

  // Every knot as often as a continuous spline allows, and the bad pieces halved.
  std::vector<ResultKnot> Refined(const std::vector<ResultKnot>& knots,
                                  const std::vector<size_t>& bad) const {
    std::vector<ResultKnot> result;
    for (size_t k = 0; k < knots.size(); ++k) {
      result.push_back(knots[k]);
      result.back().multiplicity = std::max(knots[k].multiplicity, p_ * q_);
      const double end = k + 1 == knots.size() ? f_.basis.upper() : knots[k + 1].s;
      const double middle = knots[k].s + (end - knots[k].s) / 2;
      if (!std::binary_search(bad.begin(), bad.end(), k)) continue;
      if (middle > knots[k].s && middle < end) result.push_back({middle, p_ * q_, 0, 0});
    }
    return result;
  }

  std::vector<ResultPiece> Pieces(const std::vector<ResultKnot>& knots) const {
    const std::vector<int> f_spans = f_.basis.Spans(), c_spans = outer_.basis.Spans();
    std::vector<ResultPiece> pieces;
    size_t i = 0, j = 0;
    for (size_t k = 0; k < knots.size(); ++k) {
      i += static_cast<size_t>(knots[k].f_pieces);
      j += static_cast<size_t>(knots[k].c_pieces);
      const double end = k + 1 == knots.size() ? f_.basis.upper() : knots[k + 1].s;
      pieces.push_back({knots[k].s, end, f_spans[i], c_spans[j]});
    }
    return pieces;
  }

  SplineBasis BasisOver(const std::vector<ResultKnot>& knots) const {
    const int degree = p_ * q_;
    const double a = f_.basis.lower(), b = f_.basis.upper();
    std::vector<double> V(1, a);
    for (size_t k = 1; k < knots.size(); ++k) V.insert(V.end(), knots[k].multiplicity, knots[k].s);
    if (!periodic_) {
      V.insert(V.begin(), degree, a);
      V.insert(V.end(), degree + 1, b);
      return SplineBasis(degree, std::move(V));
    }
    // One round ends with all the copies of the seam; the rest is whole rounds away.
    V.insert(V.end(), knots[0].multiplicity, b);
    const int round = static_cast<int>(V.size()) - 1;
    std::vector<double> before(degree);
    const auto at = [&](int i) { return i < 0 ? before[degree + i] : V[i]; };
    for (int i = -1; i >= -degree; --i) before[degree + i] = a - (b - at(i + round));
    for (int i = round + 1; i <= round + degree; ++i) V.push_back(b + (V[i - round] - a));
    V.insert(V.begin(), before.begin(), before.end());
    return SplineBasis::Periodic(degree, std::move(V));
  }

  // How much the blossom of a piece may amplify the coefficients on it, as a logarithm.
  static double Growth(const ResultPiece& piece, const double* arguments, int count) {
    double growth = 0;
    for (int k = 0; k < count; ++k) {
      const double outside = std::max({piece.a - arguments[k], arguments[k] - piece.b, 0.0});
      growth += std::log1p(2 * outside / (piece.b - piece.a));
    }
    return growth;
  }

  Eigen::VectorXd ControlPoint(const ResultPiece& piece, const double* arguments) const {
    std::vector<double> sorted(arguments, arguments + p_ * q_);
    const auto outside = [&](double x) { return std::max(piece.a - x, x - piece.b); };
    std::stable_sort(sorted.begin(), sorted.end(), [&](double x, double y) {
      return outside(x) > outside(y) || (outside(x) == outside(y) && x < y);
    });
    Multiset multiset;
    for (const double x : sorted) {
      if (multiset.values.empty() || multiset.values.back() != x) {
        multiset.values.push_back(x);
        multiset.counts.push_back(0);
      }
      ++multiset.counts.back();
    }
    const Eigen::VectorXd weights =
        ComposedBlossom({p_, &c_knots_, piece.c_span},
                        {q_, &f_.basis.knots(), piece.f_span},
                        f_.coefficients.segment(piece.f_span - q_, q_ + 1),
                        multiset);
    return outer_.columns.middleCols(piece.c_span - p_, p_ + 1) * weights;
  }

  double SmallestWeight(const Eigen::MatrixXd& columns) const {
    double smallest = std::numeric_limits<double>::infinity();
    for (Eigen::Index row = outer_.block - 1; row < columns.rows(); row += outer_.block) {
      smallest = std::min(smallest, columns.row(row).minCoeff());
    }
    return smallest;
  }

  // Whether a control point is near the shape: enough knots bring each near the values of C, whose
  // coordinates and weights lie between those of its control points.
  bool IsNear(const Eigen::VectorXd& point) const {
    constexpr double kTimes = 16;
    if (outer_.block > 0 && SmallestWeight(point) < least_weight_ / kTimes) return false;
    return (point.cwiseAbs().array() <= kTimes * largest_.array()).all();
  }

  // The result over these knots; `bad` gets the pieces from which control points far off came. A
  // control point comes from the piece that has to be extrapolated least; over a periodic basis its
  // copies in other rounds offer more pieces.
  Outer Over(const std::vector<ResultKnot>& knots, std::vector<size_t>& bad) const {
    Outer result{BasisOver(knots), {}, outer_.gain, outer_.block};
    const int degree = p_ * q_, n = result.basis.size(), round = periodic_ ? n - degree : n;
    const std::vector<double>& V = result.basis.knots();
    const std::vector<ResultPiece> pieces = Pieces(knots);
    result.columns.resize(outer_.columns.rows(), n);
    for (int i = 0; i < round; ++i) {
      size_t best = pieces.size();
      int best_copy = i;
      double least = std::numeric_limits<double>::infinity();
      for (int copy = i; copy < n; copy += round) {
        for (size_t k = 0; k < pieces.size(); ++k) {
          if (V[copy] > pieces[k].a || V[copy + degree + 1] < pieces[k].b) continue;
          const double growth = Growth(pieces[k], &V[copy + 1], degree);
          if (growth >= least) continue;
          least = growth, best = k, best_copy = copy;
        }
      }
      const Eigen::VectorXd point = ControlPoint(pieces[best], &V[best_copy + 1]);
      for (int copy = i; copy < n; copy += round) {
        result.columns.col(copy) = point + (copy - best_copy) / round * outer_.gain;
      }
      if (IsNear(point)) continue;
      if (bad.empty() || bad.back() != best) bad.push_back(best);
    }
    std::sort(bad.begin(), bad.end());
    return result;
  }

  const Outer& outer_;
  ScalarSpline f_;  // less shift_
  int p_, q_;
  bool periodic_;
  std::vector<double> c_knots_;  // less shift_
  double shift_ = 0;
  Eigen::VectorXd largest_;  // of each row of C
  double least_weight_ = 0;
};

Outer Compose(const Outer& outer, const ScalarSpline& f) {
  CheckMap(f, outer.basis);
  return Composer(outer, f).Result();
}

}  // namespace

double ScalarSpline::At(double s) const {
  s = std::clamp(s, basis.lower(), basis.upper());
  const int p = basis.degree(), span = basis.Span(s);
  double N[kMaxDegree + 1], sum = 0;
  basis.Values(span, s, N);
  for (int r = 0; r <= p; ++r) sum += N[r] * coefficients[span - p + r];
  return sum;
}

template <int Dim>
NurbsCurve<Dim> Composed(const NurbsCurve<Dim>& curve, const ScalarSpline& f) {
  const Outer result = Compose({curve.basis(),
                                Homogeneous(curve),
                                Eigen::VectorXd::Zero(Dim + 1),
                                curve.rational() ? Dim + 1 : 0},
                               f);
  return CurveFromHomogeneous<Dim>(result.basis, result.columns, curve.rational());
}

NurbsSurface Composed(const NurbsSurface& surface, Direction direction, const ScalarSpline& f) {
  RefuseTrims(surface.trimmed(), "Composed", "its loops would be no NURBS curves");
  const Eigen::MatrixXd rows = HomogeneousRows(surface, direction);
  const Outer result = Compose({BasisOf(surface, direction),
                                rows,
                                Eigen::VectorXd::Zero(rows.rows()),
                                surface.rational() ? 4 : 0},
                               f);
  return SurfaceFromHomogeneous(surface, direction, result.basis, result.columns);
}

ScalarSpline Composed(const ScalarSpline& g, const ScalarSpline& f) {
  CheckCoefficients(g, "g");
  const double gain = g.basis.periodic() ? Gain(g) : 0;
  const Outer result =
      Compose({g.basis, g.coefficients.transpose(), Eigen::VectorXd::Constant(1, gain), 0}, f);
  return {result.basis, result.columns.row(0).transpose()};
}

template NurbsCurve<2> Composed(const NurbsCurve<2>&, const ScalarSpline&);
template NurbsCurve<3> Composed(const NurbsCurve<3>&, const ScalarSpline&);

}  // namespace batten
