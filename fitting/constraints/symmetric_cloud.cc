// SPDX-License-Identifier: MIT
#include "fitting/constraints/symmetric_cloud.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "fitting/core/rounding.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

constexpr double kMostOff = 0.05;      // of the lengths
constexpr double kMostGap = 1.0 / 3;   // of the reflected length
constexpr double kMostInclined = 0.7;  // sine of the angle of a plane base's normal to the mirror

[[noreturn]] void RefuseLayer() {
  Reject("symmetry",
         "the plane does not cross the sheet: the mirror image lies over it as a second layer");
}

using Pairs = std::vector<std::pair<Eigen::Index, Eigen::Index>>;  // every twin pair, once

Pairs PairsOf(const PointMask& mask, const std::vector<Eigen::Index>& twins) {
  Pairs pairs;
  for (size_t k = 0; k < twins.size(); ++k) {
    const auto a = static_cast<Eigen::Index>(k);
    if (a <= twins[k] && mask[a] && mask[twins[k]]) pairs.emplace_back(a, twins[k]);
  }
  if (pairs.size() < 3) Reject("symmetry", "fewer than three points and their images are left");
  return pairs;
}

// How far from the mirror line the reflected coordinate begins, against its whole length.
void CheckGap(const Eigen::RowVectorXd& reflected, const Pairs& pairs) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const auto& [a, b] : pairs) {
    least = std::min(least, std::abs(reflected[a]));
    most = std::max(most, std::abs(reflected[a]));
  }
  if (least > kMostGap * most)
    Reject("symmetry",
           "the plane does not cross the sheet: the gap between it and its mirror image is " +
               NumberText(2 * least) + " wide");
}

void CheckOff(double sum_of_squares, double count, double length) {
  const double off = std::sqrt(sum_of_squares / count);
  if (!(off <= kMostOff * length))
    Reject("symmetry",
           "the parameters of the points and of their images are not a reflection of one another: "
           "they are off by " +
               NumberText(off) + " of a length of " + NumberText(length));
}

// Coordinates of every point with `value(k)` given, those of pairs made exactly opposite.
template <typename Value>
Eigen::RowVectorXd Opposite(const std::vector<Eigen::Index>& twins, const Value& value) {
  Eigen::RowVectorXd result(static_cast<Eigen::Index>(twins.size()));
  for (size_t k = 0; k < twins.size(); ++k) {
    const auto a = static_cast<Eigen::Index>(k);
    if (a > twins[k]) continue;
    const double half = a == twins[k] ? 0 : (value(a) - value(twins[k])) / 2;
    result[a] = half;
    result[twins[k]] = a == twins[k] ? 0 : -half;
  }
  return result;
}

// The same, made exactly equal.
template <typename Value>
Eigen::RowVectorXd Equal(const std::vector<Eigen::Index>& twins, const Value& value) {
  Eigen::RowVectorXd result(static_cast<Eigen::Index>(twins.size()));
  for (size_t k = 0; k < twins.size(); ++k) {
    const auto a = static_cast<Eigen::Index>(k);
    if (a > twins[k]) continue;
    result[a] = result[twins[k]] = (value(a) + value(twins[k])) / 2;
  }
  return result;
}

// The smallest room beside the points, which a new rectangle keeps.
double MarginOf(const Parameterization& base, const Pairs& pairs) {
  double margin = std::numeric_limits<double>::infinity();
  for (const auto& [a, b] : pairs) {
    for (const Eigen::Index k : {a, b}) {
      const Eigen::Vector2d at = base.parameters.col(k);
      margin = std::min({margin, at[0], at[1], base.length_u - at[0], base.length_v - at[1]});
    }
  }
  return std::max(0.0, margin);
}

// The frame's rectangle about the points: the reflected coordinate (about zero) centred in it.
void Place(Parameterization& base,
           Direction reflected,
           const Eigen::RowVectorXd& opposite,
           const Eigen::RowVectorXd& equal,
           const Pairs& pairs,
           double margin) {
  CheckGap(opposite, pairs);
  double wide = 0, low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& [a, b] : pairs) {
    wide = std::max(wide, std::abs(opposite[a]));
    low = std::min(low, equal[a]);
    high = std::max(high, equal[a]);
  }
  const bool u = reflected == Direction::kU;
  double& length = u ? base.length_u : base.length_v;
  double& other = u ? base.length_v : base.length_u;
  length = 2 * (wide + margin);
  other = high - low + 2 * margin;
  base.parameters.row(u ? 0 : 1) =
      (opposite.array() + length / 2).cwiseMax(0).cwiseMin(length).matrix();
  base.parameters.row(u ? 1 : 0) =
      (equal.array() - low + margin).cwiseMax(0).cwiseMin(other).matrix();
}

