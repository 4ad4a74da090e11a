// SPDX-License-Identifier: MIT
// Prints, as a Markdown table, one row for each of many clouds that nobody chose: heights, bent
// sheets, pieces of tubes and balls, and curves with and without corners, each drawn with a number
// of points, noise (often none) and outliers of its own; rms and largest distance of the noise-free
// shape from the fit with nothing given. For `ablate`, which counts the rows a rule moves.
//   random_fitting [--seeds N] [--first SEED]
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "ablation.h"
#include "batten/fitting/distances.h"
#include "batten/fitting/fit_curve.h"
#include "batten/fitting/fit_surface.h"
#include "batten/geometry/foot_point.h"
#include "draw.h"

using namespace batten;
using namespace batten::internal;

namespace batten::internal {
namespace {

using std::numbers::pi;

using Sheet = std::function<Eigen::Vector3d(double, double)>;  // of the unit square
using Curve = std::function<Eigen::Vector3d(double)>;          // of 0 … 1

// A sum of waves, of size 1 at most.
std::function<double(double, double)> Waves(Draw& draw, int count, double fastest) {
  std::vector<Eigen::Vector4d> waves;
  for (int k = 0; k < count; ++k)
    waves.emplace_back(draw.Between(-fastest, fastest),
                       draw.Between(-fastest, fastest),
                       draw.Between(0, 2 * pi),
                       draw.Between(0.2, 1) / count);
  return [waves](double x, double y) {
    double z = 0;
    for (const Eigen::Vector4d& w : waves) z += w[3] * std::sin(w[0] * x + w[1] * y + w[2]);
    return z;
  };
}

Sheet HeightOf(Draw& draw) {
  const auto waves = Waves(draw, 5, 9);
  const double height = draw.Between(0.05, 0.3);
  return [=](double x, double y) { return Eigen::Vector3d(x, y, height * waves(x, y)); };
}

Sheet BentOf(Draw& draw) {
  const auto waves = Waves(draw, 3, 6);
  const double bend = draw.Between(1, 5), rough = draw.Between(0, 0.04),
               width = draw.Between(0.4, 1.2);
  return [=](double x, double y) {
    const double a = bend * (x - 0.5), r = 1 / bend + rough * waves(x, y);
    return Eigen::Vector3d(r * std::sin(a), width * y, r * std::cos(a));
  };
}

Sheet TubeOf(Draw& draw) {
  const auto waves = Waves(draw, 3, 5);
  const double length = draw.Between(1, 3), rough = draw.Between(0, 0.05);
  return [=](double x, double y) {
    const double a = 2 * pi * x, r = 0.4 + rough * waves(std::sin(a), std::cos(a) + y);
    return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), length * y);
  };
}

Sheet BallOf(Draw& draw) {
  const auto waves = Waves(draw, 3, 3);
  const double rough = draw.Between(0, 0.08);
  return [=](double x, double y) {
    const double a = 2 * pi * x, z = 1 - 2 * y, r = std::sqrt(std::max(0.0, 1 - z * z));
    const Eigen::Vector3d way(r * std::cos(a), r * std::sin(a), z);
    return Eigen::Vector3d((0.5 + rough * waves(way[0] + way[2], way[1])) * way);
  };
}

Curve WaveOf(Draw& draw) {
  const auto waves = Waves(draw, 4, 14);
  const double height = draw.Between(0.05, 0.4), lift = draw.OneOf({0.0, 0.3});
  return [=](double t) { return Eigen::Vector3d(t, height * waves(t, 0), lift * waves(0, t)); };
}

Curve PolygonOf(Draw& draw) {
  const int legs = static_cast<int>(draw.Between(2, 7));
  std::vector<Eigen::Vector3d> corners;
  double way = 0;
  corners.emplace_back(0, 0, 0);
  for (int k = 0; k < legs; ++k) {
    way += draw.Between(0.4, 1.6) * draw.OneOf({-1.0, 1.0});
    corners.push_back(corners.back() + draw.Between(0.3, 1) / legs *
                                           Eigen::Vector3d(std::cos(way), std::sin(way), 0));
  }
  return [=](double t) {
    const double at = std::min(t * legs, legs - 1e-12);
    const auto leg = static_cast<size_t>(at);
    const double along = at - static_cast<double>(leg);
    return Eigen::Vector3d((1 - along) * corners[leg] + along * corners[leg + 1]);
  };
}

struct Settings {
  double sigma, outliers;
  int count;
};

Settings SettingsOf(Draw& draw, int least, int most) {
  return {draw.OneOf({0.0, 0.0, 1e-4, 1e-3, 3e-3, 1e-2}),
          draw.OneOf({0.0, 0.0, 0.03, 0.1}),
          static_cast<int>(least * std::pow(double(most) / least, draw.Between(0, 1)))};
}

