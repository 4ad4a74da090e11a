// SPDX-License-Identifier: MIT
#include "geometry/subdivision/smooth_corner.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <utility>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {
namespace {

// Share of the mean square of third derivatives against that of the distance from the limit
// surface. Measured on random nets of valence 7: the turn of normals has a flat minimum here, at
// 1e-9 it is twice as large, at 1e-4 corners move by half more.
constexpr double kFairness = 1e-5;
constexpr int kSamples = 14;  // in each direction of a unit square

// Rows of conditions on the coefficients of the corner: each row times them is zero.
Eigen::MatrixXd Conditions(const RingPlaces& corner) {
  const int n = corner.valence;
  const double c = std::cos(2 * std::numbers::pi / n), r = kDoubleKnot / kSingleKnot;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(5 * n, corner.size());
  for (int k = 0; k < n; ++k) {
    const auto add = [&](int condition, int sector, int i, int j, double weight) {
      rows(5 * k + condition, corner.At(sector, i, j)) += weight;
    };
    // The ends of the edges are an affine image of a regular star.
    add(0, k + 1, 1, 0, 1), add(0, k - 1, 1, 0, 1), add(0, k, 0, 0, -2 + 2 * c);
    add(0, k, 1, 0, -2 * c);
    // The edge is quadratic up to the double knot.
    add(1, k, 3, 0, r), add(1, k, 0, 0, -1), add(1, k, 1, 0, 3), add(1, k, 2, 0, -2 - r);
    // The twists on both sides.
    add(2, k, 1, 1, 1), add(2, k - 1, 1, 1, 1), add(2, k, 1, 0, -2 + 2 * c);
    add(2, k, 2, 0, -4 * c / 3), add(2, k, 0, 0, -2 * c / 3);
    // Behind the double knot the faces meet as splines do.
    add(3, k, 2, 1, 1), add(3, k - 1, 1, 2, 1), add(3, k, 2, 0, -2);
    add(4, k, 3, 1, 1), add(4, k - 1, 1, 3, 1), add(4, k, 3, 0, -2);
  }
  return rows;
}

// Of full-pivot elimination: conditions are kept to rounding, also for even n, whose rows depend on
// one another.
Eigen::MatrixXd NullSpace(const Eigen::MatrixXd& rows) {
  Eigen::FullPivLU<Eigen::MatrixXd> elimination(rows);
  constexpr double kDependent = 1e-10;  // the least pivot of independent rows is above 0.01
  elimination.setThreshold(kDependent);
  return elimination.kernel();
}

std::vector<double> CornerKnots() {
  return {0, 0, 0, 0, kDoubleKnot, kDoubleKnot, kSingleKnot, 1, 2, 3, 4};
}
constexpr int kFunctions = 7;  // that live on the first unit

// All coefficients (i, j) ≤ 6 of sector 0 that the corner does not own, on the net of three rings.
Eigen::RowVectorXd OuterCoefficient(const RingPlaces& net, int i, int j) {
  const std::vector<double> knots = CornerKnots();
  const auto weights = [&](int index) {
    const double face = index > 3 ? 1 : 0;
    return UniformCubicBlossom(
        knots[index + 1] - face, knots[index + 2] - face, knots[index + 3] - face);
  };
  const auto a = weights(i), b = weights(j);
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(net.size());
  for (int p = 0; p < 4; ++p) {
    for (int q = 0; q < 4; ++q) {
      row[net.At(0, p - 1 + (i > 3), q - 1 + (j > 3))] += a[p] * b[q];
    }
  }
  return row;
}

// Values and derivatives up to the third of the functions that live on the first unit.
Eigen::Matrix<double, 4, kFunctions> BasisAt(double t) {
  static const SplineBasis basis(3, CornerKnots());
  Eigen::Matrix<double, 4, kFunctions> values = Eigen::Matrix<double, 4, kFunctions>::Zero();
  const int span = basis.Span(t);
  std::array<double, 16> derivatives;
  basis.Derivatives(span, t, 3, derivatives.data());
  for (int d = 0; d < 4; ++d) {
    for (int r = 0; r < 4; ++r) values(d, span - 3 + r) = derivatives[d * 4 + r];
  }
  return values;
}

// Least squares for the corner's coefficients: rows · coefficients = right · net.
struct Equations {
  Eigen::MatrixXd rows, right;
};

Equations NearLimit(const RingPlaces& corner) {
  const int n = corner.valence;
  // Derivatives ∂^(d+e), d + e = 3, beside the value.
  constexpr int kKinds = 5;
  const Eigen::Index count = Eigen::Index{n} * kSamples * kSamples * kKinds;
  Equations equations{Eigen::MatrixXd::Zero(count, corner.size()),
                      Eigen::MatrixXd::Zero(count, corner.size())};
  const ExtraordinaryRing& ring = ExtraordinaryRing::Of(n);
  Eigen::MatrixXd outer(kFunctions * kFunctions, corner.size());
  for (int i = 0; i < kFunctions; ++i) {
    for (int j = 0; j < kFunctions; ++j)
      outer.row(kFunctions * i + j) = OuterCoefficient(corner, i, j);
  }
  // A column of the net seen from sector k.
  const auto turned = [&](int place, int k) {
    const int per_sector = corner.rings * (corner.rings + 1);
    return place == 0 ? 0 : 1 + (place - 1 + k * per_sector) % (corner.size() - 1);
  };
  Eigen::Index row = 0;
  for (int a = 0; a < kSamples; ++a) {
    for (int b = 0; b < kSamples; ++b) {
      const double u = (a + 0.5) / kSamples, v = (b + 0.5) / kSamples;
      const auto in_u = BasisAt(u), in_v = BasisAt(v);
      // The limit surface on the net of two rings, which are the inner ones of three.
      const ExtraordinaryRing::Piece piece = ring.PieceAt(u, v);
      const CubicWeights wu = UniformCubic(piece.u), wv = UniformCubic(piece.v);
      Eigen::RowVectorXd limit = Eigen::RowVectorXd::Zero(ring.coarse().size());
      for (int k = 0; k < 16; ++k) {
        limit += wu.value[k / 4] * wv.value[k % 4] * ring.Refined(piece.level).row(piece.places[k]);
      }
      for (int kind = 0; kind < kKinds; ++kind) {
        const int d = kind == 0 ? 0 : kind - 1, e = kind == 0 ? 0 : 3 - d;
        constexpr double kBinomial[4] = {1, 3, 3, 1};
        const double weight = kind == 0 ? 1 : std::sqrt(kFairness * kBinomial[d]);
        for (int k = 0; k < n; ++k, ++row) {
          for (int i = 0; i < kFunctions; ++i) {
            for (int j = 0; j < kFunctions; ++j) {
              const double value = weight * in_u(d, i) * in_v(e, j);
              if (value == 0) continue;
              if (i <= 3 && j <= 3) {
                equations.rows(row, corner.At(k, i, j)) += value;
              } else {
                for (int place = 0; place < corner.size(); ++place) {
                  equations.right(row, turned(place, k)) -=
                      value * outer(kFunctions * i + j, place);
                }
              }
            }
          }
          if (kind > 0) continue;
          equations.right(row, 0) += limit[0];
          for (int sector = 0; sector < n; ++sector) {
            for (int i = 1; i <= 2; ++i) {
              for (int j = 0; j <= 2; ++j) {
                equations.right(row, corner.At(sector + k, i, j)) +=
                    limit[ring.coarse().At(sector, i, j)];
              }
            }
          }
        }
      }
    }
  }
  return equations;
}

}  // namespace