// Turns a plane base about so that its normal lies in the mirror plane and u or v across it.
SymmetricBase OverUprightPlane(const Parameterization& base,
                               const PointCloud& cloud,
                               const Pairs& pairs,
                               const MirrorPlane& plane,
                               const std::vector<Eigen::Index>& twins) {
  const Eigen::Vector3d tilted = base.plane->axes.col(2);
  if (std::abs(tilted.dot(plane.normal)) > kMostInclined) RefuseLayer();
  SymmetricBase result{base, Direction::kU};
  PlaneBase& frame = *result.base.plane;
  const Eigen::Vector3d up = (tilted - plane.normal.dot(tilted) * plane.normal).normalized();
  const Eigen::Matrix3d old = base.plane->axes;
  const bool u = std::abs(old.col(0).dot(plane.normal)) >= std::abs(old.col(1).dot(plane.normal));
  const double sign = old.col(u ? 0 : 1).dot(plane.normal) < 0 ? -1 : 1;
  const Eigen::Vector3d across = sign * plane.normal;
  frame.axes.col(0) = u ? across : across.cross(up);
  frame.axes.col(1) = u ? up.cross(across) : across;
  frame.axes.col(2) = up;
  result.reflected = u ? Direction::kU : Direction::kV;
  const Eigen::Vector3d foot =
      base.plane->origin - (plane.normal.dot(base.plane->origin) - plane.offset) * plane.normal;
  const Eigen::Matrix3Xd local = frame.axes.transpose() * (cloud.points().colwise() - foot);
  const auto along = [&](int row) {
    return [&local, row](Eigen::Index k) { return local(row, k); };
  };
  const Eigen::RowVectorXd opposite = Opposite(twins, along(u ? 0 : 1)),
                           equal = Equal(twins, along(u ? 1 : 0));
  Place(result.base, result.reflected, opposite, equal, pairs, MarginOf(base, pairs));
  frame.length_u = result.base.length_u;
  frame.length_v = result.base.length_v;
  // Where (0, 0) is in space: what the parameters of any point say.
  const Eigen::Index any = pairs.front().first;
  frame.origin = foot + frame.axes.leftCols<2>() *
                            (local.col(any).head<2>() - result.base.parameters.col(any));
  return result;
}

// Both directions open: the best reflection of the parameter plane, by the turn that maximises
// Σ w'ᵀ R w about the mean.
SymmetricBase OverOpenDomain(const Parameterization& base,
                             const Pairs& pairs,
                             const std::vector<Eigen::Index>& twins) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& [a, b] : pairs) mean += base.parameters.col(a) + base.parameters.col(b);
  mean /= 2.0 * static_cast<double>(pairs.size());
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  for (const auto& [a, b] : pairs) {
    products += (base.parameters.col(b) - mean) * (base.parameters.col(a) - mean).transpose();
  }
  products = (products + products.transpose()).eval() / 2;  // a pair counts from either side
  const double reflecting = std::hypot(products(0, 0) - products(1, 1), 2 * products(0, 1));
  if (products.trace() >= reflecting) RefuseLayer();
  const double turn = std::atan2(2 * products(0, 1), products(0, 0) - products(1, 1)) / 2;
  // Kept is the direction of `turn`, reflected the one across it.
  Eigen::Vector2d kept(std::cos(turn), std::sin(turn)), across(-kept[1], kept[0]);
  const bool u = std::abs(across[0]) >= std::abs(across[1]);
  // A turn of the frame by no more than an eighth of a full one.
  if (across[u ? 0 : 1] < 0) across = -across;
  if (kept[u ? 1 : 0] < 0) kept = -kept;
  double off = 0;
  for (const auto& [a, b] : pairs) {
    const Eigen::Vector2d difference = base.parameters.col(b) - base.parameters.col(a),
                          sum = base.parameters.col(b) + base.parameters.col(a) - 2 * mean;
    off += std::pow(kept.dot(difference), 2) + std::pow(across.dot(sum), 2);
  }
  CheckOff(off, static_cast<double>(pairs.size()), std::sqrt(base.length_u * base.length_v));
  const auto along = [&](const Eigen::Vector2d& direction) {
    return [&, direction](Eigen::Index k) { return direction.dot(base.parameters.col(k) - mean); };
  };
  SymmetricBase result{base, u ? Direction::kU : Direction::kV};
  Place(result.base,
        result.reflected,
        Opposite(twins, along(across)),
        Equal(twins, along(kept)),
        pairs,
        MarginOf(base, pairs));
  return result;
}

