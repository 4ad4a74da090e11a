// SPDX-License-Identifier: MIT
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/joins.h"
#include "geometry/measure/join_tolerances.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/polygon.h"
#include "geometry/nurbs/homogeneous.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kWanted = 33;  // places on an edge
constexpr int kMost = 300;
constexpr int kStretch = 3;  // so many places in a row are more than a common point

double End(const NurbsSurface& surface, const SurfaceEdge& edge) {
  const SplineBasis& basis = BasisOf(surface, edge.direction);
  return edge.upper ? basis.upper() : basis.lower();
}

// "u = 0"
std::string EdgeText(const NurbsSurface& surface, const SurfaceEdge& edge) {
  const char* name = edge.direction == Direction::kU ? "u = " : "v = ";
  return name + NumberText(End(surface, edge));
}

// The same number of places in every span, the ends of the domain too. At an odd part of a span, so
// that knots of the other edge, which may halve it, are not met.
std::vector<double> Places(const SplineBasis& basis) {
  constexpr double kOffset = 0.4142;
  const std::vector<int> spans = basis.Spans();
  const auto count = static_cast<int>(spans.size());
  const int in_span = std::clamp(kWanted / count, 3, kWanted);
  const int stride = 1 + count * in_span / kMost;
  std::vector<double> places;
  for (int k = 0; k < count; k += stride) {
    const double a = basis.knots()[spans[k]], b = basis.knots()[spans[k] + 1];
    for (int i = 0; i < in_span; ++i) places.push_back(a + (b - a) * (i + kOffset) / in_span);
  }
  return places;
}

// An edge as a curve to be asked for its nearest points.
struct EdgeCurve {
  SurfaceEdge edge;
  NurbsCurve<3> curve;
  CurveFootPoints<3> feet;
  std::vector<double> places;
  bool collapsed;

  EdgeCurve(const NurbsSurface& surface, const SurfaceEdge& which, double position)
      : edge(which),
        curve(IsoCurve(surface, which.direction, End(surface, which))),
        feet(curve),
        places(Places(curve.basis())) {
    const Eigen::Matrix3Xd& points = curve.control_points();
    collapsed = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm() <= position;
  }
};

// Parameters on both edges that stand for one place of the joint.
struct Match {
  double first, second, gap;
};

struct EdgePair {
  const EdgeCurve *first, *second;
  std::vector<Match> matches;
  double gap = 0;        // the largest, end points of both edges included
  bool touches = false;  // along a stretch
};

// A foot point that lies on the curve, or nearly, to the last digits of its parameter, which the
// comparison of derivatives needs: Gauss–Newton steps as long as they lead nearer.
CurveFoot Sharpened(const NurbsCurve<3>& curve, const Eigen::Vector3d& q, CurveFoot foot) {
  constexpr int kMostSteps = 10;
  for (int k = 0; k < kMostSteps; ++k) {
    const Eigen::Matrix3Xd c = curve.Derivatives(foot.u, 1);
    const double step = (q - c.col(0)).dot(c.col(1)) / c.col(1).squaredNorm();
    if (!std::isfinite(step)) break;
    const double u = curve.basis().Clamp(foot.u + step);
    const double distance = (curve.At(u) - q).norm();
    if (!(distance < foot.distance)) break;
    foot.u = u;
    foot.distance = distance;
  }
  return foot;
}

// From the places of one edge to the other; returns whether a stretch of it lies on the other.
bool AddMatches(
    const EdgeCurve& from, const EdgeCurve& to, bool swapped, double position, EdgePair& pair) {
  int in_a_row = 0;
  bool touches = false;
  const auto foot_of = [&](double s) {
    const Eigen::Vector3d q = from.curve.At(s);
    const CurveFoot foot = Sharpened(to.curve, q, to.feet.Nearest(q));
    pair.gap = std::max(pair.gap, foot.distance);
    return foot;
  };
  foot_of(from.curve.basis().lower());
  foot_of(from.curve.basis().upper());
  for (const double s : from.places) {
    const CurveFoot foot = foot_of(s);
    pair.matches.push_back(swapped ? Match{foot.u, s, foot.distance}
                                   : Match{s, foot.u, foot.distance});
    in_a_row = foot.distance <= position ? in_a_row + 1 : 0;
    touches = touches || in_a_row >= kStretch;
  }
  return touches;
}

EdgePair Paired(const EdgeCurve& first, const EdgeCurve& second, double position) {
  EdgePair pair{&first, &second, {}, 0, false};
  const bool forth = AddMatches(first, second, false, position, pair);
  const bool back = AddMatches(second, first, true, position, pair);
  pair.touches = forth || back;
  return pair;
}

// One side of the joint at one place. Derivatives by the parameters run along the first edge's
// sense and across the joint, from the first surface to the second.
struct Side {
  Eigen::Vector3d along, across;             // first derivatives
  Eigen::Vector3d along2, mixed, across2;    // second
  std::optional<Eigen::Vector3d> direction;  // across the joint: in the tangent plane, unit,
                                             // perpendicular to the edge
  std::optional<Eigen::Matrix2d> curvature;  // second form in the frame of edge and direction
};

