// SPDX-License-Identifier: MIT
#include "cli/arguments/edit_shapes.h"

#include <fmt/format.h>

#include <utility>
#include <variant>
#include <vector>

#include "batten/geometry/bend.h"
#include "batten/geometry/flatten.h"
#include "batten/geometry/meet_targets.h"
#include "batten/geometry/modify_shape.h"
#include "batten/geometry/warp.h"

namespace batten::internal {
namespace {

// f(curve) or f(surface).
template <typename Curve, typename Surface>
EditOutcome ByKind(const Geometry& shape, const Curve& of_curve, const Surface& of_surface) {
  if (const auto* surface = std::get_if<NurbsSurface>(&shape)) return One(of_surface(*surface));
  if (const auto* plane = std::get_if<NurbsCurve<2>>(&shape)) return One(of_curve(*plane));
  return One(of_curve(std::get<NurbsCurve<3>>(shape)));
}

std::vector<int> Wholes(const EditOperation& op, const std::string& key) {
  if (!op.Has(key)) return {};
  return {op.Numbers(key).begin(), op.Numbers(key).end()};
}

// How many parameters a key names, each of them `each` numbers.
size_t Count(const EditOperation& op, const std::string& key, size_t each) {
  const size_t numbers = op.Has(key) ? op.Numbers(key).size() : 0;
  if (numbers % each != 0) {
    op.Refuse(fmt::format("{} holds {} numbers; on a surface they are pairs", key, numbers));
  }
  return numbers / each;
}

std::vector<int> Orders(const EditOperation& op, size_t count, size_t each) {
  std::vector<int> orders = Wholes(op, "order");
  if (orders.empty()) orders.resize(count * each, 0);
  if (orders.size() != count * each) {
    op.Refuse(fmt::format("order holds {} numbers; {} are needed, one for each of `at`",
                          orders.size(),
                          count * each));
  }
  return orders;
}

template <int Dim>
NurbsCurve<Dim> Moved(const EditOperation& op, const NurbsCurve<Dim>& curve) {
  const std::vector<double>& at = op.Numbers("at");
  const auto to = PointsOf<Dim>(op, "to", at.size());
  const std::vector<int> orders = Orders(op, at.size(), 1), fixed = Wholes(op, "fix");
  std::vector<CurveTarget<Dim>> targets;
  for (size_t k = 0; k < at.size(); ++k)
    targets.push_back({at[k], to.col(static_cast<Eigen::Index>(k)), orders[k]});
  for (size_t k = 0; k < Count(op, "keep", 1); ++k) {
    const double u = op.Numbers("keep")[k];
    targets.push_back({u, curve.At(u)});
  }
  return WithTargets<Dim>(curve, targets, fixed);
}

NurbsSurface Moved(const EditOperation& op, const NurbsSurface& surface) {
  const std::vector<double>& at = op.Numbers("at");
  const size_t count = Count(op, "at", 2);
  const Eigen::Matrix3Xd to = PointsOf<3>(op, "to", count);
  const std::vector<int> orders = Orders(op, count, 2), fixed = Wholes(op, "fix");
  std::vector<SurfaceTarget> targets;
  for (size_t k = 0; k < count; ++k) {
    targets.push_back({at[2 * k],
                       at[2 * k + 1],
                       to.col(static_cast<Eigen::Index>(k)),
                       orders[2 * k],
                       orders[2 * k + 1]});
  }
  for (size_t k = 0; k < Count(op, "keep", 2); ++k) {
    const double u = op.Numbers("keep")[2 * k], v = op.Numbers("keep")[2 * k + 1];
    targets.push_back({u, v, surface.At(u, v)});
  }
  std::vector<NetPlace> places;
  for (size_t k = 0; k < Count(op, "fix", 2); ++k)
    places.push_back({fixed[2 * k], fixed[2 * k + 1]});
  return WithTargets(surface, targets, places);
}

ParameterRange RangeOf(const EditOperation& op) {
  if (op.direction) op.Refuse("a curve has one direction; leave dir out");
  const std::vector<double>& ends = op.Numbers("region");
  if (ends.size() != 2) op.Refuse("region takes two numbers on a curve");
  return {ends[0], ends[1]};
}

// a;b;c;d, or a;b of one direction.
ParameterRegion RegionOf(const EditOperation& op) {
  const std::vector<double>& ends = op.Numbers("region");
  if (ends.size() != (op.direction ? 2U : 4U)) {
    op.Refuse("region takes four numbers on a surface, of u and of v, or two with dir=u or dir=v");
  }
  const ParameterRange first{ends[0], ends[1]};
  if (op.direction == Direction::kU) return {first, std::nullopt};
  if (op.direction == Direction::kV) return {std::nullopt, first};
  return {first, ParameterRange{ends[2], ends[3]}};
}

WarpOptions WarpOf(const EditOperation& op) {
  const std::string& word = op.Word("shape");
  return {.shape = word == "tent"      ? WarpShape::kTent
                   : word == "plateau" ? WarpShape::kPlateau
                                       : WarpShape::kBump,
          .spans = op.Whole("spans")};
}

template <int Dim>
FlattenOptions<Dim> FlattenOf(const EditOperation& op) {
  const std::vector<double>& plane = op.Numbers("plane");
  if (Dim == 2 && plane[2] != 0) op.Refuse("a plane curve needs a plane along z: c is 0");
  FlattenOptions<Dim> options;
  options.normal = Eigen::Map<const Eigen::Matrix<double, Dim, 1>>(plane.data());
  options.offset = -plane[3];
  if (op.Has("along")) options.along = PointOf<Dim>(op, "along");
  options.transition = op.Number("transition");
  return options;
}

template <int Dim>
CircleBend BendOf(const EditOperation& op) {
  CircleBend bend;
  bend.from.setZero();
  bend.from.head<Dim>() = PointOf<Dim>(op, "from");
  bend.center.setZero();
  bend.center.head<Dim>() = PointOf<Dim>(op, "center");
  if (op.Has("axis")) bend.axis = PointOf<3>(op, "axis");
  bend.length = op.Number("length");
  return bend;
}

template <int Dim, typename Shape>
EditOutcome Bent(const EditOperation& op, const Shape& shape) {
  constexpr double kOfTheSize = 1e-6;
  const auto& points = shape.control_points();
  const double tolerance =
      op.Has("tolerance")
          ? op.Number("tolerance")
          : kOfTheSize * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  auto [bent, error] = batten::Bent(shape, BendOf<Dim>(op), tolerance);
  std::string shortfall;
  if (error > tolerance) {
    shortfall = fmt::format("{}: bent to within {:.3g}, not {:.3g}", op.typed, error, tolerance);
  }
  return {{std::move(bent)}, std::move(shortfall)};
}

}  // namespace

EditOutcome SetWeight(const EditOperation& op, const Geometry& shape) {
  const std::vector<int> index = Wholes(op, "index");
  return ByKind(
      shape,
      [&](const auto& curve) {
        RequireCount(op, "index", 1);
        return WithWeight(curve, index[0], op.Number("value"));
      },
      [&](const NurbsSurface& surface) {
        RequireCount(op, "index", 2);
        return WithWeight(surface, index[0], index[1], op.Number("value"));
      });
}

EditOutcome PullPoint(const EditOperation& op, const Geometry& shape) {
  const std::vector<int> index = Wholes(op, "index");
  const std::vector<double>& at = op.Numbers("at");
  return ByKind(
      shape,
      [&](const auto& curve) {
        RequireCount(op, "at", 1);
        return Pulled(curve, at[0], index, op.Number("by"));
      },
      [&](const NurbsSurface& surface) {
        RequireCount(op, "at", 2);
        RequireCount(op, "index", 2);
        return Pulled(surface, at[0], at[1], index[0], index[1], op.Number("by"));
      });
}

EditOutcome MovePoint(const EditOperation& op, const Geometry& shape) {
  const std::vector<double>& at = op.Numbers("at");
  return ByKind(
      shape,
      [&]<int Dim>(const NurbsCurve<Dim>& curve) {
        RequireCount(op, "at", 1);
        return MovedPoint(curve, at[0], PointOf<Dim>(op, "to"));
      },
      [&](const NurbsSurface& surface) {
        RequireCount(op, "at", 2);
        return MovedPoint(surface, at[0], at[1], PointOf<3>(op, "to"));
      });
}

EditOutcome MoveTargets(const EditOperation& op, const Geometry& shape) {
  const auto moved = [&](const auto& one) { return Moved(op, one); };
  return ByKind(shape, moved, moved);
}

EditOutcome WarpRegion(const EditOperation& op, const Geometry& shape) {
  return ByKind(
      shape,
      [&]<int Dim>(const NurbsCurve<Dim>& curve) {
        return Warped<Dim>(curve, RangeOf(op), PointOf<Dim>(op, "by"), WarpOf(op));
      },
      [&](const NurbsSurface& surface) {
        return Warped(surface, RegionOf(op), PointOf<3>(op, "by"), WarpOf(op));
      });
}

EditOutcome FlattenRegion(const EditOperation& op, const Geometry& shape) {
  return ByKind(
      shape,
      [&]<int Dim>(const NurbsCurve<Dim>& curve) {
        return Flattened<Dim>(curve, RangeOf(op), FlattenOf<Dim>(op));
      },
      [&](const NurbsSurface& surface) {
        return Flattened(surface, RegionOf(op), FlattenOf<3>(op));
      });
}

EditOutcome BendShape(const EditOperation& op, const Geometry& shape) {
  if (const auto* plane = std::get_if<NurbsCurve<2>>(&shape)) return Bent<2>(op, *plane);
  if (const auto* curve = std::get_if<NurbsCurve<3>>(&shape)) return Bent<3>(op, *curve);
  return Bent<3>(op, std::get<NurbsSurface>(shape));
}

}  // namespace batten::internal
