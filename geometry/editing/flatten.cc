// SPDX-License-Identifier: MIT
#include "batten/geometry/flatten.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "batten/geometry/insert_knots.h"
#include "geometry/editing/control_forms.h"
#include "geometry/editing/region_knots.h"
#include "geometry/editing/tied_points.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

// The way to the plane of any point x is step·(offset − normal·x), the normal of length one.
template <int Dim>
struct Projection {
  Eigen::Matrix<double, Dim, 1> normal, step;
  double offset;

  Eigen::Matrix<double, Dim, 1> Move(const Eigen::Matrix<double, Dim, 1>& x) const {
    return step * (offset - normal.dot(x));
  }
};

template <int Dim>
Projection<Dim> ProjectionOf(const FlattenOptions<Dim>& options) {
  constexpr double kInPlane = 1e-9;  // sine of the angle with the plane
  const double length = options.normal.stableNorm();
  if (!(length > 0) || !std::isfinite(length) || !std::isfinite(options.offset))
    Reject("Flattened", "the plane has no normal, or is not finite");
  if (!(options.transition > 0) || !std::isfinite(options.transition)) {
    Reject("Flattened",
           "the transition " + NumberText(options.transition) + " is not positive and finite");
  }
  Projection<Dim> projection{
      options.normal / length, options.normal / length, options.offset / length};
  if (!options.along) return projection;
  const double steps = options.along->stableNorm();
  if (!(steps > 0) || !std::isfinite(steps)) Reject("Flattened", "the direction has no length");
  const Eigen::Matrix<double, Dim, 1> unit = *options.along / steps;
  const double slope = unit.dot(projection.normal);
  if (!(std::abs(slope) > kInPlane))
    Reject("Flattened", "the direction lies in the plane: it leads no point there");
  projection.step = unit / slope;
  return projection;
}

// Knots at the ends, and p in each transition, so that what acts inside acts no farther out.
std::vector<double> FlattenKnots(const SplineBasis& basis,
                                 const ParameterRange& range,
                                 double transition,
                                 bool closed,
                                 const std::string& name) {
  const bool round = closed || basis.periodic();
  CheckRange(basis, range, "Flattened", name);
  const double length = range.to - range.from;
  std::vector<double> wanted = {range.from, range.to};
  const double period = basis.upper() - basis.lower();
  const double room_before = round ? period - length : range.from - basis.lower();
  const double room_behind = round ? period - length : basis.upper() - range.to;
  for (int k = 1; k <= basis.degree(); ++k) {
    const double share = static_cast<double>(k) / basis.degree();
    wanted.push_back(range.from - share * std::min(transition * length, room_before / 2));
    wanted.push_back(range.to + share * std::min(transition * length, room_behind / 2));
  }
  return LackingKnots(basis, std::move(wanted), length, round);
}

std::vector<bool> Acting(const SplineBasis& basis, const std::optional<ParameterRange>& range) {
  if (!range) return std::vector<bool>(static_cast<size_t>(DistinctPoints(basis)), true);
  return ActingInside(basis, *range);
}

}  // namespace

template <int Dim>
NurbsCurve<Dim> Flattened(const NurbsCurve<Dim>& curve,
                          const ParameterRange& range,
                          const FlattenOptions<Dim>& options) {
  const Projection<Dim> projection = ProjectionOf<Dim>(options);
  const bool closed = TiedPoints(curve).closed(Direction::kU);
  const NurbsCurve<Dim> finer =
      RefineKnots(curve, FlattenKnots(curve.basis(), range, options.transition, closed, "u"));
  const TiedPoints ties(finer);
  const std::vector<bool> acting = ActingInside(finer.basis(), range);
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(Dim, std::ssize(acting));
  for (Eigen::Index k = 0; k < moves.cols(); ++k) {
    if (acting[static_cast<size_t>(k)])
      moves.col(ties.First(k)) = projection.Move(finer.control_points().col(k));
  }
  return WithMoves(finer, ties.Spread(std::move(moves)));
}

NurbsSurface Flattened(const NurbsSurface& surface,
                       const ParameterRegion& region,
                       const FlattenOptions<3>& options) {
  const Projection<3> projection = ProjectionOf<3>(options);
  const TiedPoints seams(surface, TiedPoints::Of::kSeams);
  NurbsSurface finer = surface;
  const auto refine = [&](Direction direction, const ParameterRange& range, const char* name) {
    const SplineBasis& basis = direction == Direction::kU ? surface.basis_u() : surface.basis_v();
    finer =
        RefineKnots(finer,
                    direction,
                    FlattenKnots(basis, range, options.transition, seams.closed(direction), name));
  };
  if (region.u) refine(Direction::kU, *region.u, "u");
  if (region.v) refine(Direction::kV, *region.v, "v");
  const TiedPoints ties(finer);
  const std::vector<bool> along_u = Acting(finer.basis_u(), region.u),
                          along_v = Acting(finer.basis_v(), region.v);
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(3, DistinctPoints(finer));
  for (size_t i = 0; i < along_u.size(); ++i) {
    for (size_t j = 0; j < along_v.size(); ++j) {
      if (!along_u[i] || !along_v[j]) continue;
      moves.col(ties.First(static_cast<Eigen::Index>(i * along_v.size() + j))) =
          projection.Move(finer.control_point(static_cast<int>(i), static_cast<int>(j)));
    }
  }
  return WithMoves(finer, ties.Spread(std::move(moves)));
}

template NurbsCurve<2> Flattened(const NurbsCurve<2>&,
                                 const ParameterRange&,
                                 const FlattenOptions<2>&);
template NurbsCurve<3> Flattened(const NurbsCurve<3>&,
                                 const ParameterRange&,
                                 const FlattenOptions<3>&);

}  // namespace batten
