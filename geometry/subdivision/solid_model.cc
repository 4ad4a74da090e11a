// SPDX-License-Identifier: MIT
#include "batten/geometry/solid_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/numeric/gauss_rule.h"
#include "geometry/numeric/polygon.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten {
namespace {

// Places in a domain: so many in every span, and towards both of its ends.
std::vector<double> PlacesOf(const SplineBasis& basis, int samples) {
  std::vector<double> places = internal::BreaksIn(basis, samples);
  const double lower = basis.lower(), upper = basis.upper();
  constexpr int kHalvings = 12;
  const double first = basis.knots()[basis.Spans().front() + 1] - lower;
  const double last = upper - basis.knots()[basis.Spans().back()];
  for (int k = 1; k <= kHalvings; ++k) {
    places.push_back(lower + std::ldexp(first, -k));
    places.push_back(upper - std::ldexp(last, -k));
  }
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

Eigen::Vector3d NormalOf(const NurbsSurface& surface, double u, double v) {
  const SurfaceJet jet = surface.JetAt(u, v);
  return jet.du.cross(jet.dv).stableNormalized();
}

double LengthOf(const NurbsCurve<3>& curve, int samples) {
  double length = 0;
  std::optional<Eigen::Vector3d> before;
  for (const double t : PlacesOf(curve.basis(), samples)) {
    const Eigen::Vector3d here = curve.At(t);
    if (before) length += (here - *before).norm();
    before = here;
  }
  return length;
}

void AuditEdge(const SolidModel& solid,
               const SolidEdge& edge,
               const std::array<std::pair<int, const SolidCoedge*>, 2>& uses,
               int samples,
               SolidAudit& audit) {
  const SplineBasis& basis = edge.curve.basis();
  double middle = 2, middle_angle = 0;  // the share nearest to a half
  for (const double t : PlacesOf(basis, samples)) {
    const double share = (t - basis.lower()) / (basis.upper() - basis.lower());
    const Eigen::Vector3d on_curve = edge.curve.At(t);
    std::array<Eigen::Vector3d, 2> normal;
    for (int k = 0; k < 2; ++k) {
      const NurbsSurface& surface = solid.faces[uses[k].first].surface;
      const SolidCoedge& coedge = *uses[k].second;
      const Eigen::Vector2d at = coedge.from + share * (coedge.to - coedge.from);
      const SurfaceJet jet = surface.JetAt(at[0], at[1]);
      audit.gap = std::max(audit.gap, (jet.point - on_curve).norm());
      normal[k] = jet.du.cross(jet.dv).stableNormalized();
    }
    const double angle = internal::AngleBetween(normal[0], normal[1]);
    if (std::abs(share - 0.5) < std::abs(middle - 0.5)) {
      middle = share;
      middle_angle = angle;
    }
    if (edge.sharp || angle <= audit.edge_angle) continue;
    audit.edge_angle = angle;
    audit.edge_angle_at = on_curve;
  }
  if (!edge.sharp) return;
  audit.least_sharp =
      audit.sharp_edges == 0 ? middle_angle : std::min(audit.least_sharp, middle_angle);
  audit.greatest_sharp = std::max(audit.greatest_sharp, middle_angle);
  audit.sharp_length += LengthOf(edge.curve, samples);
  ++audit.sharp_edges;
}

void AuditFace(const NurbsSurface& surface, int samples, SolidAudit& audit) {
  const std::vector<double> u = PlacesOf(surface.basis_u(), samples);
  const std::vector<double> v = PlacesOf(surface.basis_v(), samples);
  std::vector<Eigen::Vector3d> before, row(v.size());
  for (const double a : u) {
    for (std::size_t j = 0; j < v.size(); ++j) {
      row[j] = NormalOf(surface, a, v[j]);
      double turn = j > 0 ? internal::AngleBetween(row[j], row[j - 1]) : 0;
      if (!before.empty()) turn = std::max(turn, internal::AngleBetween(row[j], before[j]));
      if (turn <= audit.turn) continue;
      audit.turn = turn;
      audit.turn_at = surface.At(a, v[j]);
    }
    before = row;
  }
  // S·(S_u × S_v) has degree 8 in each direction: five places integrate it exactly.
  constexpr int kPlaces = 5;
  const internal::GaussRule rule = internal::GaussLegendre(kPlaces);
  for (const int p : surface.basis_u().Spans()) {
    for (const int q : surface.basis_v().Spans()) {
      const double a = surface.basis_u().knots()[p], b = surface.basis_u().knots()[p + 1];
      const double c = surface.basis_v().knots()[q], d = surface.basis_v().knots()[q + 1];
      for (int i = 0; i < kPlaces; ++i) {
        for (int j = 0; j < kPlaces; ++j) {
          const SurfaceJet jet =
              surface.JetAt(a + (b - a) * rule.nodes[i], c + (d - c) * rule.nodes[j]);
          const Eigen::Vector3d normal = jet.du.cross(jet.dv);
          const double weight = rule.weights[i] * rule.weights[j] * (b - a) * (d - c);
          audit.volume += weight * jet.point.dot(normal) / 3;
          audit.area += weight * normal.norm();
        }
      }
    }
  }
}

}  // namespace

SolidModel SolidModel::Without(const std::vector<char>& faces_left_out) const {
  SolidModel shell;
  shell.open = true;
  std::vector<int> edge_of(edges.size(), -1), vertex_of(std::size_t(vertices.cols()), -1);
  std::vector<int> kept;
  const auto vertex = [&](int v) {
    int& number = vertex_of[std::size_t(v)];
    if (number < 0) {
      number = static_cast<int>(kept.size());
      kept.push_back(v);
    }
    return number;
  };
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (faces_left_out[f]) continue;
    SolidFace& face = shell.faces.emplace_back(faces[f]);
    for (SolidCoedge& coedge : face.loop) {
      int& number = edge_of[std::size_t(coedge.edge)];
      if (number < 0) {
        number = static_cast<int>(shell.edges.size());
        const SolidEdge& edge = edges[std::size_t(coedge.edge)];
        shell.edges.push_back({edge.curve, vertex(edge.start), vertex(edge.end), edge.sharp});
      }
      coedge.edge = number;
    }
  }
  shell.vertices = vertices(Eigen::all, kept);
  return shell;
}

