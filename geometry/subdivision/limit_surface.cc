// SPDX-License-Identifier: MIT
#include "geometry/subdivision/limit_surface.h"

#include <algorithm>
#include <map>
#include <utility>

namespace batten::internal {
namespace {

// Refined nets that are kept for every vertex: three places in a thousand are nearer to it.
constexpr int kKeptLevels = 5;

// The tensor products of two directions' weights for S, S_u, S_v, S_uu, S_uv, S_vv.
Eigen::Matrix<double, 16, 6> TensorWeights(double u, double v, double scale) {
  const CubicWeights a = UniformCubic(u), b = UniformCubic(v);
  const double square = scale * scale;
  Eigen::Matrix<double, 16, 6> weights;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      weights.row(4 * i + j) << a.value[i] * b.value[j], a.first[i] * b.value[j] * scale,
          a.value[i] * b.first[j] * scale, a.second[i] * b.value[j] * square,
          a.first[i] * b.first[j] * square, a.value[i] * b.second[j] * square;
    }
  }
  return weights;
}

}  // namespace

std::vector<int> PlainPlaces(const QuadTopology& mesh, int h) {
  std::vector<int> places(16);
  const int columns[3] = {mesh.Left(h), h, mesh.Right(h)};
  for (int i = 0; i < 3; ++i) {
    const int rows[3] = {mesh.Down(columns[i]), columns[i], mesh.Up(columns[i])};
    for (int j = 0; j < 3; ++j) {
      const int cell = rows[j];
      const int next = QuadTopology::Next(cell);
      const int corner[4] = {mesh.Origin(cell),
                             mesh.Origin(QuadTopology::Previous(cell)),
                             mesh.Origin(next),
                             mesh.Origin(QuadTopology::Next(next))};
      for (int k = 0; k < 4; ++k) places[4 * (i + k / 2) + j + k % 2] = corner[k];
    }
  }
  return places;
}

std::vector<int> RingVertices(const QuadTopology& mesh, int first, const RingPlaces& places) {
  std::vector<int> vertices(places.size(), -1);
  vertices[0] = mesh.Origin(first);
  int h = first;
  for (int k = 0; k < places.valence; ++k, h = mesh.Turned(h)) {
    int column = h;
    for (int i = 0; i < places.rings; ++i) {
      int cell = column;
      for (int j = 0; j <= places.rings; ++j) {
        // The last row and column are far corners of the cells before.
        vertices[places.At(k, i + 1, j)] =
            mesh.Origin(j < places.rings ? QuadTopology::Next(cell) : QuadTopology::Across(cell));
        if (j + 1 < places.rings) cell = mesh.Up(cell);
      }
      if (i + 1 < places.rings) column = mesh.Right(column);
    }
  }
  return vertices;
}

LimitStencils::LimitStencils(const QuadTopology& mesh)
    : mesh_(mesh), finer_(Subdivided(mesh)), patches_(finer_.topology.faces()) {
  for (int p = 0; p < patches(); ++p) MakePatch(p);
}

