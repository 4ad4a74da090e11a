// SPDX-License-Identifier: MIT
#include "geometry/foot_points/foot_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/bezier/bernstein_polynomial.h"
#include "geometry/bezier/bezier_span.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

// Bézier points of the part [a, b] of [0, 1] from those of the whole: row j is the blossom with p−j
// arguments at a and j at b.
Eigen::MatrixXd SegmentMatrix(int p, double a, double b) {
  Eigen::MatrixXd result(p + 1, p + 1);
  for (int j = 0; j <= p; ++j) {
    Eigen::MatrixXd d = Eigen::MatrixXd::Identity(p + 1, p + 1);
    for (int r = 1; r <= p; ++r) {
      const double x = r <= p - j ? a : b;
      for (int k = p; k >= r; --k) d.col(k) = (1 - x) * d.col(k - 1) + x * d.col(k);
    }
    result.row(j) = d.col(p);
  }
  return result;
}

// For every cell of an axis the matrix from the control points of its span to its Bézier points.
std::vector<Eigen::MatrixXd> CellMatrices(const SplineBasis& basis, const FootAxis& axis) {
  const int cuts = axis.cuts();
  std::vector<Eigen::MatrixXd> parts, result;
  for (int part = 0; part < cuts && cuts > 1; ++part)
    parts.push_back(SegmentMatrix(basis.degree(), double(part) / cuts, double(part + 1) / cuts));
  for (int cell = 0; cell < axis.cells(); cell += cuts) {
    const Eigen::MatrixXd whole = BezierSpanMatrix(basis, axis.span(cell));
    for (const Eigen::MatrixXd& part : parts) result.push_back(part * whole);
    if (parts.empty()) result.push_back(whole);
  }
  return result;
}

// Coefficients of x^r on [−1, 1] from Bernstein coefficients on [0, 1], t = (1 + x)/2.
Eigen::MatrixXd MonomialMatrix(int p) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(p + 1, p + 1);
  const std::vector<double>& choose = Binomials(p);
  for (int k = 0; k <= p; ++k) {
    // C(p,k) (1−x)^{p−k} (1+x)^k / 2^p
    std::vector<double> product{choose[k] * std::ldexp(1.0, -p)};
    for (int factor = 0; factor < p; ++factor) {
      const double sign = factor < k ? 1 : -1;
      product.push_back(0);
      for (size_t r = product.size() - 1; r > 0; --r) product[r] += sign * product[r - 1];
    }
    for (int r = 0; r <= p; ++r) result(r, k) = product[r];
  }
  return result;
}

}  // namespace

FootAxis::FootAxis(const SplineBasis& basis, int cuts)
    : degree_(basis.degree()), cuts_(cuts), periodic_(basis.periodic()) {
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    for (int k = 0; k < cuts; ++k) {
      breaks_.push_back(a + (b - a) * k / cuts);
      spans_.push_back(span);
    }
  }
  breaks_.push_back(basis.upper());
  // Between spans there are as many knots as their numbers differ by.
  for (int cell = 0; cell < cells(); ++cell) {
    const bool last = cell + 1 == cells();
    const int next = last ? spans_.front() + basis.size() - degree_ : spans_[cell + 1];
    smooth_after_.push_back((!last || periodic_) && next - spans_[cell] < degree_ ? 1 : 0);
  }
  Finish();
}

FootAxis FootAxis::Single() {
  FootAxis axis;
  axis.breaks_ = {0, 1};
  axis.spans_ = {0};
  axis.Finish();
  return axis;
}

FootAxis FootAxis::Row(int cells, int degree) {
  FootAxis axis;
  axis.degree_ = degree;
  for (int k = 0; k < cells; ++k) {
    axis.breaks_.push_back(k);
    axis.spans_.push_back(k);
  }
  axis.breaks_.push_back(cells);
  axis.Finish();
  return axis;
}

void FootAxis::Finish() {
  const int count = cells();
  smooth_after_.resize(count, 0);
  for (int k = 0; k < count; ++k) {
    half_.push_back((breaks_[k + 1] - breaks_[k]) / 2);
  }
  constexpr int kPerCell = 4;
  lookup_.assign(kPerCell * count + 1, 0);
  lookup_scale_ = kPerCell * count / (upper() - lower());
  if (!std::isfinite(lookup_scale_)) lookup_scale_ = 0;
  for (int k = 0, cell = 0; k <= kPerCell * count; ++k) {
    const double u = lower() + k / lookup_scale_;
    while (cell + 1 < count && breaks_[cell + 1] <= u) ++cell;
    lookup_[k] = cell;
  }
}

