// SPDX-License-Identifier: MIT
// A term of one's own in a fit: the corner of a panel has to lie where its neighbour's corner is.
//   custom_term CLOUD
#include <batten/batten.h>

#include <iostream>
#include <memory>

namespace {

// A control point at a place, as heavy as weight² points of the cloud. A clamped surface meets its
// corner control points.
class Corner : public batten::ResidualTerm {
 public:
  Corner(int point, const Eigen::Vector3d& place, double weight)
      : point_(point), place_(place), weight_(weight) {}

  int residuals() const override { return 3; }
  std::vector<int> ControlPoints() const override { return {point_}; }
  bool Evaluate(std::span<const double> values,
                std::span<double> residual,
                std::span<double> jacobian) const override {
    for (int d = 0; d < 3; ++d) residual[d] = weight_ * (values[d] - place_[d]);
    if (jacobian.empty()) return true;
    for (int k = 0; k < 9; ++k) jacobian[k] = k % 4 == 0 ? weight_ : 0;  // 3 × 3, row by row
    return true;
  }

 private:
  int point_;
  Eigen::Vector3d place_;
  double weight_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const batten::PointCloud cloud = batten::ReadCloud({argv[1]}).cloud;
  Eigen::Vector3d place;
  batten::SurfaceFitOptions options;
  options.trim = batten::Trimming::kNone;
  options.terms = [&](const batten::NurbsSurface& start) -> batten::ResidualTerms {
    place = start.control_point(0, 0) + Eigen::Vector3d(0, 0, 0.5);
    return {std::make_shared<Corner>(0, place, 1000)};
  };
  const batten::SurfaceFit fit = batten::FitSurface(cloud, options);
  const double miss = (fit.surface.control_point(0, 0) - place).norm();
  std::cout << fit.report.OneLine() << "\nmisses the neighbour's corner by " << miss << '\n';
  return miss < 0.01 ? 0 : 1;
}
