// SPDX-License-Identifier: MIT
// The parts of a scan: each connected part of a cloud gets a surface of its own.
//   parts OUT.step
#include <batten/batten.h>

#include <iostream>
#include <string>

namespace {

// A scene of three patches that do not touch.
batten::PointCloud Scene() {
  constexpr int kSide = 60;
  Eigen::MatrixX3d rows(3 * kSide * kSide, 3);
  for (int k = 0; k < rows.rows(); ++k) {
    const int part = k / (kSide * kSide), place = k % (kSide * kSide);
    const double x = place / kSide / (kSide - 1.0), y = place % kSide / (kSide - 1.0);
    rows.row(k) << x + 3 * part, y, 0.3 * part * x * (1 - x) + 0.1 * y * y;
  }
  return batten::CloudFromRows(rows);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const batten::PointCloud scene = Scene();
  batten::ThreadPool pool(0);
  const batten::CloudParts found = batten::FindCloudParts(scene, pool);
  batten::GeometryFile file{argv[1], {}, {}};
  for (const batten::CloudPart& part : found.parts) {
    try {
      const batten::SurfaceFit fit = batten::FitSurface(scene.Picked(part.points));
      std::cout << part.points.size() << " points: " << fit.report.OneLine() << '\n';
      file.geometry.push_back(fit.surface);
      file.names.push_back("part " + std::to_string(file.geometry.size()));
    } catch (const batten::RefusedData& refusal) {  // such as points on a line
      std::cout << part.points.size() << " points: " << refusal.what() << '\n';
    }
  }
  batten::WriteGeometry(file);
  return file.geometry.size() == 3 ? 0 : 1;
}
