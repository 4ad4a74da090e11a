// SPDX-License-Identifier: MIT
// Orthogonal distance fitting as Ceres' manual builds such problems: one residual S(u,v) − q a
// point, its parameters (u,v) a block of their own that SPARSE_SCHUR eliminates, every control
// point a block, analytic derivatives, knot cells frozen at the start. Prints seconds an iteration
// and writes the surface. Files are those of sisl_feet.c. Links nothing of batten. Usage:
// ceres_blocks SHEET.f64 CLOUD.f64 STARTS.f64 THREADS RESULT.f64
#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "comparator.h"

namespace {

constexpr int kDegree = 3, kFunctions = kDegree + 1, kIterations = 10;

struct Basis {
  std::vector<double> knots;
  int size = 0;

  double lower() const { return knots[kDegree]; }
  double upper() const { return knots[static_cast<size_t>(size)]; }

  int Span(double t) const {
    const auto end = knots.begin() + size;
    const auto found = std::upper_bound(knots.begin() + kDegree, end, t);
    return static_cast<int>(found - knots.begin()) - 1;
  }
};

// The cubic pieces of one span and their slopes, anywhere. [Cox 1972, de Boor 1972]
struct Pieces {
  std::array<double, kFunctions> value, slope;
};

Pieces PiecesAt(const Basis& basis, int span, double t) {
  const double* u = basis.knots.data() + span;
  Pieces pieces{{1, 0, 0, 0}, {0, 0, 0, 0}};
  for (int d = 1; d <= kDegree; ++d) {
    for (int r = d; r >= 0; --r) {
      double value = 0, slope = 0;
      if (r > 0) {
        const double width = u[r] - u[r - d], share = (t - u[r - d]) / width;
        value += share * pieces.value[r - 1];
        slope += pieces.value[r - 1] / width + share * pieces.slope[r - 1];
      }
      if (r < d) {
        const double width = u[r + 1] - u[r + 1 - d], share = (u[r + 1] - t) / width;
        value += share * pieces.value[r];
        slope += share * pieces.slope[r] - pieces.value[r] / width;
      }
      pieces.value[r] = value;
      pieces.slope[r] = slope;
    }
  }
  return pieces;
}

// Parameters: (u,v), then the cell's control points, v fastest.
class OffPoint : public ceres::CostFunction {
 public:
  OffPoint(const Basis& u, const Basis& v, const double* start, const double* point)
      : u_(u), v_(v), span_u_(u.Span(start[0])), span_v_(v.Span(start[1])), point_(point) {
    set_num_residuals(3);
    mutable_parameter_block_sizes()->push_back(2);
    for (int k = 0; k < kFunctions * kFunctions; ++k) mutable_parameter_block_sizes()->push_back(3);
  }

  int first() const { return (span_u_ - kDegree) * v_.size + span_v_ - kDegree; }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const Pieces u = PiecesAt(u_, span_u_, parameters[0][0]);
    const Pieces v = PiecesAt(v_, span_v_, parameters[0][1]);
    double across[3] = {}, along[3] = {};
    for (int d = 0; d < 3; ++d) residuals[d] = -point_[d];
    for (int k = 0; k < kFunctions * kFunctions; ++k) {
      const int i = k / kFunctions, j = k % kFunctions;
      const double value = u.value[i] * v.value[j];
      for (int d = 0; d < 3; ++d) {
        const double x = parameters[k + 1][d];
        residuals[d] += value * x;
        across[d] += u.slope[i] * v.value[j] * x;
        along[d] += u.value[i] * v.slope[j] * x;
      }
      if (!jacobians || !jacobians[k + 1]) continue;
      for (int e = 0; e < 9; ++e) jacobians[k + 1][e] = e % 4 == 0 ? value : 0;
    }
    if (!jacobians || !jacobians[0]) return true;
    for (int d = 0; d < 3; ++d) {
      jacobians[0][2 * d] = across[d];
      jacobians[0][2 * d + 1] = along[d];
    }
    return true;
  }