// The second fundamental form in the orthonormal frame (e, d), n = e × d.
std::optional<Eigen::Matrix2d> SecondForm(const SurfaceJet& jet,
                                          const Eigen::Vector3d& e,
                                          const Eigen::Vector3d& d) {
  const Eigen::Vector3d n = e.cross(d);
  const Eigen::Matrix2d tangents{{jet.du.dot(e), jet.dv.dot(e)}, {jet.du.dot(d), jet.dv.dot(d)}};
  const Eigen::Matrix2d form{{n.dot(jet.duu), n.dot(jet.duv)}, {n.dot(jet.duv), n.dot(jet.dvv)}};
  constexpr double kRegular = 1e-10;
  if (!(std::abs(tangents.determinant()) > kRegular * jet.du.norm() * jet.dv.norm())) {
    return std::nullopt;
  }
  const Eigen::Matrix2d inverse = tangents.inverse();
  return Eigen::Matrix2d(inverse.transpose() * form * inverse);
}

Eigen::Vector2d Parameters(const NurbsSurface& surface, const SurfaceEdge& edge, double along) {
  const double end = End(surface, edge);
  return edge.direction == Direction::kU ? Eigen::Vector2d(end, along)
                                         : Eigen::Vector2d(along, end);
}

// `leaving`: the joint is where this surface ends, seen in the sense of the crossing; `sense` is −1
// where the parameter along the edge runs against the first edge.
Side SideOf(const NurbsSurface& surface,
            const SurfaceEdge& edge,
            double along,
            bool leaving,
            double sense) {
  const Eigen::Vector2d at = Parameters(surface, edge, along);
  const SurfaceJet jet = surface.JetAt(at[0], at[1]);
  const bool across_u = edge.direction == Direction::kU;
  const double crossing = leaving == edge.upper ? 1 : -1;
  Side side;
  side.along = sense * (across_u ? jet.dv : jet.du);
  side.across = crossing * (across_u ? jet.du : jet.dv);
  side.along2 = across_u ? jet.dvv : jet.duu;
  side.mixed = sense * crossing * jet.duv;
  side.across2 = across_u ? jet.duu : jet.dvv;
  const double length = side.along.norm();
  const auto normal = surface.NormalAt(at[0], at[1]);
  if (!normal || !(length > 0)) return side;
  const Eigen::Vector3d e = side.along / length;
  Eigen::Vector3d d = normal->cross(e);
  if (!(d.norm() > 0) || side.across.dot(d) == 0) return side;
  d *= (side.across.dot(d) > 0 ? 1 : -1) / d.norm();
  side.direction = d;
  side.curvature = SecondForm(jet, e, d);
  return side;
}

// Equality of partial derivatives of all places so far.
struct Partials {
  bool first = true, second = true;
};

class Measurement {
 public:
  Measurement(const NurbsSurface& first, const NurbsSurface& second, const JoinScale& scale)
      : first_(first), second_(second), scale_(scale) {}

  SurfaceJoin Of(const EdgePair& pair) {
    join_.edges = {pair.first->edge, pair.second->edge};
    join_.position_gap = pair.gap;
    join_.reversed = Opposed(pair);
    for (const Match& match : pair.matches) See(pair, match);
    if (join_.position_gap <= scale_.position()) Judge();
    const Match& worst = join_.position_gap > scale_.position()   ? widest_
                         : join_.geometric < 1 && join_.angle_gap ? most_bent_
                                                                  : most_curved_;
    join_.at = {Parameters(first_, join_.edges[0], worst.first),
                Parameters(second_, join_.edges[1], worst.second)};
    return join_;
  }

 private:
  // Whether most places say so: at cusps of an edge the derivatives say nothing.
  static bool Opposed(const EdgePair& pair) {
    int votes = 0;
    for (const Match& match : pair.matches) {
      const double with = pair.first->curve.Derivatives(match.first, 1)
                              .col(1)
                              .dot(pair.second->curve.Derivatives(match.second, 1).col(1));
      votes += with < 0 ? -1 : 1;
    }
    return votes < 0;
  }

  void See(const EdgePair& pair, const Match& match) {
    const Side a = SideOf(first_, join_.edges[0], match.first, true, 1);
    const Side b = SideOf(second_, join_.edges[1], match.second, false, join_.reversed ? -1 : 1);
    if (!(match.gap <= widest_.gap)) widest_ = match;
    if (a.direction && b.direction) {
      const double angle = AngleBetween(*a.direction, *b.direction);
      if (!join_.angle_gap || angle > *join_.angle_gap) {
        join_.angle_gap = angle;
        most_bent_ = match;
      }
    }
    if (a.curvature && b.curvature) {
      const double gap = Largest(*a.curvature - *b.curvature);
      const double curvature = std::max(Largest(*a.curvature), Largest(*b.curvature));
      equally_curved_ = equally_curved_ && scale_.EquallyCurved(gap, curvature);
      if (!join_.curvature_gap || gap > *join_.curvature_gap) {
        join_.curvature_gap = gap;
        most_curved_ = match;
      }
    }
    Compare(pair, match, a, b);
  }

