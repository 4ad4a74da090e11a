// SPDX-License-Identifier: MIT
#include "io/cloud/local_projection.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <system_error>

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

// x, less whole circles, from `start` on and less than one beyond it; one within is not changed.
double From(double start, double x) {
  return x - kFullCircle * std::floor((x - start) / kFullCircle);
}

// Where the circle of longitudes can be cut: the upper end of the widest range without any.
// Whatever the order of the points, it is the same.
double CutOfLongitudes(std::vector<FileCloud>& parts) {
  double start = std::nan(""), low = 0, high = 0;
  ForEachPiece(parts, [&](std::size_t, auto points) {
    for (const double x : points.row(0)) {
      if (std::isnan(start)) start = low = high = From(-kFullCircle / 2, x);
      const double near = From(start - kFullCircle / 2, x);
      low = std::min(low, near);
      high = std::max(high, near);
    }
  });
  if (high - low < kFullCircle / 2) return From(-kFullCircle / 2, low);  // no wider range is left
  std::vector<double> all;
  ForEachPiece(parts, [&](std::size_t, auto points) {
    for (const double x : points.row(0)) all.push_back(From(-kFullCircle / 2, x));
  });
  std::sort(all.begin(), all.end());
  double cut = all.front(), widest = all.front() + kFullCircle - all.back();
  for (std::size_t k = 1; k < all.size(); ++k) {
    if (all[k] - all[k - 1] <= widest) continue;
    widest = all[k] - all[k - 1];
    cut = all[k];
  }
  return cut;
}

void RequireLatitudes(const std::vector<std::string>& paths, std::vector<FileCloud>& parts) {
  ForEachPiece(parts, [&](std::size_t k, auto points) {
    if (points.cols() == 0) return;
    Eigen::Index worst = 0;
    if (points.row(1).cwiseAbs().maxCoeff(&worst) <= kRightAngle) return;
    throw ReadError(paths[k],
                    fmt::format("the latitude {} is beyond 90 degrees; say which columns are x "
                                "and y with --columns, or --projection none",
                                points(1, worst)));
  });
}

// Of points whose longitudes are taken from `start` on.
Eigen::AlignedBox3d BoxFrom(double start, std::vector<FileCloud>& parts) {
  Eigen::AlignedBox3d box;
  ForEachPiece(parts, [&](std::size_t, auto points) {
    for (const auto& p : points.colwise())
      box.extend(Eigen::Vector3d(From(start, p[0]), p[1], p[2]));
  });
  return box;
}

Eigen::AlignedBox3d BoxOf(std::vector<FileCloud>& parts) {
  Eigen::AlignedBox3d box;
  ForEachPiece(parts, [&](std::size_t, auto points) {
    if (points.cols() == 0) return;
    box.extend(points.rowwise().minCoeff().eval());
    box.extend(points.rowwise().maxCoeff().eval());
  });
  return box;
}

// By what share lengths within the box are off where a degree is as long everywhere as in the
// middle: a degree at the ends, and an arc of the parallel L as against the shortest way between
// its ends, which is shorter by (L sin φ)² / 24.
double ShareOff(const Eigen::AlignedBox3d& box, const Eigen::Vector2d& metres) {
  constexpr double kRadian = std::numbers::pi / 180;
  double off = 0;
  for (const double end : {box.min()[1], box.max()[1]}) {
    const Eigen::Array2d there = MetresInDegree(end).array() / metres.array();
    off = std::max({off, (there - 1).abs().maxCoeff(), (1 / there - 1).abs().maxCoeff()});
    const double turn = kRadian * box.sizes()[0] * std::sin(end * kRadian);
    off = std::max(off, turn * turn / 24);
  }
  return off;
}

// To 1e-5 degrees, about a metre, so that it is what can be typed; longitudes from −180 on.
Eigen::Vector2d Rounded(const Eigen::Vector2d& middle) {
  constexpr double kPerDegree = 1e5;
  return (Eigen::Array2d(From(-kFullCircle / 2, middle[0]), middle[1]) * kPerDegree).round() /
             kPerDegree +
         0.0;  // no −0
}

}  // namespace