void LimitStencils::MakePatch(int p) {
  const QuadTopology& finer = finer_.topology;
  Patch& patch = patches_[p];
  const int first = 4 * p;
  const int valence = finer.Valence(finer.Origin(first));
  if (valence == 4) {
    patch.places = PlainPlaces(finer, first);
  } else {
    patch.ring = &ExtraordinaryRing::Of(valence);
    patch.places = RingVertices(finer, first, patch.ring->coarse());
    const int vertex = finer.Origin(first);
    // All patches about a vertex share its refined nets, which begin at its first half-edge.
    int h = finer.Outgoing(vertex);
    for (patch.sector = 0; h != first; ++patch.sector) h = finer.Turned(h);
    if (patch.sector == 0) ring_vertices_.push_back(vertex);
    patch.vertex = vertex;
  }
  // Places that weigh nothing in this sector would only widen the support.
  std::vector<bool> counts(patch.places.size(), true);
  if (patch.ring != nullptr) {
    Eigen::VectorXd most = Eigen::VectorXd::Zero(patch.ring->coarse().size());
    for (const auto& [u, v] : {std::pair{0.3, 0.7}, {0.7, 0.3}, {0.8, 0.9}}) {
      const ExtraordinaryRing::Piece piece = patch.ring->PieceAt(u, v);
      for (const int place : piece.places) {
        most += patch.ring->Refined(piece.level).row(place).cwiseAbs().transpose();
      }
    }
    for (std::size_t k = 0; k < counts.size(); ++k) counts[k] = most[Eigen::Index(k)] > 0;
  }
  std::map<int, int> column;
  for (std::size_t k = 0; k < patch.places.size(); ++k) {
    if (!counts[k]) continue;
    for (StencilMatrix::InnerIterator it(finer_.stencils, patch.places[k]); it; ++it) {
      column.emplace(static_cast<int>(it.col()), 0);
    }
  }
  for (auto& [vertex, number] : column) {
    number = static_cast<int>(patch.support.size());
    patch.support.push_back(vertex);
  }
  patch.stencils =
      Eigen::MatrixXd::Zero(Eigen::Index(patch.places.size()), Eigen::Index(column.size()));
  for (std::size_t k = 0; k < patch.places.size(); ++k) {
    if (!counts[k]) continue;
    for (StencilMatrix::InnerIterator it(finer_.stencils, patch.places[k]); it; ++it) {
      patch.stencils(Eigen::Index(k), column.at(static_cast<int>(it.col()))) += it.value();
    }
  }
}

Eigen::MatrixXd LimitStencils::WeightsAt(const LimitPlace& place, int kinds) const {
  const Patch& patch = patches_[place.patch];
  if (patch.ring == nullptr) {
    const Eigen::Matrix<double, 16, 6> weights = TensorWeights(place.u, place.v, 1.0);
    return patch.stencils.transpose() * weights.leftCols(kinds);
  }
  const ExtraordinaryRing::Piece piece = patch.ring->PieceAt(place.u, place.v);
  const Eigen::Matrix<double, 16, 6> weights = TensorWeights(piece.u, piece.v, piece.scale);
  const Eigen::MatrixXd& refined = patch.ring->Refined(piece.level);
  Eigen::MatrixXd on_places = Eigen::MatrixXd::Zero(refined.cols(), kinds);
  for (int k = 0; k < 16; ++k) {
    on_places += refined.row(piece.places[k]).transpose() * weights.row(k).head(kinds);
  }
  return patch.stencils.transpose() * on_places;
}

LimitPlace LimitStencils::PlaceOnFace(int face, double u, double v) {
  if (v <= 0.5) {
    return u <= 0.5 ? LimitPlace{4 * face, 2 * u, 2 * v}
                    : LimitPlace{4 * face + 1, 2 * v, 2 * (1 - u)};
  }
  return u <= 0.5 ? LimitPlace{4 * face + 3, 2 * (1 - v), 2 * u}
                  : LimitPlace{4 * face + 2, 2 * (1 - u), 2 * (1 - v)};
}

LimitSurface::LimitSurface(const LimitStencils& stencils, const Eigen::Matrix3Xd& control_points)
    : stencils_(stencils), finer_points_(Combined(stencils.finer_.stencils, control_points)) {
  const QuadTopology& finer = stencils.finer_.topology;
  rings_.resize(finer.vertices());
  for (const int vertex : stencils.ring_vertices_) {
    const ExtraordinaryRing& ring = ExtraordinaryRing::Of(finer.Valence(vertex));
    const std::vector<int> places = RingVertices(finer, finer.Outgoing(vertex), ring.coarse());
    Eigen::Matrix3Xd net(3, ring.coarse().size());
    for (std::size_t k = 0; k < places.size(); ++k) {
      net.col(Eigen::Index(k)) = finer_points_.col(places[k]);
    }
    std::vector<Eigen::Matrix3Xd>& levels = rings_[vertex];
    levels.push_back(net);
    for (int level = 1; level <= kKeptLevels; ++level) {
      levels.push_back(net * ring.Refined(level).transpose());
    }
  }
}

