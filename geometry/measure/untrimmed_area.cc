// SPDX-License-Identifier: MIT
#include "geometry/measure/untrimmed_area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/bezier/spline_pieces.h"
#include "geometry/numeric/adaptive_sum.h"
#include "geometry/numeric/gauss_rule.h"
#include "geometry/nurbs/rational_derivatives.h"

namespace batten::internal {
namespace {

constexpr double kUntrimmedTolerance = 1e-10;
constexpr double kLeastAreaPart = 0x1p-40;  // of a span: shorter parts are not cut
constexpr size_t kMostAreaSplits = 10000, kMostSplitsPerPair = 100;

// Homogeneous Bézier nets, (p+1) × (q+1) each: w·x, w·y, w·z, w.
using AreaNet = std::array<Eigen::MatrixXd, 4>;

// A rectangle of a piece and its Bézier net; lengths of its sides as parts of the piece's; whether
// the tangents are proved to differ in direction.
struct AreaCell {
  AreaNet net;
  double width_u, width_v;
  bool apart;
  CellIntegral integral;
};

// One row a node: the Bernstein polynomials of the degree there.
Eigen::MatrixXd BasisAt(int degree, const GaussRule& rule) {
  Eigen::MatrixXd rows(rule.nodes.size(), degree + 1);
  double B[kMaxDegree + 1];
  for (Eigen::Index k = 0; k < rows.rows(); ++k) {
    BernsteinBasis(degree, rule.nodes[k], B);
    for (int i = 0; i <= degree; ++i) rows(k, i) = B[i];
  }
  return rows;
}

// The product of n Gauss nodes in u and in v, for nets of one bidegree.
class ProductRule {
 public:
  ProductRule(int p, int q, int count)
      : rule_(GaussLegendre(count)),
        in_u_(BasisAt(p, rule_)),
        in_v_(BasisAt(q, rule_).transpose()),
        slope_u_(p * BasisAt(p - 1, rule_)),
        slope_v_(q * BasisAt(q - 1, rule_).transpose()) {}

  // ∫∫ |S_s × S_t| ds dt over [0, 1]².
  double Integral(const AreaNet& net) const {
    const Eigen::Index p = in_u_.cols() - 1, q = in_v_.rows() - 1;
    std::array<Eigen::ArrayXXd, 4> point, du, dv;
    for (int d = 0; d < 4; ++d) {
      const Eigen::MatrixXd along_v = net[d] * in_v_;
      point[d] = in_u_ * along_v;
      du[d] = slope_u_ * (along_v.bottomRows(p) - along_v.topRows(p));
      dv[d] = in_u_ * ((net[d].rightCols(q) - net[d].leftCols(q)) * slope_v_);
    }
    for (int d = 0; d < 3; ++d) {  // the quotient rule
      du[d] -= du[3] / point[3] * point[d];
      dv[d] -= dv[3] / point[3] * point[d];
    }
    const Eigen::ArrayXXd x = du[1] * dv[2] - du[2] * dv[1], y = du[2] * dv[0] - du[0] * dv[2],
                          z = du[0] * dv[1] - du[1] * dv[0];
    const Eigen::MatrixXd density =
        ((x.square() + y.square() + z.square()).sqrt() / point[3].square()).matrix();
    return rule_.weights.dot(density * rule_.weights);
  }

 private:
  GaussRule rule_;
  Eigen::MatrixXd in_u_, in_v_, slope_u_, slope_v_;
};

// Products of Bernstein polynomials of degree n: B_i B_j = part(i,j) B_{i+j} of degree 2n.
Eigen::MatrixXd ProductParts(int n) {
  Eigen::MatrixXd parts(n + 1, n + 1);
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      parts(i, j) = Binomial(n, i) * Binomial(n, j) / Binomial(2 * n, i + j);
    }
  }
  return parts;
}

// A cone of directions: its axis and the sine and cosine of its half angle. Wider than 84° counts
// as no cone.
struct Cone {
  Eigen::Vector3d axis;
  double cosine, sine;
};
std::optional<Cone> ConeOf(const Eigen::Matrix3Xd& directions) {
  constexpr double kWidest = 0.1;
  Cone cone{directions.rowwise().sum().normalized(), 1, 0};
  for (const auto& direction : directions.colwise()) {
    const double length = direction.norm();
    if (length > 0) cone.cosine = std::min(cone.cosine, direction.dot(cone.axis) / length);
  }
  cone.sine = std::sqrt(std::max(0.0, 1 - cone.cosine * cone.cosine));
  if (!(cone.cosine > kWidest)) return std::nullopt;
  return cone;
}

