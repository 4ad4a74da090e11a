// SPDX-License-Identifier: MIT
#include "batten/geometry/bounding_box.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "geometry/bezier/spline_pieces.h"
#include "geometry/measure/trimmed_box.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/constants.h"

namespace batten {
using namespace internal;
namespace {

// One coordinate of a piece, or minus it, as a rational function in Bézier form; a curve has one
// column. `reach` is the greatest control value: nowhere is the function greater.
struct Patch {
  Eigen::ArrayXXd numerator, weight;
  double reach = 0;

  void FindReach() { reach = (numerator / weight).maxCoeff(); }
};

// The corners of the net lie on the shape.
double GreatestCorner(const Patch& patch) {
  const Eigen::Index p = patch.weight.rows() - 1, q = patch.weight.cols() - 1;
  double greatest = -std::numeric_limits<double>::infinity();
  for (const Eigen::Index i : {Eigen::Index{0}, p}) {
    for (const Eigen::Index j : {Eigen::Index{0}, q}) {
      greatest = std::max(greatest, patch.numerator(i, j) / patch.weight(i, j));
    }
  }
  return greatest;
}

// De Casteljau at the middle of the rows. [Piegl & Tiller 1997, A1.5]
std::pair<Eigen::ArrayXXd, Eigen::ArrayXXd> Halved(Eigen::ArrayXXd net) {
  const Eigen::Index p = net.rows() - 1;
  Eigen::ArrayXXd first = net;
  for (Eigen::Index k = 1; k <= p; ++k) {
    for (Eigen::Index i = 0; i <= p - k; ++i) net.row(i) = (net.row(i) + net.row(i + 1)) / 2;
    first.row(k) = net.row(0);
  }
  return {std::move(first), std::move(net)};
}

// How much the control values differ along the rows' direction.
double Variation(const Eigen::ArrayXXd& values) {
  const Eigen::Index p = values.rows() - 1;
  return p == 0 ? 0 : (values.bottomRows(p) - values.topRows(p)).abs().maxCoeff();
}

// Halves in the direction along which the values differ more.
std::pair<Patch, Patch> Split(const Patch& patch) {
  const Eigen::ArrayXXd values = patch.numerator / patch.weight;
  const bool other = Variation(values.transpose()) > Variation(values);
  const auto halves = [&](const Eigen::ArrayXXd& net) {
    if (!other) return Halved(net);
    auto turned = Halved(net.transpose());
    return std::pair<Eigen::ArrayXXd, Eigen::ArrayXXd>(turned.first.transpose(),
                                                       turned.second.transpose());
  };
  auto numerators = halves(patch.numerator), weights = halves(patch.weight);
  std::pair<Patch, Patch> result;
  result.first = {std::move(numerators.first), std::move(weights.first), 0};
  result.second = {std::move(numerators.second), std::move(weights.second), 0};
  result.first.FindReach();
  result.second.FindReach();
  return result;
}

bool ReachesLess(const Patch& a, const Patch& b) { return a.reach < b.reach; }

// The greatest value over all patches, given one that is attained. Patches that don't reach
// beyond it are left alone; what remains is a heap with the farthest on top.
double Greatest(std::vector<Patch> patches, double attained, double negligible) {
  constexpr int kMostSplits = 50000;
  std::make_heap(patches.begin(), patches.end(), ReachesLess);
  for (int count = 0; !patches.empty(); ++count) {
    std::pop_heap(patches.begin(), patches.end(), ReachesLess);
    const Patch farthest = std::move(patches.back());
    patches.pop_back();
    if (farthest.reach <= attained + negligible) break;
    if (count == kMostSplits) return farthest.reach;
    auto [first, second] = Split(farthest);
    for (Patch* half : {&first, &second}) {
      attained = std::max(attained, GreatestCorner(*half));
      if (half->reach <= attained + negligible) continue;
      patches.push_back(std::move(*half));
      std::push_heap(patches.begin(), patches.end(), ReachesLess);
    }
  }
  return attained;
}

// A rational piece: Euclidean coordinates relative to a common centre times weights, and weights.
struct Net {
  std::vector<Eigen::ArrayXXd> numerators;
  Eigen::ArrayXXd weight;
};

Patch PatchOf(const Net& net, int coordinate, double sign) {
  Patch patch{sign * net.numerators[coordinate], net.weight, 0};
  patch.FindReach();
  return patch;
}

// `size` is that of the control points' box, which rounding is relative to.
Eigen::AlignedBox3d BoxOf(const std::vector<Net>& nets,
                          const Eigen::Vector3d& centre,
                          double size,
                          int dimension) {
  const double negligible = 16 * kEpsilon * size;
  Eigen::AlignedBox3d box(centre, centre);
  for (int d = 0; d < dimension; ++d) {
    for (const double sign : {-1.0, 1.0}) {
      double attained = -std::numeric_limits<double>::infinity();
      for (const Net& net : nets) {
        attained = std::max(attained, GreatestCorner({sign * net.numerators[d], net.weight, 0}));
      }
      std::vector<Patch> patches;
      for (const Net& net : nets) {
        Patch patch = PatchOf(net, d, sign);
        if (patch.reach > attained + negligible) patches.push_back(std::move(patch));
      }
      const double greatest = Greatest(std::move(patches), attained, negligible);
      (sign < 0 ? box.min() : box.max())[d] = centre[d] + sign * greatest;
    }
  }
  return box;
}

}  // namespace

template <int Dim>
Eigen::AlignedBox<double, Dim> BoundingBox(const NurbsCurve<Dim>& curve) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  centre.head<Dim>() = curve.control_points().col(0);
  std::vector<Net> nets;
  for (const int span : curve.basis().Spans()) {
    const CurvePiece piece = PieceOf(curve, span, centre);
    Net& net = nets.emplace_back();
    for (int d = 0; d < Dim; ++d) net.numerators.push_back(piece.points.row(d).transpose());
    net.weight = piece.points.row(3).transpose();
  }
  const Eigen::AlignedBox3d box = BoxOf(nets, centre, BoxDiagonal(curve.control_points()), Dim);
  return {box.min().template head<Dim>(), box.max().template head<Dim>()};
}

template Eigen::AlignedBox<double, 2> BoundingBox(const NurbsCurve<2>&);
template Eigen::AlignedBox<double, 3> BoundingBox(const NurbsCurve<3>&);

Eigen::AlignedBox3d BoundingBox(const NurbsSurface& surface) {
  if (surface.trimmed()) return TrimmedBox(surface);
  const Eigen::Vector3d centre = surface.control_points().col(0);
  const SurfacePieces pieces(surface);
  std::vector<Net> nets;
  for (int i = 0; i < pieces.count_u(); ++i) {
    for (int j = 0; j < pieces.count_v(); ++j) {
      const SurfacePiece piece = pieces.Piece(i, j, centre);
      Net& net = nets.emplace_back();
      for (int d = 0; d < 4; ++d) {
        Eigen::ArrayXXd values(piece.p + 1, piece.q + 1);
        for (int k = 0; k <= piece.p; ++k) {
          values.row(k) = piece.points.row(d).segment(k * (piece.q + 1), piece.q + 1);
        }
        (d < 3 ? net.numerators.emplace_back() : net.weight) = std::move(values);
      }
    }
  }
  return BoxOf(nets, centre, BoxDiagonal(surface.control_points()), 3);
}

}  // namespace batten
