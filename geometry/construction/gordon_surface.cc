// SPDX-License-Identifier: MIT
#include "batten/geometry/gordon_surface.h"

#include <algorithm>
#include <utility>

#include "batten/geometry/compatible_curves.h"
#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/reverse.h"
#include "geometry/construction/compatible_knots.h"
#include "geometry/construction/curve_network.h"
#include "geometry/construction/curves_together.h"
#include "geometry/construction/monotone_map.h"
#include "geometry/construction/one_sided_curve.h"
#include "geometry/construction/section_rows.h"
#include "geometry/construction/spline_interpolation.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kStay = 0.1;  // of the tolerance: curves so near to meeting stay as they are

// Where the curves of the other family cross all curves of this one.
std::vector<double> CommonParameters(const CurveFamily& family) {
  std::vector<double> at;
  for (const double mean : family.meets.colwise().mean()) at.push_back(mean);
  at.front() = 0;
  if (!family.closed) at.back() = 1;
  return at;
}

std::vector<double> WithEnd(std::vector<double> at, bool closed) {
  if (closed) at.push_back(1);
  return at;
}

// How far the curves of the family are, where they are to meet the others, from where they do.
double FarthestFromMeeting(const CurveFamily& family, const std::vector<double>& at) {
  double farthest = 0;
  for (std::size_t k = 0; k < family.curves.size(); ++k) {
    for (std::size_t l = 0; l < at.size(); ++l) {
      const NurbsCurve<3>& curve = family.curves[k];
      farthest = std::max(farthest, (curve.At(at[l]) - curve.At(family.meets(k, l))).norm());
    }
  }
  return farthest;
}

// The curves of a family over one basis, polynomial, each meeting the others at `at`.
CurvesTogether Traced(const CurveFamily& family, const std::vector<double>& at, double tolerance) {
  const double off = FarthestFromMeeting(family, at);
  const bool rational = std::ranges::any_of(
      family.curves, [](const NurbsCurve<3>& curve) { return curve.rational(); });
  if (off <= kStay * tolerance && !rational) return {Compatible(family.curves), off};
  const std::vector<double> places = WithEnd(at, family.closed);
  std::vector<MonotoneMap> maps;
  std::vector<FunctionBreak> breaks = {{0}, {1}};
  for (std::size_t k = 0; k < family.curves.size(); ++k) {
    const Eigen::RowVectorXd meets = family.meets.row(static_cast<Eigen::Index>(k));
    std::vector<double> values(meets.begin(), meets.end());
    maps.emplace_back(places, WithEnd(std::move(values), family.closed), family.closed);
    for (const double place : places) breaks.push_back({place, maps[k].continuity()});
    for (const FunctionBreak& knot : BreaksOf(family.curves[k])) {
      breaks.push_back({maps[k].InverseAt(knot.at), knot.continuity});
    }
  }
  std::erase_if(breaks, [](const FunctionBreak& b) { return b.at < 0 || b.at > 1; });
  return RetracedCubics(
      family.curves,
      [&](std::size_t k, double s, Side side) { return maps[k].At(s, side); },
      MergedBreaks(std::move(breaks)),
      tolerance,
      "Gordon");
}

// What is interpolated across the curves of a family, which lie at `at`.
struct Across {
  SplineBasis basis;
  std::vector<SplineDatum> data;
};

Across AcrossOf(const std::vector<double>& at, bool closed) {
  constexpr int kDegree = 3;
  std::vector<SplineDatum> data;
  for (const double place : at) data.push_back({place});
  if (closed) return {PeriodicKnots(kDegree, WithEnd(at, true)), std::move(data)};
  return {AveragedKnots(std::min<int>(kDegree, static_cast<int>(at.size()) - 1), at),
          std::move(data)};
}

// u along the curves, v across them.
NurbsSurface Skinned(const std::vector<NurbsCurve<3>>& curves, const Across& across) {
  const SectionRows rows = SectionRowsOf(curves);
  const Eigen::MatrixXd points = Interpolated(across.basis, across.data, rows.points);
  return SurfaceOfRows(
      rows.basis, across.basis, points, Eigen::MatrixXd::Ones(rows.rows(), across.basis.size()));
}

// Through the meeting points, u across the curves along v.
NurbsSurface ThroughPoints(const Eigen::Matrix3Xd& points, const Across& u, const Across& v) {
  const Eigen::Index n = static_cast<Eigen::Index>(u.data.size());
  const Eigen::Index m = static_cast<Eigen::Index>(v.data.size());
  // Row block k belongs to curve k along u, column l to curve l along v.
  Eigen::MatrixXd grid(3 * m, n);
  for (Eigen::Index k = 0; k < m; ++k) grid.middleRows<3>(3 * k) = points.middleCols(k * n, n);
  const Eigen::MatrixXd in_u = Interpolated(u.basis, u.data, grid);
  Eigen::MatrixXd turned(3 * u.basis.size(), m);
  for (Eigen::Index k = 0; k < m; ++k) {
    turned.col(k) = in_u.middleRows<3>(3 * k).reshaped();
  }
  const Eigen::MatrixXd net = Interpolated(v.basis, v.data, turned);
  return SurfaceOfRows(
      u.basis, v.basis, net, Eigen::MatrixXd::Ones(u.basis.size(), v.basis.size()));
}

}  // namespace

GordonSurface Gordon(const std::vector<NurbsCurve<3>>& along_u,
                     const std::vector<NurbsCurve<3>>& along_v,
                     const GordonOptions& options) {
  RequirePositive("Gordon", "tolerance", options.tolerance);
  CurveNetwork network = NetworkOf(along_u, along_v, options.tolerance);
  std::vector<double> u = CommonParameters(network.along_u);
  std::vector<double> v = CommonParameters(network.along_v);
  const CurvesTogether us = Traced(network.along_u, u, options.tolerance);
  const CurvesTogether vs = Traced(network.along_v, v, options.tolerance);
  const Across across_u = AcrossOf(u, network.along_u.closed);
  const Across across_v = AcrossOf(v, network.along_v.closed);
  const std::vector<NurbsSurface> parts =
      Compatible({Skinned(us.curves, across_v),
                  Swapped(Skinned(vs.curves, across_u)),
                  ThroughPoints(network.points, across_u, across_v)});
  const Eigen::Matrix3Xd net =
      parts[0].control_points() + (parts[1].control_points() - parts[2].control_points());
  return {NurbsSurface(parts[0].basis_u(), parts[0].basis_v(), net),
          std::move(u),
          std::move(v),
          std::move(network.along_u.order),
          std::move(network.along_v.order),
          network.gap,
          std::max(us.error, vs.error)};
}

}  // namespace batten
