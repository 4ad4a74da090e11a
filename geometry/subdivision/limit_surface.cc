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

// The same applied to points, one direction after the other.
SurfaceJet JetOf(const Eigen::Matrix<double, 3, 16>& points, double u, double v, double scale) {
  const CubicWeights a = UniformCubic(u), b = UniformCubic(v);
  Eigen::Matrix<double, 3, 4> value = Eigen::Matrix<double, 3, 4>::Zero();
  Eigen::Matrix<double, 3, 4> first = value, second = value;
  for (int i = 0; i < 4; ++i) {
    const auto row = points.middleCols<4>(4 * i);
    value += a.value[i] * row;
    first += a.first[i] * row;
    second += a.second[i] * row;
  }
  using Weights = Eigen::Map<const Eigen::Vector4d>;
  const Weights by_value(b.value.data()), by_first(b.first.data()), by_second(b.second.data());
  const double square = scale * scale;
  return {value * by_value,
          scale * first * by_value,
          scale * value * by_first,
          square * second * by_value,
          square * first * by_first,
          square * value * by_second};
}

}  // namespace

PlainNet PlainNetOf(const QuadTopology& mesh, int h) {
  PlainNet net;
  net.vertices.fill(-1);
  const int columns[3] = {mesh.Left(h), h, mesh.Right(h)};
  net.beyond = {columns[0] < 0, mesh.Down(h) < 0, columns[2] < 0, mesh.Up(h) < 0};
  for (int i = 0; i < 3; ++i) {
    if (columns[i] < 0) continue;
    const int rows[3] = {mesh.Down(columns[i]), columns[i], mesh.Up(columns[i])};
    for (int j = 0; j < 3; ++j) {
      const int cell = rows[j];
      if (cell < 0) continue;
      const int next = QuadTopology::Next(cell);
      const int corner[4] = {mesh.Origin(cell),
                             mesh.Origin(QuadTopology::Previous(cell)),
                             mesh.Origin(next),
                             mesh.Origin(QuadTopology::Next(next))};
      for (int k = 0; k < 4; ++k) net.vertices[4 * (i + k / 2) + j + k % 2] = corner[k];
    }
  }
  return net;
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
        if (i == 0 && j < places.rings) {
          vertices[places.At(k, 0, j + 1)] = mesh.Origin(QuadTopology::Previous(cell));
        }
        if (j + 1 < places.rings) cell = mesh.Up(cell);
      }
      if (i + 1 < places.rings) column = mesh.Right(column);
    }
  }
  return vertices;
}

LimitStencils::LimitStencils(const QuadTopology& mesh)
    : LimitStencils(mesh, std::vector<char>(std::size_t(mesh.faces()), 1)) {}

LimitStencils::LimitStencils(const QuadTopology& mesh, const std::vector<char>& faces)
    : mesh_(mesh), finer_(Subdivided(mesh)), patches_(finer_.topology.faces()) {
  std::map<int, int> nets;
  for (int p = 0; p < patches(); ++p) MakePatch(p, nets, faces[std::size_t(p >> 2)] != 0);
}

void LimitStencils::MakePatch(int p, std::map<int, int>& nets, bool stencils) {
  const QuadTopology& finer = finer_.topology;
  Patch& patch = patches_[p];
  const int first = 4 * p;
  const QuadFan fan = finer.FanOf(first);
  if (fan.plain()) {
    const PlainNet net = PlainNetOf(finer, first);
    patch.places.assign(net.vertices.begin(), net.vertices.end());
    patch.beyond = net.beyond;
  } else {
    patch.ring = &ExtraordinaryRing::Of({fan.sectors, fan.open, fan.corner});
    // All patches of a fan share its refined nets, which begin at its first half-edge.
    patch.places = RingVertices(finer, fan.first, patch.ring->coarse());
    for (int h = fan.first; h != first; ++patch.sector) h = finer.Turned(h);
    const auto [known, fresh] = nets.try_emplace(fan.first, static_cast<int>(net_first_.size()));
    if (fresh) net_first_.push_back(fan.first);
    patch.net = known->second;
  }
  if (stencils) MakeStencils(patch);
}

