// SPDX-License-Identifier: MIT
#include "io/cloud/local_projection.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "batten/io/read_error.h"

namespace batten::internal {
namespace {

constexpr double kRightAngle = 90, kFullCircle = 360;  // degrees

// Metres that a degree of longitude and of latitude is long at a latitude, on the ellipsoid WGS 84
// [NIMA TR8350.2, 3rd ed., table 3.1]: the radii of curvature across and along the meridian
// [Snyder 1987, Map Projections, USGS PP 1395, eq. 4-20, 4-18].
Eigen::Vector2d MetresInDegree(double latitude) {
  constexpr double kSemiMajor = 6378137, kFlattening = 1 / 298.257223563;
  constexpr double kSquare = kFlattening * (2 - kFlattening);  // of the eccentricity
  constexpr double kRadian = std::numbers::pi / 180;
  const double sine = std::sin(latitude * kRadian);
  const double w = 1 - kSquare * sine * sine;
  return kRadian * kSemiMajor / std::sqrt(w) *
         Eigen::Vector2d(std::cos(latitude * kRadian), (1 - kSquare) / w);
}

template <class Change>
void ForEachPiece(std::vector<FileCloud>& parts, const Change& change) {
  for (std::size_t k = 0; k < parts.size(); ++k) {
    for (CloudChunk& chunk : parts[k].chunks) change(k, chunk.points.leftCols(chunk.size));
  }
}

// Whether x and y may be degrees beside a z in metres. A degree is 111 km: z reaches a thousand
// times as far as x and y where the ground rises by 9 m in a kilometre, and never, on this earth,
// where they reach beyond 9 degrees. A range about zero of both is that of a rod.
bool LooksLikeDegrees(const Eigen::AlignedBox3d& box) {
  constexpr double kTimes = 1000;
  const Eigen::Vector3d low = box.min(), high = box.max(), size = high - low;
  const auto holds_zero = [&](int d) { return low[d] <= 0 && high[d] >= 0; };
  return low[0] >= -kFullCircle / 2 && high[0] <= kFullCircle / 2 && low[1] >= -kRightAngle &&
         high[1] <= kRightAngle && size[0] > 0 && size[1] > 0 &&
         size[2] >= kTimes * std::max(size[0], size[1]) && !(holds_zero(0) && holds_zero(1));
}

bool AsksForProjection(CloudProjection projection,
                       const std::vector<std::string>& paths,
                       const std::vector<FileCloud>& parts) {
  if (projection != CloudProjection::kByNames) return projection == CloudProjection::kLocal;
  for (std::size_t k = 1; k < parts.size(); ++k) {
    if (parts[k].degrees == parts[0].degrees) continue;
    throw ReadError(paths[k],
                    fmt::format("names {}, {} does not: say --projection local where all hold "
                                "degrees, none where none does",
                                parts[k].degrees ? "longitude and latitude" : "x and y",
                                paths[0]));
  }
  return parts[0].degrees;
}

}  // namespace

std::optional<std::string> ProjectLocally(CloudProjection projection,
                                          const std::vector<std::string>& paths,
                                          std::vector<FileCloud>& parts) {
  const bool asked = AsksForProjection(projection, paths, parts);
  if (projection == CloudProjection::kNone) return std::nullopt;
  Eigen::AlignedBox3d box;
  double start = std::nan("");  // the first longitude: others are within half a circle of it
  ForEachPiece(parts, [&](std::size_t k, auto points) {
    if (points.cols() == 0) return;
    if (asked) {
      if (std::isnan(start)) start = points(0, 0);
      for (double& x : points.row(0)) x = start + std::remainder(x - start, kFullCircle);
      Eigen::Index worst = 0;
      const double latitude = points.row(1).cwiseAbs().maxCoeff(&worst);
      if (latitude > kRightAngle)
        throw ReadError(paths[k],
                        fmt::format("the latitude {} is beyond 90 degrees; say which columns are x "
                                    "and y with --columns, or --projection none",
                                    points(1, worst)));
    }
    box.extend(points.rowwise().minCoeff().eval());
    box.extend(points.rowwise().maxCoeff().eval());
  });
  if (box.isEmpty()) return std::nullopt;
  if (!asked) {
    if (!LooksLikeDegrees(box)) return std::nullopt;
    return "x and y look like longitude and latitude in degrees beside a z in metres: "
           "--projection local turns them into metres, none leaves them without this word";
  }
  const Eigen::Vector2d middle = box.center().head<2>();
  const Eigen::Vector2d metres = MetresInDegree(middle[1]);
  ForEachPiece(parts, [&](std::size_t, auto points) {
    points.template topRows<2>() =
        metres.asDiagonal() * (points.template topRows<2>().colwise() - middle);
  });
  double off = 0;  // how much longer or shorter a degree is at the ends
  for (const double end : {box.min()[1], box.max()[1]})
    off = std::max(off, (MetresInDegree(end).array() / metres.array() - 1).abs().maxCoeff());
  return fmt::format(
      "longitude and latitude in degrees are now metres east and north of {:.9f}, {:.9f}, with "
      "lengths true to {:.1g} %; --projection none leaves them",
      middle[0],
      middle[1],
      100 * off);
}

}  // namespace batten::internal
