// SPDX-License-Identifier: MIT
// Curves from scanned profiles: a cloud cut into slices, a curve through each, all in one file.
//   profiles CLOUD OUT
#include <batten/batten.h>

#include <cmath>
#include <iostream>
#include <string>
#include <vector>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  constexpr int kSlices = 5;
  const batten::PointCloud cloud = batten::ReadCloud({argv[1]}).cloud;
  const double low = cloud.points().row(0).minCoeff(), high = cloud.points().row(0).maxCoeff();
  const double half = (high - low) / 200;  // of a slice's thickness

  batten::GeometryFile file{argv[2], {}, {}};
  for (int s = 1; s <= kSlices; ++s) {
    const double x = low + s * (high - low) / (kSlices + 1);
    std::vector<Eigen::Index> slice;
    for (Eigen::Index k = 0; k < cloud.size(); ++k)
      if (std::abs(cloud.points()(0, k) - x) < half) slice.push_back(k);
    Eigen::Matrix3Xd profile = cloud.Picked(slice).points();
    profile.row(0).setConstant(x);  // into the plane of the slice
    const batten::PointCloud points(std::move(profile), cloud.origin());
    // Along y, in no order of their own, with a few points that belong elsewhere.
    const batten::CurveFit<3> fit =
        batten::FitCurve<3>(points, {.order = batten::PointOrder::kUnordered, .corners = false});
    std::cout << "x = " << x << ": " << fit.report.OneLine() << '\n';
    file.geometry.push_back(fit.curve);
    file.names.push_back("profile " + std::to_string(s));
  }
  batten::WriteGeometry(file);
  return batten::ReadGeometry(argv[2]).size() == kSlices ? 0 : 1;
}
