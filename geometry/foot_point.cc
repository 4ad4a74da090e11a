// SPDX-License-Identifier: MIT
#include "batten/geometry/foot_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "batten/geometry/bezier_span.h"

namespace batten {
namespace {

constexpr int kMaxNewtonSteps = 60;
constexpr int kMaxHalvings = 30;
constexpr int kSamples = 4;  // a piece is sampled on a 4 × 4 grid of cell midpoints
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// The Newton step for f = |S − q|²/2 in the parameters that are free; a parameter at a side of the box
// is held when the descent leads out. Indefinite Hessians are shifted by their lowest eigenvalue.
Eigen::Vector2d FootStep(const SurfaceJet& jet,
                         const Eigen::Vector3d& difference,
                         bool free_u,
                         bool free_v,
                         const Eigen::Vector2d& gradient) {
  double a = jet.du.squaredNorm() + difference.dot(jet.duu);
  const double b = jet.du.dot(jet.dv) + difference.dot(jet.duv);
  double c = jet.dv.squaredNorm() + difference.dot(jet.dvv);
  const double scale_u = jet.du.squaredNorm(), scale_v = jet.dv.squaredNorm();
  if (!free_u || !free_v) {
    // Uphill curvature: fall back to the positive scale of the first derivatives.
    const double h = free_u ? a : c;
    const double fallback = free_u ? scale_u : scale_v;
    const double curvature = h > 1e-12 * fallback ? h : std::max(fallback, std::abs(h));
    const double g = free_u ? gradient[0] : gradient[1];
    const double step = curvature > 0 ? -g / curvature : 0;
    return free_u ? Eigen::Vector2d(step, 0) : Eigen::Vector2d(0, step);
  }
  // Scale to unit first derivatives, so that the shift means the same in both parameters.
  const double su = scale_u > 0 ? 1 / std::sqrt(scale_u) : 1;
  const double sv = scale_v > 0 ? 1 / std::sqrt(scale_v) : 1;
  a *= su * su;
  c *= sv * sv;
  const double bs = b * su * sv;
  const double mean = (a + c) / 2, radius = std::hypot((a - c) / 2, bs);
  const double lowest = mean - radius;
  constexpr double kLeastCurvature = 1e-3;
  if (lowest < kLeastCurvature * std::max(1.0, mean + radius)) {
    const double shift = kLeastCurvature * std::max(1.0, std::abs(mean) + radius) - lowest +
                         (lowest < 0 ? -lowest : 0);
    a += shift;
    c += shift;
  }
  const double gu = gradient[0] * su, gv = gradient[1] * sv;
  const double det = a * c - bs * bs;
  return Eigen::Vector2d(-su * (c * gu - bs * gv) / det, -sv * (a * gv - bs * gu) / det);
}

}  // namespace

SurfaceFoot LocalFootPoint(const NurbsSurface& surface,
                           const Eigen::Vector3d& q,
                           double u,
                           double v,
                           const ParameterBox& box) {
  u = std::clamp(u, box.u0, box.u1);
  v = std::clamp(v, box.v0, box.v1);
  SurfaceJet jet = surface.JetAt(u, v);
  double value = (jet.point - q).squaredNorm();
  for (int iteration = 0; iteration < kMaxNewtonSteps; ++iteration) {
    const Eigen::Vector3d difference = jet.point - q;
    const Eigen::Vector2d gradient(difference.dot(jet.du), difference.dot(jet.dv));
    const bool free_u = !((u <= box.u0 && gradient[0] >= 0) || (u >= box.u1 && gradient[0] <= 0));
    const bool free_v = !((v <= box.v0 && gradient[1] >= 0) || (v >= box.v1 && gradient[1] <= 0));
    if (!free_u && !free_v) break;
    Eigen::Vector2d step = FootStep(jet, difference, free_u, free_v, gradient);
    bool moved = false;
    for (int halving = 0; halving < kMaxHalvings; ++halving, step *= 0.5) {
      const double nu = std::clamp(u + step[0], box.u0, box.u1);
      const double nv = std::clamp(v + step[1], box.v0, box.v1);
      if (std::abs(nu - u) <= 4 * kEpsilon * (std::abs(u) + box.u1 - box.u0) &&
          std::abs(nv - v) <= 4 * kEpsilon * (std::abs(v) + box.v1 - box.v0)) {
        break;
      }
      const SurfaceJet trial = surface.JetAt(nu, nv);
      const double trial_value = (trial.point - q).squaredNorm();
      if (trial_value < value) {
        moved = value - trial_value > 4 * kEpsilon * value || halving == 0;
        u = nu;
        v = nv;
        jet = trial;
        value = trial_value;
        break;
      }
    }
    if (!moved) break;
  }
  return {u, v, jet.point, std::sqrt(value)};
}

SurfaceFoot LocalFootPoint(const NurbsSurface& surface, const Eigen::Vector3d& q, double u, double v) {
  return LocalFootPoint(surface, q, u, v,
                        {surface.basis_u().lower(), surface.basis_u().upper(),
                         surface.basis_v().lower(), surface.basis_v().upper()});
}

// A binary tree of boxes over the Bézier pieces.
struct SurfaceFootPoints::Tree {
  struct Piece {
    ParameterBox box;
    Eigen::AlignedBox3d hull;
    std::array<Eigen::Vector3d, kSamples * kSamples> samples;
  };
  struct Node {
    Eigen::AlignedBox3d hull;
    int left = -1, right = -1;  // children, or
    int piece = -1;             // a leaf
  };