SolidModel SolidModel::Translated(const Eigen::Vector3d& shift) const {
  SolidModel moved;
  moved.open = open;
  moved.vertices = vertices.colwise() + shift;
  for (const SolidEdge& edge : edges) {
    Eigen::Matrix3Xd points = edge.curve.control_points().colwise() + shift;
    moved.edges.push_back(
        {NurbsCurve<3>(edge.curve.basis(), std::move(points), edge.curve.weights()),
         edge.start,
         edge.end,
         edge.sharp});
  }
  for (const SolidFace& face : faces)
    moved.faces.push_back({face.surface.Translated(shift), face.loop});
  return moved;
}

std::vector<FaceBorder> BordersOf(const SolidModel& solid) {
  std::vector<FaceBorder> borders;
  for (const SolidFace& face : solid.faces) {
    std::vector<BorderPiece>& loop = borders.emplace_back().loops.emplace_back();
    for (const SolidCoedge& coedge : face.loop) {
      Eigen::Matrix2d ends;
      ends.col(0) = coedge.reversed ? coedge.to : coedge.from;
      ends.col(1) = coedge.reversed ? coedge.from : coedge.to;
      loop.push_back(
          {NurbsCurve<2>(SplineBasis(1, {0, 0, 1, 1}), ends), coedge.edge, coedge.reversed});
    }
  }
  return borders;
}

SolidAudit AuditSolid(const SolidModel& solid, int samples) {
  SolidAudit audit;
  std::vector<std::vector<std::pair<int, const SolidCoedge*>>> uses(solid.edges.size());
  for (std::size_t f = 0; f < solid.faces.size(); ++f) {
    AuditFace(solid.faces[f].surface, samples, audit);
    for (const SolidCoedge& coedge : solid.faces[f].loop) {
      uses[std::size_t(coedge.edge)].emplace_back(static_cast<int>(f), &coedge);
    }
  }
  for (std::size_t e = 0; e < uses.size(); ++e) {
    const auto& use = uses[e];
    if (use.size() != 2 || use[0].second->reversed == use[1].second->reversed) {
      ++audit.open_edges;
      audit.open_length += LengthOf(solid.edges[e].curve, samples);
      continue;
    }
    AuditEdge(solid, solid.edges[e], {use[0], use[1]}, samples, audit);
  }
  return audit;
}

}  // namespace batten