// Bézier points of vectors along S_s, rows being the direction of s: differences or, for a rational
// net, those of the numerator X1 w0 − X0 w1 where X0 and X1 are the nets without their last and
// first row. [Floater 1992]
Eigen::Matrix3Xd Directions(const AreaNet& net,
                            const Eigen::MatrixXd& in_s,
                            const Eigen::MatrixXd& in_t) {
  const Eigen::Index p = net[3].rows() - 1, q = net[3].cols() - 1;
  if ((net[3].array() == net[3](0, 0)).all()) {
    Eigen::Matrix3Xd differences(3, p * (q + 1));
    for (int d = 0; d < 3; ++d) {
      differences.row(d) = (net[d].bottomRows(p) - net[d].topRows(p)).reshaped().transpose();
    }
    return differences;
  }
  Eigen::Matrix3Xd product = Eigen::Matrix3Xd::Zero(3, (2 * p - 1) * (2 * q + 1));
  for (Eigen::Index i = 0; i < p; ++i) {
    for (Eigen::Index k = 0; k < p; ++k) {
      for (Eigen::Index j = 0; j <= q; ++j) {
        for (Eigen::Index l = 0; l <= q; ++l) {
          const double part = in_s(i, k) * in_t(j, l);
          const double w1 = part * net[3](k, l), w0 = part * net[3](i + 1, j);
          auto sum = product.col((i + k) * (2 * q + 1) + j + l);
          for (int d = 0; d < 3; ++d) sum[d] += net[d](i + 1, j) * w1 - net[d](k, l) * w0;
        }
      }
    }
  }
  return product;
}

AreaNet Transposed(const AreaNet& net) {
  return {net[0].transpose(), net[1].transpose(), net[2].transpose(), net[3].transpose()};
}

// Integrates cells of one bidegree.
class Quadrature {
 public:
  Quadrature(int p, int q)
      : fine_(p, q, 12),
        coarse_(p, q, 8),
        u_(ProductParts(p)),
        v_(ProductParts(q)),
        less_u_(ProductParts(p - 1)),
        less_v_(ProductParts(q - 1)) {}

  // `apart` says that it is proved for a greater cell.
  AreaCell Measured(AreaNet net, double width_u, double width_v, bool apart) const {
    const double fine = fine_.Integral(net);
    double error = std::abs(fine - coarse_.Integral(net));
    apart = apart || TangentsApart(net);
    if (!apart) error = std::max(error, kHidden * fine);
    return {std::move(net), width_u, width_v, apart, {fine, error}};
  }

 private:
  // The part of an integral that a fold between the side of a cell and the nodes next to it, at
  // 0.0092 of its width, can hide: twice the square of that.
  static constexpr double kHidden = 2e-4;

  // Whether no line lies in the cones of both tangents: then S_s × S_t vanishes at most with one of
  // them, and nothing hides between the nodes of a rule.
  bool TangentsApart(const AreaNet& net) const {
    const auto a = ConeOf(Directions(net, less_u_, v_));
    if (!a) return false;
    const auto b = ConeOf(Directions(Transposed(net), less_v_, u_));
    // |axis · axis| < cos(sum of the half angles)
    return b && std::abs(a->axis.dot(b->axis)) < a->cosine * b->cosine - a->sine * b->sine;
  }

  ProductRule fine_, coarse_;
  Eigen::MatrixXd u_, v_, less_u_, less_v_;
};

// De Casteljau along the rows at t: the nets of [0, t] and of [t, 1].
std::pair<AreaNet, AreaNet> CutRows(AreaNet net, double t) {
  AreaNet first = net;
  const Eigen::Index p = net[0].rows() - 1;
  for (int d = 0; d < 4; ++d) {
    for (Eigen::Index k = 1; k <= p; ++k) {
      for (Eigen::Index i = 0; i <= p - k; ++i) {
        net[d].row(i) = (1 - t) * net[d].row(i) + t * net[d].row(i + 1);
      }
      first[d].row(k) = net[d].row(0);
    }
  }
  return {std::move(first), std::move(net)};
}

// The net of [t0, t1] along the rows.
AreaNet PartOfRows(AreaNet net, double t0, double t1) {
  if (t1 < 1) net = CutRows(std::move(net), t1).first;
  if (t0 > 0) net = CutRows(std::move(net), t0 / t1).second;
  return net;
}

std::vector<AreaCell> Split(const Quadrature& quadrature, const AreaCell& cell) {
  std::vector<AreaCell> parts;
  const bool cut_u = cell.width_u > kLeastAreaPart, cut_v = cell.width_v > kLeastAreaPart;
  const double width_u = cut_u ? cell.width_u / 2 : cell.width_u;
  const double width_v = cut_v ? cell.width_v / 2 : cell.width_v;
  std::vector<AreaNet> halves{cell.net};
  if (cut_u) {
    auto [first, second] = CutRows(cell.net, 0.5);
    halves = {std::move(first), std::move(second)};
  }
  for (AreaNet& half : halves) {
    if (!cut_v) {
      parts.push_back(quadrature.Measured(std::move(half), width_u, width_v, cell.apart));
      continue;
    }
    const auto [first, second] = CutRows(Transposed(half), 0.5);
    parts.push_back(quadrature.Measured(Transposed(first), width_u, width_v, cell.apart));
    parts.push_back(quadrature.Measured(Transposed(second), width_u, width_v, cell.apart));
  }
  return parts;
}