  explicit Tree(NurbsSurface s) : surface(std::move(s)) {
    MakePieces();
    std::vector<int> order(pieces.size());
    std::iota(order.begin(), order.end(), 0);
    nodes.reserve(2 * pieces.size());
    Build(order.data(), static_cast<int>(order.size()));
  }

  void MakePieces() {
    const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
    const int p = bu.degree(), q = bv.degree();
    const std::vector<int> spans_v = bv.Spans();
    std::vector<Eigen::MatrixXd> to_bezier_v;
    for (const int j : spans_v) to_bezier_v.push_back(BezierSpanMatrix(bv, j));
    for (const int i : bu.Spans()) {
      const Eigen::MatrixXd to_bezier_u = BezierSpanMatrix(bu, i);
      for (size_t k = 0; k < spans_v.size(); ++k) {
        const int j = spans_v[k];
        Piece piece;
        piece.box = {bu.knots()[i], bu.knots()[i + 1], bv.knots()[j], bv.knots()[j + 1]};
        Eigen::MatrixXd net[4];
        for (auto& component : net) component.resize(p + 1, q + 1);
        for (int r = 0; r <= p; ++r) {
          for (int s = 0; s <= q; ++s) {
            const Eigen::Index column = Eigen::Index{i - p + r} * surface.size_v() + j - q + s;
            const double w = surface.weights()[column];
            for (int d = 0; d < 3; ++d) net[d](r, s) = w * surface.control_points()(d, column);
            net[3](r, s) = w;
          }
        }
        for (auto& component : net) {
          component = to_bezier_u * component * to_bezier_v[k].transpose();
        }
        for (int r = 0; r <= p; ++r) {
          for (int s = 0; s <= q; ++s) {
            piece.hull.extend(Eigen::Vector3d(net[0](r, s), net[1](r, s), net[2](r, s)) / net[3](r, s));
          }
        }
        const double size = std::max(piece.hull.min().cwiseAbs().maxCoeff(),
                                     piece.hull.max().cwiseAbs().maxCoeff());
        const Eigen::Vector3d slack = Eigen::Vector3d::Constant(64 * kEpsilon * size);
        piece.hull.min() -= slack;
        piece.hull.max() += slack;
        for (int r = 0; r < kSamples; ++r) {
          for (int s = 0; s < kSamples; ++s) {
            piece.samples[r * kSamples + s] = surface.At(SampleU(piece, r), SampleV(piece, s));
          }
        }
        pieces.push_back(std::move(piece));
      }
    }
  }

  static double SampleU(const Piece& piece, int r) {
    return piece.box.u0 + (piece.box.u1 - piece.box.u0) * (r + 0.5) / kSamples;
  }
  static double SampleV(const Piece& piece, int s) {
    return piece.box.v0 + (piece.box.v1 - piece.box.v0) * (s + 0.5) / kSamples;
  }

