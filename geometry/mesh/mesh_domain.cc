// SPDX-License-Identifier: MIT
#include "geometry/mesh/mesh_domain.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "batten/geometry/direction.h"

namespace batten::internal {
namespace {

// The mean length of the control polygons along u and along v.
Eigen::Vector2d MeanLengths(const NurbsSurface& surface) {
  Eigen::Vector2d lengths = Eigen::Vector2d::Zero();
  for (int i = 0; i < surface.size_u(); ++i) {
    for (int j = 0; j < surface.size_v(); ++j) {
      const Eigen::Vector3d here = surface.control_point(i, j);
      if (i > 0) lengths[0] += (here - surface.control_point(i - 1, j)).norm() / surface.size_v();
      if (j > 0) lengths[1] += (here - surface.control_point(i, j - 1)).norm() / surface.size_u();
    }
  }
  return lengths;
}

// The ends of spans, and places between them: more for high degrees, and `least` spans in all.
std::vector<double> Lines(const SplineBasis& basis, int least) {
  const std::vector<int> spans = basis.Spans();
  const int count = static_cast<int>(spans.size());
  const int parts = std::max((basis.degree() + 2) / 3, (least + count - 1) / count);
  std::vector<double> lines;
  for (const int span : spans) {
    const double lower = basis.knots()[span], upper = basis.knots()[span + 1];
    for (int k = 0; k < parts; ++k) lines.push_back(lower + (upper - lower) * k / parts);
  }
  lines.push_back(basis.upper());
  return lines;
}

// Spans shorter than this share of the domain hold no triangle: they count as creases where the
// knots on both their sides are together as many as the degree.
constexpr double kSliverShare = 0x1p-28;

// Knots inside the domain that, with those no farther than a sliver after them, are as many as the
// degree.
std::vector<double> Creases(const SplineBasis& basis) {
  std::vector<double> creases;
  const double sliver = kSliverShare * (basis.upper() - basis.lower());
  int together = 0;
  double first = basis.lower();
  for (int i = basis.degree() + 1; i < basis.size(); ++i) {
    const double knot = basis.knots()[i];
    if (knot - basis.lower() <= sliver || basis.upper() - knot <= sliver) continue;
    if (together == 0 || knot - first > sliver) {
      first = knot;
      together = 0;
    }
    if (++together == basis.degree()) creases.push_back(first);
  }
  return creases;
}

// The lattice lines of increasing values; of values on one line the first stays, or the last of
// all.
template <class Snap>
std::vector<std::int64_t> Snapped(std::vector<double>& values, Snap&& snap) {
  std::vector<std::int64_t> lines;
  std::vector<double> kept;
  for (const double value : values) {
    const std::int64_t line = snap(value);
    if (!lines.empty() && lines.back() == line) {
      if (value == values.back()) kept.back() = value;
      continue;
    }
    lines.push_back(line);
    kept.push_back(value);
  }
  values = std::move(kept);
  return lines;
}

}  // namespace

MeshDomain::MeshDomain(const NurbsSurface& surface)
    : lower_(surface.basis_u().lower(), surface.basis_v().lower()),
      upper_(surface.basis_u().upper(), surface.basis_v().upper()),
      closed_u_(Closed(surface, Direction::kU)),
      closed_v_(Closed(surface, Direction::kV)),
      poles_(CollapsedEdges(surface)) {
  constexpr double kLeastShare = 1.0 / 256;
  const Eigen::Vector2d lengths = MeanLengths(surface);
  const double longest = lengths.maxCoeff();
  const auto steps = [&](double length) {
    const double share = longest > 0 ? std::max(length / longest, kLeastShare) : 1.0;
    return static_cast<std::int64_t>(share * static_cast<double>(ConstrainedDelaunay::kReach));
  };
  width_ = steps(lengths[0]);
  height_ = steps(lengths[1]);
  constexpr int kRound = 4, kAny = 1;
  const bool poles_u = poles_.u_lower && poles_.u_upper, poles_v = poles_.v_lower && poles_.v_upper;
  const auto snap_u = [&](double u) { return Snap({u, lower_[1]}).x; };
  const auto snap_v = [&](double v) { return Snap({lower_[0], v}).y; };
  values_u_ = Lines(surface.basis_u(), closed_u_ || poles_u ? kRound : kAny);
  values_v_ = Lines(surface.basis_v(), closed_v_ || poles_v ? kRound : kAny);
  lines_u_ = Snapped(values_u_, snap_u);
  lines_v_ = Snapped(values_v_, snap_v);
  std::vector<double> creases_u = Creases(surface.basis_u()),
                      creases_v = Creases(surface.basis_v());
  creases_u_ = Snapped(creases_u, snap_u);
  creases_v_ = Snapped(creases_v, snap_v);
}

LatticePoint MeshDomain::Snap(const Eigen::Vector2d& parameter) const {
  const Eigen::Array2d share =
      ((parameter - lower_).array() / (upper_ - lower_).array()).max(0.0).min(1.0);
  return {std::llround(share[0] * static_cast<double>(width_)),
          std::llround(share[1] * static_cast<double>(height_))};
}

LatticePoint MeshDomain::OntoBorder(LatticePoint point, std::int64_t within) const {
  if (point.x <= within) point.x = 0;
  if (point.y <= within) point.y = 0;
  if (point.x >= width_ - within) point.x = width_;
  if (point.y >= height_ - within) point.y = height_;
  return point;
}

Eigen::Vector2d MeshDomain::ParameterOf(const LatticePoint& point) const {
  const auto mixed = [](double lower,
                        double upper,
                        std::int64_t step,
                        std::int64_t steps,
                        const std::vector<std::int64_t>& lines,
                        const std::vector<double>& values) {
    const auto line = std::lower_bound(lines.begin(), lines.end(), step);
    if (line != lines.end() && *line == step) return values[line - lines.begin()];
    const double share = static_cast<double>(step) / static_cast<double>(steps);
    return std::min(lower + (upper - lower) * share, upper);
  };
  return {mixed(lower_[0], upper_[0], point.x, width_, lines_u_, values_u_),
          mixed(lower_[1], upper_[1], point.y, height_, lines_v_, values_v_)};
}

bool MeshDomain::OnBorder(const LatticePoint& point) const {
  return point.x == 0 || point.x == width_ || point.y == 0 || point.y == height_;
}

std::vector<LatticePoint> MeshDomain::Mirrored(const LatticePoint& point) const {
  std::vector<LatticePoint> same;
  const bool seam_u = closed_u_ && (point.x == 0 || point.x == width_);
  const bool seam_v = closed_v_ && (point.y == 0 || point.y == height_);
  if (seam_u) same.push_back({width_ - point.x, point.y});
  if (seam_v) same.push_back({point.x, height_ - point.y});
  if (seam_u && seam_v) same.push_back({width_ - point.x, height_ - point.y});
  return same;
}

LatticePoint MeshDomain::Canonical(LatticePoint point) const {
  if (closed_u_ && point.x == width_) point.x = 0;
  if (closed_v_ && point.y == height_) point.y = 0;
  if ((poles_.u_lower && point.x == 0) || (poles_.u_upper && point.x == width_)) point.y = 0;
  if ((poles_.v_lower && point.y == 0) || (poles_.v_upper && point.y == height_)) point.x = 0;
  return point;
}

}  // namespace batten::internal
