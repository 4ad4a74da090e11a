// SPDX-License-Identifier: MIT
#include "fitting/regions/grow_regions.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <fstream>

#include "batten/fitting/fit_parts.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/regions/settle_regions.h"
#include "part_clouds.h"

namespace batten::internal {
namespace grow_regions_test {

TEST(GrowRegionsTest, Look) {
  const auto now = [] { return std::chrono::steady_clock::now(); };
  ThreadPool pool(2);
  for (const TruthPart& part : MachinedParts()) {
    if (const char* only = std::getenv("ONLY"); only && part.name.find(only) == std::string::npos) continue;
    for (const double sigma : {0.0, 1e-4, 1e-3}) {
      const PartCloud cloud = SampledPart(part, 20000, sigma, 7);
      if (std::getenv("DUMP")) {
        std::ofstream out("/tmp/parts/" + part.name.substr(0, 4) + "_" + std::to_string(int(std::round(1e4 * sigma))) + ".xyz");
        out.precision(17);
        out << cloud.points.transpose() << "\n";
      }
      const auto t0 = now();
      const RegionPoints data = MakeRegionPoints(PointCloud(cloud.points), 1, pool);
      const auto t1 = now();
      RegionLabels labels = GrowRegions(data, data.noise, 30, nullptr, pool);
      const auto t2 = now();
      std::map<std::string, int> kinds, settled;
      for (const Region& r : labels.regions) ++kinds[Name(r.shape.kind)];
      SettleRegions(data, data.noise, 30, labels, pool);
      const auto t3 = now();
      for (const Region& r : labels.regions) ++settled[Name(r.shape.kind)];
      const auto s = [](auto d) { return std::chrono::duration<double>(d).count(); };
      std::printf("%s σ %g: noise %.3g spacing %.3g | truth %zu grown %zu settled %zu | %.2f %.2f %.2f s | ",
                  part.name.c_str(), sigma, data.noise * data.unit, data.spacing * data.unit,
                  part.faces.size(), kinds.size() ? std::size_t(0) : 0, labels.regions.size(), s(t1 - t0), s(t2 - t1), s(t3 - t2));
      for (auto& [k, n] : kinds) std::printf("%s %d ", k.c_str(), n);
      std::printf("-> ");
      for (auto& [k, n] : settled) std::printf("%s %d ", k.c_str(), n);
      long none = std::count(labels.label.begin(), labels.label.end(), kNoRegion);
      std::printf(" unlabelled %ld\n", none);
    }
  }
}

TEST(FitPartsTest, Look) {
  for (const TruthPart& part : MachinedParts()) {
    if (const char* only = std::getenv("ONLY"); only && part.name.find(only) == std::string::npos) continue;
    for (const double sigma : {0.0, 1e-4, 1e-3}) {
      const PartCloud cloud = SampledPart(part, 20000, sigma, 7);
      const auto t0 = std::chrono::steady_clock::now();
      const PartsFit fit = FitParts(PointCloud(cloud.points), {.regularise = std::getenv("REG") != nullptr, .solid = true, .threads = 2});
      const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
      std::printf("%s σ %g: %zu faces of %zu, %.2f s (prep %.2f solve %.2f trim %.2f proj %.2f) rms %.3g outliers %ld noise %.3g\n", part.name.c_str(), sigma, fit.faces.size(), part.faces.size(), s,
        fit.report.seconds.prepare, fit.report.seconds.solve, fit.report.seconds.trim, fit.report.seconds.project, fit.report.error.rms, long(fit.report.input.outliers), fit.report.input.noise);
      std::printf("   solid: %s; %zu edges (truth %d) %ld vertices (truth %d)\n", fit.no_solid.c_str(), fit.solid ? fit.solid->edges.size() : 0, part.edges, fit.solid ? long(fit.solid->vertices.cols()) : 0, part.vertices);
      for (auto& w : fit.report.warnings) std::printf("   %s\n", w.c_str());
      if (std::getenv("ALL")) for (auto& f : fit.summary.faces) std::printf("   %s %ld %s\n", f.kind.c_str(), long(f.points), f.primitive ? f.primitive->Words().c_str() : "");
    }
  }
}

}  // namespace grow_regions_test
}  // namespace batten::internal