  int Build(int* order, int count) {
    const int index = static_cast<int>(nodes.size());
    nodes.emplace_back();
    Eigen::AlignedBox3d hull, centres;
    for (int i = 0; i < count; ++i) {
      hull.extend(pieces[order[i]].hull);
      centres.extend(pieces[order[i]].hull.center());
    }
    nodes[index].hull = hull;
    if (count == 1) {
      nodes[index].piece = order[0];
      return index;
    }
    int axis;
    centres.sizes().maxCoeff(&axis);
    std::nth_element(order, order + count / 2, order + count, [&](int a, int b) {
      const double ca = pieces[a].hull.center()[axis], cb = pieces[b].hull.center()[axis];
      return ca != cb ? ca < cb : a < b;
    });
    const int left = Build(order, count / 2);
    const int right = Build(order + count / 2, count - count / 2);
    nodes[index].left = left;
    nodes[index].right = right;
    return index;
  }

  // Newton steps from every sample that is no farther than its neighbours in the grid.
  void Search(const Piece& piece, const Eigen::Vector3d& q, SurfaceFoot& best) const {
    double d[kSamples][kSamples];
    for (int r = 0; r < kSamples; ++r) {
      for (int s = 0; s < kSamples; ++s) {
        d[r][s] = (piece.samples[r * kSamples + s] - q).squaredNorm();
      }
    }
    for (int r = 0; r < kSamples; ++r) {
      for (int s = 0; s < kSamples; ++s) {
        const bool lowest = (r == 0 || d[r][s] <= d[r - 1][s]) &&
                            (r == kSamples - 1 || d[r][s] < d[r + 1][s]) &&
                            (s == 0 || d[r][s] <= d[r][s - 1]) &&
                            (s == kSamples - 1 || d[r][s] < d[r][s + 1]);
        if (!lowest) continue;
        const SurfaceFoot foot =
            LocalFootPoint(surface, q, SampleU(piece, r), SampleV(piece, s), piece.box);
        if (foot.distance < best.distance) best = foot;
      }
    }
  }

  NurbsSurface surface;
  std::vector<Piece> pieces;
  std::vector<Node> nodes;
};

SurfaceFootPoints::SurfaceFootPoints(NurbsSurface surface)
    : tree_(std::make_unique<Tree>(std::move(surface))) {}
SurfaceFootPoints::~SurfaceFootPoints() = default;
SurfaceFootPoints::SurfaceFootPoints(SurfaceFootPoints&&) noexcept = default;
SurfaceFootPoints& SurfaceFootPoints::operator=(SurfaceFootPoints&&) noexcept = default;

const NurbsSurface& SurfaceFootPoints::surface() const { return tree_->surface; }

SurfaceFoot SurfaceFootPoints::Nearest(const Eigen::Vector3d& q) const {
  struct Entry {
    int node;
    double bound;
  };
  Entry stack[128];
  int depth = 0;
  stack[depth++] = {0, tree_->nodes[0].hull.squaredExteriorDistance(q)};
  SurfaceFoot best;
  best.distance = std::numeric_limits<double>::infinity();
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.bound >= best.distance * best.distance) continue;
    const Tree::Node& node = tree_->nodes[entry.node];
    if (node.piece >= 0) {
      tree_->Search(tree_->pieces[node.piece], q, best);
      continue;
    }
    // Equal bounds (a point inside both boxes) go to the nearer centre first.
    Entry near{node.left, tree_->nodes[node.left].hull.squaredExteriorDistance(q)};
    Entry far{node.right, tree_->nodes[node.right].hull.squaredExteriorDistance(q)};
    const bool swap = near.bound != far.bound
                          ? far.bound < near.bound
                          : (tree_->nodes[far.node].hull.center() - q).squaredNorm() <
                                (tree_->nodes[near.node].hull.center() - q).squaredNorm();
    if (swap) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  return best;
}

std::vector<SurfaceFoot> SurfaceFootPoints::Nearest(const Eigen::Matrix3Xd& points,
                                                    ThreadPool& pool) const {
  std::vector<SurfaceFoot> feet(points.cols());
  pool.For(points.cols(), 256, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) feet[k] = Nearest(points.col(k));
  });
  return feet;
}

