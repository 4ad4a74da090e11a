// SPDX-License-Identifier: MIT
#include "batten/geometry/coons_surface.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "batten/geometry/bicubic_patch.h"
#include "batten/geometry/compatible_curves.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "geometry/construction/boundary_loop.h"
#include "geometry/construction/compatible_knots.h"
#include "geometry/construction/curve_closure.h"
#include "geometry/construction/curves_together.h"
#include "geometry/construction/section_rows.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

using Curves = std::vector<NurbsCurve<3>>;

bool AnyRational(const BoundaryLoop& loop) {
  const auto rational = [](const NurbsCurve<3>& curve) { return curve.rational(); };
  return std::ranges::any_of(loop.along_u, rational) || std::ranges::any_of(loop.along_v, rational);
}

// u along the curves, which are the rows of a Bézier net across v.
NurbsSurface BezierAcross(Curves rows) {
  rows = Compatible(std::move(rows));
  const Eigen::Index size = rows[0].control_points().cols();
  const Eigen::Index count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd points(3 * size, count), weights(size, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    points.col(k) = rows[k].control_points().reshaped();
    weights.col(k) = rows[k].weights();
  }
  const int degree = static_cast<int>(count) - 1;
  return SurfaceOfRows(
      rows[0].basis(), SplineBasis::Uniform(degree, degree + 1, 0, 1), points, weights);
}

// Control points a + b − c about `middle`, in homogeneous coordinates, of surfaces brought
// together.
struct Blend {
  SplineBasis u, v;
  Eigen::Matrix4Xd columns;
};

Blend BlendOf(const NurbsSurface& a,
              const NurbsSurface& b,
              const NurbsSurface& c,
              const Eigen::Vector3d& middle) {
  const std::vector<NurbsSurface> parts = Compatible({a, b, c});
  const auto columns = [&](const NurbsSurface& part) {
    Eigen::Matrix4Xd homogeneous(4, part.control_points().cols());
    homogeneous.topRows<3>() =
        (part.control_points().colwise() - middle) * part.weights().asDiagonal();
    homogeneous.row(3) = part.weights().transpose();
    return homogeneous;
  };
  return {parts[0].basis_u(),
          parts[0].basis_v(),
          columns(parts[0]) + (columns(parts[1]) - columns(parts[2]))};
}

NurbsSurface SurfaceOf(const Blend& blend, const Eigen::Vector3d& middle) {
  Eigen::Matrix3Xd points = blend.columns.topRows<3>();
  points.array().rowwise() /= blend.columns.row(3).array();
  points.colwise() += middle;
  return NurbsSurface(blend.u, blend.v, std::move(points), blend.columns.row(3).transpose());
}

Eigen::Vector3d MiddleOf(const BoundaryLoop& loop) {
  return (loop.corners[0] + loop.corners[1] + loop.corners[2] + loop.corners[3]) / 4;
}

Blend BilinearBlend(const BoundaryLoop& loop) {
  return BlendOf(BezierAcross(loop.along_u),
                 Swapped(BezierAcross(loop.along_v)),
                 MakeBilinear(loop.corners[0], loop.corners[1], loop.corners[2], loop.corners[3]),
                 MiddleOf(loop));
}

double LeastWeight(const Curves& curves) {
  double least = 1;
  for (const NurbsCurve<3>& curve : curves) least = std::min(least, curve.weights().minCoeff());
  return least;
}

// Its sides as cubics; the largest distance by which they differ.
double ReplaceByCubics(BoundaryLoop& loop, double tolerance) {
  double error = 0;
  for (Curves* pair : {&loop.along_u, &loop.along_v}) {
    CurvesTogether cubics = AsCubics(*pair, tolerance, "Coons");
    *pair = std::move(cubics.curves);
    error = std::max(error, cubics.error);
  }
  return error;
}

CoonsSurface Bilinear(BoundaryLoop loop, double tolerance) {
  constexpr double kSound = 0.1;  // of the least given weight
  if (AnyRational(loop)) {
    BoundaryLoop even = loop;
    for (Curves* pair : {&even.along_u, &even.along_v}) {
      for (NurbsCurve<3>& side : *pair) side = WithEndWeights(side, 1, 1);
    }
    const double given = std::min(LeastWeight(even.along_u), LeastWeight(even.along_v));
    const Blend blend = BilinearBlend(even);
    if (blend.columns.row(3).minCoeff() >= kSound * given) {
      return {SurfaceOf(blend, MiddleOf(even)), loop.gap, 0};
    }
  }
  const double error = AnyRational(loop) ? ReplaceByCubics(loop, tolerance) : 0;
  return {SurfaceOf(BilinearBlend(loop), MiddleOf(loop)), loop.gap, error};
}

Eigen::Vector3d SlopeAt(const NurbsCurve<3>& curve, int end) {
  const SplineBasis& basis = curve.basis();
  return curve.JetAt(end == 0 ? basis.lower() : basis.upper()).first;
}

