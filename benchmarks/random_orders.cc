// SPDX-License-Identifier: MIT
// Prints, as a Markdown table, one row for each of many clouds of curves that nobody chose: waves,
// loops, stars, polygons, spirals and helices, one to three in a cloud, in order or not, each drawn
// with a number of points, noise, outliers and a gap of its own, all in steps; how many curves are
// found, how many outliers are kept, how many points lost, and how long the way along the order is
// against the curves. For `sweep`, which counts the rows that a constant moves.
//   random_orders [--seeds N] [--first SEED]
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "ablation.h"
#include "batten/fitting/curve_components.h"
#include "draw.h"

using namespace batten;

namespace batten::internal {
namespace {

using std::numbers::pi;

struct Curve {
  std::function<Eigen::Vector3d(double)> at;  // of 0 … 1, of size about 1
  bool closed = false;
};

Curve WaveOf(Draw& draw) {
  std::vector<Eigen::Vector3d> waves;
  for (int k = 0; k < 3; ++k)
    waves.emplace_back(draw.Between(2, 14), draw.Between(0, 2 * pi), draw.Between(0.02, 0.12));
  return {[waves](double t) {
            double y = 0;
            for (const Eigen::Vector3d& w : waves) y += w[2] * std::sin(w[0] * t + w[1]);
            return Eigen::Vector3d(t, y, 0);
          },
          false};
}

Curve LoopOf(Draw& draw) {
  const int lobes = draw.Whole(2, 5);
  const double depth = draw.Between(0, 0.3), lift = draw.OneOf({0.0, 0.1});
  return {[=](double t) {
            const double a = 2 * pi * t, r = 0.4 * (1 + depth * std::cos(lobes * a));
            return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), lift * std::sin(2 * a));
          },
          true};
}

// Straight from corner to corner.
Curve ThroughCorners(std::vector<Eigen::Vector3d> corners, bool closed) {
  if (closed) corners.push_back(corners.front());
  return {[corners](double t) {
            const double at = std::min(t * (double(corners.size()) - 1), corners.size() - 1.000001);
            const auto leg = static_cast<size_t>(at);
            const double along = at - static_cast<double>(leg);
            return Eigen::Vector3d((1 - along) * corners[leg] + along * corners[leg + 1]);
          },
          closed};
}

Curve StarOf(Draw& draw) {
  const int tips = draw.Whole(3, 6);
  const double depth = draw.Between(0.4, 1);
  std::vector<Eigen::Vector3d> corners;
  for (int k = 0; k < 2 * tips; ++k) {
    const double a = pi * k / tips, r = 0.45 * (k % 2 == 0 ? 1 : depth);
    corners.emplace_back(r * std::cos(a), r * std::sin(a), 0);
  }
  return ThroughCorners(corners, true);
}

Curve PolygonOf(Draw& draw) {
  std::vector<Eigen::Vector3d> corners = {{0, 0, 0}};
  for (int legs = draw.Whole(2, 5); legs > 0; --legs)
    corners.push_back(corners.back() +
                      Eigen::Vector3d(draw.Between(0.15, 0.4), draw.Between(-0.3, 0.3), 0));
  return ThroughCorners(corners, false);
}

Curve SpiralOf(Draw& draw) {
  const double turns = draw.Between(1, 3), rise = draw.OneOf({0.0, 0.6});
  return {[=](double t) {
            const double a = 2 * pi * turns * t, r = rise > 0 ? 0.3 : 0.1 + 0.4 * t;
            return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), rise * turns * t);
          },
          false};
}

struct Truth {
  Eigen::Matrix3Xd points;
  std::vector<int> curve;     // −1: outlier
  std::vector<double> along;  // length on its curve
  double length = 0;          // of all curves
  int curves = 0, closed = 0;
};

