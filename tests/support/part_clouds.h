// SPDX-License-Identifier: MIT
// Machined parts whose faces are known exactly, and points on them, evenly by area.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/geometry/classify_shape.h"

namespace batten::internal {

// A rectangle of parameters with its place in space and the area of a unit of it; what `keep`
// refuses is not of the face.
struct TruthFace {
  SurfaceShape shape;
  Eigen::Vector2d low, high;
  std::function<Eigen::Vector3d(double, double)> place;
  std::function<double(double, double)> density;
  double most_density = 1;
  std::function<bool(const Eigen::Vector3d&)> keep = [](const Eigen::Vector3d&) { return true; };

  double Bound() const { return (high - low).prod() * most_density; }
};

struct TruthPart {
  std::string name;
  std::vector<TruthFace> faces;
  int edges = 0, vertices = 0;
  double volume = 0;
};

struct PartCloud {
  Eigen::Matrix3Xd points;
  std::vector<int> face;  // of each point
};

using Keep = std::function<bool(const Eigen::Vector3d&)>;

inline TruthFace FlatFace(const Eigen::Vector3d& corner,
                          const Eigen::Vector3d& along,
                          const Eigen::Vector3d& up,
                          const Keep& keep = nullptr) {
  const double area = along.cross(up).norm();
  TruthFace face{PlaneShape{corner, along.cross(up).normalized()},
                 {0, 0},
                 {1, 1},
                 [=](double u, double v) -> Eigen::Vector3d { return corner + u * along + v * up; },
                 [=](double, double) { return area; },
                 area};
  if (keep) face.keep = keep;
  return face;
}

// About the axis through `foot` from height low to high, angles from x towards axis × x; radii
// at both heights.
inline TruthFace TurnedFace(const Eigen::Vector3d& foot,
                            const Eigen::Vector3d& axis,
                            const Eigen::Vector3d& x,
                            std::pair<double, double> radii,
                            std::pair<double, double> heights,
                            std::pair<double, double> angles,
                            const Keep& keep = nullptr) {
  const auto [r0, r1] = radii;
  const auto [h0, h1] = heights;
  const Eigen::Vector3d y = axis.cross(x);
  const double slant = std::hypot(r1 - r0, h1 - h0), most = slant * std::max(r0, r1);
  SurfaceShape shape = CylinderShape{foot, axis, r0};
  if (r0 != r1) {
    const double apex = h0 + (h1 - h0) * r0 / (r0 - r1);
    shape = ConeShape{foot + apex * axis,
                      apex > (h0 + h1) / 2 ? Eigen::Vector3d(-axis) : axis,
                      std::atan(std::abs(r1 - r0) / (h1 - h0))};
  }
  TruthFace face{shape,
                 {angles.first, 0},
                 {angles.second, 1},
                 [=](double a, double t) -> Eigen::Vector3d {
                   const double r = r0 + t * (r1 - r0);
                   return foot + (h0 + t * (h1 - h0)) * axis + r * std::cos(a) * x +
                          r * std::sin(a) * y;
                 },
                 [=](double, double t) { return slant * (r0 + t * (r1 - r0)); },
                 most};
  if (keep) face.keep = keep;
  return face;
}

// The part of a sphere between longitudes and latitudes in the frame x, axis × x, axis.
inline TruthFace BallFace(const Eigen::Vector3d& center,
                          const Eigen::Vector3d& axis,
                          const Eigen::Vector3d& x,
                          double radius,
                          std::pair<double, double> longitude,
                          std::pair<double, double> latitude) {
  const Eigen::Vector3d y = axis.cross(x);
  return {SphereShape{center, radius},
          {longitude.first, latitude.first},
          {longitude.second, latitude.second},
          [=](double a, double b) -> Eigen::Vector3d {
            return center + radius * (std::cos(b) * (std::cos(a) * x + std::sin(a) * y) +
                                      std::sin(b) * axis);
          },
          [=](double, double b) { return radius * radius * std::cos(b); },
          radius* radius};
}

// The part of a torus between angles round the axis and round the tube, from the outermost place.
inline TruthFace RingFace(const Eigen::Vector3d& center,
                          const Eigen::Vector3d& axis,
                          const Eigen::Vector3d& x,
                          double major,
                          double minor,
                          std::pair<double, double> round,
                          std::pair<double, double> tube) {
  const Eigen::Vector3d y = axis.cross(x);
  return {TorusShape{center, axis, major, minor},
          {round.first, tube.first},
          {round.second, tube.second},
          [=](double a, double b) -> Eigen::Vector3d {
            return center + (major + minor * std::cos(b)) * (std::cos(a) * x + std::sin(a) * y) +
                   minor * std::sin(b) * axis;
          },
          [=](double, double b) { return minor * (major + minor * std::cos(b)); },
          minor*(major + minor)};
}

inline PartCloud SampledPart(const TruthPart& part, int count, double sigma, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> even(0, 1);
  std::normal_distribution<double> normal(0, 1);
  std::vector<double> bounds;
  for (const TruthFace& face : part.faces) bounds.push_back(face.Bound());
  std::discrete_distribution<int> which(bounds.begin(), bounds.end());
  PartCloud cloud;
  cloud.points.resize(3, count);
  while (std::ssize(cloud.face) < count) {
    const int k = which(engine);
    const TruthFace& face = part.faces[std::size_t(k)];
    const double u = face.low[0] + (face.high[0] - face.low[0]) * even(engine);
    const double v = face.low[1] + (face.high[1] - face.low[1]) * even(engine);
    if (even(engine) * face.most_density > face.density(u, v)) continue;
    const Eigen::Vector3d p = face.place(u, v);
    if (!face.keep(p)) continue;
    const auto at = std::ssize(cloud.face);
    for (int i = 0; i < 3; ++i) cloud.points(i, at) = p[i] + sigma * normal(engine);
    cloud.face.push_back(k);
  }
  return cloud;
}

// Round faces as facets whose corners are on them, so many radians wide.
inline TruthPart Tessellated(TruthPart part, double width) {
  for (TruthFace& face : part.faces) {
    if (std::holds_alternative<PlaneShape>(face.shape)) continue;
    const Eigen::Array2d low = face.low, range = face.high - face.low;
    const Eigen::Array2d count = (range / width).ceil();
    face.place = [=, exact = face.place](double u, double v) -> Eigen::Vector3d {
      const Eigen::Array2d at = (Eigen::Array2d(u, v) - low) / range * count;
      const Eigen::Array2d corner = at.floor().min(count - 1), share = at - corner;
      const auto of = [&](double i, double j) -> Eigen::Vector3d {
        const Eigen::Array2d uv = low + (corner + Eigen::Array2d(i, j)) / count * range;
        return exact(uv[0], uv[1]);
      };
      return (1 - share[1]) * ((1 - share[0]) * of(0, 0) + share[0] * of(1, 0)) +
             share[1] * ((1 - share[0]) * of(0, 1) + share[0] * of(1, 1));
    };
  }
  return part;
}

inline constexpr double kTurn = 2 * std::numbers::pi;

inline void AddBox(TruthPart& part, const Eigen::Vector3d& low, const Eigen::Vector3d& size) {
  const Eigen::Vector3d x(size[0], 0, 0), y(0, size[1], 0), z(0, 0, size[2]);
  for (const auto& [a, b, c] : {std::tuple(x, y, z), std::tuple(y, z, x), std::tuple(z, x, y)}) {
    part.faces.push_back(FlatFace(low, b, a));
    part.faces.push_back(FlatFace(low + c, a, b));
  }
}

inline TruthPart BoxPart() {
  TruthPart part{"box", {}, 12, 8, 1 * 0.7 * 0.4};
  AddBox(part, {0, 0, 0}, {1, 0.7, 0.4});
  return part;
}

// An L of two legs, 0.3 wide, 0.4 deep.
inline TruthPart LBlockPart() {
  TruthPart part{"L-block", {}, 18, 12, (1 * 0.3 + 0.5 * 0.3) * 0.4};
  const std::vector<Eigen::Vector2d> corners{
      {0, 0}, {1, 0}, {1, 0.3}, {0.3, 0.3}, {0.3, 0.8}, {0, 0.8}};
  const Eigen::Vector3d depth(0, 0, 0.4);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Eigen::Vector2d from = corners[k], to = corners[(k + 1) % corners.size()];
    part.faces.push_back(
        FlatFace({from[0], from[1], 0}, {to[0] - from[0], to[1] - from[1], 0}, depth));
  }
  const Keep inside = [](const Eigen::Vector3d& p) { return p[0] < 0.3 || p[1] < 0.3; };
  part.faces.push_back(FlatFace({0, 0, 0}, {0, 0.8, 0}, {1, 0, 0}, inside));
  part.faces.push_back(FlatFace(depth, {1, 0, 0}, {0, 0.8, 0}, inside));
  return part;
}