// One direction by itself, a line or a circle.
struct Axis {
  Eigen::RowVectorXd at;
  double length;
  bool around;

  // The difference of two parameters, the short way.
  double Difference(double a, double b) const {
    return around ? std::remainder(a - b, length) : a - b;
  }
};

// What a direction is if it is reflected: about where, and how far off that is; and how far off it
// is if it stays.
struct AxisFit {
  double centre, off_reflected, off_kept;
};

AxisFit FitAxis(const Axis& axis, const Pairs& pairs) {
  const double turn = 2 * std::numbers::pi / axis.length;
  std::complex<double> sums = 0;
  double sum = 0;
  for (const auto& [a, b] : pairs) {
    sums += std::polar(1.0, turn * (axis.at[a] + axis.at[b]));
    sum += axis.at[a] + axis.at[b];
  }
  AxisFit fit{
      axis.around ? std::arg(sums) / turn / 2 : sum / 2 / static_cast<double>(pairs.size()), 0, 0};
  for (const auto& [a, b] : pairs) {
    fit.off_reflected += std::pow(axis.Difference(axis.at[a] + axis.at[b], 2 * fit.centre), 2);
    fit.off_kept += std::pow(axis.Difference(axis.at[a], axis.at[b]), 2);
  }
  return fit;
}

Eigen::RowVectorXd KeptAxis(const Axis& axis, const std::vector<Eigen::Index>& twins) {
  Eigen::RowVectorXd result(axis.at.size());
  for (size_t k = 0; k < twins.size(); ++k) {
    const auto a = static_cast<Eigen::Index>(k);
    if (a > twins[k]) continue;
    double mean = axis.at[a] + axis.Difference(axis.at[twins[k]], axis.at[a]) / 2;
    if (axis.around) mean -= axis.length * std::floor(mean / axis.length);
    result[a] = result[twins[k]] = std::clamp(mean, 0.0, axis.length);
  }
  return result;
}

// On a circle the mirror line becomes zero (and half the length); on a line with poles at its ends,
// the middle.
Eigen::RowVectorXd ReflectedAxis(const Axis& axis,
                                 double centre,
                                 const std::vector<Eigen::Index>& twins) {
  Eigen::RowVectorXd result(axis.at.size());
  for (size_t k = 0; k < twins.size(); ++k) {
    const auto a = static_cast<Eigen::Index>(k);
    if (a > twins[k]) continue;
    const double from = axis.Difference(axis.at[a], centre),
                 to = axis.Difference(axis.at[twins[k]], centre);
    double half = from - axis.Difference(from + to, 0) / 2;
    if (axis.around) {
      half = std::remainder(half, axis.length);
      if (a == twins[k]) half = std::abs(half) < axis.length / 4 ? 0 : axis.length / 2;
      result[a] = half < 0 ? axis.length + half : half;
      result[twins[k]] = half > 0 ? axis.length - half : -half;
      if (a == twins[k]) result[a] = std::abs(half);
    } else {
      half = a == twins[k] ? 0 : std::clamp(half, -axis.length / 2, axis.length / 2);
      result[a] = axis.length / 2 + half;
      result[twins[k]] = axis.length / 2 - half;
    }
  }
  return result;
}

