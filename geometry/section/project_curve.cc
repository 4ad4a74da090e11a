// SPDX-License-Identifier: MIT
#include "batten/geometry/project_curve.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/geometry/closure.h"
#include "batten/geometry/foot_point.h"
#include "geometry/bezier/bernstein.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kSamplesInSpan = 16;
constexpr int kMostHalvings = 16;

// A foot point and how it moves with the curve's parameter.
struct Station {
  double t;
  Eigen::Vector2d at, velocity;
  bool inside;  // not on an edge that the curve lies beyond
};

class Projector {
 public:
  Projector(const NurbsSurface& surface, const NurbsCurve<3>& curve, double tolerance)
      : surface_(surface), foot_points_(surface), curve_(curve), tolerance_(tolerance) {}

  std::vector<NurbsCurve<2>> Project() {
    std::vector<Station> samples;
    for (const int span : curve_.basis().Spans()) {
      const double a = curve_.basis().knots()[span], b = curve_.basis().knots()[span + 1];
      for (int k = 0; k < kSamplesInSpan; ++k) {
        samples.push_back(StationAt(a + k * (b - a) / kSamplesInSpan));
      }
    }
    samples.push_back(StationAt(curve_.basis().upper()));
    std::vector<NurbsCurve<2>> curves;
    for (std::size_t k = 0; k < samples.size();) {
      if (!samples[k].inside) {
        ++k;
        continue;
      }
      std::vector<Station> run;
      if (k > 0) run.push_back(Border(samples[k], samples[k - 1].t));
      for (; k < samples.size() && samples[k].inside; ++k) run.push_back(samples[k]);
      if (k < samples.size()) run.push_back(Border(run.back(), samples[k].t));
      if (run.size() > 1) curves.push_back(AlgebraicCurveFit(run));
    }
    const bool whole = curves.size() == 1 && Closed(curve_) && samples.front().inside;
    return whole ? std::vector{ClosedUp(curves[0])} : curves;
  }

 private:
  // With (S − C)·S_u = (S − C)·S_v = 0 for all t: (JᵀJ + (S − C)·S'')·(u', v') = Jᵀ C'. The same
  // matrix takes the nearest point, of which only the distance is certain, to the place.
  Station StationAt(double t) {
    const CurveJet<3> c = curve_.JetAt(t);
    const SurfaceFoot foot = foot_points_.Nearest(c.point);
    Eigen::Vector2d at(foot.u, foot.v), velocity;
    Eigen::Vector3d gap, normal;
    constexpr int kSteps = 4;
    for (int k = 0;; ++k) {
      const SurfaceJet s = surface_.JetAt(at[0], at[1]);
      gap = s.point - c.point;
      normal = s.du.cross(s.dv).normalized();
      const double mixed = s.du.dot(s.dv) + gap.dot(s.duv);
      Eigen::Matrix2d matrix;
      matrix << s.du.dot(s.du) + gap.dot(s.duu), mixed, mixed, s.dv.dot(s.dv) + gap.dot(s.dvv);
      const auto solver = matrix.partialPivLu();
      velocity = solver.solve(Eigen::Vector2d(s.du.dot(c.first), s.dv.dot(c.first)));
      const Eigen::Vector2d step = solver.solve(Eigen::Vector2d(-gap.dot(s.du), -gap.dot(s.dv)));
      if (k == kSteps || !step.allFinite()) break;
      at[0] = std::clamp(at[0] + step[0], surface_.basis_u().lower(), surface_.basis_u().upper());
      at[1] = std::clamp(at[1] + step[1], surface_.basis_v().lower(), surface_.basis_v().upper());
    }
    if (!velocity.allFinite()) velocity.setZero();
    // Beyond an edge the gap is not along the normal.
    constexpr double kBeyond = 0.05;
    const bool beyond = (gap - gap.dot(normal) * normal).norm() > kBeyond * tolerance_;
    return {t, at, velocity, !beyond};
  }

