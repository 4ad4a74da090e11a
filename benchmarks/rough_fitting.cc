// SPDX-License-Identifier: MIT
// Prints, as Markdown tables, how whole fits bear what scans are like. Known heights z = f(x, y)
// over the unit square with gaps, clumps, waves of the scanner, layers of outliers, edges and steep
// slopes: rms distance of the truth where there are points, and the greatest anywhere inside the
// points' hull, gaps included. `CLOUD…`: the same of scans, one in ten points held out: their
// distances from the fit of the others, by rms and quantiles.
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "ablation.h"
#include "batten/fitting/distances.h"
#include "batten/fitting/fit_surface.h"
#include "batten/fitting/statistics.h"
#include "batten/io/read_cloud.h"
#include "known_clouds.h"

using namespace batten;
using namespace batten::internal;

namespace {

constexpr double kSigma = 1e-3;
constexpr int kSeeds = 3, kPlaces = 101;

using Height = std::function<double(double, double)>;
using Kept = std::function<bool(double, double)>;

struct RoughCloud {
  std::string name;
  Height height;
  Eigen::Index count = 20000;
  Kept kept = [](double, double) { return true; };
  double waves = 0;     // amplitude of errors that neighbours share, over 0.02
  double layer = 0;     // share of points in a patch of a second sheet, 0.05 above
  double outliers = 0;  // share in the box
};

double Step(double x, double y) { return (x > 0.5 ? 0.1 : 0.0) + 0.05 * y; }
double Ridge(double x, double y) {
  return 0.2 * std::exp(-std::pow((x - 0.4 - 0.2 * y) / 0.02, 2));
}
double Steep(double x, double y) { return 2 * std::tanh(6 * (x - 0.5)) + 0.1 * Franke(x, y); }

std::vector<RoughCloud> Clouds() {
  const auto gap = [](double x, double y) { return std::hypot(x - 0.45, y - 0.55) > 0.18; };
  const auto comb = [](double x, double y) { return y < 0.25 || std::fmod(5 * x, 1.0) < 0.5; };
  const auto lines = [](double, double y) { return std::fmod(30 * y, 1.0) < 0.08; };
  return {{"gap", Franke, 20000, gap},
          {"comb", Franke, 20000, comb},
          {"far scan lines", Franke, 20000, lines},
          {"200 points", Franke, 200},
          {"waves of the scanner", Franke, 50000, Kept(), 3e-3},
          {"waves as large as the noise", Franke, 50000, Kept(), 1e-3},
          {"second layer, 5 %", Franke, 20000, Kept(), 0, 0.05},
          {"gap and 5 % outliers", Franke, 20000, gap, 0, 0, 0.05},
          {"step", Step, 20000},
          {"step, 2 % outliers", Step, 20000, Kept(), 0, 0, 0.02},
          {"narrow ridge", Ridge, 40000},
          {"steep", Steep, 40000},
          {"steep, 5 % outliers", Steep, 40000, Kept(), 0, 0, 0.05}};
}

Eigen::Matrix3Xd PointsOf(const RoughCloud& cloud, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, kSigma);
  Eigen::Matrix3Xd points(3, cloud.count);
  for (auto point : points.colwise()) {
    double x = uniform(engine), y = uniform(engine);
    while (cloud.kept && !cloud.kept(x, y)) x = uniform(engine), y = uniform(engine);
    double z = cloud.height(x, y) + cloud.waves * std::sin(2 * std::numbers::pi * x / 0.02);
    if (uniform(engine) < cloud.layer) {
      x = 0.6 + 0.2 * uniform(engine), y = 0.3 + 0.2 * uniform(engine);
      z = cloud.height(x, y) + 0.05;
    }
    const bool stray = uniform(engine) < cloud.outliers;
    point << x + normal(engine), y + normal(engine), z + normal(engine);
    if (stray) point << uniform(engine), uniform(engine), 1.5 * uniform(engine) - 0.25;
  }
  return points;
}

