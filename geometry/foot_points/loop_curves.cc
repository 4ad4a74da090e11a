// SPDX-License-Identifier: MIT
#include "geometry/foot_points/loop_curves.h"

#include <algorithm>
#include <utility>

#include "geometry/bezier/spline_pieces.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten::internal {
namespace {

constexpr double kDeviation = 1e-12;  // of the size
// Where halving hardly helps it is no use: below this share of the size after two times, which is
// rounding, and elsewhere after eight.
constexpr double kRoundingLevel = 2e-11;
constexpr int kInVain = 2, kMostInVain = 8;
constexpr double kClose = 2e-11;  // of the size: what deviates more is looked at by itself
constexpr int kMostHalvings = 40;
constexpr double kLeastPart = 1e-13;  // of an arc

// The span of a parameter, counted along the breaks.
int SpanAt(const std::vector<double>& breaks, double u) {
  const auto next = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, u);
  return static_cast<int>(next - breaks.begin()) - 1;
}

CurvePiece ToCurvePiece(const MonotoneArc& arc) {
  CurvePiece piece{0, 1, Eigen::Vector3d::Zero(), Eigen::Matrix4Xd::Zero(4, arc.net.cols()), {}};
  piece.points.topRows<2>() = arc.net.topRows<2>();
  piece.points.row(3) = arc.net.row(2);
  return piece;
}

// A parameter along a loop, local to a piece of the surface, with its derivatives. What rounding or
// a loop leaves outside stays at the piece's side.
struct LocalParameter {
  double at, first, second;

  LocalParameter(double u, double du, double ddu, double u0, double u1)
      : at((u - u0) / (u1 - u0)), first(du / (u1 - u0)), second(ddu / (u1 - u0)) {
    constexpr double kRounding = 1e-14;
    if (at >= -kRounding && at <= 1 + kRounding) return;
    at = std::clamp(at, 0.0, 1.0);
    first = second = 0;
  }
};

struct Jet {
  Eigen::Vector3d point, first, second;
};

// Bézier points of the quintic with two jets, over an interval of that length.
Eigen::Matrix3Xd Quintic(const Jet& a, const Jet& b, double length) {
  const double first = length / 5, second = length * length / 20;
  Eigen::Matrix3Xd points(3, 6);
  points.col(0) = a.point;
  points.col(1) = a.point + first * a.first;
  points.col(2) = a.point + 2 * first * a.first + second * a.second;
  points.col(3) = b.point - 2 * first * b.first + second * b.second;
  points.col(4) = b.point - first * b.first;
  points.col(5) = b.point;
  return points;
}

}  // namespace

class LoopCurves::Builder {
 public:
  Builder(LoopCurves& result, const NurbsSurface& surface, double size)
      : result_(result),
        size_(size),
        pieces_(surface),
        breaks_{BreaksIn(surface.basis_u()), BreaksIn(surface.basis_v())} {}

  void AddArc(int index) {
    const MonotoneArc& arc = result_.arcs_[index];
    const CurvePiece curve = ToCurvePiece(arc);
    std::vector<double> cuts;
    for (const int axis : {0, 1}) {
      for (const double knot : breaks_[axis]) {
        const double value = (knot - result_.domain_.lower[axis]) / result_.domain_.length[axis];
        if (value > arc.Low(axis) && value < arc.High(axis)) {
          cuts.push_back(arc.Where(axis, value));
        }
      }
    }
    std::sort(cuts.begin(), cuts.end());
    cuts.push_back(1);
    double from = 0;
    for (const double to : cuts) {
      if (to - from <= kLeastPart || (to < 1 && 1 - to <= kLeastPart)) continue;
      const Eigen::Vector2d uv = result_.domain_.Back(arc.At(from + (to - from) / 2));
      const SurfacePiece piece =
          pieces_.Piece(SpanAt(breaks_[0], uv[0]), SpanAt(breaks_[1], uv[1]), result_.middle_);
      const Along along{result_.domain_, curve, piece};
      Add(along, {index, from, to}, along.At(from), along.At(to), {size_, 0, 0});
      from = to;
    }
  }

 private:
  // The smooth stretch of a loop in one piece of the surface.
  struct Along {
    const UnitDomain& domain;
    const CurvePiece& curve;
    const SurfacePiece& piece;