Truth CloudOf(const std::vector<Curve>& curves,
              int count,
              double noise,
              double outliers,
              double steps,
              double gap,
              Draw& draw) {
  Truth truth;
  std::vector<Eigen::Vector3d> points;
  truth.curves = int(curves.size());
  for (int c = 0; c < truth.curves; ++c) {
    const Eigen::Vector3d shift(0, 2.0 * c, 0);
    truth.closed += curves[std::size_t(c)].closed;
    constexpr int kTable = 4000;
    std::vector<double> lengths = {0};
    for (int k = 1; k <= kTable; ++k)
      lengths.push_back(lengths.back() + (curves[std::size_t(c)].at(double(k) / kTable) -
                                          curves[std::size_t(c)].at(double(k - 1) / kTable))
                                             .norm());
    const double length = lengths.back(), spacing = length / count;
    truth.length += length;
    const double hole = draw.Between(0.1, 0.9) * length;
    std::vector<double> places;
    for (int k = 0; k < count; ++k) places.push_back((k + draw.Between(0, 1)) * spacing);
    for (const double s : places) {
      if (s > hole && s < hole + gap * spacing) continue;
      const auto k = std::upper_bound(lengths.begin(), lengths.end() - 1, s) - lengths.begin();
      const double before = lengths[std::size_t(k - 1)], after = lengths[std::size_t(k)];
      const double t = (double(k - 1) + (s - before) / (after - before)) / kTable;
      Eigen::Vector3d point = curves[std::size_t(c)].at(t) + shift;
      for (double& x : point) x += noise * spacing * draw.Normal();
      const bool outlier = draw.Between(0, 1) < outliers;
      if (outlier)
        for (double& x : point) x += steps * spacing * draw.Between(-1, 1);
      points.push_back(point);
      truth.curve.push_back(outlier ? -1 : c);
      truth.along.push_back(s);
    }
  }
  truth.points.resize(3, Eigen::Index(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) truth.points.col(Eigen::Index(k)) = points[k];
  return truth;
}

void PrintRow(const std::string& name, const std::string& cloud, const std::string& rest) {
  std::printf("| %s | %s | %s |\n", name.c_str(), cloud.c_str(), rest.c_str());
}

void OrderRow(const std::string& name, const std::vector<Curve>& curves, Draw& draw) {
  const int count = int(24 * std::pow(60, draw.Between(0, 1)));
  const double noise = draw.OneOf({0.0, 0.0, 0.05, 0.2, 1.0, 3.0});
  const double outliers = draw.OneOf({0.0, 0.0, 0.03, 0.1});
  const double steps = draw.OneOf({2.0, 5.0, 100.0});
  const double gap = draw.OneOf({0.0, 0.0, 3.0, 8.0});
  const bool shuffled = curves.size() > 1 || draw.Between(0, 1) < 0.6;
  Truth truth = CloudOf(curves, count, noise, outliers, steps, gap, draw);
  std::vector<int> order(truth.curve.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = int(k);
  if (shuffled) std::shuffle(order.begin(), order.end(), draw.engine());
  const PointCloud cloud = PointCloud::FromWorld(truth.points(Eigen::all, order).eval());
  std::map<std::array<double, 3>, int> index;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const auto p = cloud.points().col(k);
    index[{p[0], p[1], p[2]}] = order[std::size_t(k)];
  }
  char text[200];
  std::snprintf(text,
                sizeof text,
                "%d points, noise %g, outliers %g by %g, gap %g%s",
                count,
                noise,
                outliers,
                steps,
                gap,
                shuffled ? "" : ", in order");
  const std::string words = text;
  try {
    ThreadPool pool(1);
    const CurveComponents found = ArrangeCurves(cloud, {}, pool);
    int kept = 0, closed = 0;
    std::vector<char> seen(truth.curve.size(), 0);
    double way = 0;
    for (const OrderedPoints& path : found.curves) {
      closed += path.closed;
      int last = -1;
      for (Eigen::Index k = 0; k < path.cloud.size(); ++k) {
        const auto p = path.cloud.points().col(k);
        const auto at = index.find({p[0], p[1], p[2]});
        if (at == index.end()) continue;
        const int now = at->second;
        seen[std::size_t(now)] = 1;
        if (truth.curve[std::size_t(now)] < 0) {
          ++kept;
          continue;
        }
        if (last >= 0)
          way += truth.curve[std::size_t(last)] == truth.curve[std::size_t(now)]
                     ? std::abs(truth.along[std::size_t(now)] - truth.along[std::size_t(last)])
                     : truth.length;
        last = now;
      }
    }
    int lost = 0;
    for (std::size_t k = 0; k < seen.size(); ++k) lost += truth.curve[k] >= 0 && !seen[k];
    std::snprintf(text,
                  sizeof text,
                  "%d of %d | %d of %d | %d | %d | %.3f",
                  int(found.curves.size()),
                  truth.curves,
                  closed,
                  truth.closed,
                  kept,
                  lost,
                  way / truth.length);
    PrintRow(name, words, text);
  } catch (const std::exception&) {
    PrintRow(name, words, "refused | – | – | – | –");
  }
}

void PrintTable(std::uint64_t first, std::uint64_t seeds) {
  std::printf(
      "| curves | cloud | found | closed | outliers kept | points lost | way "
      "|\n|---|---|---|---|---|---|---|\n");
  const std::vector<std::pair<std::string, Curve (*)(Draw&)>> kinds = {{"wave", WaveOf},
                                                                       {"loop", LoopOf},
                                                                       {"star", StarOf},
                                                                       {"polygon", PolygonOf},
                                                                       {"spiral", SpiralOf}};
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    Draw draw(seed);
    for (const auto& [name, make] : kinds)
      OrderRow(name + " " + std::to_string(seed), {make(draw)}, draw);
    std::vector<Curve> several;
    for (int k = draw.Whole(2, 3); k > 0; --k)
      several.push_back(kinds[std::size_t(draw.Whole(0, 4))].second(draw));
    OrderRow("several " + std::to_string(seed), several, draw);
  }
}

}  // namespace
}  // namespace batten::internal

int main(int argc, char** argv) {
  std::uint64_t first = 1, seeds = 60;
  for (int k = 1; k + 1 < argc; k += 2) {
    const std::string flag = argv[k];
    if (flag == "--first") first = std::strtoull(argv[k + 1], nullptr, 10);
    if (flag == "--seeds") seeds = std::strtoull(argv[k + 1], nullptr, 10);
  }
  batten::internal::PrintTable(first, seeds);
}
