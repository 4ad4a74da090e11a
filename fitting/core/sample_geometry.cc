// SPDX-License-Identifier: MIT
#include "batten/fitting/sample_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/trim_region.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten {
namespace {

constexpr int kStrips = 8;  // a knot span is cut into this many for the distribution of area

void Check(const SampleOptions& options) {
  if (options.count < 1) throw std::invalid_argument("SampleOptions: count must be at least 1");
  if (!(options.noise >= 0) || !std::isfinite(options.noise)) {
    throw std::invalid_argument("SampleOptions: noise must not be negative");
  }
  if (!(options.outliers >= 0 && options.outliers <= 1)) {
    throw std::invalid_argument("SampleOptions: outliers is a fraction from 0 to 1");
  }
}

// Uniform and normal numbers from the bits of a Mersenne twister; the library's own distributions
// differ between implementations.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  // [Box & Muller 1958]
  double Normal() {
    const double radius = std::sqrt(-2 * std::log(1 - Uniform()));
    return radius * std::cos(2 * std::numbers::pi * Uniform());
  }

 private:
  std::mt19937_64 engine_;
};

// Strips of a trimmed surface's axis within the loops' range, cut finer.
std::vector<double> Strips(const SplineBasis& basis,
                           const std::vector<NurbsCurve<2>>& loops,
                           int axis) {
  constexpr int kParts = 32;
  Eigen::AlignedBox2d reach;
  for (const NurbsCurve<2>& loop : loops) reach.extend(BoundingBox(loop));
  const double low = std::max(reach.min()[axis], basis.lower());
  const double high = std::min(reach.max()[axis], basis.upper());
  std::vector<double> strips = internal::BreaksIn(basis, kStrips);
  for (int k = 0; k <= kParts; ++k) strips.push_back(low + (high - low) * k / kParts);
  std::erase_if(strips, [&](double u) { return u < low || u > high; });
  std::sort(strips.begin(), strips.end());
  strips.erase(std::unique(strips.begin(), strips.end()), strips.end());
  return strips;
}

// The index in which a running sum passes a fraction of the whole.
size_t Pick(const std::vector<double>& running, double fraction) {
  const auto found = std::upper_bound(running.begin(), running.end(), fraction * running.back());
  return std::min(static_cast<size_t>(found - running.begin()), running.size() - 1);
}

// Noise on every point, then outliers at random places in the box of the shape.
PointCloud Disturb(Eigen::Matrix3Xd points,
                   const SampleOptions& options,
                   Random& random,
                   int dimension) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index k = 0; k < points.cols(); ++k) box.extend(Eigen::Vector3d(points.col(k)));
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    for (int d = 0; d < dimension && options.noise > 0; ++d)
      points(d, k) += options.noise * random.Normal();
    if (options.outliers > 0 && random.Uniform() < options.outliers) {
      for (int d = 0; d < dimension; ++d) {
        points(d, k) = box.min()[d] + (box.max()[d] - box.min()[d]) * random.Uniform();
      }
    }
  }
  return PointCloud::FromWorld(std::move(points), dimension);
}

template <int Dim>
PointCloud SampleCurve(const NurbsCurve<Dim>& curve, const SampleOptions& options) {
  Check(options);
  Random random(options.seed);
  const std::vector<double> strips = internal::BreaksIn(curve.basis(), kStrips);
  std::vector<double> running;
  double length = 0;
  for (size_t k = 0; k + 1 < strips.size(); ++k) {
    length += (curve.At(strips[k + 1]) - curve.At(strips[k])).norm();
    running.push_back(length);
  }
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, options.count);
  for (Eigen::Index k = 0; k < options.count; ++k) {
    const size_t strip = Pick(running, random.Uniform());
    const double u = strips[strip] + (strips[strip + 1] - strips[strip]) * random.Uniform();
    points.col(k).head<Dim>() = curve.At(u);
  }
  return Disturb(std::move(points), options, random, Dim);
}

}  // namespace

PointCloud SampleGeometry(const NurbsSurface& surface, const SampleOptions& options) {
  Check(options);
  Random random(options.seed);
  const TrimRegion region(surface);
  std::vector<double> in_u, in_v;
  if (surface.trimmed()) {
    in_u = Strips(surface.basis_u(), surface.trims(), 0);
    in_v = Strips(surface.basis_v(), surface.trims(), 1);
  } else {
    in_u = internal::BreaksIn(surface.basis_u(), kStrips);
    in_v = internal::BreaksIn(surface.basis_v(), kStrips);
  }
  const size_t columns = in_v.size() - 1;
  std::vector<double> running;
  double area = 0;
  for (size_t i = 0; i + 1 < in_u.size(); ++i) {
    for (size_t j = 0; j < columns; ++j) {
      const double du = in_u[i + 1] - in_u[i], dv = in_v[j + 1] - in_v[j];
      if (region.CoverOf({in_u[i], in_u[i + 1], in_v[j], in_v[j + 1]}) ==
          TrimRegion::Cover::kOutside) {
        running.push_back(area);
        continue;
      }
      const SurfaceJet jet = surface.JetAt(in_u[i] + du / 2, in_v[j] + dv / 2);
      area += jet.du.cross(jet.dv).norm() * du * dv;
      running.push_back(area);
    }
  }
  Eigen::Matrix3Xd points(3, options.count);
  constexpr Eigen::Index kMostTries = 1000;  // for a point, on average
  Eigen::Index tries = 0;
  for (Eigen::Index k = 0; k < options.count;) {
    if (++tries > kMostTries * options.count) {
      throw std::invalid_argument("SampleGeometry: the trims of the surface leave no area");
    }
    const size_t cell = Pick(running, random.Uniform());
    const size_t i = cell / columns, j = cell % columns;
    const double u = in_u[i] + (in_u[i + 1] - in_u[i]) * random.Uniform();
    const double v = in_v[j] + (in_v[j + 1] - in_v[j]) * random.Uniform();
    if (region.Contains(u, v)) points.col(k++) = surface.At(u, v);
  }
  return Disturb(std::move(points), options, random, 3);
}

PointCloud SampleGeometry(const NurbsCurve<2>& curve, const SampleOptions& options) {
  return SampleCurve(curve, options);
}

PointCloud SampleGeometry(const NurbsCurve<3>& curve, const SampleOptions& options) {
  return SampleCurve(curve, options);
}

}  // namespace batten
