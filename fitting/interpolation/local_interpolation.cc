// SPDX-License-Identifier: MIT
#include "batten/fitting/local_interpolation.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "fitting/interpolation/tangent_pieces.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten {
using namespace internal;

template <int Dim>
InterpolatedCurve<Dim> InterpolateLocally(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                          LocalPieces kind,
                                          const TangentOptions& options) {
  const PointTangents<Dim> tangents = TangentsAt<Dim>(points, options);
  const Eigen::Index m = points.cols(), steps = options.closed ? m : m - 1;
  // Points are relative to their middle, so that large coordinates cost no digits.
  const Eigen::Matrix<double, Dim, 1> middle =
      points.rowwise().minCoeff() + (points.rowwise().maxCoeff() - points.rowwise().minCoeff()) / 2;
  std::vector<ChainPiece<Dim>> pieces;
  std::vector<Eigen::Index> first;  // piece of every step
  for (Eigen::Index k = 0; k < steps; ++k) {
    const Eigen::Index next = (k + 1) % m;
    const DirectedPoint<Dim> start{points.col(k) - middle, tangents.leaving.col(k)},
        end{points.col(next) - middle, tangents.arriving.col(next)};
    first.push_back(static_cast<Eigen::Index>(pieces.size()));
    if (kind == LocalPieces::kCubics) {
      pieces.push_back(CubicPiece(start, end));
    } else {
      for (ChainPiece<Dim>& piece : ConicPieces(start, end, kind == LocalPieces::kConics)) {
        pieces.push_back(std::move(piece));
      }
    }
    const auto corner = std::lower_bound(tangents.corners.begin(), tangents.corners.end(), next);
    pieces.back().smooth = corner == tangents.corners.end() || *corner != next;
  }
  first.push_back(static_cast<Eigen::Index>(pieces.size()));
  auto [curve, breaks] = Chained<Dim>(pieces, options.closed);
  Eigen::VectorXd parameters(m);
  for (Eigen::Index k = 0; k < m; ++k) parameters[k] = breaks[first[static_cast<size_t>(k)]];
  return {Translated(curve, middle), std::move(parameters)};
}

template InterpolatedCurve<2> InterpolateLocally<2>(const Eigen::Matrix2Xd&,
                                                    LocalPieces,
                                                    const TangentOptions&);
template InterpolatedCurve<3> InterpolateLocally<3>(const Eigen::Matrix3Xd&,
                                                    LocalPieces,
                                                    const TangentOptions&);

}  // namespace batten
