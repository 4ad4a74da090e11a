// SPDX-License-Identifier: MIT
#include "geometry/intersection/normal_net.h"

#include "geometry/bezier/rational_patch.h"

namespace batten::internal {
namespace {

// A polynomial of degrees (m, n), its rows the components.
struct Form {
  int m, n;
  Eigen::MatrixXd rows;

  Form Rows(int first, int count) const { return {m, n, rows.middleRows(first, count)}; }
};

// The derivative by u or v over the degree.
Form Differences(const Form& f, bool by_u) {
  const int stride = by_u ? f.n + 1 : 1;
  Form d{f.m - (by_u ? 1 : 0), f.n - (by_u ? 0 : 1), {}};
  d.rows.resize(f.rows.rows(), (d.m + 1) * (d.n + 1));
  for (int i = 0; i <= d.m; ++i) {
    for (int j = 0; j <= d.n; ++j) {
      const int from = i * (f.n + 1) + j;
      d.rows.col(i * (d.n + 1) + j) = f.rows.col(from + stride) - f.rows.col(from);
    }
  }
  return d;
}

Form Times(const Form& f, const Form& g, int row) {
  return {f.m + g.m, f.n + g.n, PatchProduct(f.rows, f.m, f.n, g.rows.row(row), g.m, g.n)};
}

// f × g of three components each.
Form Cross(const Form& f, const Form& g) {
  const Form by_x = Times(f, g, 0), by_y = Times(f, g, 1), by_z = Times(f, g, 2);
  Form cross{by_x.m, by_x.n, Eigen::MatrixXd(3, by_x.rows.cols())};
  cross.rows.row(0) = by_z.rows.row(1) - by_y.rows.row(2);
  cross.rows.row(1) = by_x.rows.row(2) - by_z.rows.row(0);
  cross.rows.row(2) = by_y.rows.row(0) - by_x.rows.row(1);
  return cross;
}

}  // namespace

// With X = w·S: S_u × S_v · w³ = w X_u × X_v + (w_u X_v − w_v X_u) × X.
Eigen::Matrix3Xd NormalNet(const Eigen::Matrix4Xd& net, int p, int q, double rounding) {
  const Form form{p, q, net};
  const Form by_u = Differences(form, true), by_v = Differences(form, false);
  Form normals = Cross(by_u.Rows(0, 3), by_v.Rows(0, 3));
  if (by_u.rows.row(3).any() || by_v.rows.row(3).any()) {
    normals = Times(normals, form, 3);
    Form turning = Times(by_v.Rows(0, 3), by_u, 3);
    turning.rows -= Times(by_u.Rows(0, 3), by_v, 3).rows;
    normals.rows += Cross(turning, form.Rows(0, 3)).rows;
  }
  Eigen::Matrix3Xd vectors = normals.rows;
  const double least = rounding * vectors.colwise().norm().maxCoeff();
  for (Eigen::Index k = 0; k < vectors.cols(); ++k) {
    if (vectors.col(k).norm() <= least) vectors.col(k).setZero();
  }
  return vectors;
}

}  // namespace batten::internal
