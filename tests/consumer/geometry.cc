// SPDX-License-Identifier: MIT
// A program that needs exact geometry and nothing else.
#include <batten/geometry/foot_point.h>
#include <batten/geometry/make_surface.h>

#include <cmath>
#include <iostream>

int main() {
  const batten::NurbsSurface sphere = batten::MakeSphere({}, 2.0);
  const batten::SurfaceFootPoints nearest(sphere);
  const double distance = nearest.Nearest({3.0, 0.0, 4.0}).distance;
  std::cout << "distance " << distance << '\n';
  return std::abs(distance - 3.0) < 1e-9 ? 0 : 1;
}
