// SPDX-License-Identifier: MIT
#include "fitting/solid/surface_system.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "fitting/core/shared_constants.h"

namespace batten::internal {
namespace {

// Normals of neighbours differ: as much of what is along them counts across a vertex's own, of
// the data, and the other way round, of the stiffness. Without the latter parts without points
// take more steps than a direct solution does.
constexpr double kLeak = 0.05;

}  // namespace

SurfaceSystem::SurfaceSystem(const LimitStencils& stencils,
                             const std::vector<char>& moves,
                             ThreadPool& pool)
    : stencils_(stencils), pool_(pool), number_(std::size_t(stencils.mesh().vertices()), -1) {
  for (int v = 0; v < stencils.mesh().vertices(); ++v) {
    if (!moves.empty() && !moves[std::size_t(v)]) continue;
    number_[std::size_t(v)] = static_cast<int>(movable_.size());
    movable_.push_back(v);
  }
  vertices_ = static_cast<int>(movable_.size());
  MakePattern();
  MakeDifferences();
}

void SurfaceSystem::MakePattern() {
  std::vector<std::set<int>> rows(vertices_);
  for (int patch = 0; patch < stencils_.patches(); ++patch) {
    const std::vector<int> support = Numbers(patch);
    for (std::size_t b = 0; b < support.size(); ++b) {
      rows[support[b]].insert(support.begin() + std::ptrdiff_t(b), support.end());
    }
  }
  column_begin_.assign(1, 0);
  for (const std::set<int>& column : rows) {
    block_row_.insert(block_row_.end(), column.begin(), column.end());
    column_begin_.push_back(static_cast<int>(block_row_.size()));
  }
  blocks_.assign(block_row_.size(), Eigen::Matrix3d::Zero());
  energy_ = blocks_;
  shares_.assign(block_row_.size(), 0.0);
  plates_ = shares_;
  patch_blocks_.resize(stencils_.patches());
  for (int patch = 0; patch < stencils_.patches(); ++patch) {
    const std::vector<int> support = Numbers(patch);
    for (std::size_t a = 0; a < support.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        patch_blocks_[patch].push_back(BlockOf(support[a], support[b]));
      }
    }
  }
  // Columns 3v + c hold the rows of their blocks from the diagonal on.
  std::vector<int> counts(3 * vertices_);
  for (int v = 0; v < vertices_; ++v) {
    const int below = 3 * (column_begin_[v + 1] - column_begin_[v]);
    for (int c = 0; c < 3; ++c) counts[3 * v + c] = below - c;
  }
  matrix_.resize(3 * vertices_, 3 * vertices_);
  matrix_.reserve(counts);
  for (int v = 0; v < vertices_; ++v) {
    for (int c = 0; c < 3; ++c) {
      for (int k = column_begin_[v]; k < column_begin_[v + 1]; ++k) {
        for (int r = block_row_[k] == v ? c : 0; r < 3; ++r) {
          matrix_.insert(3 * block_row_[k] + r, 3 * v + c) = 1;
        }
      }
    }
  }
  matrix_.makeCompressed();
}

// Of the vertices that move in the support of a patch, ascending.
std::vector<int> SurfaceSystem::Numbers(int patch) const {
  std::vector<int> numbers;
  for (const int vertex : stencils_.Support(patch)) {
    if (number_[std::size_t(vertex)] >= 0) numbers.push_back(number_[std::size_t(vertex)]);
  }
  return numbers;
}

int SurfaceSystem::BlockOf(int row, int column) const {
  const auto begin = block_row_.begin() + column_begin_[column];
  const auto end = block_row_.begin() + column_begin_[column + 1];
  return static_cast<int>(std::lower_bound(begin, end, row) - block_row_.begin());
}