std::array<double, 4> UniformCubicBlossom(double a, double b, double c) {
  const double arguments[3] = {a, b, c};
  std::array<double, 4> weights{};
  for (int point = 0; point < 4; ++point) {
    double level[4] = {};
    level[point] = 1;
    for (int r = 1; r <= 3; ++r) {
      for (int i = 0; i <= 3 - r; ++i) {
        // Knots −2 … 3: point i lies between knots i − 2 and i + 1.
        const double low = i + r - 3, high = i + 1;
        const double share = (arguments[r - 1] - low) / (high - low);
        level[i] = (1 - share) * level[i] + share * level[i + 1];
      }
    }
    weights[point] = level[0];
  }
  return weights;
}

SmoothCorner::SmoothCorner(int valence) : net_{valence, 3} {
  const Eigen::MatrixXd free = NullSpace(Conditions(net_));
  const Equations equations = NearLimit(net_);
  const Eigen::MatrixXd reduced = equations.rows * free;
  const Eigen::MatrixXd normal = reduced.transpose() * reduced;
  mask_ = free * normal.ldlt().solve(reduced.transpose() * equations.right);
}

const SmoothCorner& SmoothCorner::Of(int valence) {
  static std::mutex mutex;
  static std::map<int, std::unique_ptr<const SmoothCorner>> corners;
  const std::lock_guard<std::mutex> lock(mutex);
  auto& corner = corners[valence];
  if (!corner) corner = std::make_unique<const SmoothCorner>(valence);
  return *corner;
}

}  // namespace batten::internal