// Noise in every coordinate; outliers by up to 0.3.
Eigen::Vector3d Measured(const Eigen::Vector3d& place, const Settings& settings, Draw& draw) {
  const bool outlier = draw.Between(0, 1) < settings.outliers;
  Eigen::Vector3d point = place;
  for (double& x : point) x += outlier ? draw.Between(-0.3, 0.3) : settings.sigma * draw.Normal();
  return point;
}

void PrintRow(const std::string& name, const Settings& settings, const std::string& rest) {
  std::printf("| %s | %d points, noise %g, outliers %g | %s |\n",
              name.c_str(),
              settings.count,
              settings.sigma,
              settings.outliers,
              rest.c_str());
  std::fflush(stdout);
}

std::string Figures(const Eigen::VectorXd& distances,
                    int control_points,
                    EndCode end,
                    const FitReport& report) {
  char text[160];
  std::snprintf(text,
                sizeof text,
                "%.3e | %.3e | %d | %.2f | %s",
                std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size())),
                distances.cwiseAbs().maxCoeff(),
                control_points,
                report.seconds.total,
                Name(end));
  return text;
}

void SheetRow(const std::string& name, const Sheet& sheet, Draw& draw) {
  const Settings settings = SettingsOf(draw, 1500, 12000);
  Eigen::Matrix3Xd points(3, settings.count);
  for (auto point : points.colwise()) {
    const double x = draw.Between(0, 1);
    point = Measured(sheet(x, draw.Between(0, 1)), settings, draw);
  }
  constexpr int kSide = 80;
  Eigen::Matrix3Xd truth(3, kSide * kSide);
  for (int k = 0; k < kSide * kSide; ++k)
    truth.col(k) =
        sheet(0.02 + 0.96 * (k % kSide) / (kSide - 1.0), 0.02 + 0.96 * (k / kSide) / (kSide - 1.0));
  try {
    const SurfaceFit fit = FitSurface(PointCloud::FromWorld(points));
    ThreadPool pool(0);
    PrintRow(name,
             settings,
             Figures(DistancesTo(fit.surface, truth, pool).distances,
                     fit.surface.size_u() * fit.surface.size_v(),
                     fit.report.end.code,
                     fit.report));
  } catch (const std::exception& failure) {
    PrintRow(name, settings, "refused | – | – | – | –");
  }
}

void CurveRow(const std::string& name, const Curve& curve, Draw& draw) {
  const Settings settings = SettingsOf(draw, 40, 3000);
  Eigen::Matrix3Xd points(3, settings.count);
  for (int k = 0; k < settings.count; ++k)
    points.col(k) = Measured(curve((k + draw.Between(0, 1)) / settings.count), settings, draw);
  constexpr int kPlaces = 4000;
  Eigen::VectorXd distances(kPlaces);
  try {
    const CurveFit<3> fit = FitCurve<3>(PointCloud::FromWorld(points));
    const CurveFootPoints<3> feet(fit.curve);
    for (int k = 0; k < kPlaces; ++k)
      distances[k] = feet.Nearest(curve(0.02 + 0.96 * k / (kPlaces - 1.0))).distance;
    PrintRow(name,
             settings,
             Figures(distances,
                     static_cast<int>(fit.curve.control_points().cols()),
                     fit.report.end.code,
                     fit.report));
  } catch (const std::exception& failure) {
    PrintRow(name, settings, "refused | – | – | – | –");
  }
}

void PrintTable(std::uint64_t first, std::uint64_t seeds) {
  std::printf(
      "| shape | cloud | rms | max | control points | seconds | end "
      "|\n|---|---|---|---|---|---|---|\n");
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    const std::string of = " " + std::to_string(seed);
    Draw draw(seed);
    SheetRow("height" + of, HeightOf(draw), draw);
    SheetRow("bent" + of, BentOf(draw), draw);
    SheetRow("tube" + of, TubeOf(draw), draw);
    SheetRow("ball" + of, BallOf(draw), draw);
    CurveRow("wave" + of, WaveOf(draw), draw);
    CurveRow("polygon" + of, PolygonOf(draw), draw);
  }
}

}  // namespace
}  // namespace batten::internal

int main(int argc, char** argv) {
  std::uint64_t first = 1, seeds = 24;
  for (int k = 1; k + 1 < argc; k += 2) {
    const std::string flag = argv[k];
    if (flag == "--first") first = std::strtoull(argv[k + 1], nullptr, 10);
    if (flag == "--seeds") seeds = std::strtoull(argv[k + 1], nullptr, 10);
  }
  PrintTable(first, seeds);
}
