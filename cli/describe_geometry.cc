// SPDX-License-Identifier: MIT
#include "batten/cli/describe_geometry.h"

#include <algorithm>
#include <array>

#include "batten/geometry/curvature.h"

namespace batten {
namespace {

constexpr double kMeets = 1e-9;

// Nodes and weights on [0, 1]. [Abramowitz & Stegun 1964, table 25.4]
constexpr std::array<std::array<double, 2>, 4> kGauss{{{0.06943184420297371, 0.17392742256872693},
                                                       {0.33000947820757187, 0.32607257743127307},
                                                       {0.66999052179242813, 0.32607257743127307},
                                                       {0.93056815579702629, 0.17392742256872693}}};

// The knot spans, cut further where there are few.
std::vector<double> Cells(const SplineBasis& basis) {
  constexpr int kFewest = 16;
  const std::vector<int> spans = basis.Spans();
  const int parts = std::max(1, kFewest / static_cast<int>(spans.size()));
  std::vector<double> cells;
  for (const int span : spans) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    for (int k = 0; k < parts; ++k) cells.push_back(a + (b - a) * k / parts);
  }
  cells.push_back(basis.upper());
  return cells;
}

struct Node {
  double at, weight;
};

// Gauss points of every cell, and the cells' ends with weight zero.
std::vector<Node> Nodes(const SplineBasis& basis) {
  const std::vector<double> cells = Cells(basis);
  std::vector<Node> nodes;
  for (size_t k = 0; k + 1 < cells.size(); ++k) {
    const double width = cells[k + 1] - cells[k];
    nodes.push_back({cells[k], 0});
    for (const auto& [at, weight] : kGauss)
      nodes.push_back({cells[k] + width * at, width * weight});
  }
  nodes.push_back({cells.back(), 0});
  return nodes;
}

// The shape at parameters as a point of space.
template <int Dim>
Eigen::Vector3d PointAt(const NurbsCurve<Dim>& curve, const Eigen::Vector2d& at) {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  point.head<Dim>() = curve.At(curve.basis().Clamp(at[0]));
  return point;
}
Eigen::Vector3d PointAt(const NurbsSurface& surface, const Eigen::Vector2d& at) {
  return surface.At(surface.basis_u().Clamp(at[0]), surface.basis_v().Clamp(at[1]));
}

// The sample that is farthest along each of the six directions, moved farther as long as it goes.
class BoxFinder {
 public:
  void See(const Eigen::Vector3d& point, const Eigen::Vector2d& at) {
    for (int side = 0; side < 6; ++side) {
      const double value = Value(point, side);
      if (value <= far_[side]) continue;
      far_[side] = value;
      at_[side] = at;
    }
  }

  template <typename Shape>
  Eigen::AlignedBox3d Refined(const Shape& shape, const Eigen::Vector2d& step) {
    for (int side = 0; side < 6; ++side) {
      for (double scale = 1; scale > 1e-9;) {
        if (!Advance(shape, side, scale * step)) scale /= 2;
      }
    }
    return {Eigen::Vector3d(-far_[3], -far_[4], -far_[5]),
            Eigen::Vector3d(far_[0], far_[1], far_[2])};
  }

 private:
  static double Value(const Eigen::Vector3d& point, int side) {
    return side < 3 ? point[side] : -point[side - 3];
  }

  template <typename Shape>
  bool Advance(const Shape& shape, int side, const Eigen::Vector2d& step) {
    for (const auto& [du, dv] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const Eigen::Vector2d at = at_[side] + Eigen::Vector2d(du * step[0], dv * step[1]);
      const double value = Value(PointAt(shape, at), side);
      if (value <= far_[side]) continue;
      far_[side] = value;
      at_[side] = at;
      return true;
    }
    return false;
  }

  std::array<double, 6> far_{-1e300, -1e300, -1e300, -1e300, -1e300, -1e300};
  std::array<Eigen::Vector2d, 6> at_;
};

template <typename Points>
double Extent(const Points& points) {
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

double CellWidth(const SplineBasis& basis) {
  return (basis.upper() - basis.lower()) / static_cast<double>(Cells(basis).size() - 1);
}

}  // namespace

template <int Dim>
std::vector<bool> ClosedDirections(const NurbsCurve<Dim>& curve) {
  const double gap = (curve.At(curve.basis().lower()) - curve.At(curve.basis().upper())).norm();
  return {gap <= kMeets * Extent(curve.control_points())};
}

std::vector<bool> ClosedDirections(const NurbsSurface& surface) {
  const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
  double gap_u = 0, gap_v = 0;
  for (const double v : Cells(bv)) {
    gap_u = std::max(gap_u, (surface.At(bu.lower(), v) - surface.At(bu.upper(), v)).norm());
  }
  for (const double u : Cells(bu)) {
    gap_v = std::max(gap_v, (surface.At(u, bv.lower()) - surface.At(u, bv.upper())).norm());
  }
  const double meets = kMeets * Extent(surface.control_points());
  return {gap_u <= meets, gap_v <= meets};
}

template <int Dim>
ShapeMeasures Measure(const NurbsCurve<Dim>& curve) {
  ShapeMeasures measures;
  BoxFinder box;
  for (const auto& [u, weight] : Nodes(curve.basis())) {
    Eigen::Matrix<double, 3, 4> space = Eigen::Matrix<double, 3, 4>::Zero();
    space.topRows<Dim>() = curve.Derivatives(u, 3);
    box.See(space.col(0), {u, 0});
    measures.size += weight * space.col(1).norm();
    if (const auto c = CurvatureOf(Eigen::Vector3d(space.col(1)), space.col(2), space.col(3))) {
      measures.curvature_min = std::min(measures.curvature_min, c->curvature);
      measures.curvature_max = std::max(measures.curvature_max, c->curvature);
    }
  }
  measures.box = box.Refined(curve, {CellWidth(curve.basis()), 0});
  return measures;
}

ShapeMeasures Measure(const NurbsSurface& surface) {
  ShapeMeasures measures;
  BoxFinder box;
  const std::vector<Node> in_v = Nodes(surface.basis_v());
  for (const auto& [u, weight_u] : Nodes(surface.basis_u())) {
    for (const auto& [v, weight_v] : in_v) {
      const SurfaceJet jet = surface.JetAt(u, v);
      box.See(jet.point, {u, v});
      measures.size += weight_u * weight_v * jet.du.cross(jet.dv).norm();
      if (const auto c = CurvatureOf(jet)) {
        measures.curvature_min = std::min(measures.curvature_min, c->principal_low);
        measures.curvature_max = std::max(measures.curvature_max, c->principal_high);
      }
    }
  }
  measures.box = box.Refined(surface, {CellWidth(surface.basis_u()), CellWidth(surface.basis_v())});
  return measures;
}

template std::vector<bool> ClosedDirections(const NurbsCurve<2>&);
template std::vector<bool> ClosedDirections(const NurbsCurve<3>&);
template ShapeMeasures Measure(const NurbsCurve<2>&);
template ShapeMeasures Measure(const NurbsCurve<3>&);

}  // namespace batten
