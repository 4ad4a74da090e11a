// SPDX-License-Identifier: MIT
// Normal equations for the control points of a limit surface.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <utility>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/solid/split_preconditioner.h"
#include "geometry/subdivision/limit_surface.h"

namespace batten::internal {

// A point's demand on the surface: (S(place) − target)ᵀ W (S(place) − target), W is
// weight · (P + tangential (I − P)) and P = n nᵀ for the normal n or, on a crease, P = I − t tᵀ for
// its tangent t, zero at a corner.
struct SurfaceDemand {
  LimitPlace place;
  Eigen::Vector3d target;
  bool on_crease = false;
  Eigen::Vector3d direction;  // n or t
  double weight = 1;
};

// How stiff the control mesh is, relative to the data: against bending, which the shape has, and
// against uneven faces, which it need not have.
struct Stiffness {
  double bending = 0, stretch = 0;
};

// The sparse system (A + P) Δ = r for a step Δ of the control points that move: A from demands, P
// the discrete thin-plate energy of the control mesh, its second differences weighed along the
// vertex's normal by one factor and across it by the other. The pattern is made once.
class SurfaceSystem {
 public:
  // `moves`: by vertex; empty: all do.
  SurfaceSystem(const LimitStencils& stencils, const std::vector<char>& moves, ThreadPool& pool);

  // Sets A and the right side Σ Wᵀ(target − S) of the demands, and P, for the surface of these
  // control points; normals are those of the vertices. Creases bend across their own direction.
  // Factors relative to tr(A) over the trace of a P of factors one.
  void Assemble(const std::vector<SurfaceDemand>& demands,
                double tangential,
                const Eigen::Matrix3Xd& control_points,
                const Eigen::Matrix3Xd& normals,
                const Stiffness& stiffness);

  // The step of all control points from these: what A asks for less the pull of P. Throws
  // std::runtime_error where the system is singular.
  Eigen::Matrix3Xd Step(const Eigen::Matrix3Xd& control_points);

  // The energy of control points, by the P of the last Assemble.
  double Energy(const Eigen::Matrix3Xd& control_points) const;

 private:
  void MakePattern();
  void MakeDifferences();
  template <typename Add>
  void AddInwardCorners(int v, const Add& add) const;
  void AssembleEnergy(const Eigen::Matrix3Xd& control_points,
                      const Eigen::Matrix3Xd& normals,
                      const Stiffness& stiffness);
  std::vector<int> Numbers(int patch) const;
  int BlockOf(int row, int column) const;  // row ≥ column
  Eigen::Matrix3Xd EnergyPull(const Eigen::Matrix3Xd& control_points) const;
  bool Iterate(const Eigen::Matrix3Xd& right, Eigen::Matrix3Xd& x) const;
  Eigen::SparseMatrix<double> Scalars(double of_data, double of_energy) const;

  const LimitStencils& stencils_;
  ThreadPool& pool_;
  std::vector<int> movable_;                   // vertices that move, ascending
  std::vector<int> number_;                    // of each vertex among these; −1: it does not move
  int vertices_;                               // that move
  std::vector<int> column_begin_, block_row_;  // lower triangle of 3 × 3 blocks by columns
  std::vector<std::vector<int>> patch_blocks_;  // for a ≥ b of each support that move: its block
  std::vector<Eigen::Matrix3d> blocks_;         // A
  std::vector<Eigen::Matrix3d> energy_;         // P
  std::vector<double> shares_, plates_;         // both as if the demands' metric were one
  struct Difference {
    int vertex;   // whose normal counts
    bool crease;  // where all directions across the crease do
    double weight;
    std::vector<std::pair<int, double>> row;
    std::vector<int> blocks;  // for a ≥ b of the row that move, by vertices: its block
    Eigen::Matrix3d metric = Eigen::Matrix3d::Zero();

    Eigen::Vector3d At(const Eigen::Matrix3Xd& control_points) const;
  };
  std::vector<Difference> differences_;
  Eigen::Matrix3Xd right_;  // of those that move, as normals_
  Eigen::SparseMatrix<double> matrix_;
  SplitPreconditioner preconditioner_;
  Eigen::Matrix3Xd normals_;
  double tangential_ = 0;
  Stiffness stiffness_;
  double energy_trace_ = 0;  // of P with factors one
};

}  // namespace batten::internal