void LimitStencils::MakeStencils(Patch& patch) const {
  // Places that weigh nothing in this sector would only widen the support.
  std::vector<bool> counts(patch.places.size(), true);
  if (patch.ring != nullptr) {
    Eigen::VectorXd most = Eigen::VectorXd::Zero(patch.ring->coarse().size());
    for (const auto& [u, v] : {std::pair{0.3, 0.7}, {0.7, 0.3}, {0.8, 0.9}, {1e-6, 1e-6}}) {
      const ExtraordinaryRing::Piece piece = patch.ring->PieceAt(u, v, patch.sector);
      most += patch.ring->Rows(piece).cwiseAbs().colwise().sum().transpose();
    }
    for (std::size_t k = 0; k < counts.size(); ++k) counts[k] = most[Eigen::Index(k)] > 0;
  }
  for (std::size_t k = 0; k < counts.size(); ++k) counts[k] = counts[k] && patch.places[k] >= 0;
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
  if (patch.ring == nullptr) patch.beyond.Fill([&](int k) { return patch.stencils.row(k); });
}

Eigen::MatrixXd LimitStencils::WeightsAt(const LimitPlace& place, int kinds) const {
  const Patch& patch = patches_[place.patch];
  if (patch.ring == nullptr) {
    const Eigen::Matrix<double, 16, 6> weights = TensorWeights(place.u, place.v, 1.0);
    return patch.stencils.transpose() * weights.leftCols(kinds);
  }
  const ExtraordinaryRing::Piece piece = patch.ring->PieceAt(place.u, place.v, patch.sector);
  const Eigen::Matrix<double, 16, 6> weights = TensorWeights(piece.u, piece.v, piece.scale);
  const Eigen::MatrixXd on_places = patch.ring->Rows(piece).transpose() * weights.leftCols(kinds);
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
  for (const int first : stencils.net_first_) {
    const QuadFan fan = finer.FanOf(first);
    const ExtraordinaryRing& ring = ExtraordinaryRing::Of({fan.sectors, fan.open, fan.corner});
    const std::vector<int> places = RingVertices(finer, first, ring.coarse());
    Eigen::Matrix3Xd net(3, ring.coarse().size());
    for (std::size_t k = 0; k < places.size(); ++k) {
      net.col(Eigen::Index(k)) = finer_points_.col(places[k]);
    }
    std::vector<Eigen::Matrix3Xd>& levels = rings_.emplace_back();
    levels.push_back(net);
    for (int level = 1; level <= kKeptLevels; ++level) {
      levels.push_back(net * ring.Refined(level).transpose());
    }
  }
}

Eigen::Matrix<double, 3, 16> LimitSurface::PointsOf(const LimitStencils::Patch& plain) const {
  Eigen::Matrix<double, 3, 16> points;
  for (int k = 0; k < 16; ++k) {
    if (plain.places[k] >= 0) points.col(k) = finer_points_.col(plain.places[k]);
  }
  plain.beyond.Fill([&](int k) { return points.col(k); });
  return points;
}

Eigen::Matrix3Xd LimitSurface::NormalsOn(int patch, std::span<const double> parameters) const {
  const LimitStencils::Patch& of = stencils_.patches_[patch];
  const auto count = Eigen::Index(parameters.size());
  Eigen::Matrix3Xd normals(3, count * count);
  if (of.ring != nullptr) {
    for (Eigen::Index k = 0; k < count * count; ++k) {
      const SurfaceJet jet = JetAt({patch, parameters[k / count], parameters[k % count]});
      normals.col(k) = jet.du.cross(jet.dv).stableNormalized();
    }
    return normals;
  }
  const Eigen::Matrix<double, 3, 16> points = PointsOf(of);
  Eigen::Matrix<double, 4, Eigen::Dynamic> values(4, count), slopes(4, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const CubicWeights weights = UniformCubic(parameters[k]);
    values.col(k) = Eigen::Map<const Eigen::Vector4d>(weights.value.data());
    slopes.col(k) = Eigen::Map<const Eigen::Vector4d>(weights.first.data());
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    Eigen::Matrix<double, 3, 4> value = Eigen::Matrix<double, 3, 4>::Zero(), slope = value;
    for (int row = 0; row < 4; ++row) {
      value += values(row, i) * points.middleCols<4>(4 * row);
      slope += slopes(row, i) * points.middleCols<4>(4 * row);
    }
    for (Eigen::Index j = 0; j < count; ++j) {
      const Eigen::Vector3d du = slope * values.col(j), dv = value * slopes.col(j);
      normals.col(i * count + j) = du.cross(dv).stableNormalized();
    }
  }
  return normals;
}

