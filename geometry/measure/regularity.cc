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

OpenPart Whole(const SurfacePiece& piece) {
  return {{piece.u0, piece.u1, piece.v0, piece.v1}, {piece.p, piece.q, piece.points}, 0};
}

// Across the directions by turns: parts stay as wide as high.
std::pair<OpenPart, OpenPart> Split(const OpenPart& part) {
  const bool in_u = part.depth % 2 == 0;
  auto [low, high] = Halved(part.patch, in_u ? Direction::kU : Direction::kV);
  ParameterBox lower = part.box, upper = part.box;
  (in_u ? lower.u1 : lower.v1) = (in_u ? upper.u0 : upper.v0) =
      in_u ? (part.box.u0 + part.box.u1) / 2 : (part.box.v0 + part.box.v1) / 2;
  return {{lower, std::move(low), part.depth + 1}, {upper, std::move(high), part.depth + 1}};
}

WeightedNet NetOf(const OpenPart& part) { return {part.patch.p, part.patch.q, part.patch.columns}; }

bool Outside(const TrimRegion* region, const ParameterBox& box) {
  return region && region->CoverOf(box) == TrimRegion::Cover::kOutside;
}

// Adds the parts of one cell that stay open.
void ProveCell(const SurfacePiece& piece,
               const TrimRegion* region,
               std::vector<ParameterBox>& open) {
  std::vector<OpenPart> waiting{Whole(piece)};
  const double error = piece.errors.maxCoeff();
  int left = kMostBoxes;
  while (!waiting.empty()) {
    const OpenPart part = std::move(waiting.back());
    waiting.pop_back();
    const WeightedNet net = NetOf(part);
    if (KeepsSign(net, DirectionOf(net), error) || Outside(region, part.box)) continue;
    if (part.depth == kDeepest || --left < 0) {
      open.push_back(part.box);
      continue;
    }
    auto [low, high] = Split(part);
    waiting.push_back(std::move(low));
    waiting.push_back(std::move(high));
  }
}

// Adds what stays open of the line of knots between two cells, where tangent planes may jump: the
// parts next to it are to have their normals on one side of a plane.
void ProveCrease(const SurfacePiece& before,
                 const SurfacePiece& after,
                 Direction across,
                 const TrimRegion* region,
                 std::vector<ParameterBox>& open) {
  std::vector<std::pair<OpenPart, OpenPart>> waiting;
  waiting.emplace_back(Whole(before), Whole(after));
  const double error_before = before.errors.maxCoeff(), error_after = after.errors.maxCoeff();
  while (!waiting.empty()) {
    const auto [left, right] = std::move(waiting.back());
    waiting.pop_back();
    const WeightedNet one = NetOf(left), other = NetOf(right);
    const Eigen::Vector3d direction = (DirectionOf(one) + DirectionOf(other)).normalized();
    if (KeepsSign(one, direction, error_before) && KeepsSign(other, direction, error_after))
      continue;
    if (Outside(region, left.box)) continue;
    if (left.depth == kDeepest) {
      ParameterBox line = left.box;
      (across == Direction::kU ? line.u0 : line.v0) = across == Direction::kU ? line.u1 : line.v1;
      open.push_back(line);
      continue;
    }
    const bool towards = (left.depth % 2 == 0) == (across == Direction::kU);
    auto [left_low, left_high] = Split(left);
    auto [right_low, right_high] = Split(right);
    if (towards) {
      waiting.emplace_back(std::move(left_high), std::move(right_low));
    } else {
      waiting.emplace_back(std::move(left_low), std::move(right_low));
      waiting.emplace_back(std::move(left_high), std::move(right_high));
    }
  }
}

bool MayCrease(const SplineBasis& basis, double knot) {
  return std::count(basis.knots().begin(), basis.knots().end(), knot) >= basis.degree();
}

}  // namespace

std::vector<ParameterBox> UnprovedRegularity(const NurbsSurface& surface) {
  std::optional<TrimRegion> trims;
  if (surface.trimmed()) trims.emplace(surface);
  const TrimRegion* const region = trims ? &*trims : nullptr;
  const SurfacePieces pieces(surface);
  std::vector<ParameterBox> open;
  for (int i = 0; i < pieces.count_u(); ++i) {
    for (int j = 0; j < pieces.count_v(); ++j) {
      const SurfacePiece piece = pieces.Piece(i, j);
      ProveCell(piece, region, open);
      if (i > 0 && MayCrease(surface.basis_u(), piece.u0))
        ProveCrease(pieces.Piece(i - 1, j), piece, Direction::kU, region, open);
      if (j > 0 && MayCrease(surface.basis_v(), piece.v0))
        ProveCrease(pieces.Piece(i, j - 1), piece, Direction::kV, region, open);
    }
  }
  return open;
}

}  // namespace batten