// Second differences over vertices of four edges, the distance from the mean of the neighbours over
// others, and the twist of every face twice: on a grid the bending energy of a thin plate. Creases
// are thin rods, and no plate goes over them.
void SurfaceSystem::MakeDifferences() {
  const QuadTopology& mesh = stencils_.mesh();
  const auto add = [&](int vertex, std::vector<std::pair<int, double>> row, double weight) {
    std::sort(row.begin(), row.end());
    std::vector<int> moving;
    for (const auto& [other, factor] : row) {
      const int number = number_[std::size_t(other)];
      if (number < 0) continue;
      moving.push_back(number);
      energy_trace_ += 3 * weight * factor * factor;
    }
    if (moving.empty()) return;
    const bool crease = mesh.Creases(vertex) > 0 && row.size() == 3 && !mesh.IsCorner(vertex);
    Difference difference{vertex, crease, weight, std::move(row), {}};
    for (std::size_t a = 0; a < moving.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        difference.blocks.push_back(BlockOf(moving[a], moving[b]));
      }
    }
    differences_.push_back(std::move(difference));
  };
  for (int v = 0; v < mesh.vertices(); ++v) {
    std::vector<int> around;
    int h = mesh.Outgoing(v);
    for (int k = 0; k < mesh.Valence(v); ++k, h = mesh.Turned(h)) {
      if (mesh.Creases(v) > 0 && !mesh.IsCrease(h)) continue;
      around.push_back(mesh.Origin(QuadTopology::Next(h)));
    }
    if (mesh.Creases(v) > 0) {
      AddInwardCorners(v, add);
      if (!mesh.IsCorner(v)) add(v, {{around[0], 1}, {v, -2}, {around[1], 1}}, 1);
      continue;
    }
    if (around.size() == 4) {
      add(v, {{around[0], 1}, {v, -2}, {around[2], 1}}, 1);
      add(v, {{around[1], 1}, {v, -2}, {around[3], 1}}, 1);
      continue;
    }
    std::vector<std::pair<int, double>> row = {{v, -1}};
    for (const int other : around) row.emplace_back(other, 1.0 / double(around.size()));
    constexpr double kOfFour = 8;  // what two second differences weigh on a bowl
    add(v, row, kOfFour);
  }
  for (int face = 0; face < mesh.faces(); ++face) {
    const auto corner = mesh.corners().col(face);
    // Normals on creases are of no side.
    int smooth = 0;
    while (smooth < 3 && mesh.Creases(corner[smooth]) > 0) ++smooth;
    add(corner[mesh.Creases(corner[smooth]) > 0 ? 0 : smooth],
        {{corner[0], 1}, {corner[1], -1}, {corner[2], 1}, {corner[3], -1}},
        2);
  }
}

// Three faces at a corner are a grid without one of its quarters.
template <typename Add>
void SurfaceSystem::AddInwardCorners(int v, const Add& add) const {
  const QuadTopology& mesh = stencils_.mesh();
  int h = mesh.Outgoing(v);
  for (int k = 0; k < mesh.Valence(v); ++k, h = mesh.Turned(h)) {
    const QuadFan fan = mesh.FanOf(h);
    if (fan.first != h || !fan.corner || fan.sectors != 3) continue;
    std::array<int, 4> ends{};
    int edge = h;
    for (int& end : ends) {
      end = mesh.Origin(QuadTopology::Next(edge));
      edge = mesh.Turned(edge);
    }
    add(v, {{ends[0], 1}, {v, -2}, {ends[2], 1}}, 1);
    add(v, {{ends[1], 1}, {v, -2}, {ends[3], 1}}, 1);
  }
}