// A disc or ring at a height, between radii, less round holes of one radius.
inline TruthFace Ring(double height,
                      double inner,
                      double outer,
                      double up,
                      const std::vector<Eigen::Vector2d>& holes = {},
                      double hole = 0) {
  const Keep inside = [=](const Eigen::Vector3d& p) {
    const double r = p.head<2>().norm();
    for (const Eigen::Vector2d& at : holes) {
      if ((p.head<2>() - at).norm() < hole) return false;
    }
    return r > inner && r < outer;
  };
  return FlatFace({-outer, -outer * up, height}, {2 * outer, 0, 0}, {0, 2 * outer * up, 0}, inside);
}

inline TruthFace Turned(double lower, double upper, double low, double high) {
  return TurnedFace({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {lower, upper}, {low, high}, {0, kTurn});
}

inline TruthPart TubePart() {
  constexpr double kOuter = 0.3, kInner = 0.15, kHigh = 0.7;
  TruthPart part{"cylinder with a hole",
                 {},
                 4,
                 0,
                 std::numbers::pi * (kOuter * kOuter - kInner * kInner) * kHigh};
  part.faces = {Turned(kOuter, kOuter, 0, kHigh),
                Turned(kInner, kInner, 0, kHigh),
                Ring(0, kInner, kOuter, -1),
                Ring(kHigh, kInner, kOuter, 1)};
  return part;
}

// A box of which every edge and corner is rounded.
inline TruthPart FilletedBoxPart() {
  constexpr double r = 0.12;
  const Eigen::Vector3d size(1, 0.8, 0.6), core = size - Eigen::Vector3d::Constant(2 * r);
  TruthPart part{"filleted box", {}, 48, 24, 0};
  for (int axis = 0; axis < 3; ++axis) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    const Eigen::Vector3d ea = Eigen::Vector3d::Unit(axis), eb = Eigen::Vector3d::Unit(b),
                          ec = Eigen::Vector3d::Unit(c);
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector3d corner =
          side * size[axis] / 2 * ea - core[b] / 2 * eb - core[c] / 2 * ec;
      part.faces.push_back(side > 0 ? FlatFace(corner, core[b] * eb, core[c] * ec)
                                    : FlatFace(corner, core[c] * ec, core[b] * eb));
    }
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
      const double sb = quadrant == 0 || quadrant == 3 ? 1 : -1, sc = quadrant < 2 ? 1 : -1;
      const double from = quadrant * std::numbers::pi / 2;
      part.faces.push_back(TurnedFace(sb * core[b] / 2 * eb + sc * core[c] / 2 * ec,
                                      ea,
                                      eb,
                                      {r, r},
                                      {-core[axis] / 2, core[axis] / 2},
                                      {from, from + std::numbers::pi / 2}));
    }
  }
  for (int octant = 0; octant < 8; ++octant) {
    const double sx = octant & 1 ? 1 : -1, sy = octant & 2 ? 1 : -1, sz = octant & 4 ? 1 : -1;
    const double mid = std::atan2(sy, sx), quarter = std::numbers::pi / 4;
    part.faces.push_back(BallFace(
        {sx * core[0] / 2, sy * core[1] / 2, sz * core[2] / 2},
        {0, 0, 1},
        {1, 0, 0},
        r,
        {mid - quarter, mid + quarter},
        sz > 0 ? std::pair(0.0, std::numbers::pi / 2) : std::pair(-std::numbers::pi / 2, 0.0)));
  }
  const Eigen::Vector3d k = core;
  part.volume = k.prod() + 2 * r * (k[0] * k[1] + k[1] * k[2] + k[2] * k[0]) +
                std::numbers::pi * r * r * k.sum() + 4.0 / 3 * std::numbers::pi * r * r * r;
  return part;
}