// From one vector to the other with slopes of zero: the blend that makes twists vanish.
NurbsCurve<3> Blended(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  Eigen::Matrix3Xd points(3, 4);
  points << from, from, to, to;
  return NurbsCurve<3>(SplineBasis::Uniform(3, 4, 0, 1), std::move(points));
}

// Derivatives across v = 0, v = 1, u = 0, u = 1.
std::array<NurbsCurve<3>, 4> AcrossOf(const BoundaryLoop& loop) {
  const auto blended = [](const Curves& pair, int end) {
    return Blended(SlopeAt(pair[0], end), SlopeAt(pair[1], end));
  };
  return {blended(loop.along_v, 0),
          blended(loop.along_v, 1),
          blended(loop.along_u, 0),
          blended(loop.along_u, 1)};
}

void RequireNear(const Eigen::Vector3d& a,
                 const Eigen::Vector3d& b,
                 int corner,
                 const std::string& what) {
  constexpr double kNear = 1e-6;
  const double size = std::max(a.norm(), b.norm());
  RequireThat((a - b).norm() <= kNear * std::max(size, std::numeric_limits<double>::min()),
              "Coons",
              "at corner u = " + std::to_string(corner % 2) +
                  ", v = " + std::to_string(corner / 2) + " " + what + " differ by " +
                  RoundedText((a - b).norm()) + ", above 1e-6 of their size " + RoundedText(size));
}

// Tangents and twists at the corners, which sides and derivatives across must agree about.
PatchCorners CornersOf(const BoundaryLoop& loop, const std::array<NurbsCurve<3>, 4>& across) {
  PatchCorners corners{loop.corners, {}, {}, {}};
  for (int corner = 0; corner < 4; ++corner) {
    const int u = corner % 2, v = corner / 2;
    corners.tangents_u[corner] = SlopeAt(loop.along_u[v], u);
    corners.tangents_v[corner] = SlopeAt(loop.along_v[u], v);
    const auto at_end = [](const NurbsCurve<3>& curve, int end) {
      return curve.At(end == 0 ? curve.basis().lower() : curve.basis().upper());
    };
    RequireNear(at_end(across[v], u),
                corners.tangents_v[corner],
                corner,
                "the derivative across and the side's tangent in v");
    RequireNear(at_end(across[2 + u], v),
                corners.tangents_u[corner],
                corner,
                "the derivative across and the side's tangent in u");
    const Eigen::Vector3d twist = SlopeAt(across[v], u);
    RequireNear(twist, SlopeAt(across[2 + u], v), corner, "the twists of the derivatives across");
    corners.twists[corner] = twist;
  }
  return corners;
}

NurbsCurve<3> Plus(const NurbsCurve<3>& side, const NurbsCurve<3>& across, double factor) {
  const Curves both = Compatible({side, across});
  return NurbsCurve<3>(both[0].basis(),
                       both[0].control_points() + factor * both[1].control_points());
}

// u along the sides, v the cubic Hermite blend of both and of the derivatives across them.
NurbsSurface HermiteAcross(const Curves& sides,
                           const NurbsCurve<3>& lower,
                           const NurbsCurve<3>& upper) {
  return BezierAcross(
      {sides[0], Plus(sides[0], lower, 1.0 / 3), Plus(sides[1], upper, -1.0 / 3), sides[1]});
}

CoonsSurface Bicubic(BoundaryLoop loop, const CoonsOptions& options) {
  const double error = AnyRational(loop) ? ReplaceByCubics(loop, options.tolerance) : 0;
  const std::array<NurbsCurve<3>, 4> across = options.across.value_or(AcrossOf(loop));
  for (const NurbsCurve<3>& one : across) {
    RequireThat(!one.rational(), "Coons", "a derivative across has weights");
  }
  const Eigen::Vector3d middle = MiddleOf(loop);
  const Blend blend = BlendOf(HermiteAcross(loop.along_u, across[0], across[1]),
                              Swapped(HermiteAcross(loop.along_v, across[2], across[3])),
                              BicubicPatch(CornersOf(loop, across)),
                              middle);
  return {SurfaceOf(blend, middle), loop.gap, error};
}

}  // namespace

CoonsSurface Coons(const std::vector<NurbsCurve<3>>& sides, const CoonsOptions& options) {
  RequirePositive("Coons", "tolerance", options.tolerance);
  RequireThat(options.bicubic || !options.across, "Coons", "across: bicubic alone takes it");
  BoundaryLoop loop = LoopOf(sides, options.tolerance);
  CoonsSurface coons = options.bicubic ? Bicubic(std::move(loop), options)
                                       : Bilinear(std::move(loop), options.tolerance);
  RequireArea(coons.surface, "Coons");
  return coons;
}

}  // namespace batten