// A direction closes: either u or v is reflected.
SymmetricBase OverClosedDomain(const Parameterization& base,
                               const Pairs& pairs,
                               const std::vector<Eigen::Index>& twins) {
  Axis u{base.parameters.row(0), base.length_u, base.periodic_u},
      v{base.parameters.row(1), base.length_v, base.periodic_v};
  const AxisFit fit_u = FitAxis(u, pairs), fit_v = FitAxis(v, pairs);
  const bool reflect_u =
      fit_u.off_reflected + fit_v.off_kept <= fit_v.off_reflected + fit_u.off_kept;
  const double off =
      reflect_u ? fit_u.off_reflected + fit_v.off_kept : fit_v.off_reflected + fit_u.off_kept;
  if (fit_u.off_kept + fit_v.off_kept < off) RefuseLayer();
  CheckOff(off, static_cast<double>(pairs.size()), std::min(base.length_u, base.length_v));
  SymmetricBase result{base, reflect_u ? Direction::kU : Direction::kV};
  Axis& axis = reflect_u ? u : v;
  const double centre = (reflect_u ? fit_u : fit_v).centre;
  if (!reflect_u && base.poles.start != base.poles.end)
    Reject("symmetry", "the plane exchanges the ends of the surface, of which only one is a pole");
  if (!axis.around && !base.poles.any()) {
    const auto from = [&](Eigen::Index k) { return axis.at[k] - centre; };
    const Eigen::RowVectorXd opposite = Opposite(twins, from);
    CheckGap(opposite, pairs);
    double wide = 0;
    for (const auto& [a, b] : pairs) wide = std::max(wide, std::abs(opposite[a]));
    const double margin =
        std::max(0.0, std::min(axis.at.minCoeff(), axis.length - axis.at.maxCoeff()));
    axis.length = 2 * (wide + margin);
    (reflect_u ? result.base.length_u : result.base.length_v) = axis.length;
    result.base.parameters.row(reflect_u ? 0 : 1) =
        (opposite.array() + axis.length / 2).cwiseMax(0).cwiseMin(axis.length).matrix();
  } else {
    result.base.parameters.row(reflect_u ? 0 : 1) = ReflectedAxis(axis, centre, twins);
  }
  result.base.parameters.row(reflect_u ? 1 : 0) = KeptAxis(reflect_u ? v : u, twins);
  return result;
}

}  // namespace

SymmetricCloud WithMirrorImage(const PointCloud& cloud, const MirrorPlane& plane) {
  const double length = plane.normal.norm();
  if (!(std::abs(length - 1) <= kRelativelyEqual) || !std::isfinite(plane.offset))
    throw std::invalid_argument(
        "WithMirrorImage: the plane's normal must have length one and its offset be finite");
  const MirrorPlane local = MirrorPlane{plane.normal / length, plane.offset}.From(cloud.origin());
  const Eigen::Index count = cloud.size();
  SymmetricCloud result;
  std::vector<Eigen::Index> images;  // of which points the images are, in order
  result.twins.resize(static_cast<size_t>(count));
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Vector3d point = cloud.points().col(k);
    if (local.Mirrored(point) == point) {
      result.twins[static_cast<size_t>(k)] = k;
      continue;
    }
    result.twins[static_cast<size_t>(k)] = count + static_cast<Eigen::Index>(images.size());
    images.push_back(k);
  }
  std::vector<Eigen::Index> all(static_cast<size_t>(count));
  for (Eigen::Index k = 0; k < count; ++k) all[static_cast<size_t>(k)] = k;
  all.insert(all.end(), images.begin(), images.end());
  const PointCloud doubled = cloud.Picked(all);
  Eigen::Matrix3Xd points = doubled.points(), normals = doubled.normals();
  for (Eigen::Index k = count; k < points.cols(); ++k) {
    points.col(k) = local.Mirrored(points.col(k));
    if (normals.cols() > 0) normals.col(k) -= 2 * local.normal.dot(normals.col(k)) * local.normal;
    result.twins.push_back(images[static_cast<size_t>(k - count)]);
  }
  result.cloud = PointCloud(std::move(points), cloud.origin(), cloud.dimension());
  result.cloud.set_normals(std::move(normals));
  result.cloud.set_weights(doubled.weights());
  result.cloud.set_colours(doubled.colours());
  return result;
}

SymmetricBase SymmetricParameters(const Parameterization& base,
                                  const PointCloud& cloud,
                                  const PointMask& mask,
                                  const MirrorPlane& plane,
                                  const std::vector<Eigen::Index>& twins) {
  const auto count = static_cast<Eigen::Index>(twins.size());
  if (base.parameters.cols() != count || mask.size() != count || cloud.size() != count)
    throw std::invalid_argument(
        "SymmetricParameters: parameters, points, mask and twins differ in number");
  const Pairs pairs = PairsOf(mask, twins);
  if (base.plane) return OverUprightPlane(base, cloud, pairs, plane, twins);
  if (base.periodic_u || base.periodic_v || base.poles.any())
    return OverClosedDomain(base, pairs, twins);
  return OverOpenDomain(base, pairs, twins);
}

}  // namespace batten::internal