void SurfaceSystem::AssembleEnergy(const Eigen::Matrix3Xd& control_points,
                                   const Eigen::Matrix3Xd& normals,
                                   const Stiffness& stiffness) {
  double data_trace = 0;
  for (int v = 0; v < vertices_; ++v) data_trace += blocks_[column_begin_[v]].trace();
  const double scale = data_trace / energy_trace_;
  std::fill(energy_.begin(), energy_.end(), Eigen::Matrix3d::Zero());
  std::fill(plates_.begin(), plates_.end(), 0.0);
  for (Difference& difference : differences_) {
    Eigen::Matrix3d across;
    if (difference.crease) {
      Eigen::Vector3d along = Eigen::Vector3d::Zero();
      double sign = 1;
      for (const auto& [vertex, factor] : difference.row) {
        if (vertex == difference.vertex) continue;
        along += sign * control_points.col(vertex);
        sign = -1;
      }
      along.stableNormalize();
      across = Eigen::Matrix3d::Identity() - along * along.transpose();
    } else {
      const Eigen::Vector3d normal = normals.col(difference.vertex);
      across = normal * normal.transpose();
    }
    difference.metric = scale * difference.weight *
                        (stiffness.stretch * Eigen::Matrix3d::Identity() +
                         (stiffness.bending - stiffness.stretch) * across);
    std::size_t at = 0;
    for (std::size_t a = 0; a < difference.row.size(); ++a) {
      if (number_[std::size_t(difference.row[a].first)] < 0) continue;
      for (std::size_t b = 0; b <= a; ++b) {
        if (number_[std::size_t(difference.row[b].first)] < 0) continue;
        const double product = difference.row[a].second * difference.row[b].second;
        energy_[difference.blocks[at]] += product * difference.metric;
        plates_[difference.blocks[at++]] += product * scale * difference.weight;
      }
    }
  }
}

void SurfaceSystem::Assemble(const std::vector<SurfaceDemand>& demands,
                             double tangential,
                             const Eigen::Matrix3Xd& control_points,
                             const Eigen::Matrix3Xd& normals,
                             const Stiffness& stiffness) {
  std::fill(blocks_.begin(), blocks_.end(), Eigen::Matrix3d::Zero());
  std::fill(shares_.begin(), shares_.end(), 0.0);
  right_ = Eigen::Matrix3Xd::Zero(3, vertices_);
  std::vector<Eigen::VectorXd> all_weights(demands.size());
  pool_.For(std::ptrdiff_t(demands.size()),
            kSlowPointsPerTask,
            [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
              for (std::ptrdiff_t k = begin; k < end; ++k) {
                const LimitPlace& place = demands[std::size_t(k)].place;
                if (!stencils_.Support(place.patch).empty())
                  all_weights[std::size_t(k)] = stencils_.WeightsAt(place, 1);
              }
            });
  for (std::size_t k = 0; k < demands.size(); ++k) {
    const SurfaceDemand& demand = demands[k];
    const Eigen::VectorXd& weights = all_weights[k];
    const auto support = stencils_.Support(demand.place.patch);
    if (!(demand.weight > 0) || support.empty()) continue;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (std::size_t a = 0; a < support.size(); ++a) {
      point += weights[Eigen::Index(a)] * control_points.col(support[a]);
    }
    Eigen::Matrix3d along = demand.direction * demand.direction.transpose();
    if (demand.on_crease) along = Eigen::Matrix3d::Identity() - along;
    const Eigen::Matrix3d metric =
        demand.weight * (along + tangential * (Eigen::Matrix3d::Identity() - along));
    const Eigen::Vector3d pull = metric * (demand.target - point);
    const std::vector<int>& blocks = patch_blocks_[demand.place.patch];
    std::size_t at = 0;
    for (std::size_t a = 0; a < support.size(); ++a) {
      if (number_[std::size_t(support[a])] < 0) continue;
      right_.col(number_[std::size_t(support[a])]) += weights[Eigen::Index(a)] * pull;
      const Eigen::Matrix3d row = weights[Eigen::Index(a)] * metric;
      const double share = weights[Eigen::Index(a)] * demand.weight;
      for (std::size_t b = 0; b <= a; ++b) {
        if (number_[std::size_t(support[b])] < 0) continue;
        blocks_[blocks[at]] += weights[Eigen::Index(b)] * row;
        shares_[blocks[at++]] += weights[Eigen::Index(b)] * share;
      }
    }
  }
  AssembleEnergy(control_points, normals, stiffness);
  normals_ = normals(Eigen::all, movable_);
  tangential_ = tangential;
  stiffness_ = stiffness;
  double* value = matrix_.valuePtr();
  for (int v = 0; v < vertices_; ++v) {
    for (int c = 0; c < 3; ++c) {
      for (int k = column_begin_[v]; k < column_begin_[v + 1]; ++k) {
        for (int r = block_row_[k] == v ? c : 0; r < 3; ++r) {
          *value++ = blocks_[k](r, c) + energy_[k](r, c);
        }
      }
    }
  }
}

