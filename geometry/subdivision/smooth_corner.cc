// SPDX-License-Identifier: MIT
#include "geometry/subdivision/smooth_corner.h"

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
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

// Share of the mean square of third derivatives against that of the distance from the limit
// surface. Measured on random nets of valence 7: the turn of normals has a flat minimum here, at
// 1e-9 it is twice as large, at 1e-4 corners move by half more.
constexpr double kFairness = 1e-5;
constexpr int kSamples = 14;  // in each direction of a unit square

std::vector<double> CornerKnots() {
  return {0, 0, 0, 0, kDoubleKnot, kDoubleKnot, kSingleKnot, 1, 2, 3, 4};
}
constexpr int kFunctions = 7;  // that live on the first unit

// Linear equations for the corner's coefficients: rows · coefficients = right · net.
struct Equations {
  Eigen::MatrixXd rows, right;

  Equations(Eigen::Index count, int size)
      : rows(Eigen::MatrixXd::Zero(count, size)), right(Eigen::MatrixXd::Zero(count, size)) {}
};

// The weights of the four points of the first unit, or of the second one, in coefficient i.
std::array<double, 4> WeightsOf(int i) {
  const std::vector<double> knots = CornerKnots();
  const double unit = i > 3 ? 1 : 0;
  return UniformCubicBlossom(knots[i + 1] - unit, knots[i + 2] - unit, knots[i + 3] - unit);
}

// Vertex (i, j) of sector k as a combination of the net; beyond creases as NetBorders has it.
void AddVertex(const RingPlaces& net, int k, int i, int j, double factor, Eigen::RowVectorXd& row) {
  if (const int place = net.At(k, i, j); place >= 0) {
    row[place] += factor;
  } else if (j < 0) {
    AddVertex(net, k, i, 0, 2 * factor, row);
    AddVertex(net, k, i, 1, -factor, row);
  } else {
    AddVertex(net, k, 0, j, 2 * factor, row);
    AddVertex(net, k, 1, j, -factor, row);
  }
}

// The coefficient (i, j) ≤ 6 of sector k that the corner does not own, on the net of three rings.
Eigen::RowVectorXd OuterCoefficient(const RingPlaces& net, int k, int i, int j) {
  const auto a = WeightsOf(i), b = WeightsOf(j);
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(net.size());
  for (int p = 0; p < 4; ++p) {
    for (int q = 0; q < 4; ++q)
      AddVertex(net, k, p - 1 + (i > 3), q - 1 + (j > 3), a[p] * b[q], row);
  }
  return row;
}

// Coefficient i ≤ 3 of the curve of edge 0 or n of an open fan: that of a uniform spline that goes
// on in the other one or, at a corner, ends.
Eigen::RowVectorXd CreaseCoefficient(const RingPlaces& net, bool corner, int edge, int i) {
  const auto weights = WeightsOf(i);
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(net.size());
  for (int p = 1; p < 4; ++p) row[net.At(edge, p - 1, 0)] += weights[p];
  if (corner) {
    row[0] += 2 * weights[0];
    row[net.At(edge, 1, 0)] -= weights[0];
  } else {
    row[net.At(net.valence - edge, 1, 0)] += weights[0];
  }
  return row;
}