SurfaceJet LimitSurface::JetAt(const LimitPlace& place) const {
  const LimitStencils::Patch& patch = stencils_.patches_[place.patch];
  Eigen::Matrix<double, 3, 16> points;
  double u = place.u, v = place.v, scale = 1;
  if (patch.ring == nullptr) {
    points = PointsOf(patch);
  } else {
    const ExtraordinaryRing::Piece piece = patch.ring->PieceAt(u, v, patch.sector);
    const std::vector<Eigen::Matrix3Xd>& levels = rings_[patch.net];
    for (int k = 0; k < 16; ++k) {
      const int at = piece.places[k];
      if (at < 0) continue;
      if (piece.level <= kKeptLevels) {
        points.col(k) = levels[piece.level].col(at);
      } else {
        points.col(k) = levels[0] * patch.ring->Refined(piece.level).row(at).transpose();
      }
    }
    piece.beyond.Fill([&](int k) { return points.col(k); });
    u = piece.u;
    v = piece.v;
    scale = piece.scale;
  }
  return JetOf(points, u, v, scale);
}

namespace {

// A place on a side of a patch as the patch beside it has it, and a step from there.
struct Crossing {
  LimitPlace place;
  double du, dv;
};

Crossing Crossed(
    const QuadTopology& finer, const LimitPlace& place, int side, double du, double dv) {
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
      return {{beside >> 2, r, 0}, dr, dq};
    case 1:
      return {{beside >> 2, 1, r}, -dq, dr};
    case 2:
      return {{beside >> 2, 1 - r, 1}, -dr, -dq};
    default:
      return {{beside >> 2, 0, 1 - r}, dq, -dr};
  }
}

}  // namespace

LimitPlace LimitSurface::Moved(const LimitPlace& from, double du, double dv, int crossings) const {
  const QuadTopology& finer = stencils_.finer_.topology;
  LimitPlace place = from;
  for (;;) {
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
    if (side < 0) return place;
    du *= 1 - share;
    dv *= 1 - share;
    if (finer.IsCrease(4 * place.patch + side)) {
      (side % 2 == 0 ? dv : du) = 0;
      (side % 2 == 0 ? place.v : place.u) = 0;  // where patches have creases
      continue;
    }
    if (crossings-- <= 0) return place;
    const Crossing crossing = Crossed(finer, place, side, du, dv);
    place = crossing.place;
    du = crossing.du;
    dv = crossing.dv;
  }
}

LimitSurface::Creases LimitSurface::CreasesAt(const LimitPlace& place) const {
  const QuadTopology& finer = stencils_.finer_.topology;
  return {place.v == 0 && finer.IsCrease(4 * place.patch),
          place.u == 0 && finer.IsCrease(4 * place.patch + 3)};
}

std::vector<LimitPlace> LimitSurface::Beyond(const LimitPlace& place) const {
  const QuadTopology& finer = stencils_.finer_.topology;
  const Creases creases = CreasesAt(place);
  std::vector<LimitPlace> places;
  if (creases.down) places.push_back(Crossed(finer, place, 0, 0, 0).place);
  if (creases.left) places.push_back(Crossed(finer, place, 3, 0, 0).place);
  return places;
}

}  // namespace batten::internal
