// SPDX-License-Identifier: MIT
#include "batten/geometry/regularity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "batten/geometry/trim_region.h"
#include "geometry/bezier/rational_patch.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/numeric/constants.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kDeepest =
    12;  // halvings: boxes at poles are then a 64th of a cell in either direction
constexpr int kMostBoxes = 4000;  // of one cell, left open before the rest is given up

// Rows x, y, z, w of a patch or its derivative by one parameter of [0, 1].
struct WeightedNet {
  int p, q;
  Eigen::Matrix4Xd columns;
  double reach() const { return columns.topRows<3>().cwiseAbs().maxCoeff(); }
  double weight() const { return columns.row(3).cwiseAbs().maxCoeff(); }
};

WeightedNet Derivative(const WeightedNet& net, bool by_u) {
  WeightedNet d{by_u ? net.p - 1 : net.p, by_u ? net.q : net.q - 1, {}};
  d.columns.resize(4, (d.p + 1) * (d.q + 1));
  const int step = by_u ? net.q + 1 : 1;
  for (int i = 0; i <= d.p; ++i) {
    for (int j = 0; j <= d.q; ++j) {
      const int at = i * (net.q + 1) + j;
      d.columns.col(i * (d.q + 1) + j) =
          (by_u ? net.p : net.q) * (net.columns.col(at + step) - net.columns.col(at));
    }
  }
  return d;
}

// d · (a × b).
Eigen::RowVectorXd Along(const Eigen::Vector3d& d, const WeightedNet& a, const WeightedNet& b) {
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero((a.p + b.p + 1) * (a.q + b.q + 1));
  for (int c = 0; c < 3; ++c) {
    const int x = (c + 1) % 3, y = (c + 2) % 3;
    sum += d[c] * (PatchProduct(a.columns.row(x), a.p, a.q, b.columns.row(y), b.p, b.q) -
                   PatchProduct(a.columns.row(y), a.p, a.q, b.columns.row(x), b.p, b.q));
  }
  return sum;
}

// The Bernstein coefficients of d · (w P_u × P_v + w_u P_v × P + w_v P × P_u), and what rounding
// may have made of each; `error` bounds that of a coordinate of the net.
bool KeepsSign(const WeightedNet& net, const Eigen::Vector3d& d, double error) {
  const WeightedNet du = Derivative(net, true), dv = Derivative(net, false);
  const double weight = net.weight(), weight_u = du.weight(), weight_v = dv.weight();
  const double p = net.reach(), pu = du.reach(), pv = dv.reach();
  const double of_u = 2 * net.p * error, of_v = 2 * net.q * error;
  double terms = weight * pu * pv, moved = weight * (of_u * pv + pu * of_v);
  const auto times =
      [](const Eigen::RowVectorXd& f, int m, int n, const WeightedNet& w) -> Eigen::RowVectorXd {
    return PatchProduct(f, m, n, w.columns.row(3), w.p, w.q);
  };
  Eigen::RowVectorXd value = times(Along(d, du, dv), du.p + dv.p, du.q + dv.q, net);
  if (weight_u > 0 || weight_v > 0) {
    value += times(Along(d, dv, net), dv.p + net.p, dv.q + net.q, du);
    value += times(Along(d, net, du), net.p + du.p, net.q + du.q, dv);
    terms += weight_u * pv * p + weight_v * p * pu;
    moved += weight_u * (of_v * p + pv * error) + weight_v * (error * pu + p * of_u);
  }
  const double margin = 12 * moved + 512 * (net.p + net.q) * kEpsilon * terms;
  return value.minCoeff() > margin;
}

Eigen::Vector3d DirectionOf(const WeightedNet& net) {
  const auto corner = [&](int i, int j) -> Eigen::Vector3d {
    const auto column = net.columns.col(i * (net.q + 1) + j);
    return column.head<3>() / column[3];
  };
  return (corner(net.p, net.q) - corner(0, 0))
      .cross(corner(0, net.q) - corner(net.p, 0))
      .normalized();
}

struct OpenPart {
  ParameterBox box;
  RationalPatch patch;
  int depth;
};

// Adds the parts of one cell that stay open.
void ProveCell(const SurfacePiece& piece,
               const TrimRegion* region,
               std::vector<ParameterBox>& open) {
  std::vector<OpenPart> waiting;
  waiting.push_back(
      {{piece.u0, piece.u1, piece.v0, piece.v1}, {piece.p, piece.q, piece.points}, 0});
  const double error = piece.errors.maxCoeff();
  int left = kMostBoxes;
  while (!waiting.empty()) {
    OpenPart part = std::move(waiting.back());
    waiting.pop_back();
    const WeightedNet net{part.patch.p, part.patch.q, part.patch.columns};
    const Eigen::Vector3d direction = DirectionOf(net);
    if (direction.allFinite() && KeepsSign(net, direction, error)) continue;
    if (region && region->CoverOf(part.box) == TrimRegion::Cover::kOutside) continue;
    if (part.depth == kDeepest || --left < 0) {
      open.push_back(part.box);
      continue;
    }
    const bool in_u = part.depth % 2 == 0;  // by turns: boxes stay as wide as high
    auto [low, high] = Halved(part.patch, in_u ? Direction::kU : Direction::kV);
    ParameterBox lower = part.box, upper = part.box;
    (in_u ? lower.u1 : lower.v1) = (in_u ? upper.u0 : upper.v0) =
        in_u ? (part.box.u0 + part.box.u1) / 2 : (part.box.v0 + part.box.v1) / 2;
    waiting.push_back({lower, std::move(low), part.depth + 1});
    waiting.push_back({upper, std::move(high), part.depth + 1});
  }
}

}  // namespace

std::vector<ParameterBox> UnprovedRegularity(const NurbsSurface& surface) {
  std::optional<TrimRegion> region;
  if (surface.trimmed()) region.emplace(surface);
  const SurfacePieces pieces(surface);
  std::vector<ParameterBox> open;
  for (int i = 0; i < pieces.count_u(); ++i)
    for (int j = 0; j < pieces.count_v(); ++j)
      ProveCell(pieces.Piece(i, j), region ? &*region : nullptr, open);
  return open;
}

}  // namespace batten