// A disc with a bore in its middle and six around it.
inline TruthPart FlangePart() {
  constexpr double kOuter = 0.5, kBore = 0.15, kHole = 0.06, kCircle = 0.34, kHigh = 0.15;
  std::vector<Eigen::Vector2d> holes;
  for (int k = 0; k < 6; ++k) {
    holes.emplace_back(kCircle * std::cos(kTurn * k / 6), kCircle * std::sin(kTurn * k / 6));
  }
  TruthPart part{"flange with six bores",
                 {},
                 16,
                 0,
                 std::numbers::pi * kHigh * (kOuter * kOuter - kBore * kBore - 6 * kHole * kHole)};
  part.faces = {Turned(kOuter, kOuter, 0, kHigh),
                Turned(kBore, kBore, 0, kHigh),
                Ring(0, kBore, kOuter, -1, holes, kHole),
                Ring(kHigh, kBore, kOuter, 1, holes, kHole)};
  for (const Eigen::Vector2d& at : holes) {
    part.faces.push_back(TurnedFace(
        {at[0], at[1], 0}, {0, 0, 1}, {1, 0, 0}, {kHole, kHole}, {0, kHigh}, {0, kTurn}));
  }
  return part;
}

// Three steps and a chamfer.
inline TruthPart ShaftPart() {
  TruthPart part{"stepped shaft", {}, 7, 0, 0};
  const double r[] = {0.1, 0.18, 0.13}, h[] = {0, 0.3, 0.65, 0.9};
  constexpr double kTop = 0.07, kEnd = 1;
  part.faces = {Ring(0, 0, r[0], -1),
                Turned(r[0], r[0], h[0], h[1]),
                Ring(h[1], r[0], r[1], -1),
                Turned(r[1], r[1], h[1], h[2]),
                Ring(h[2], r[2], r[1], 1),
                Turned(r[2], r[2], h[2], h[3]),
                Turned(r[2], kTop, h[3], kEnd),
                Ring(kEnd, 0, kTop, 1)};
  for (int k = 0; k < 3; ++k) part.volume += std::numbers::pi * r[k] * r[k] * (h[k + 1] - h[k]);
  part.volume += std::numbers::pi / 3 * (kEnd - h[3]) * (r[2] * r[2] + r[2] * kTop + kTop * kTop);
  return part;
}

