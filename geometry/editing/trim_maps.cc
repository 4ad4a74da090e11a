// SPDX-License-Identifier: MIT
#include "geometry/editing/trim_maps.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "batten/geometry/remove_knots.h"
#include "geometry/bezier/bernstein.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/editing/control_rows.h"

namespace batten::internal {
namespace {

int AxisOf(Direction direction) { return direction == Direction::kU ? 0 : 1; }

// The loop with one coordinate of its control points changed: for maps that are linear.
template <typename Map>
NurbsCurve<2> WithAxis(const NurbsCurve<2>& loop, int axis, const Map& map) {
  Eigen::Matrix2Xd points = loop.control_points();
  for (double& x : points.row(axis)) x = map(x);
  return NurbsCurve<2>(loop.basis(), std::move(points), loop.weights());
}

// Ends go to ends exactly.
auto LinearMap(const SplineBasis& basis, double a, double b) {
  return [lower = basis.lower(), upper = basis.upper(), a, b](double x) {
    const double length = upper - lower;
    if (x - lower < upper - x) return a + (b - a) * ((x - lower) / length);
    return b - (b - a) * ((upper - x) / length);
  };
}

// Homogeneous Bézier nets (x, y, w) one after another, and the breaks between them.
struct NetChain {
  std::vector<Eigen::MatrixXd> nets;
  std::vector<double> breaks;
};

// Rows (wτ, wy, w) of a piece, τ along the axis that is mapped.
Eigen::MatrixXd UnitNet(const CurvePiece& piece, int axis, const SplineBasis& basis) {
  Eigen::MatrixXd net(3, piece.points.cols());
  net.row(2) = piece.points.row(3);
  const double length = basis.upper() - basis.lower();
  net.row(axis) =
      (piece.points.row(axis) + (piece.origin[axis] - basis.lower()) * net.row(2)) / length;
  net.row(1 - axis) = piece.points.row(1 - axis) + piece.origin[1 - axis] * net.row(2);
  return net;
}

void AddMobius(
    const Eigen::MatrixXd& net, int axis, double ratio, double end, int halvings, NetChain& chain) {
  constexpr int kMostHalvings = 24;
  constexpr double kLeastWeight = 0x1p-10;  // of the greatest
  const Eigen::MatrixXd denominator = net.row(2) + (ratio - 1) * net.row(axis);
  const Eigen::MatrixXd weight = net.row(2);
  Eigen::MatrixXd image = BernsteinProduct(net, denominator.row(0));
  image.row(axis) = BernsteinProduct(ratio * net.row(axis), weight.row(0));
  const double start = chain.breaks.back();
  if (image.row(2).minCoeff() > kLeastWeight * image.row(2).cwiseAbs().maxCoeff()) {
    chain.nets.push_back(std::move(image));
    chain.breaks.push_back(end);
    return;
  }
  if (halvings == kMostHalvings) {
    throw std::invalid_argument("MobiusReparameterized: a trim loop meets the pole of the map");
  }
  const auto [first, second] = SplitBernstein(net, 0.5);
  AddMobius(first, axis, ratio, start + (end - start) / 2, halvings + 1, chain);
  AddMobius(second, axis, ratio, end, halvings + 1, chain);
}

// One clamped curve whose breaks are knots of multiplicity p.
NurbsCurve<2> CurveOf(const NetChain& chain) {
  const int p = static_cast<int>(chain.nets.front().cols()) - 1;
  const Eigen::Index count = p * static_cast<Eigen::Index>(chain.nets.size()) + 1;
  Eigen::Matrix2Xd points(2, count);
  Eigen::VectorXd weights(count);
  std::vector<double> knots(1, chain.breaks.front());
  for (const double at : chain.breaks) knots.insert(knots.end(), p, at);
  knots.push_back(chain.breaks.back());
  for (size_t k = 0; k < chain.nets.size(); ++k) {
    const Eigen::MatrixXd& net = chain.nets[k];
    const Eigen::Index first = p * static_cast<Eigen::Index>(k);
    points.middleCols(first, p + 1) = net.topRows<2>().array().rowwise() / net.row(2).array();
    weights.segment(first, p + 1) = net.row(2).transpose();
  }
  return NurbsCurve<2>(SplineBasis(p, std::move(knots)), std::move(points), std::move(weights));
}

// Takes away what knots the continuity of the old loop allows.
NurbsCurve<2> Simplified(NurbsCurve<2> image, const NurbsCurve<2>& old) {
  constexpr double kRounding = 1e-13;
  const int p = old.basis().degree();
  const double size =
      (image.control_points().rowwise().maxCoeff() - image.control_points().rowwise().minCoeff())
          .maxCoeff();
  const std::vector<int> spans = old.basis().Spans();
  for (size_t k = 1; k < spans.size(); ++k) {
    const double knot = old.basis().knots()[spans[k]];
    const int times = p - old.basis().Multiplicity(knot);
    if (times > 0) image = RemoveKnot(image, knot, times, kRounding * size).shape;
  }
  return image;
}

}  // namespace

TrimLoops ReversedTrims(const TrimLoops& loops, Direction direction, const SplineBasis& basis) {
  TrimLoops images;
  for (const NurbsCurve<2>& loop : loops) {
    const auto map = LinearMap(basis, basis.upper(), basis.lower());
    images.push_back(Edited(WithAxis(loop, AxisOf(direction), map), ReversedRows));
  }
  return images;
}

TrimLoops SwappedTrims(const TrimLoops& loops) {
  TrimLoops images;
  for (const NurbsCurve<2>& loop : loops) {
    images.push_back(Edited(
        NurbsCurve<2>(loop.basis(), loop.control_points().colwise().reverse(), loop.weights()),
        ReversedRows));
  }
  return images;
}

TrimLoops ScaledTrims(
    const TrimLoops& loops, Direction direction, const SplineBasis& basis, double a, double b) {
  TrimLoops images;
  for (const NurbsCurve<2>& loop : loops) {
    images.push_back(WithAxis(loop, AxisOf(direction), LinearMap(basis, a, b)));
  }
  return images;
}

TrimLoops MobiusTrims(const TrimLoops& loops,
                      Direction direction,
                      const SplineBasis& basis,
                      double a,
                      double b,
                      double ratio) {
  const int axis = AxisOf(direction);
  TrimLoops images;
  for (const NurbsCurve<2>& loop : loops) {
    if (2 * loop.basis().degree() > kMaxDegree) {
      throw std::invalid_argument("MobiusReparameterized: the image of a trim loop of degree " +
                                  std::to_string(loop.basis().degree()) +
                                  " would have twice that, more than " +
                                  std::to_string(kMaxDegree));
    }
    NetChain chain{{}, {loop.basis().lower()}};
    for (const CurvePiece& piece : PiecesOf(loop)) {
      AddMobius(UnitNet(piece, axis, basis), axis, ratio, piece.u1, 0, chain);
    }
    for (Eigen::MatrixXd& net : chain.nets) {
      net.row(axis) = a * net.row(2) + (b - a) * net.row(axis);
    }
    images.push_back(Simplified(CurveOf(chain), loop));
  }
  return images;
}

}  // namespace batten::internal
