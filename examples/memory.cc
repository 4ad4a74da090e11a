// SPDX-License-Identifier: MIT
// Points in the memory of another program, a progress bar, and a button that cancels.
//   memory
#include <batten/batten.h>

#include <atomic>
#include <cmath>
#include <iostream>
#include <vector>

namespace {

// What a scanner's driver hands over: x y z in single precision.
std::vector<float> Scan() {
  std::vector<float> xyz;
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j) {
      const float x = 0.1F * static_cast<float>(i), y = 0.1F * static_cast<float>(j);
      xyz.insert(xyz.end(), {x, y, std::sin(x) * std::cos(y)});
    }
  }
  return xyz;
}

}  // namespace

int main() {
  const std::vector<float> xyz = Scan();
  const batten::PointCloud cloud = batten::CloudFromCoordinates(xyz);
  std::atomic<bool> stop = false;  // set by the user interface
  batten::SurfaceFitOptions options{.tolerance = 0.001};
  options.progress = batten::WholeFit([&](const batten::FitProgress& at) {
    std::cerr << '\r' << std::lround(100 * at.fraction) << " %";
    return !stop;
  });
  const batten::SurfaceFit fit = batten::FitSurface(cloud, options);
  std::cerr << '\n';
  std::cout << fit.report.OneLine() << '\n';

  // Now with a user who has no patience: before there is a surface, Cancelled is thrown; after
  // that the best so far is returned and `end` in the report says so.
  stop = true;
  try {
    batten::FitSurface(cloud, options);
  } catch (const batten::Cancelled&) {
    std::cout << "cancelled\n";
    return fit.report.tolerance_reached().value_or(false) ? 0 : 1;
  }
  return 1;
}
