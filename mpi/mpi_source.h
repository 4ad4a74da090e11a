// SPDX-License-Identifier: MIT
// Points that the processes of an MPI job share.
#pragma once

#include <cstdint>

#include "batten/fitting/point_source.h"

namespace batten {

// This process's share of the points, with sums over all processes of MPI_COMM_WORLD: collective
// calls, to be made by all of them alike. Sums are taken in the order of ranks, pair by pair
// (MPI_Reduce of an operation that does not commute), so that the same number of processes gives
// the same bytes. MPI is initialised while one lives.
class MpiSource : public PointSource {
 public:
  // `own` is referred to.
  explicit MpiSource(PointSource& own) : own_(own) {}

  void Pass(const TakePoints& take) override { own_.Pass(take); }
  void Sum(std::span<double> numbers) override;
  std::vector<double> Gathered(std::vector<double> numbers) override;
  bool shared() const override;

  // Bytes that this process has handed to collective calls.
  static std::int64_t bytes();

 private:
  PointSource& own_;
};

}  // namespace batten
