// SPDX-License-Identifier: MIT
#include "geometry/section/section_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/bezier/bernstein.h"
#include "geometry/numeric/box_diagonal.h"

namespace batten::internal {
namespace {

constexpr double kTouch = 1e-6;      // radians: less than this everywhere is a touch
constexpr double kLeastSine = 0.01;  // see SectionOptions
constexpr int kMostFitHalvings = 40;
constexpr int kPlacesInLink = 5, kPlacesAcross = 9;

// A chain that is bent more than this is not one cubic.
constexpr double kLeastCosine = 0.5;

template <int Dim>
Eigen::Matrix<double, Dim, 1> ArcAt(const Eigen::Matrix<double, Dim, 4>& b, double t) {
  double B[4];
  BernsteinValues(3, t, B);
  return B[0] * b.col(0) + B[1] * b.col(1) + B[2] * b.col(2) + B[3] * b.col(3);
}

Eigen::Vector2d Into(const ParameterBox& box, const Eigen::Vector2d& at) {
  return {std::clamp(at[0], box.u0, box.u1), std::clamp(at[1], box.v0, box.v1)};
}

}  // namespace

SectionFitter::SectionFitter(const NurbsSurface& surface,
                             const Eigen::Vector3d& normal,
                             double offset,
                             double tolerance)
    : surface_(surface),
      normal_(normal),
      offset_(offset),
      tolerance_(tolerance),
      size_(BoxDiagonal(surface.control_points())),
      pieces_(surface) {}

// The tangent (S_u f_v − S_v f_u), which has what is above on its left.
SectionFitter::Contact SectionFitter::ContactOf(const Eigen::Vector2d& at,
                                                const SurfaceJet& jet) const {
  Contact c;
  c.at = at;
  c.height = normal_.dot(jet.point) - offset_;
  c.point = jet.point - c.height * normal_;
  c.height_u = normal_.dot(jet.du);
  c.height_v = normal_.dot(jet.dv);
  const Eigen::Vector3d along = jet.du * c.height_v - jet.dv * c.height_u;
  const double length = along.norm(), area = jet.du.cross(jet.dv).norm();
  constexpr double kParallel = 1e-12;
  c.regular = length > 0 && area > kParallel * jet.du.norm() * jet.dv.norm() &&
              length > kTouch * kLeastSine * area;
  c.sine = area > 0 ? std::min(1.0, length / area) : 0;
  c.tangent = c.regular ? Eigen::Vector3d(along / length) : Eigen::Vector3d::Zero();
  c.velocity = c.regular ? Eigen::Vector2d(c.height_v / length, -c.height_u / length)
                         : Eigen::Vector2d::Zero();
  return c;
}

SectionFitter::Contact SectionFitter::ContactAt(const Eigen::Vector2d& at) const {
  return ContactOf(at, surface_.JetAt(at[0], at[1]));
}

SectionFitter::Contact SectionFitter::ContactIn(const SectionLink& link,
                                                const Eigen::Vector2d& at) {
  const std::pair<int, int> key{link.patch_u, link.patch_v};
  auto place = used_.find(key);
  if (place == used_.end()) {
    place = used_.emplace(key, pieces_.Piece(key.first, key.second)).first;
  }
  const SurfacePiece& piece = place->second;
  const double wide = piece.u1 - piece.u0, tall = piece.v1 - piece.v0;
  SurfaceJet jet = JetOf(piece, (at[0] - piece.u0) / wide, (at[1] - piece.v0) / tall);
  jet.point += piece.origin;
  jet.du /= wide;
  jet.dv /= tall;
  return ContactOf(at, jet);
}

// Hermite's cubic; an end without a tangent takes the chord's direction.
SectionFitter::Arc SectionFitter::ArcBetween(const Contact& a, const Contact& b) {
  const Eigen::Vector3d chord = b.point - a.point;
  const Eigen::Vector2d step = b.at - a.at;
  const double distance = chord.norm();
  const double turn = a.regular && b.regular ? (b.tangent - a.tangent).norm() : 0;
  Arc arc;
  constexpr double kOfTheTurn = 1.0 / 24;  // an arc of a circle is so much longer than its chord
  arc.length = distance * (1 + kOfTheTurn * turn * turn);
  const auto in_space = [&](const Contact& c) -> Eigen::Vector3d {
    return c.regular ? Eigen::Vector3d(arc.length / 3 * c.tangent) : Eigen::Vector3d(chord / 3);
  };
  const auto in_domain = [&](const Contact& c) -> Eigen::Vector2d {
    return c.regular ? Eigen::Vector2d(arc.length / 3 * c.velocity) : Eigen::Vector2d(step / 3);
  };
  arc.points << a.point, a.point + in_space(a), b.point - in_space(b), b.point;
  arc.places << a.at, a.at + in_domain(a), b.at - in_domain(b), b.at;
  return arc;
}

// Whether an arc keeps the tolerance at places inside it.
bool SectionFitter::Near(const Arc& arc, const SectionLink* link, int places) {
  for (int k = 1; k <= places; ++k) {
    const double t = static_cast<double>(k) / (places + 1);
    const Eigen::Vector2d at = ArcAt<2>(arc.places, t);
    const Contact c = link ? ContactIn(*link, at) : ContactAt(at);
    if (std::abs(c.height) > tolerance_ * std::max(c.sine, kLeastSine)) return false;
    const Eigen::Vector3d on_surface = c.point + c.height * normal_;
    if ((ArcAt<3>(arc.points, t) - on_surface).norm() > tolerance_) return false;
  }
  return true;
}

// Newton's steps of least length on the surface, kept in the cell.
std::optional<SectionFitter::Contact> SectionFitter::Settled(const SectionLink& link,
                                                             Eigen::Vector2d at) {
  constexpr int kSteps = 12;
  for (int k = 0; k < kSteps; ++k) {
    at = Into(link.cell, at);
    const Contact c = ContactIn(link, at);
    if (std::abs(c.height) <= tolerance_ * kLeastSine * kLeastSine) return c;
    if (!c.regular) return std::nullopt;
    // The direction across the section in the tangent plane, in parameters: along n's shadow.
    const SurfacePiece& piece = used_.at({link.patch_u, link.patch_v});
    const double wide = piece.u1 - piece.u0, tall = piece.v1 - piece.v0;
    const SurfaceJet jet = JetOf(piece, (at[0] - piece.u0) / wide, (at[1] - piece.v0) / tall);
    const Eigen::Vector3d du = jet.du / wide, dv = jet.dv / tall;
    const double e = du.dot(du), f = du.dot(dv), g = dv.dot(dv), det = e * g - f * f;
    if (!(det > 0)) return std::nullopt;
    const Eigen::Vector2d up((g * c.height_u - f * c.height_v) / det,
                             (e * c.height_v - f * c.height_u) / det);
    at -= c.height / (c.height_u * up[0] + c.height_v * up[1]) * up;
    if (!at.allFinite()) return std::nullopt;
  }
  return std::nullopt;
}

// In a cell where the chain is a graph: halfway in its variable, the zero in the other.
SectionFitter::Contact SectionFitter::Bracketed(const SectionLink& link,
                                                const Contact& a,
                                                const Contact& b) {
  const Eigen::Vector2d middle = (a.at + b.at) / 2;
  if (!link.over_u && !link.over_v) return ContactIn(link, middle);
  const int free = link.over_v ? 0 : 1;
  Eigen::Vector2d low = middle, high = middle;
  low[free] = free == 0 ? link.cell.u0 : link.cell.v0;
  high[free] = free == 0 ? link.cell.u1 : link.cell.v1;
  const bool rises = ContactIn(link, high).height > ContactIn(link, low).height;
  constexpr int kHalvings = 60;
  for (int k = 0; k < kHalvings; ++k) {
    const Eigen::Vector2d half = (low + high) / 2;
    ((ContactIn(link, half).height < 0) == rises ? low : high) = half;
  }
  return ContactIn(link, (low + high) / 2);
}

SectionFitter::Contact SectionFitter::MiddleOf(const SectionLink& link,
                                               const Contact& a,
                                               const Contact& b) {
  const auto between = [](double x, double y, double z) {
    return y >= std::min(x, z) && y <= std::max(x, z);
  };
  for (const Eigen::Vector2d& start :
       {ArcAt<2>(ArcBetween(a, b).places, 0.5), Eigen::Vector2d((a.at + b.at) / 2)}) {
    const std::optional<Contact> c = Settled(link, start);
    if (!c) continue;
    const bool ours = (link.over_v && between(a.at[1], c->at[1], b.at[1])) ||
                      (link.over_u && between(a.at[0], c->at[0], b.at[0])) ||
                      (!link.over_u && !link.over_v);
    const double to_a = (c->point - a.point).norm(), to_b = (c->point - b.point).norm();
    constexpr double kUneven = 0.1;
    const bool inside = std::max(to_a, to_b) < (b.point - a.point).norm();
    const bool even = std::min(to_a, to_b) > kUneven * std::max(to_a, to_b);
    if (ours && inside && even) return *c;
  }
  return Bracketed(link, a, b);
}

void SectionFitter::Refine(const SectionLink& link,
                           const Contact& a,
                           const Contact& b,
                           int depth,
                           std::vector<Station>& stations) {
  if (depth == kMostFitHalvings || (b.at - a.at).isZero(0)) return;
  const bool bent = a.regular && b.regular && a.tangent.dot(b.tangent) < kLeastCosine;
  if (!bent && Near(ArcBetween(a, b), &link, kPlacesInLink)) return;
  const Contact middle = MiddleOf(link, a, b);
  Refine(link, a, middle, depth + 1, stations);
  stations.push_back({middle, middle});
  Refine(link, middle, b, depth + 1, stations);
}

std::vector<SectionFitter::Station> SectionFitter::StationsOf(
    const SectionTrace& trace, const std::vector<SectionLink>& chain) {
  std::vector<Station> stations;
  for (const SectionLink& link : chain) {
    const Eigen::Vector2d &from = trace.nodes[link.from], &to = trace.nodes[link.to];
    const Contact a = ContactIn(link, from), b = ContactIn(link, to);
    if (stations.empty()) stations.push_back({a, a});
    stations.back().after = a;
    if (from == to) continue;
    Refine(link, a, b, 0, stations);
    stations.push_back({b, b});
  }
  return stations;
}

bool SectionFitter::Corner(const Station& station) {
  constexpr double kSame = 1e-9;
  const Contact &a = station.before, &b = station.after;
  return a.regular != b.regular || (a.tangent - b.tangent).norm() > kSame ||
         (a.velocity - b.velocity).norm() > kSame * a.velocity.norm();
}

// Whether one arc may stand for those between stations i and j.
bool SectionFitter::Replaces(const std::vector<Station>& stations, std::size_t i, std::size_t j) {
  const Contact &a = stations[i].after, &b = stations[j].before;
  if (a.regular && b.regular && a.tangent.dot(b.tangent) < kLeastCosine) return false;
  std::vector<double> along{0};
  for (std::size_t k = i; k < j; ++k) {
    along.push_back(along.back() +
                    (stations[k + 1].before.point - stations[k].before.point).norm());
  }
  const Arc arc = ArcBetween(a, b);
  constexpr double kOfTheChord = 0.05;
  for (std::size_t k = i + 1; k < j; ++k) {
    const Eigen::Vector3d there = ArcAt<3>(arc.points, along[k - i] / along.back());
    if ((there - stations[k].before.point).norm() > kOfTheChord * along.back()) return false;
  }
  return Near(arc, nullptr, kPlacesAcross);
}

// As few stations as keep the tolerance, each as far from the one before as can be.
std::vector<SectionFitter::Station> SectionFitter::Thinned(const std::vector<Station>& stations) {
  std::vector<Station> kept{stations.front()};
  for (std::size_t i = 0; i + 1 < stations.size();) {
    std::size_t wall = i + 1;
    while (wall + 1 < stations.size() && !Corner(stations[wall])) ++wall;
    std::size_t good = i + 1, bad = wall + 1;
    for (std::size_t step = 2; i + step < bad; step *= 2) {
      if (!Replaces(stations, i, i + step)) {
        bad = i + step;
      } else {
        good = i + step;
      }
    }
    while (bad - good > 1) {
      const std::size_t middle = (good + bad) / 2;
      (Replaces(stations, i, middle) ? good : bad) = middle;
    }
    kept.push_back(stations[good]);
    i = good;
  }
  return kept;
}

FittedChains SectionFitter::Fit(const SectionTrace& trace) {
  FittedChains fitted;
  for (const std::vector<SectionLink>& chain : trace.chains) {
    const std::vector<Station> all = StationsOf(trace, chain);
    const auto sine = [](const Station& a) { return std::max(a.before.sine, a.after.sine); };
    const bool crosses =
        std::any_of(all.begin(), all.end(), [&](const Station& a) { return sine(a) > kTouch; });
    if (!crosses || all.size() < 2) {
      fitted.touches.push_back(all[all.size() / 2].after.at);
      continue;
    }
    const std::vector<Station> stations = Thinned(all);
    std::vector<double> knots(4, 0);
    std::vector<Eigen::Vector3d> points{stations[0].after.point};
    std::vector<Eigen::Vector2d> places{stations[0].after.at};
    for (std::size_t k = 0; k + 1 < stations.size(); ++k) {
      const Arc arc = ArcBetween(stations[k].after, stations[k + 1].before);
      const double end =
          knots.back() + std::max(arc.length, std::numeric_limits<double>::epsilon() * size_ * 4);
      const bool last = k + 2 == stations.size();
      const bool corner = last || Corner(stations[k + 1]) || !stations[k + 1].before.regular;
      for (int i = 1; i <= (corner ? 3 : 2); ++i) {
        points.push_back(arc.points.col(i));
        places.push_back(arc.places.col(i));
      }
      knots.insert(knots.end(), last ? 4 : corner ? 3 : 2, end);
    }
    const bool closed = chain.front().from == chain.back().to;
    if (closed) {
      points.back() = points.front();
      places.back() = places.front();
    }
    const auto count = static_cast<Eigen::Index>(points.size());
    const SplineBasis basis(3, std::move(knots));
    fitted.curves.push_back(
        {NurbsCurve<2>(basis, Eigen::Map<Eigen::Matrix2Xd>(places[0].data(), 2, count)),
         NurbsCurve<3>(basis, Eigen::Map<Eigen::Matrix3Xd>(points[0].data(), 3, count)),
         closed});
  }
  return fitted;
}

}  // namespace batten::internal