// Two legs with a fillet between them and a hole in each.
inline TruthPart BracketPart() {
  constexpr double kThick = 0.15, kFillet = 0.12, kLong = 1, kHigh = 0.8, kDeep = 0.5, kHole = 0.1;
  constexpr double kAt = kThick + kFillet;
  TruthPart part{"bracket", {}, 25, 18, 0};
  const Eigen::Vector2d low_hole(0.65, 0.25), high_hole(0.55, 0.25);  // (x, z) and (y, z)
  const Eigen::Vector3d depth(0, 0, kDeep);
  const Keep off_low = [=](const Eigen::Vector3d& p) {
    return (Eigen::Vector2d(p[0], p[2]) - low_hole).norm() > kHole;
  };
  const Keep off_high = [=](const Eigen::Vector3d& p) {
    return (Eigen::Vector2d(p[1], p[2]) - high_hole).norm() > kHole;
  };
  const Keep profile = [=](const Eigen::Vector3d& p) {
    if (p[0] < kThick || p[1] < kThick) return true;
    return p[0] < kAt && p[1] < kAt && (p.head<2>() - Eigen::Vector2d(kAt, kAt)).norm() > kFillet;
  };
  part.faces = {FlatFace({0, 0, 0}, {kLong, 0, 0}, depth, off_low),
                FlatFace({kLong, 0, 0}, {0, kThick, 0}, depth),
                FlatFace({kLong, kThick, 0}, {kAt - kLong, 0, 0}, depth, off_low),
                FlatFace({kThick, kAt, 0}, {0, kHigh - kAt, 0}, depth, off_high),
                FlatFace({kThick, kHigh, 0}, {-kThick, 0, 0}, depth),
                FlatFace({0, kHigh, 0}, {0, -kHigh, 0}, depth, off_high),
                FlatFace({0, 0, 0}, {0, kHigh, 0}, {kLong, 0, 0}, profile),
                FlatFace(depth, {kLong, 0, 0}, {0, kHigh, 0}, profile)};
  part.faces.push_back(TurnedFace({kAt, kAt, 0},
                                  {0, 0, 1},
                                  {1, 0, 0},
                                  {kFillet, kFillet},
                                  {0, kDeep},
                                  {std::numbers::pi, 1.5 * std::numbers::pi}));
  part.faces.push_back(TurnedFace({low_hole[0], 0, low_hole[1]},
                                  {0, 1, 0},
                                  {1, 0, 0},
                                  {kHole, kHole},
                                  {0, kThick},
                                  {0, kTurn}));
  part.faces.push_back(TurnedFace({0, high_hole[0], high_hole[1]},
                                  {1, 0, 0},
                                  {0, 1, 0},
                                  {kHole, kHole},
                                  {0, kThick},
                                  {0, kTurn}));
  return part;
}

inline std::vector<TruthPart> MachinedParts() {
  return {BoxPart(),
          LBlockPart(),
          TubePart(),
          FilletedBoxPart(),
          FlangePart(),
          ShaftPart(),
          BracketPart()};
}

}  // namespace batten::internal