 private:
  const Basis &u_, &v_;
  int span_u_, span_v_;
  const double* point_;
};

struct Sheet {
  Basis u, v;
  std::vector<double> numbers;  // of the whole file
  double* net() { return numbers.data() + 2 + u.knots.size() + v.knots.size(); }
};

std::vector<double> Read(const char* path) {
  size_t count = 0;
  double* numbers = ReadDoubles(path, &count);
  if (!numbers) return {};
  std::vector<double> all(numbers, numbers + count);
  std::free(numbers);
  return all;
}

Sheet SheetOf(std::vector<double> numbers) {
  Sheet sheet;
  sheet.numbers = std::move(numbers);
  const double* next = sheet.numbers.data() + 2;
  for (int d = 0; d < 2; ++d) {
    Basis& basis = d == 0 ? sheet.u : sheet.v;
    basis.size = static_cast<int>(sheet.numbers[static_cast<size_t>(d)]);
    basis.knots.assign(next, next + basis.size + kFunctions);
    next += basis.size + kFunctions;
  }
  return sheet;
}

ceres::Solver::Summary Optimise(Sheet& sheet,
                                const std::vector<double>& cloud,
                                std::vector<double>& starts,
                                int threads) {
  ceres::Problem problem;
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  options.max_num_iterations = kIterations;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 0;
  options.num_threads = threads;
  options.logging_type = ceres::SILENT;
  for (size_t k = 0; k < cloud.size() / 3; ++k) {
    double* at = starts.data() + 2 * k;
    auto* cost = new OffPoint(sheet.u, sheet.v, at, cloud.data() + 3 * k);
    std::vector<double*> blocks{at};
    for (int i = 0; i < kFunctions; ++i) {
      for (int j = 0; j < kFunctions; ++j) {
        blocks.push_back(sheet.net() + 3 * (cost->first() + i * sheet.v.size + j));
      }
    }
    problem.AddResidualBlock(cost, nullptr, blocks);
    const Basis* bases[] = {&sheet.u, &sheet.v};
    for (int d = 0; d < 2; ++d) {
      problem.SetParameterLowerBound(at, d, bases[d]->lower());
      problem.SetParameterUpperBound(at, d, bases[d]->upper());
    }
    options.linear_solver_ordering->AddElementToGroup(at, 0);
  }
  for (int k = 0; k < sheet.u.size * sheet.v.size; ++k) {
    double* point = sheet.net() + 3 * k;
    if (problem.HasParameterBlock(point))
      options.linear_solver_ordering->AddElementToGroup(point, 1);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "usage: ceres_blocks SHEET.f64 CLOUD.f64 STARTS.f64 THREADS RESULT.f64\n");
    return 2;
  }
  std::vector<double> numbers = Read(argv[1]), starts = Read(argv[3]);
  const std::vector<double> cloud = Read(argv[2]);
  if (numbers.size() < 2 || cloud.empty() || cloud.size() / 3 != starts.size() / 2) {
    std::fprintf(stderr, "ceres_blocks: can't use these files\n");
    return 1;
  }
  Sheet sheet = SheetOf(std::move(numbers));
  const Seconds begin = Now();
  const ceres::Solver::Summary summary = Optimise(sheet, cloud, starts, std::atoi(argv[4]));
  const Seconds took = Since(begin);
  const int steps = std::max(1, summary.num_successful_steps + summary.num_unsuccessful_steps - 1);
  FILE* out = std::fopen(argv[5], "wb");
  const size_t wanted = sheet.numbers.size();
  if (!out || std::fwrite(sheet.numbers.data(), sizeof(double), wanted, out) != wanted ||
      std::fclose(out) != 0) {
    std::fprintf(stderr, "ceres_blocks: can't write %s\n", argv[5]);
    return 1;
  }
  std::printf("wall=%.6g cpu=%.6g steps=%d cost=%.6g\n",
              took.wall / steps,
              took.cpu / steps,
              steps,
              2 * summary.final_cost);
  return 0;
}