  // The largest absolute eigenvalue of a symmetric matrix.
  static double Largest(const Eigen::Matrix2d& m) {
    const double mean = (m(0, 0) + m(1, 1)) / 2;
    return std::abs(mean) + std::hypot((m(0, 0) - m(1, 1)) / 2, (m(0, 1) + m(1, 0)) / 2);
  }

  static double SteepnessAcross(const NurbsSurface& surface, const SurfaceEdge& edge) {
    return Steepness(BasisOf(surface, edge.direction), End(surface, edge));
  }

  void Compare(const EdgePair& pair, const Match& match, const Side& a, const Side& b) {
    const double along = std::max(Steepness(pair.first->curve.basis(), match.first),
                                  Steepness(pair.second->curve.basis(), match.second));
    const double across =
        std::max(SteepnessAcross(first_, join_.edges[0]), SteepnessAcross(second_, join_.edges[1]));
    const auto rounding = [&](int k, int l) {
      return scale_.rounding() * std::pow(along, k) * std::pow(across, l);
    };
    const auto least = [&](const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
      return x.norm() * y.norm() / scale_.size();
    };
    partials_.first = partials_.first && scale_.Equal(a.along, b.along, 0, rounding(1, 0)) &&
                      scale_.Equal(a.across, b.across, 0, rounding(0, 1));
    partials_.second =
        partials_.second &&
        scale_.Equal(a.along2, b.along2, least(a.along, a.along), rounding(2, 0)) &&
        scale_.Equal(a.mixed, b.mixed, least(a.along, a.across), rounding(1, 1)) &&
        scale_.Equal(a.across2, b.across2, least(a.across, a.across), rounding(0, 2));
  }

  void Judge() {
    join_.parametric = !partials_.first ? 0 : !partials_.second ? 1 : 2;
    join_.geometric = 0;
    if (join_.angle_gap && scale_.Smooth(*join_.angle_gap)) {
      join_.geometric = join_.curvature_gap && equally_curved_ ? 2 : 1;
    }
  }

  const NurbsSurface &first_, &second_;
  const JoinScale& scale_;
  SurfaceJoin join_;
  Partials partials_;
  bool equally_curved_ = true;
  Match widest_{0, 0, -1}, most_bent_{}, most_curved_{};
};

std::vector<EdgeCurve> EdgesOf(const NurbsSurface& surface, double position) {
  std::vector<EdgeCurve> edges;
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    for (const bool upper : {false, true}) {
      EdgeCurve edge(surface, {direction, upper}, position);
      if (!edge.collapsed) edges.push_back(std::move(edge));
    }
  }
  return edges;
}

}  // namespace

SurfaceJoin TestJoin(const NurbsSurface& first,
                     const NurbsSurface& second,
                     const JoinOptions& options) {
  const JoinScale scale(first, second, options, "TestJoin");
  const std::vector<EdgeCurve> of_first = EdgesOf(first, scale.position());
  const std::vector<EdgeCurve> of_second = EdgesOf(second, scale.position());
  if (of_first.empty() || of_second.empty()) {
    throw std::invalid_argument("TestJoin: all edges of a surface are collapsed to points");
  }
  std::optional<EdgePair> best, partial;
  int shared = 0;
  for (const EdgeCurve& a : of_first) {
    for (const EdgeCurve& b : of_second) {
      EdgePair pair = Paired(a, b, scale.position());
      const bool coincides = pair.gap <= scale.position();
      if (coincides) ++shared;
      if (pair.touches && !coincides && !partial) partial = pair;
      if (!best || (shared <= 1 && coincides) || (shared == 0 && pair.gap < best->gap)) {
        best = std::move(pair);
      }
    }
  }
  if (shared == 0 && partial) {
    throw std::invalid_argument("TestJoin: the edge " + EdgeText(first, partial->first->edge) +
                                " of the first surface and the edge " +
                                EdgeText(second, partial->second->edge) +
                                " of the second coincide over a part only");
  }
  SurfaceJoin join = Measurement(first, second, scale).Of(*best);
  join.shared_edges = shared;
  return join;
}

SurfaceJoin TestSeam(const NurbsSurface& surface, Direction direction, const JoinOptions& options) {
  const JoinScale scale(surface, surface, options, "TestSeam");
  const EdgeCurve end(surface, {direction, true}, scale.position());
  const EdgeCurve start(surface, {direction, false}, scale.position());
  const EdgePair pair = Paired(end, start, scale.position());
  SurfaceJoin join = Measurement(surface, surface, scale).Of(pair);
  join.shared_edges = pair.gap <= scale.position() ? 1 : 0;
  return join;
}

}  // namespace batten