int FootAxis::Find(double u) const {
  const int last = static_cast<int>(lookup_.size()) - 1;
  const double place = (u - lower()) * lookup_scale_;
  const int k = place > 0 ? std::min(last, static_cast<int>(place)) : 0;
  // One cell of rounding on either side.
  int low = lookup_[std::max(0, k - 1)], high = lookup_[std::min(last, k + 1)];
  if (high - low <= 4) {
    while (low < high && breaks_[low + 1] <= u) ++low;
    return low;
  }
  const auto next = std::upper_bound(breaks_.begin() + low + 1, breaks_.begin() + high + 1, u);
  return std::min(high, static_cast<int>(next - breaks_.begin()) - 1);
}

void FootTable::Allocate() {
  const int p = degree_u(), q = degree_v();
  bezier_stride_ = static_cast<size_t>(4) * (p + 1) * (q + 1);
  padded_ = (coefficients() + 7) / 8 * 8;
  squares_stride_ = static_cast<size_t>(rational ? 5 : 4) * padded_;
  const auto count = static_cast<size_t>(pieces());
  bezier_.resize(count * bezier_stride_);
  if (monomial()) local_.resize(count * bezier_stride_);
  squares_.assign(count * squares_stride_, 0.0);
  centres.resize(count);
  radii.resize(count);
  boxes.resize(count);
  to_local_u_ = MonomialMatrix(p);
  to_local_v_ = MonomialMatrix(q);
}

void FootTable::SetPiece(int piece, const Eigen::Vector3d& centre, Eigen::Matrix4Xd net) {
  const int p = degree_u(), q = degree_v(), count = (p + 1) * (q + 1);
  net /= net.row(3).maxCoeff();
  if (!rational) net.row(3).setOnes();
  centres[piece] = centre;
  Eigen::AlignedBox3d box;
  double radius = 0;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d x = net.col(k).head<3>() / net(3, k);
    radius = std::max(radius, x.norm());
    box.extend(centre + x);
  }
  radii[piece] = radius;
  // Outward by what the net may be off.
  const Eigen::Vector3d slack =
      Eigen::Vector3d::Constant(16 * kEpsilon * radius) + 4 * kEpsilon * centre.cwiseAbs();
  boxes[piece] = {box.min() - slack, box.max() + slack};
  double* bezier = bezier_.data() + piece * bezier_stride_;
  Eigen::Map<Eigen::Matrix4Xd>(bezier, 4, count) = net;
  if (monomial()) {
    double* local = local_.data() + piece * bezier_stride_;
    for (int d = 0; d < 4; ++d) {
      Eigen::MatrixXd component(p + 1, q + 1);
      for (int k = 0; k < count; ++k) component(k / (q + 1), k % (q + 1)) = net(d, k);
      const Eigen::MatrixXd powers = to_local_u_ * component * to_local_v_.transpose();
      for (int k = 0; k < count; ++k) local[4 * k + d] = powers(k / (q + 1), k % (q + 1));
    }
  }
  std::vector<double> component[4];
  for (int d = 0; d < 4; ++d) {
    for (int k = 0; k < count; ++k) component[d].push_back(net(d, k));
  }
  double* rows = squares_.data() + piece * squares_stride_;
  for (int d = 0; d < 3; ++d) {
    const double* x = component[d].data();
    AddProduct(x, x, p, q, 1, rows);
    AddProduct(x, component[3].data(), p, q, -2, rows + (d + 1) * padded_);
  }
  if (rational) {
    AddProduct(component[3].data(), component[3].data(), p, q, 1, rows + 4 * padded_);
  }
  constexpr double kVeryLarge = 1e300;
  std::fill(rows + coefficients(), rows + padded_, kVeryLarge);
}

namespace {

// How many parts every span is cut into: pieces of high degree are cut, because the bounds of their
// products are weak.
int CutsFor(const SplineBasis& basis) { return basis.degree() <= 4 ? 1 : 2; }

template <typename Points>
void SetSize(const Points& points, double& size, Eigen::Vector3d& middle) {
  const Eigen::Index rows = points.rows();
  middle.setZero();
  const Eigen::VectorXd low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  middle.head(rows) = low + (high - low) / 2;
  size = (high - low).norm() / 2;
}

}  // namespace