// What the coefficients have to keep.
Equations Conditions(const RingPlaces& corner, const CornerKind& kind) {
  const int n = corner.valence, open = kind.ring.open;
  const double r = kDoubleKnot / kSingleKnot;
  Equations equations(5 * (n - open) + 7 * open, corner.size());
  Eigen::Index row = 0;
  for (int k = open; k < n; ++k, row += 5) {
    const double c =
        kind.cosines.empty() ? std::cos(kind.angle / n) : kind.cosines[std::size_t(k - open)];
    const auto add = [&](int condition, int sector, int i, int j, double weight) {
      equations.rows(row + condition, corner.At(sector, i, j)) += weight;
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
  for (int i = 0; open && i <= 3; ++i) {
    for (const int edge : {0, n}) {
      if (edge > 0 && i == 0) continue;
      equations.rows(row, corner.At(edge, i, 0)) = 1;
      equations.right.row(row++) = CreaseCoefficient(corner, kind.ring.corner, edge, i);
    }
  }
  return equations;
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

// Sector k of the limit surface at a place on the net of three rings, of which a ring's two are the
// inner ones.
Eigen::RowVectorXd LimitAt(
    const ExtraordinaryRing& ring, const RingPlaces& corner, int k, double u, double v) {
  const ExtraordinaryRing::Piece piece = ring.PieceAt(u, v, k);
  const CubicWeights wu = UniformCubic(piece.u), wv = UniformCubic(piece.v);
  Eigen::RowVectorXd weights(16);
  for (int p = 0; p < 16; ++p) weights[p] = wu.value[p / 4] * wv.value[p % 4];
  const Eigen::RowVectorXd inner = weights * ring.Rows(piece);
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(corner.size());
  row[0] = inner[0];
  for (int i = 1; i <= 2; ++i) {
    for (int sector = 0; sector < corner.valence; ++sector) {
      for (int j = 0; j <= 2; ++j)
        row[corner.At(sector, i, j)] = inner[ring.coarse().At(sector, i, j)];
    }
    if (!corner.open) continue;
    row[corner.At(corner.valence, i, 0)] = inner[ring.coarse().At(corner.valence, i, 0)];
  }
  return row;
}

// Least squares for what is free.
Equations NearLimit(const RingPlaces& corner, const CornerKind& kind) {
  const int n = corner.valence;
  // Where creases end, or turn by more than a straight angle inside, limit surfaces have no tangent
  // plane and fold: the corner bends as little as it can instead.
  const bool folds = kind.ring.corner && kind.angle > std::numbers::pi;
  const int order = folds ? 2 : 3;
  const int kinds = order + 2;  // derivatives ∂^(d+e), d + e = order, beside the value
  Equations equations(Eigen::Index{n} * kSamples * kSamples * kinds, corner.size());
  const ExtraordinaryRing& ring = ExtraordinaryRing::Of(kind.ring);
  Eigen::Index row = 0;
  for (int k = 0; k < n; ++k) {
    Eigen::MatrixXd outer(kFunctions * kFunctions, corner.size());
    for (int i = 0; i < kFunctions; ++i) {
      for (int j = 0; j < kFunctions; ++j)
        outer.row(kFunctions * i + j) = OuterCoefficient(corner, k, i, j);
    }
    for (int sample = 0; sample < kSamples * kSamples; ++sample) {
      const double u = (sample / kSamples + 0.5) / kSamples;
      const double v = (sample % kSamples + 0.5) / kSamples;
      const auto in_u = BasisAt(u), in_v = BasisAt(v);
      for (int derivative = 0; derivative < kinds; ++derivative, ++row) {
        if (folds && derivative == 0) continue;
        const int d = derivative == 0 ? 0 : derivative - 1, e = derivative == 0 ? 0 : order - d;
        const double binomial = d == 0 || e == 0 ? 1 : order;
        const double weight = derivative == 0 ? 1 : std::sqrt(kFairness * binomial);
        for (int i = 0; i < kFunctions; ++i) {
          for (int j = 0; j < kFunctions; ++j) {
            const double value = weight * in_u(d, i) * in_v(e, j);
            if (value == 0) continue;
            if (i <= 3 && j <= 3) {
              equations.rows(row, corner.At(k, i, j)) += value;
            } else {
              equations.right.row(row) -= value * outer.row(kFunctions * i + j);
            }
          }
        }
        if (derivative == 0) equations.right.row(row) += LimitAt(ring, corner, k, u, v);
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

SmoothCorner::SmoothCorner(const CornerKind& kind) : net_{kind.ring.sectors, 3, kind.ring.open} {
  const Equations conditions = Conditions(net_, kind);
  // Full-pivot elimination: conditions are kept to rounding, also for even n all round, whose rows
  // depend on one another.
  Eigen::FullPivLU<Eigen::MatrixXd> elimination(conditions.rows);
  constexpr double kDependent = 1e-10;  // the least pivot of independent rows is above 0.01
  elimination.setThreshold(kDependent);
  const Eigen::MatrixXd given = elimination.solve(conditions.right);
  const Eigen::MatrixXd free = elimination.kernel();
  const Equations equations = NearLimit(net_, kind);
  const Eigen::MatrixXd reduced = equations.rows * free;
  const Eigen::MatrixXd normal = reduced.transpose() * reduced;
  mask_ =
      given + free * SymmetricSolution(
                         normal, reduced.transpose() * (equations.right - equations.rows * given));
}

const SmoothCorner& SmoothCorner::Of(const CornerKind& kind) {
  static std::mutex mutex;
  static std::map<CornerKind, std::unique_ptr<const SmoothCorner>> corners;
  const std::lock_guard<std::mutex> lock(mutex);
  auto& corner = corners[kind];
  if (!corner) corner = std::make_unique<const SmoothCorner>(kind);
  return *corner;
}

}  // namespace batten::internal