// What part of a span's own parameters lies in [low, high]; empty for none.
struct Part {
  int span;
  double t0, t1;
};
std::vector<Part> PartsIn(const SplineBasis& basis, double low, double high) {
  std::vector<Part> parts;
  const std::vector<int> spans = basis.Spans();
  for (int k = 0; k < static_cast<int>(spans.size()); ++k) {
    const double a = basis.knots()[spans[k]], b = basis.knots()[spans[k] + 1];
    if (b <= low || a >= high) continue;
    parts.push_back(
        {k, std::max(0.0, (low - a) / (b - a)), high >= b ? 1.0 : (high - a) / (b - a)});
  }
  return parts;
}

std::vector<Part> Parts(const SplineBasis& basis, double low, double high, const char* name) {
  std::vector<Part> parts;
  for (const DomainStretch& stretch : StretchesInDomain(basis, low, high, name)) {
    for (const Part& part : PartsIn(basis, stretch.low, stretch.high)) parts.push_back(part);
  }
  return parts;
}

AreaNet NetOf(const SurfacePiece& piece, const Part& u, const Part& v) {
  AreaNet net;
  for (int d = 0; d < 4; ++d) {
    net[d].resize(piece.p + 1, piece.q + 1);
    for (int i = 0; i <= piece.p; ++i) {
      net[d].row(i) = piece.points.row(d).segment(i * (piece.q + 1), piece.q + 1);
    }
  }
  net = PartOfRows(std::move(net), u.t0, u.t1);
  return Transposed(PartOfRows(Transposed(net), v.t0, v.t1));
}

// What |S_s × S_t| of a piece is a rounding of: the greatest steps along the net.
double StepProduct(const SurfacePiece& piece) {
  double along_u = 0, along_v = 0;
  for (int i = 0; i <= piece.p; ++i) {
    for (int j = 0; j <= piece.q; ++j) {
      const Eigen::Vector3d here = piece.Euclidean(i, j);
      if (i < piece.p) along_u = std::max(along_u, (piece.Euclidean(i + 1, j) - here).norm());
      if (j < piece.q) along_v = std::max(along_v, (piece.Euclidean(i, j + 1) - here).norm());
    }
  }
  return piece.p * along_u * piece.q * along_v;
}

}  // namespace

std::vector<DomainStretch> StretchesInDomain(const SplineBasis& basis,
                                             double low,
                                             double high,
                                             const char* name) {
  const auto reject = [&](const std::string& rule) {
    throw std::invalid_argument("Area: " + std::string(name) + " in [" + std::to_string(low) +
                                ", " + std::to_string(high) + "] " + rule);
  };
  if (!(low <= high)) reject("is not an interval");
  if (!basis.periodic()) {
    if (low < basis.lower() || high > basis.upper()) {
      reject("is not inside the domain [" + std::to_string(basis.lower()) + ", " +
             std::to_string(basis.upper()) + "]");
    }
    return {{low, high}};
  }
  const double period = basis.upper() - basis.lower();
  if (!(high - low <= period)) reject("is longer than one period");
  const double start = basis.Clamp(low), end = start + (high - low);
  if (end <= basis.upper()) return {{start, end}};
  return {{start, basis.upper()}, {basis.lower(), end - period}};
}

double UntrimmedArea(const NurbsSurface& surface, double u0, double u1, double v0, double v1) {
  const Quadrature quadrature(surface.basis_u().degree(), surface.basis_v().degree());
  const SurfacePieces pieces(surface);
  const std::vector<Part> in_v = Parts(surface.basis_v(), v0, v1, "v");
  std::vector<AreaCell> cells;
  double negligible = 0;
  for (const Part& u : Parts(surface.basis_u(), u0, u1, "u")) {
    for (const Part& v : in_v) {
      const SurfacePiece piece = pieces.Piece(u.span, v.span);
      const double width_u = u.t1 - u.t0, width_v = v.t1 - v.t0;
      cells.push_back(quadrature.Measured(NetOf(piece, u, v), width_u, width_v, false));
      negligible += std::numeric_limits<double>::epsilon() * StepProduct(piece) * width_u * width_v;
    }
  }
  const size_t most = kMostAreaSplits + kMostSplitsPerPair * cells.size();
  RefineUntilExact(cells, kUntrimmedTolerance, negligible, most, [&](const AreaCell& cell) {
    return Split(quadrature, cell);
  });
  CarriedSum sum;
  for (const AreaCell& cell : cells) sum.Add(cell.integral.value);
  return sum.value();
}

}  // namespace batten::internal