FootTable::FootTable(const NurbsSurface& surface)
    : u(surface.basis_u(), CutsFor(surface.basis_u())),
      v(surface.basis_v(), CutsFor(surface.basis_v())),
      rational(surface.rational()) {
  SetSize(surface.control_points(), size, middle);
  Allocate();
  const int p = degree_u(), q = degree_v();
  const auto in_u = CellMatrices(surface.basis_u(), u), in_v = CellMatrices(surface.basis_v(), v);
  for (int i = 0; i < u.cells(); ++i) {
    for (int j = 0; j < v.cells(); ++j) {
      Eigen::Matrix3Xd points(3, (p + 1) * (q + 1));
      Eigen::VectorXd weights(points.cols());
      for (int r = 0; r <= p; ++r) {
        for (int s = 0; s <= q; ++s) {
          const Eigen::Index from =
              Eigen::Index{u.span(i) - p + r} * surface.size_v() + v.span(j) - q + s;
          points.col(r * (q + 1) + s) = surface.control_points().col(from);
          weights[r * (q + 1) + s] = rational ? surface.weights()[from] : 1;
        }
      }
      const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
      const Eigen::Vector3d centre = low + (high - low) / 2;
      points.colwise() -= centre;
      Eigen::Matrix4Xd net(4, points.cols());
      for (int d = 0; d < 4; ++d) {
        Eigen::MatrixXd component(p + 1, q + 1);
        for (Eigen::Index k = 0; k < points.cols(); ++k) {
          component(k / (q + 1), k % (q + 1)) = d < 3 ? weights[k] * points(d, k) : weights[k];
        }
        const Eigen::MatrixXd bezier = in_u[i] * component * in_v[j].transpose();
        for (Eigen::Index k = 0; k < points.cols(); ++k) {
          net(d, k) = bezier(k / (q + 1), k % (q + 1));
        }
      }
      SetPiece(i * v.cells() + j, centre, std::move(net));
    }
  }
}

template <int Dim>
FootTable::FootTable(const NurbsCurve<Dim>& curve)
    : u(curve.basis(), CutsFor(curve.basis())), v(FootAxis::Single()), rational(curve.rational()) {
  SetSize(curve.control_points(), size, middle);
  Allocate();
  const int p = degree_u();
  const std::vector<Eigen::MatrixXd> matrices = CellMatrices(curve.basis(), u);
  for (int i = 0; i < u.cells(); ++i) {
    const int first = u.span(i) - p;
    Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, p + 1);
    points.topRows<Dim>() = curve.control_points().middleCols(first, p + 1);
    const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
    const Eigen::Vector3d centre = low + (high - low) / 2;
    points.colwise() -= centre;
    Eigen::Matrix4Xd net = Eigen::Matrix4Xd::Ones(4, p + 1);
    if (rational) net.row(3) = curve.weights().segment(first, p + 1).transpose();
    net.topRows<3>() = points * net.row(3).asDiagonal();
    SetPiece(i, centre, net * matrices[i].transpose());
  }
}

FootTable::FootTable(const std::vector<Eigen::Matrix3Xd>& curves, const Eigen::Vector3d& origin)
    : u(FootAxis::Row(static_cast<int>(curves.size()), static_cast<int>(curves[0].cols()) - 1)),
      v(FootAxis::Single()) {
  Eigen::AlignedBox3d whole;
  for (const Eigen::Matrix3Xd& points : curves) {
    for (Eigen::Index k = 0; k < points.cols(); ++k) whole.extend(Eigen::Vector3d(points.col(k)));
  }
  size = whole.diagonal().norm() / 2;
  middle = origin + whole.center();
  Allocate();
  for (int i = 0; i < u.cells(); ++i) {
    const Eigen::Vector3d low = curves[i].rowwise().minCoeff();
    const Eigen::Vector3d high = curves[i].rowwise().maxCoeff();
    const Eigen::Vector3d centre = origin + (low + (high - low) / 2);
    Eigen::Matrix4Xd net = Eigen::Matrix4Xd::Ones(4, curves[i].cols());
    net.topRows<3>() = curves[i].colwise() - (centre - origin);
    SetPiece(i, centre, std::move(net));
  }
}

template FootTable::FootTable(const NurbsCurve<2>&);
template FootTable::FootTable(const NurbsCurve<3>&);

}  // namespace batten::internal