SurfaceJet LimitSurface::JetAt(const LimitPlace& place) const {
  const LimitStencils::Patch& patch = stencils_.patches_[place.patch];
  Eigen::Matrix<double, 3, 16> points;
  double u = place.u, v = place.v, scale = 1;
  if (patch.ring == nullptr) {
    for (int k = 0; k < 16; ++k) points.col(k) = finer_points_.col(patch.places[k]);
  } else {
    const ExtraordinaryRing::Piece piece = patch.ring->PieceAt(u, v);
    const std::vector<Eigen::Matrix3Xd>& levels = rings_[patch.vertex];
    const RingPlaces& fine = patch.ring->fine();
    const int per_sector = fine.rings * (fine.rings + 1);
    for (int k = 0; k < 16; ++k) {
      // Sector 0 of the patch is another one of the vertex.
      const int at = piece.places[k];
      const int turned = at == 0 ? 0 : 1 + (at - 1 + patch.sector * per_sector) % (fine.size() - 1);
      if (piece.level <= kKeptLevels) {
        points.col(k) = levels[piece.level].col(turned);
      } else {
        points.col(k) = levels[0] * patch.ring->Refined(piece.level).row(turned).transpose();
      }
    }
    u = piece.u;
    v = piece.v;
    scale = piece.scale;
  }
  const Eigen::Matrix<double, 3, 6> jet = points * TensorWeights(u, v, scale);
  return {jet.col(0), jet.col(1), jet.col(2), jet.col(3), jet.col(4), jet.col(5)};
}

LimitPlace LimitSurface::Moved(const LimitPlace& from, double du, double dv, int crossings) const {
  const QuadTopology& finer = stencils_.finer_.topology;
  LimitPlace place = from;
  for (;; --crossings) {
    // How much of the step fits.
    double share = 1;
    int side = -1;
    const auto limit = [&](double at, double step, int low, int high) {
      if (step < 0 && at + step < 0 && -at / step < share) {
        share = -at / step;
        side = low;
      }
      if (step > 0 && at + step > 1 && (1 - at) / step < share) {
        share = (1 - at) / step;
        side = high;
      }
    };
    limit(place.u, du, 3, 1);
    limit(place.v, dv, 0, 2);
    place.u = std::clamp(place.u + share * du, 0.0, 1.0);
    place.v = std::clamp(place.v + share * dv, 0.0, 1.0);
    if (side < 0 || crossings <= 0) return place;
    du *= 1 - share;
    dv *= 1 - share;
    // In the frame of the side: s along it, t inwards. Across, s runs the other way and t outwards.
    const double s = side == 0   ? place.u
                     : side == 1 ? place.v
                     : side == 2 ? 1 - place.u
                                 : 1 - place.v;
    const double ds = side == 0 ? du : side == 1 ? dv : side == 2 ? -du : -dv;
    const double dt = side == 0 ? dv : side == 1 ? -du : side == 2 ? -dv : du;
    const int beside = finer.Twin(4 * place.patch + side);
    const double r = 1 - s, dr = -ds, dq = -dt;
    switch (beside & 3) {
      case 0:
        place = {beside >> 2, r, 0};
        du = dr, dv = dq;
        break;
      case 1:
        place = {beside >> 2, 1, r};
        du = -dq, dv = dr;
        break;
      case 2:
        place = {beside >> 2, 1 - r, 1};
        du = -dr, dv = -dq;
        break;
      default:
        place = {beside >> 2, 0, 1 - r};
        du = dq, dv = -dr;
    }
  }
}

}  // namespace batten::internal
