// SPDX-License-Identifier: MIT
#include "batten/geometry/surface_evaluator.h"

#include <algorithm>
#include <cstddef>

#include "geometry/evaluation/evaluation_kernels.h"
#include "geometry/evaluation/evaluation_table.h"

namespace batten {
using namespace internal;
namespace {

// Blocks that threads take: large against the cost of taking one, small against a cache.
constexpr Eigen::Index kSurfaceBlock = 4096;

// The kernels write jets as rows of doubles.
static_assert(sizeof(SurfaceJet) == 18 * sizeof(double) && offsetof(SurfaceJet, point) == 0 &&
              offsetof(SurfaceJet, duv) == 12 * sizeof(double) &&
              offsetof(SurfaceJet, dvv) == 15 * sizeof(double));

double* Raw(SurfaceJet* jets) { return reinterpret_cast<double*>(jets); }

// Rows [begin, end) of a grid. Normals that the kernel leaves open are judged one by one.
void FillRows(const NurbsSurface& surface,
              const SurfaceTable& table,
              std::span<const double> us,
              std::span<const double> vs,
              Eigen::Index begin,
              Eigen::Index end,
              SurfaceGrid& grid) {
  const Eigen::Index n = static_cast<Eigen::Index>(vs.size()), first = begin * n;
  const size_t open = EvaluateGrid(table,
                                   us.data() + begin,
                                   static_cast<size_t>(end - begin),
                                   vs.data(),
                                   vs.size(),
                                   grid.points.data() + 3 * first,
                                   grid.normals.data() + 3 * first);
  if (open == 0) return;
  for (Eigen::Index i = begin; i < end; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      auto normal = grid.normals.col(i * n + j);
      if (normal != Eigen::Vector3d::Zero()) continue;
      const auto exact = surface.NormalAt(us[static_cast<size_t>(i)], vs[static_cast<size_t>(j)]);
      if (exact) normal = *exact;
    }
  }
}

}  // namespace

struct SurfaceEvaluator::State {
  explicit State(NurbsSurface given) : surface(std::move(given)), storage(surface) {}
  NurbsSurface surface;
  SurfaceStorage storage;
};

SurfaceEvaluator::SurfaceEvaluator(NurbsSurface surface)
    : state_(std::make_shared<const State>(std::move(surface))) {}

const NurbsSurface& SurfaceEvaluator::surface() const { return state_->surface; }

const SurfaceTable& SurfaceEvaluator::table() const { return state_->storage.table(); }

Eigen::Vector3d SurfaceEvaluator::At(double u, double v) const {
  const double uv[2] = {u, v};
  Eigen::Vector3d point;
  EvaluatePoints(table(), uv, 1, point.data());
  return point;
}

SurfaceJet SurfaceEvaluator::JetAt(double u, double v) const {
  const double uv[2] = {u, v};
  SurfaceJet jet;
  EvaluateJets(table(), uv, 1, Raw(&jet));
  return jet;
}

void SurfaceEvaluator::Points(const Eigen::Matrix2Xd& parameters, Eigen::Matrix3Xd& points) const {
  points.resize(3, parameters.cols());
  EvaluatePoints(table(), parameters.data(), static_cast<size_t>(parameters.cols()), points.data());
}

void SurfaceEvaluator::Points(const Eigen::Matrix2Xd& parameters,
                              Eigen::Matrix3Xd& points,
                              ThreadPool& pool) const {
  points.resize(3, parameters.cols());
  pool.For(parameters.cols(), kSurfaceBlock, [&](Eigen::Index begin, Eigen::Index end) {
    EvaluatePoints(table(),
                   parameters.data() + 2 * begin,
                   static_cast<size_t>(end - begin),
                   points.data() + 3 * begin);
  });
}

void SurfaceEvaluator::Jets(const Eigen::Matrix2Xd& parameters,
                            std::vector<SurfaceJet>& jets) const {
  jets.resize(static_cast<size_t>(parameters.cols()));
  EvaluateJets(table(), parameters.data(), jets.size(), Raw(jets.data()));
}

void SurfaceEvaluator::Jets(const Eigen::Matrix2Xd& parameters,
                            std::vector<SurfaceJet>& jets,
                            ThreadPool& pool) const {
  jets.resize(static_cast<size_t>(parameters.cols()));
  pool.For(parameters.cols(), kSurfaceBlock, [&](Eigen::Index begin, Eigen::Index end) {
    EvaluateJets(table(),
                 parameters.data() + 2 * begin,
                 static_cast<size_t>(end - begin),
                 Raw(jets.data() + begin));
  });
}

std::optional<Eigen::Vector3d> SurfaceEvaluator::NormalAt(double u, double v) const {
  Eigen::Vector3d point, normal;
  if (EvaluateGrid(table(), &u, 1, &v, 1, point.data(), normal.data()) == 0) return normal;
  return surface().NormalAt(u, v);
}

void SurfaceEvaluator::Grid(std::span<const double> us,
                            std::span<const double> vs,
                            SurfaceGrid& grid) const {
  const Eigen::Index rows = static_cast<Eigen::Index>(us.size());
  grid.points.resize(3, rows * static_cast<Eigen::Index>(vs.size()));
  grid.normals.resize(3, grid.points.cols());
  FillRows(surface(), table(), us, vs, 0, rows, grid);
}

void SurfaceEvaluator::Grid(std::span<const double> us,
                            std::span<const double> vs,
                            SurfaceGrid& grid,
                            ThreadPool& pool) const {
  const Eigen::Index rows = static_cast<Eigen::Index>(us.size());
  const Eigen::Index n = static_cast<Eigen::Index>(vs.size());
  grid.points.resize(3, rows * n);
  grid.normals.resize(3, rows * n);
  const Eigen::Index block =
      std::max<Eigen::Index>(1, kSurfaceBlock / std::max<Eigen::Index>(1, n));
  pool.For(rows, block, [&](Eigen::Index begin, Eigen::Index end) {
    FillRows(surface(), table(), us, vs, begin, end, grid);
  });
}

}  // namespace batten
