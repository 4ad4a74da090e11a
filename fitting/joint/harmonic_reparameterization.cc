// SPDX-License-Identifier: MIT
#include "fitting/joint/harmonic_reparameterization.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/geometry/surface_evaluator.h"

namespace batten::internal {
namespace {

constexpr int kElements = 80;
constexpr double kFlattest = 1e-4;  // of the mean area: an element is taken as no flatter

int Place(int i, int j) { return i * (kElements + 1) + j; }

// The stiffness of one square element of side 1 for the tensor [a b; b c], by the midpoints of
// bilinear functions' exact integrals. Corners in the order (0,0), (0,1), (1,0), (1,1).
Eigen::Matrix4d Stiffness(double a, double b, double c) {
  Eigen::Matrix4d uu, vv, uv;
  uu << 2, 1, -2, -1, 1, 2, -1, -2, -2, -1, 2, 1, -1, -2, 1, 2;
  vv << 2, -2, 1, -1, -2, 2, -1, 1, 1, -1, 2, -2, -1, 1, -2, 2;
  uv << 1, 0, 0, -1, 0, -1, 1, 0, 0, 1, -1, 0, -1, 0, 0, 1;
  return a / 6 * uu + c / 6 * vv + b / 2 * uv;
}

}  // namespace

ReparameterizeHarmonically::ReparameterizeHarmonically(const NurbsSurface& surface,
                                                       ThreadPool& pool) {
  const SplineBasis* bases[2] = {&surface.basis_u(), &surface.basis_v()};
  for (int d = 0; d < 2; ++d) {
    lower_[d] = bases[d]->lower();
    upper_[d] = bases[d]->upper();
    length_[d] = upper_[d] - lower_[d];
  }
  const double cell[2] = {length_[0] / kElements, length_[1] / kElements};
  Eigen::Matrix2Xd middles(2, kElements * kElements);
  for (int i = 0; i < kElements; ++i) {
    for (int j = 0; j < kElements; ++j) {
      middles.col(i * kElements + j) << lower_[0] + (i + 0.5) * cell[0],
          lower_[1] + (j + 0.5) * cell[1];
    }
  }
  std::vector<SurfaceJet> jets;
  SurfaceEvaluator(surface).Jets(middles, jets, pool);
  std::vector<double> areas;
  for (const SurfaceJet& jet : jets) areas.push_back(jet.du.cross(jet.dv).norm());
  double mean = 0;
  for (const double area : areas) mean += area / static_cast<double>(areas.size());
  if (!(mean > 0) || !std::isfinite(mean)) return;  // no surface: the map that changes nothing

  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < kElements; ++i) {
    for (int j = 0; j < kElements; ++j) {
      const SurfaceJet& jet = jets[static_cast<size_t>(i * kElements + j)];
      // √g times the inverse of the metric [E F; F G], in units of the element.
      const double area = std::max(areas[static_cast<size_t>(i * kElements + j)], kFlattest * mean);
      const double E = jet.du.squaredNorm() * cell[0] * cell[0];
      const double F = jet.du.dot(jet.dv) * cell[0] * cell[1];
      const double G = jet.dv.squaredNorm() * cell[1] * cell[1];
      const double root = area * cell[0] * cell[1];
      const Eigen::Matrix4d K = Stiffness(G / root, -F / root, E / root);
      const int corners[4] = {Place(i, j), Place(i, j + 1), Place(i + 1, j), Place(i + 1, j + 1)};
      for (int r = 0; r < 4; ++r) {
        for (int s = 0; s < 4; ++s) entries.emplace_back(corners[r], corners[s], K(r, s));
      }
    }
  }
  const int places = (kElements + 1) * (kElements + 1);
  Eigen::SparseMatrix<double> stiffness(places, places);
  stiffness.setFromTriplets(entries.begin(), entries.end());

  for (int d = 0; d < 2; ++d) {
    // Ends of the direction are held at 0 and 1; the natural condition holds on the other sides.
    const auto held = [&](int k) {
      const int along = d == 0 ? k / (kElements + 1) : k % (kElements + 1);
      return along == 0 ? 0 : along == kElements ? 1 : -1;
    };
    std::vector<int> number(static_cast<size_t>(places), -1);
    int unknowns = 0;
    for (int k = 0; k < places; ++k) {
      if (held(k) < 0) number[static_cast<size_t>(k)] = unknowns++;
    }
    std::vector<Eigen::Triplet<double>> inner;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    for (int column = 0; column < places; ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(stiffness, column); it; ++it) {
        const int row = number[static_cast<size_t>(it.row())];
        if (row < 0) continue;
        const int to = number[static_cast<size_t>(column)];
        if (to >= 0) {
          inner.emplace_back(row, to, it.value());
        } else if (held(column) == 1) {
          right[row] -= it.value();
        }
      }
    }
    Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
    matrix.setFromTriplets(inner.begin(), inner.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    const Eigen::VectorXd solution = solver.solve(right);
    image_[d].resize(kElements + 1, kElements + 1);
    for (int k = 0; k < places; ++k) {
      const int end = held(k);
      const double share = end >= 0 ? end : solution[number[static_cast<size_t>(k)]];
      image_[d](k / (kElements + 1), k % (kElements + 1)) =
          lower_[d] + length_[d] * std::clamp(share, 0.0, 1.0);
    }
  }
  std::sort(areas.begin(), areas.end());
  const size_t tail = areas.size() / 40;
  unevenness_ = areas[areas.size() - 1 - tail] / std::max(areas[tail], kFlattest * mean);
}

Eigen::Matrix2Xd ReparameterizeHarmonically::operator()(const Eigen::Matrix2Xd& parameters) const {
  if (image_[0].size() == 0) return parameters;
  Eigen::Matrix2Xd moved(2, parameters.cols());
  for (Eigen::Index k = 0; k < parameters.cols(); ++k) {
    int at[2];
    double share[2];
    for (int d = 0; d < 2; ++d) {
      const double x =
          std::clamp((parameters(d, k) - lower_[d]) / length_[d], 0.0, 1.0) * kElements;
      at[d] = std::min(static_cast<int>(x), kElements - 1);
      share[d] = x - at[d];
    }
    for (int d = 0; d < 2; ++d) {
      const Eigen::Matrix2d corner = image_[d].block<2, 2>(at[0], at[1]);
      const double image = Eigen::RowVector2d(1 - share[0], share[0]) * corner *
                           Eigen::Vector2d(1 - share[1], share[1]);
      moved(d, k) = std::clamp(image, lower_[d], upper_[d]);
    }
  }
  return moved;
}

}  // namespace batten::internal