Eigen::Vector3d SurfaceSystem::Difference::At(const Eigen::Matrix3Xd& control_points) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& [vertex, factor] : row) sum += factor * control_points.col(vertex);
  return sum;
}

// P times control points, of those that move.
Eigen::Matrix3Xd SurfaceSystem::EnergyPull(const Eigen::Matrix3Xd& control_points) const {
  Eigen::Matrix3Xd pull = Eigen::Matrix3Xd::Zero(3, vertices_);
  for (const Difference& difference : differences_) {
    const Eigen::Vector3d force = difference.metric * difference.At(control_points);
    for (const auto& [vertex, factor] : difference.row) {
      const int number = number_[std::size_t(vertex)];
      if (number >= 0) pull.col(number) += factor * force;
    }
  }
  return pull;
}

Eigen::Matrix3Xd SurfaceSystem::Step(const Eigen::Matrix3Xd& control_points) {
  const Eigen::Matrix3Xd right = right_ - EnergyPull(control_points);
  Eigen::Matrix3Xd step = Eigen::Matrix3Xd::Zero(3, vertices_);
  const auto of_all = [&] {
    Eigen::Matrix3Xd all = Eigen::Matrix3Xd::Zero(3, control_points.cols());
    all(Eigen::all, movable_) = step;
    return all;
  };
  if (preconditioner_.Factor(Scalars(1, stiffness_.bending + kLeak * stiffness_.stretch),
                             Scalars(tangential_ + kLeak, stiffness_.stretch),
                             pool_) &&
      Iterate(right, step)) {
    return of_all();
  }
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(matrix_);
  if (factor.info() != Eigen::Success) {
    throw std::runtime_error("the points do not determine the surface");
  }
  step = factor.solve(right.reshaped()).reshaped(3, vertices_);
  return of_all();
}

Eigen::SparseMatrix<double> SurfaceSystem::Scalars(double of_data, double of_energy) const {
  Eigen::SparseMatrix<double> matrix(vertices_, vertices_);
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < vertices_; ++v) {
    for (int k = column_begin_[v]; k < column_begin_[v + 1]; ++k) {
      entries.emplace_back(block_row_[k], v, of_data * shares_[k] + of_energy * plates_[k]);
    }
  }
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// Conjugate gradients. [Hestenes & Stiefel 1952]
bool SurfaceSystem::Iterate(const Eigen::Matrix3Xd& right, Eigen::Matrix3Xd& x) const {
  constexpr int kMost = 200;
  constexpr double kExact = 1e-2;  // relative: steps are followed by others
  const auto matrix = matrix_.selfadjointView<Eigen::Lower>();
  Eigen::Matrix3Xd residual = right;
  Eigen::Matrix3Xd preconditioned = preconditioner_.Apply(normals_, residual);
  Eigen::Matrix3Xd way = preconditioned;
  double norm = residual.cwiseProduct(preconditioned).sum();
  const double enough = kExact * kExact * norm;
  for (int round = 0; round < kMost && norm > 0; ++round) {
    const Eigen::VectorXd product = matrix * way.reshaped();
    const double length = norm / way.reshaped().dot(product);
    if (!std::isfinite(length)) return false;
    x += length * way;
    residual -= length * product.reshaped(3, vertices_);
    preconditioned = preconditioner_.Apply(normals_, residual);
    const double next = residual.cwiseProduct(preconditioned).sum();
    if (next <= enough) return true;
    way = preconditioned + (next / norm) * way;
    norm = next;
  }
  return !(norm > 0);
}

double SurfaceSystem::Energy(const Eigen::Matrix3Xd& control_points) const {
  double energy = 0;
  for (const Difference& difference : differences_) {
    const Eigen::Vector3d bend = difference.At(control_points);
    energy += bend.dot(difference.metric * bend);
  }
  return energy;
}

}  // namespace batten::internal
