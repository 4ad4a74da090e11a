// SPDX-License-Identifier: MIT
#include "fitting/regions/grow_regions.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <fstream>

#include "batten/geometry/thread_pool.h"
#include "fitting/regions/settle_regions.h"
#include "part_clouds.h"

namespace batten::internal {
namespace grow_regions_test {

TEST(GrowRegionsTest, Look) {
  const auto now = [] { return std::chrono::steady_clock::now(); };
  ThreadPool pool(2);
  for (const TruthPart& part : MachinedParts()) {
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

}  // namespace grow_regions_test
}  // namespace batten::internal
