// SPDX-License-Identifier: MIT
#include "fitting/flattening/rectangle_map.h"

#include <Eigen/Geometry>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <utility>
#include <vector>

#include "fitting/core/rounding.h"

namespace batten::internal {
namespace {

using Complex = std::complex<double>;

// Of the usual weight. Zero would let nodes fall together.
constexpr double kLeastCotangent = 1e-3;

std::map<std::pair<int, int>, double> CotangentWeights(const Eigen::Matrix3Xd& nodes,
                                                       const SheetTriangulation& sheet) {
  std::map<std::pair<int, int>, double> weights;
  for (const auto& t : sheet.triangles) {
    for (size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      const Eigen::Vector3d to_a = nodes.col(a) - nodes.col(c), to_b = nodes.col(b) - nodes.col(c);
      const double area = to_a.cross(to_b).norm();
      weights[{std::min(a, b), std::max(a, b)}] += area > 0 ? to_a.dot(to_b) / (2 * area) : 0;
    }
  }
  for (auto& [edge, weight] : weights) weight = std::max(weight, kLeastCotangent);
  return weights;
}

// Puts the nodes of the border onto the rectangle's.
void PlaceBorder(const Eigen::Matrix3Xd& nodes,
                 const std::vector<int>& loop,
                 std::array<size_t, 4> corners,
                 RectangleMap& map,
                 std::vector<bool>& fixed) {
  const size_t count = loop.size();
  const auto step = [&](size_t k) {
    return (nodes.col(loop[(k + 1) % count]) - nodes.col(loop[k % count])).norm();
  };
  const auto end_of = [&](size_t side) {
    return corners[(side + 1) % 4] + (side == 3 ? count : 0);
  };
  std::array<double, 4> lengths{};
  for (size_t side = 0; side < 4; ++side)
    for (size_t k = corners[side]; k < end_of(side); ++k) lengths[side] += step(k);
  if (lengths[1] + lengths[3] > lengths[0] + lengths[2]) {
    // Numbered from the next corner; places run on beyond the end of the loop.
    corners = {corners[1], corners[2], corners[3], corners[0] + count};
    lengths = {lengths[1], lengths[2], lengths[3], lengths[0]};
  }
  map.length_u = (lengths[0] + lengths[2]) / 2;
  map.length_v = (lengths[1] + lengths[3]) / 2;
  const std::array<Complex, 4> at = {Complex(0, 0),
                                     Complex(map.length_u, 0),
                                     Complex(map.length_u, map.length_v),
                                     Complex(0, map.length_v)};
  for (size_t side = 0; side < 4; ++side) {
    double way = 0;
    const size_t end = side < 3 ? corners[side + 1] : corners[0] + count;
    for (size_t k = corners[side]; k < end; ++k) {
      const int node = loop[k % count];
      const double share = lengths[side] > 0 ? way / lengths[side] : 0;
      map.places[node] = at[side] + share * (at[(side + 1) % 4] - at[side]);
      fixed[static_cast<size_t>(node)] = true;
      way += step(k);
    }
  }
}

void PlaceInside(const std::map<std::pair<int, int>, double>& weights,
                 const std::vector<bool>& fixed,
                 Eigen::VectorXcd& places) {
  std::vector<int> unknown(fixed.size(), -1);
  int count = 0;
  for (size_t i = 0; i < fixed.size(); ++i)
    if (!fixed[i]) unknown[i] = count++;
  if (count == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d rhs = Eigen::MatrixX2d::Zero(count, 2);
  const auto add = [&](int i, int j, double weight) {
    const int own = unknown[static_cast<size_t>(i)], other = unknown[static_cast<size_t>(j)];
    if (own < 0) return;
    entries.emplace_back(own, own, weight);
    if (other >= 0) {
      entries.emplace_back(own, other, -weight);
    } else {
      rhs.row(own) += weight * Eigen::RowVector2d(places[j].real(), places[j].imag());
    }
  };
  for (const auto& [edge, weight] : weights) {
    add(edge.first, edge.second, weight);
    add(edge.second, edge.first, weight);
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::MatrixX2d solution = solver.solve(rhs);
  for (size_t i = 0; i < fixed.size(); ++i) {
    if (unknown[i] < 0) continue;
    places[static_cast<Eigen::Index>(i)] =
        Complex(solution(unknown[i], 0), solution(unknown[i], 1));
  }
}

}  // namespace

RectangleMap MapOntoRectangle(const Eigen::Matrix3Xd& nodes,
                              const SheetTriangulation& sheet,
                              std::array<size_t, 4> corners) {
  RectangleMap map;
  map.places = Eigen::VectorXcd::Zero(nodes.cols());
  std::vector<bool> fixed(static_cast<size_t>(nodes.cols()), false);
  PlaceBorder(nodes, sheet.loops.front(), corners, map, fixed);
  PlaceInside(CotangentWeights(nodes, sheet), fixed, map.places);
  for (const auto& t : sheet.triangles) {
    const Complex a = map.places[t[1]] - map.places[t[0]], b = map.places[t[2]] - map.places[t[0]];
    // Three nodes of one side have no area.
    if (!((std::conj(a) * b).imag() > -kRelativeRounding * map.length_u * map.length_v))
      ++map.flipped;
  }
  return map;
}

}  // namespace batten::internal