namespace {

template <int Dim>
Eigen::Vector3d InSpace(const Eigen::Matrix<double, Dim, 1>& p) {
  if constexpr (Dim == 3) {
    return p;
  } else {
    return {p[0], p[1], 0};
  }
}

// Newton steps for |C(u) − q|²/2 between two parameters, never uphill.
template <int Dim>
CurveFoot LocalFoot(
    const NurbsCurve<Dim>& curve, const Eigen::Vector3d& q, double u, double lower, double upper) {
  auto derivatives = curve.Derivatives(u, 2);
  double value = (InSpace<Dim>(derivatives.col(0)) - q).squaredNorm();
  for (int iteration = 0; iteration < kMaxNewtonSteps; ++iteration) {
    const Eigen::Vector3d difference = InSpace<Dim>(derivatives.col(0)) - q;
    const Eigen::Vector3d first = InSpace<Dim>(derivatives.col(1));
    const double gradient = difference.dot(first);
    if ((u <= lower && gradient >= 0) || (u >= upper && gradient <= 0)) break;
    const double scale = first.squaredNorm();
    const double h = scale + difference.dot(InSpace<Dim>(derivatives.col(2)));
    const double curvature = h > 1e-12 * scale ? h : std::max(scale, std::abs(h));
    if (!(curvature > 0)) break;
    double step = -gradient / curvature;
    bool moved = false;
    for (int halving = 0; halving < kMaxHalvings; ++halving, step *= 0.5) {
      const double next = std::clamp(u + step, lower, upper);
      if (std::abs(next - u) <= 4 * kEpsilon * (std::abs(u) + upper - lower)) break;
      auto trial = curve.Derivatives(next, 2);
      const double trial_value = (InSpace<Dim>(trial.col(0)) - q).squaredNorm();
      if (trial_value < value) {
        moved = true;
        u = next;
        value = trial_value;
        derivatives = std::move(trial);
        break;
      }
    }
    if (!moved) break;
  }
  return {u, InSpace<Dim>(derivatives.col(0)), std::sqrt(value)};
}

}  // namespace

template <int Dim>
CurveFootPoints<Dim>::CurveFootPoints(NurbsCurve<Dim> curve) : curve_(std::move(curve)) {
  const SplineBasis& basis = curve_.basis();
  const int per_span = 4 * basis.degree();
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    for (int k = 0; k < per_span; ++k) parameters_.push_back(a + (b - a) * k / per_span);
  }
  parameters_.push_back(basis.upper());
  samples_.resize(3, static_cast<Eigen::Index>(parameters_.size()));
  for (size_t k = 0; k < parameters_.size(); ++k) {
    samples_.col(static_cast<Eigen::Index>(k)) = InSpace<Dim>(curve_.At(parameters_[k]));
  }
}

template <int Dim>
CurveFoot CurveFootPoints<Dim>::Nearest(const Eigen::Vector3d& q) const {
  const Eigen::VectorXd d = (samples_.colwise() - q).colwise().squaredNorm();
  const Eigen::Index last = d.size() - 1;
  CurveFoot best;
  best.distance = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k <= last; ++k) {
    if ((k > 0 && d[k] > d[k - 1]) || (k < last && d[k] >= d[k + 1])) continue;
    const CurveFoot foot = LocalFoot<Dim>(curve_, q, parameters_[k],
                                          parameters_[std::max<Eigen::Index>(0, k - 1)],
                                          parameters_[std::min(last, k + 1)]);
    if (foot.distance < best.distance) best = foot;
  }
  return best;
}

template <int Dim>
std::vector<CurveFoot> CurveFootPoints<Dim>::Nearest(const Eigen::Matrix3Xd& points,
                                                     ThreadPool& pool) const {
  std::vector<CurveFoot> feet(points.cols());
  pool.For(points.cols(), 256, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) feet[k] = Nearest(points.col(k));
  });
  return feet;
}

template class CurveFootPoints<2>;
template class CurveFootPoints<3>;

}  // namespace batten