ProjectedDegrees ProjectLocally(const CloudReadOptions& options,
                                const std::vector<std::string>& paths,
                                std::vector<FileCloud>& parts) {
  const bool asked = AsksForProjection(options.projection, paths, parts);
  if (options.projection == CloudProjection::kNone) return {};
  if (!asked) {
    const Eigen::AlignedBox3d box = BoxOf(parts);
    if (box.isEmpty() || !LooksLikeDegrees(box)) return {};
    return {std::nullopt,
            "x and y look like longitude and latitude in degrees beside a z in metres: "
            "--projection local turns them into metres, none leaves them without this word"};
  }
  RequireLatitudes(paths, parts);
  const auto& fixed = options.projection_middle;
  const double cut = fixed ? 0 : CutOfLongitudes(parts);
  const Eigen::AlignedBox3d whole = BoxFrom(cut, parts);
  if (whole.isEmpty()) return {};
  const Eigen::Vector2d middle = fixed ? *fixed : Rounded(whole.center().head<2>());
  const double start = middle[0] - kFullCircle / 2;
  const Eigen::AlignedBox3d box = fixed ? BoxFrom(start, parts) : whole;
  const Eigen::Vector2d metres = MetresInDegree(middle[1]);
  const double off = ShareOff(box, metres);
  constexpr double kMostOff = 0.01;
  if (!(off <= kMostOff)) {
    throw ReadError(
        paths.front(),
        fmt::format("its degrees reach {:.4g} of longitude and from {:.7g} to {:.7g} of "
                    "latitude: in metres about {:.5f},{:.5f} lengths would be off by "
                    "more than 1 %; keep a smaller part with --box, {}or project the "
                    "file before",
                    box.sizes()[0],
                    box.min()[1],
                    box.max()[1],
                    middle[0],
                    middle[1],
                    fixed ? "name a nearer place with --projection local=LON,LAT, " : ""));
  }
  ForEachPiece(parts, [&](std::size_t, auto points) {
    for (double& x : points.row(0)) x = From(start, x);
    points.template topRows<2>() =
        metres.asDiagonal() * (points.template topRows<2>().colwise() - middle);
  });
  const std::string place = fixed ? fmt::format("{},{}", middle[0], middle[1])
                                  : fmt::format("{:.5f},{:.5f}", middle[0], middle[1]);
  return {middle,
          fmt::format("longitude and latitude in degrees are now metres east and north of the {} "
                      "(--projection local={}), with lengths true to {:.1g} %; --projection none "
                      "leaves them",
                      fixed ? "place given" : "middle of the points",
                      place,
                      100 * off)};
}

}  // namespace batten::internal

namespace batten {

void TakeProjection(const std::string& word, CloudReadOptions& options) {
  options.projection = CloudProjection::kLocal;
  options.projection_middle.reset();
  if (word == "local") return;
  if (word == "none") {
    options.projection = CloudProjection::kNone;
    return;
  }
  constexpr std::string_view kLocal = "local=";
  const auto refuse = [&](const std::string& rule) {
    throw std::invalid_argument("'" + word + "' " + rule);
  };
  if (!word.starts_with(kLocal)) refuse("is none of local, local=LON,LAT and none");
  Eigen::Vector2d middle;
  const char* at = word.data() + kLocal.size();
  const char* const end = word.data() + word.size();
  for (int d = 0; d < 2; ++d) {
    const auto [parsed, error] = std::from_chars(at, end, middle[d]);
    if (error != std::errc() || (d == 0 ? parsed == end || *parsed != ',' : parsed != end))
      refuse("is not local=LON,LAT, a longitude and a latitude in degrees");
    at = parsed + 1;
  }
  if (!(std::abs(middle[0]) <= internal::kFullCircle))
    refuse("holds a longitude beyond 360 degrees");
  if (!(std::abs(middle[1]) <= internal::kRightAngle)) refuse("holds a latitude beyond 90 degrees");
  options.projection_middle = middle;
}

}  // namespace batten