    Jet At(double t) const {
      const CurvePieceJet at = JetOf(curve, t);
      const Eigen::Vector2d uv = domain.Back(at.point.head<2>());
      const Eigen::Array2d first = domain.length * at.first.head<2>().array();
      const Eigen::Array2d second = domain.length * at.second.head<2>().array();
      const LocalParameter x(uv[0], first[0], second[0], piece.u0, piece.u1);
      const LocalParameter y(uv[1], first[1], second[1], piece.v0, piece.v1);
      const SurfaceJet jet = JetOf(piece, x.at, y.at);
      return {jet.point,
              x.first * jet.du + y.first * jet.dv,
              x.first * x.first * jet.duu + 2 * x.first * y.first * jet.duv +
                  y.first * y.first * jet.dvv + x.second * jet.du + y.second * jet.dv};
    }
  };

  // What became of the parts that hold a part.
  struct History {
    double deviation;
    int halvings, in_vain;
  };

  static Eigen::Vector3d PointOf(const Eigen::Matrix3Xd& bezier, double t) {
    double values[6];
    BernsteinBasis(5, t, values);
    return bezier * Eigen::Map<const Eigen::VectorXd>(values, 6);
  }

  void Add(const Along& along, const Part& part, const Jet& from, const Jet& to, History history) {
    const double length = part.t1 - part.t0, t = part.t0 + length / 2;
    const Eigen::Matrix3Xd points = Quintic(from, to, length);
    const Jet middle = along.At(t);
    double deviation = (PointOf(points, 0.5) - middle.point).norm();
    for (const double at : {0.25, 0.75}) {
      const Eigen::Vector3d off = PointOf(points, at) - along.At(part.t0 + at * length).point;
      deviation = std::max(deviation, off.norm());
    }
    deviation *= 2;
    history.in_vain = deviation > history.deviation / 4 ? history.in_vain + 1 : 0;
    const bool rounding = deviation <= kRoundingLevel * size_ && history.in_vain >= kInVain;
    if (deviation <= kDeviation * size_ || rounding || history.in_vain >= kMostInVain ||
        history.halvings >= kMostHalvings) {
      result_.parts_.push_back(part);
      result_.curves_.push_back(points);
      if (deviation <= kClose * size_) {
        result_.deviation_ = std::max(result_.deviation_, deviation);
      } else {
        AddLoose(points, deviation);
      }
      return;
    }
    history = {deviation, history.halvings + 1, history.in_vain};
    Add(along, {part.arc, part.t0, t}, from, middle, history);
    Add(along, {part.arc, t, part.t1}, middle, to, history);
  }

  void AddLoose(const Eigen::Matrix3Xd& points, double deviation) {
    Eigen::AlignedBox3d box;
    for (Eigen::Index k = 0; k < points.cols(); ++k) box.extend(Eigen::Vector3d(points.col(k)));
    const Eigen::Vector3d more = Eigen::Vector3d::Constant(deviation);
    result_.loose_.emplace_back(box.min() - more, box.max() + more);
  }

  LoopCurves& result_;
  double size_;
  SurfacePieces pieces_;
  std::vector<double> breaks_[2];
};

LoopCurves::LoopCurves(const NurbsSurface& surface, const Eigen::Vector3d& middle, double size)
    : domain_(surface), middle_(middle), arcs_(MonotoneArcs(surface.trims(), domain_)) {
  Builder builder(*this, surface, size);
  for (int k = 0; k < static_cast<int>(arcs_.size()); ++k) builder.AddArc(k);
}

double LoopCurves::LowerBound(const Eigen::Vector3d& q, double from_curves) const {
  double bound = from_curves - deviation_;
  for (const Eigen::AlignedBox3d& box : loose_)
    bound = std::min(bound, box.exteriorDistance(Eigen::Vector3d(q - middle_)));
  return std::max(0.0, bound);
}

Eigen::Vector2d LoopCurves::At(int part, double x) const {
  const Part& at = parts_[part];
  return domain_.Back(arcs_[at.arc].At(at.t0 + (at.t1 - at.t0) * (1 + x) / 2));
}

}  // namespace batten::internal
