// SPDX-License-Identifier: MIT
#include "geometry/joining/end_jet.h"

#include "geometry/numeric/construction_checks.h"
#include "geometry/nurbs/homogeneous.h"

namespace batten::internal {
namespace {

// rows: one column for each control point along the direction.
EndJet JetOfRows(const Eigen::MatrixXd& columns, const SplineBasis& basis, bool upper) {
  const int p = basis.degree();
  const double end = upper ? basis.upper() : basis.lower();
  const int span = basis.Span(end);
  Eigen::MatrixXd values(p + 1, 3);
  basis.Derivatives(span, end, 2, values.data());
  if (!upper) values.col(1) = -values.col(1);
  EndJet jet;
  for (int k = 0; k < 3; ++k) jet[k] = columns.middleCols(span - p, p + 1) * values.col(k);
  return jet;
}

}  // namespace

template <int Dim>
EndJet EndJetOf(const NurbsCurve<Dim>& curve, bool upper) {
  return JetOfRows(Homogeneous(curve), curve.basis(), upper);
}

EndJet EndJetOf(const NurbsSurface& surface, const SurfaceEdge& edge) {
  EndJet jet = JetOfRows(
      HomogeneousRows(surface, edge.direction), BasisOf(surface, edge.direction), edge.upper);
  for (Eigen::MatrixXd& columns : jet) {
    columns = columns.reshaped(4, columns.size() / 4).eval();
  }
  return jet;
}

EndJet Reparameterized(const EndJet& jet, const JoinFreedom& f) {
  return {f.alpha * jet[0],
          f.alpha * f.beta * jet[1] + f.eta * jet[0],
          f.alpha * f.beta * f.beta * jet[2] + (f.alpha * f.beta2 + 2 * f.eta * f.beta) * jet[1] +
              f.eta2 * jet[0]};
}

Eigen::MatrixXd Places(const Eigen::MatrixXd& columns,
                       const char* function,
                       const std::string& what) {
  const Eigen::Index dim = columns.rows() - 1;
  Eigen::MatrixXd places(dim, columns.cols());
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    RequireThat(
        columns(dim, k) > 0,
        function,
        "a weight becomes " + RoundedText(columns(dim, k)) + ", which is not positive; " + what);
    places.col(k) = columns.col(k).head(dim) / columns(dim, k);
  }
  return places;
}

template EndJet EndJetOf(const NurbsCurve<2>&, bool);
template EndJet EndJetOf(const NurbsCurve<3>&, bool);

}  // namespace batten::internal
