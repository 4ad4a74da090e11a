// SPDX-License-Identifier: MIT
// Builds and owns the tables that the evaluation kernels read. Internal to the evaluators.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/evaluation/kernel_tables.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// Doubles that begin a cache line; they do not move with their owner.
class AlignedDoubles {
 public:
  AlignedDoubles() = default;
  explicit AlignedDoubles(size_t count) : memory_(count + kLine) {}
  AlignedDoubles(AlignedDoubles&&) = default;
  AlignedDoubles& operator=(AlignedDoubles&&) = default;
  double* data() {
    const auto address = reinterpret_cast<std::uintptr_t>(memory_.data());
    return memory_.data() + (kBytes - address % kBytes) % kBytes / sizeof(double);
  }

 private:
  static constexpr size_t kBytes = 64, kLine = kBytes / sizeof(double);
  std::vector<double> memory_;
};

// One direction, with the basis functions and their derivatives up to `order`. The basis must live
// as long as the table is used.
class AxisStorage {
 public:
  AxisStorage(const SplineBasis& basis, int order);
  AxisStorage(AxisStorage&&) = default;
  AxisStorage& operator=(AxisStorage&&) = default;
  const AxisTable& table() const { return table_; }

 private:
  void FillCells();

  std::vector<int> cell_spans_, first_point_;
  std::vector<TableSpan> spans_;
  AlignedDoubles basis_;
  AxisTable table_{};
};

// The functions that do not vanish on span [knots[i], knots[i+1]] as polynomials in a ∈ [−1, 1]:
// entry (r, k) is the coefficient of a^k in N_{i-p+r}. Exact to the last digit but few.
Eigen::MatrixXd MonomialBasis(const SplineBasis& basis, int span);

// The surface must live as long as the table is used; so must the curve below.
class SurfaceStorage {
 public:
  explicit SurfaceStorage(const NurbsSurface& surface);
  const SurfaceTable& table() const { return table_; }

 private:
  void FillNet(const NurbsSurface& surface);
  void FillPatches(const NurbsSurface& surface);
  // Fills one patch from the rows of the net that Mu has turned into polynomials in a. Returns the
  // sum of its coefficients against the extent and the smallest weight: so much larger than in a
  // sum of positive terms are its rounding errors.
  double FillPatch(const Eigen::MatrixXd& rows,
                   const Eigen::MatrixXd& Mv,
                   int first,
                   double least_weight,
                   double* patch) const;

  AxisStorage u_, v_;
  AlignedDoubles net_, patches_;
  SurfaceTable table_{};
};

template <int Dim>
class CurveStorage {
 public:
  explicit CurveStorage(const NurbsCurve<Dim>& curve);
  const CurveTable& table() const { return table_; }

 private:
  AxisStorage axis_;
  AlignedDoubles pieces_;
  CurveTable table_{};
};

extern template class CurveStorage<2>;
extern template class CurveStorage<3>;

}  // namespace batten::internal