  // The last station inside between one that is inside and a parameter that is not.
  Station Border(const Station& inside, double outside) {
    Station best = inside;
    constexpr int kHalvings = 50;
    for (int k = 0; k < kHalvings; ++k) {
      const Station middle = StationAt((best.t + outside) / 2);
      if (middle.inside) {
        best = middle;
      } else {
        outside = middle.t;
      }
    }
    return best;
  }

  static Eigen::Vector2d Between(const Station& a, const Station& b, double share) {
    const double length = b.t - a.t;
    double B[4];
    BernsteinValues(3, share, B);
    return B[0] * a.at + B[1] * (a.at + length / 3 * a.velocity) +
           B[2] * (b.at - length / 3 * b.velocity) + B[3] * b.at;
  }

  void CheckStep(const Station& a, const Station& b) const {
    const Eigen::Array2d domain(surface_.basis_u().upper() - surface_.basis_u().lower(),
                                surface_.basis_v().upper() - surface_.basis_v().lower());
    constexpr double kJump = 0.4;
    RequireThat(((b.at - a.at).array().abs() <= kJump * domain).all(),
                "ProjectedCurve",
                "the foot points jump at t = " + NumberText(b.t) +
                    ": the curve passes a seam or is too far from the surface");
  }

  void Refine(const Station& a, const Station& b, int depth, std::vector<Station>& stations) {
    bool near = depth > 0;
    for (const double share : {0.25, 0.5, 0.75}) {
      if (!near) break;
      const Station there = StationAt(a.t + share * (b.t - a.t));
      const Eigen::Vector2d at = Between(a, b, share);
      near = (surface_.At(at[0], at[1]) - surface_.At(there.at[0], there.at[1])).norm() <=
             tolerance_ / 2;
    }
    if (near || depth == kMostHalvings || !(b.t > a.t)) {
      RequireThat(near || depth < kMostHalvings || !(b.t > a.t),
                  "ProjectedCurve",
                  "the foot points jump at t = " + NumberText(b.t));
      stations.push_back(b);
      return;
    }
    const Station middle = StationAt((a.t + b.t) / 2);
    Refine(a, middle, depth + 1, stations);
    Refine(middle, b, depth + 1, stations);
  }

  NurbsCurve<2> AlgebraicCurveFit(std::vector<Station> run) {
    if (run.front().t > run[1].t) std::swap(run[0], run[1]);
    std::vector<Station> stations{run.front()};
    for (std::size_t k = 0; k + 1 < run.size(); ++k) {
      CheckStep(run[k], run[k + 1]);
      if (run[k + 1].t > run[k].t) Refine(run[k], run[k + 1], 0, stations);
    }
    std::vector<double> knots(4, stations.front().t);
    std::vector<Eigen::Vector2d> points{stations.front().at};
    for (std::size_t k = 0; k + 1 < stations.size(); ++k) {
      const Station &a = stations[k], &b = stations[k + 1];
      const double third = (b.t - a.t) / 3;
      points.push_back(a.at + third * a.velocity);
      points.push_back(b.at - third * b.velocity);
      points.push_back(b.at);
      knots.insert(knots.end(), k + 2 == stations.size() ? 4 : 3, b.t);
    }
    return NurbsCurve<2>(SplineBasis(3, std::move(knots)),
                         Eigen::Map<Eigen::Matrix2Xd>(
                             points[0].data(), 2, static_cast<Eigen::Index>(points.size())));
  }

  static NurbsCurve<2> ClosedUp(const NurbsCurve<2>& curve) {
    NurbsCurve<2>::Points points = curve.control_points();
    points.rightCols<1>() = points.leftCols<1>().eval();
    return NurbsCurve<2>(curve.basis(), std::move(points));
  }

  const NurbsSurface& surface_;
  SurfaceFootPoints foot_points_;
  const NurbsCurve<3>& curve_;
  double tolerance_;
};

}  // namespace

std::vector<NurbsCurve<2>> ProjectedCurve(const NurbsSurface& surface,
                                          const NurbsCurve<3>& curve,
                                          double tolerance) {
  RequirePositive("ProjectedCurve", "tolerance", tolerance);
  return Projector(surface, curve, tolerance).Project();
}

}  // namespace batten
