// SPDX-License-Identifier: MIT
// Prints, as a Markdown table, how near whole fits come to shapes that are known: rms and largest
// distance of the noise-free surface from the fitted one, beside the limit σ√(n/N) that noise alone
// sets.
#include <cstdio>
#include <cstdlib>

#include "ablation.h"
#include "batten/fitting/distances.h"
#include "batten/fitting/fit_surface.h"
#include "known_clouds.h"

using namespace batten;
using namespace batten::internal;

namespace {

constexpr double kSigma = 1e-3;

template <typename Height>
void Row(const char* name,
         Height height,
         Eigen::Index count,
         double outliers,
         const SurfaceFitOptions& options) {
  const auto cloud = PointCloud::FromWorld(Scatter(height, count, kSigma, outliers, 20261121));
  const SurfaceFit fit = FitSurface(cloud, options);
  ThreadPool pool(0);
  const Eigen::VectorXd d = DistancesTo(fit.surface, TruthGrid(height, 201), pool).distances;
  const double n = fit.surface.size_u() * fit.surface.size_v();
  std::printf("| %s | %ld | %d × %d | %.2e | %.2e | %.2e | %.2f |\n",
              name,
              static_cast<long>(count),
              fit.surface.size_u(),
              fit.surface.size_v(),
              std::sqrt(d.squaredNorm() / static_cast<double>(d.size())),
              d.cwiseAbs().maxCoeff(),
              kSigma * std::sqrt(n / static_cast<double>(count)),
              fit.report.seconds.total);
  std::fflush(stdout);
}

}  // namespace

int main() {
  std::printf(
      "| cloud (σ = 1e-3) | points | control points | truth rms | truth max | limit σ√(n/N) | "
      "seconds |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  const SurfaceFitOptions defaults;
  SurfaceFitOptions coarse;
  coarse.control_points = {{12, 12}};
  SurfaceFitOptions coarse_linear = coarse;
  coarse_linear.optimize = FreeVariables{};
  Row("plane", Tilted, 20000, 0, defaults);
  Row("Franke", Franke, 20000, 0, defaults);
  Row("Franke", Franke, 100000, 0, defaults);
  Row("Franke", Franke, 1000000, 0, defaults);
  Row("Franke, 1 % outliers", Franke, 20000, 0.01, defaults);
  Row("Franke, 20 % outliers", Franke, 20000, 0.2, defaults);
  Row("Franke, 12 × 12, linear only", Franke, 20000, 0, coarse_linear);
  Row("Franke, 12 × 12, joint stage", Franke, 20000, 0, coarse);
  return EXIT_SUCCESS;
}