void PrintKnown() {
  std::printf(
      "| cloud (σ = 1e-3) | points | control points | truth rms | greatest, gaps included | "
      "seconds |\n");
  std::printf("|---|---|---|---|---|---|\n");
  ThreadPool pool(0);
  for (const RoughCloud& cloud : Clouds()) {
    std::vector<double> numbers, rms, greatest, seconds;
    std::string refused;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      try {
        const SurfaceFit fit = FitSurface(PointCloud::FromWorld(PointsOf(cloud, seed)));
        const NurbsSurface whole = fit.surface.WithTrims({});
        double squares = 0, most = 0;
        Eigen::Matrix3Xd truth(3, kPlaces * kPlaces);
        std::vector<char> with_points;
        for (int k = 0; k < truth.cols(); ++k) {
          const double x = 0.01 + 0.98 * (k % kPlaces) / (kPlaces - 1),
                       y = 0.01 + 0.98 * (k / kPlaces) / (kPlaces - 1);
          truth.col(k) << x, y, cloud.height(x, y);
          with_points.push_back(!cloud.kept || cloud.kept(x, y));
        }
        const Eigen::VectorXd off = DistancesTo(whole, truth, pool).distances;
        int count = 0;
        for (Eigen::Index k = 0; k < off.size(); ++k) {
          most = std::max(most, std::abs(off[k]));
          if (with_points[static_cast<size_t>(k)] == 0) continue;
          squares += off[k] * off[k];
          ++count;
        }
        numbers.push_back(whole.size_u() * whole.size_v());
        rms.push_back(std::sqrt(squares / count));
        greatest.push_back(most);
        seconds.push_back(fit.report.seconds.total);
      } catch (const std::exception& failure) {
        refused = std::string("refused: ") + failure.what();
      }
    }
    if (rms.empty()) {
      std::printf("| %s | %td | %s | | | |\n", cloud.name.c_str(), cloud.count, refused.c_str());
      continue;
    }
    std::printf("| %s | %td | %.0f | %.2e | %.2e | %.2f |\n",
                cloud.name.c_str(),
                cloud.count,
                Median(numbers),
                Median(rms),
                Median(greatest),
                Median(seconds));
    std::fflush(stdout);
  }
}

void PrintScans(const std::vector<std::string>& paths) {
  std::printf(
      "\n| scan | points | base | control points | held-out rms | 50 %% | 95 %% | 99 %% | seconds "
      "|\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  ThreadPool pool(0);
  for (const std::string& path : paths) {
    const std::string name = path.substr(path.rfind('/') + 1);
    const PointCloud cloud = ReadCloud({path}).cloud;
    Eigen::Array<bool, Eigen::Dynamic, 1> kept(cloud.size());
    for (Eigen::Index k = 0; k < kept.size(); ++k) kept[k] = k % 10 != 5;
    const PointCloud most = cloud.Subset(kept), rest = cloud.Subset(!kept);
    try {
      SurfaceFitOptions options;
      options.shift = most.origin();
      const SurfaceFit fit = FitSurface(most, options);
      const ErrorSummary error = Summarise(
          DistancesTo(fit.surface.Translated(most.origin() - rest.origin()), rest.points(), pool)
              .distances.cwiseAbs(),
          {});
      std::printf("| %s | %td | %s | %d | %.4g | %.4g | %.4g | %.4g | %.2f |\n",
                  name.c_str(),
                  most.size(),
                  fit.report.geometry.base.c_str(),
                  fit.surface.size_u() * fit.surface.size_v(),
                  error.rms,
                  error.p50,
                  error.p95,
                  error.p99,
                  fit.report.seconds.total);
    } catch (const std::exception& failure) {
      std::printf(
          "| %s | %td | refused: %s | | | | | | |\n", name.c_str(), most.size(), failure.what());
    }
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    PrintKnown();
    if (argc > 1) PrintScans({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rough_fitting: %s\n", error.what());
    return 1;
  }
}
