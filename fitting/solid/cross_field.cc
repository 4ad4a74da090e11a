// SPDX-License-Identifier: MIT
#include "fitting/solid/cross_field.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <complex>

namespace batten::internal {
namespace {

using Complex = std::complex<double>;
using SparseComplex = Eigen::SparseMatrix<Complex>;
using Factor = Eigen::SimplicialLDLT<SparseComplex, Eigen::Lower>;

Complex Unit(Complex z) {
  const double length = std::abs(z);
  return length > 0 ? z / length : Complex(1);
}

// Crosses are fourth powers of unit directions, which do not tell the four apart.
class CrossSmoother {
 public:
  CrossSmoother(const TriangleSurface& surface, const TriangleTopology& topology, double length)
      : surface_(surface), topology_(topology), planar_(PlanarEdges(surface)), length_(length) {
    // The direction of the shared edge is opposite in the two triangles, its square the same.
    for (int h = 0; h < topology.half_edges(); ++h) {
      const Complex turn = Unit(planar_[std::size_t(topology.Twin(h))] / planar_[std::size_t(h)]);
      carried_.push_back(turn * turn);
    }
  }

  std::vector<double> Angles() {
    const int count = topology_.triangles();
    PullByCurvature();
    const double kWide = 30, kNarrow = getenv("NARROW") ? atof(getenv("NARROW"))
                                                        : 0.3;  // squares of face lengths
    crosses_ = pull_;
    for (Eigen::Index t = 0; t < count; ++t) {
      if (crosses_[t] == Complex(0)) crosses_[t] = 1e-6;
    }
    // Diffused far first, so that the field is that of the whole shape.
    for (const double share : {kWide, kWide / 5, kWide / 25, kNarrow}) Diffuse(share);
    std::vector<double> angles;
    for (const Complex cross : crosses_) angles.push_back(std::arg(cross) / 4);
    return angles;
  }

 private:
  // The deviation of the second fundamental form from that of a sphere, as a squared direction
  // times the half difference of the curvatures.
  Eigen::VectorXcd Bending() const {
    Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, surface_.vertices.cols());
    for (const auto t : surface_.triangles.colwise()) {
      const Eigen::Vector3d a = surface_.vertices.col(t[0]);
      const Eigen::Vector3d normal =
          (surface_.vertices.col(t[1]) - a).cross(surface_.vertices.col(t[2]) - a);
      for (const int v : t) normals.col(v) += normal;
    }
    for (auto normal : normals.colwise()) normal.stableNormalize();
    Eigen::VectorXcd bending(topology_.triangles());
    for (int t = 0; t < topology_.triangles(); ++t) {
      Eigen::Matrix3d rows;
      Eigen::Vector3d along;
      for (int k = 0; k < 3; ++k) {
        const int h = 3 * t + k;
        const int from = topology_.Origin(h), to = topology_.Origin(TriangleTopology::Next(h));
        const Complex e = planar_[std::size_t(h)];
        rows.row(k) << e.real() * e.real(), 2 * e.real() * e.imag(), e.imag() * e.imag();
        along[k] = (normals.col(to) - normals.col(from))
                       .dot(surface_.vertices.col(to) - surface_.vertices.col(from));
      }
      const Eigen::Vector3d form = rows.colPivHouseholderQr().solve(along);
      bending[t] = {(form[0] - form[2]) / 2, form[1]};
      if (!std::isfinite(std::abs(bending[t]))) bending[t] = 0;
    }
    return bending;
  }

  void PullByCurvature() {
    Eigen::VectorXcd bending = Bending();
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds; ++round) {
      Eigen::VectorXcd mean = bending;
      for (int h = 0; h < topology_.half_edges(); ++h) {
        mean[topology_.Twin(h) / 3] += carried_[std::size_t(h)] * bending[h / 3];
      }
      bending = mean / 4;
    }
    pull_.resize(bending.size());
    constexpr double kStrong = 0.5;  // radians over a face that count in full
    for (Eigen::Index t = 0; t < bending.size(); ++t) {
      const double weight = std::min(1.0, std::abs(bending[t]) * length_ / kStrong);
      pull_[t] = weight * weight * Unit(bending[t] * bending[t]);
    }
  }

  // One implicit step of diffusion over so many squares of the face length, lengths one again.
  void Diffuse(double share) {
    double area = 0;
    for (const auto t : surface_.triangles.colwise()) {
      const Eigen::Vector3d a = surface_.vertices.col(t[0]);
      area += (surface_.vertices.col(t[1]) - a).cross(surface_.vertices.col(t[2]) - a).norm() / 2;
    }
    // On triangles of even size a the differences from the three beside are a / sqrt 3 times the
    // Laplacian.
    const double even = area / topology_.triangles();
    const double step = share * length_ * length_ * std::sqrt(3.0) / even;
    const double kPull = getenv("PULL") ? atof(getenv("PULL")) : 0.05;
    const int count = topology_.triangles();
    std::vector<Eigen::Triplet<Complex>> entries;
    for (int t = 0; t < count; ++t) {
      entries.emplace_back(t, t, 1 + 3 * step + step * kPull * std::abs(pull_[t]));
      for (int k = 0; k < 3; ++k) {
        const int beside = topology_.Twin(3 * t + k) / 3;
        const Complex carried = carried_[std::size_t(3 * t + k)];
        if (beside > t) entries.emplace_back(beside, t, -step * carried * carried);
      }
    }
    SparseComplex matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Factor factor(matrix);
    constexpr int kRounds = 6;
    for (int round = 0; round < kRounds; ++round) {
      crosses_ = factor.solve(crosses_ + step * kPull * pull_).eval();
      for (Complex& cross : crosses_) cross = Unit(cross);
    }
  }

  const TriangleSurface& surface_;
  const TriangleTopology& topology_;
  std::vector<Complex> planar_;
  double length_;
  std::vector<Complex> carried_;  // squared directions from a half-edge's triangle to its twin's
  Eigen::VectorXcd pull_, crosses_;
};

}  // namespace

std::vector<double> SmoothCrosses(const TriangleSurface& surface,
                                  const TriangleTopology& topology,
                                  double face_length) {
  return CrossSmoother(surface, topology, face_length).Angles();
}

}  // namespace batten::internal
