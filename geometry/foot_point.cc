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
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// The moves (du, dv) that keep the parameters in their box.
struct Moves {
  double low_u, high_u, low_v, high_v;
};

// The minimum of g·d + d'Hd/2 over the box for H = (a b; b c) positive definite: inside, or on a
// side that the free minimum violates.
Eigen::Vector2d BoxMinimum(
    double a, double b, double c, const Eigen::Vector2d& g, const Moves& box) {
  const double det = a * c - b * b;
  const double x = (b * g[1] - c * g[0]) / det, y = (b * g[0] - a * g[1]) / det;
  const double side_x = std::clamp(x, box.low_u, box.high_u);
  const double side_y = std::clamp(y, box.low_v, box.high_v);
  if (side_x == x && side_y == y) return {x, y};
  Eigen::Vector2d on_u(side_x, std::clamp(-(g[1] + b * side_x) / c, box.low_v, box.high_v));
  Eigen::Vector2d on_v(std::clamp(-(g[0] + b * side_y) / a, box.low_u, box.high_u), side_y);
  const auto model = [&](const Eigen::Vector2d& d) {
    return g.dot(d) + a * d[0] * d[0] / 2 + b * d[0] * d[1] + c * d[1] * d[1] / 2;
  };
  if (side_y == y) return on_u;
  if (side_x == x) return on_v;
  return model(on_u) <= model(on_v) ? on_u : on_v;
}

// The Newton step for f = |S − q|²/2 within the box, in the parameters that are free; a parameter
// at a side is held when the descent leads out. An indefinite Hessian is shifted by its lowest
// eigenvalue.
Eigen::Vector2d FootStep(const SurfaceJet& jet,
                         const Eigen::Vector3d& difference,
                         bool free_u,
                         bool free_v,
                         const Eigen::Vector2d& gradient,
                         const Moves& box) {
  double a = jet.du.squaredNorm() + difference.dot(jet.duu);
  double b = jet.du.dot(jet.dv) + difference.dot(jet.duv);
  double c = jet.dv.squaredNorm() + difference.dot(jet.dvv);
  const double scale_u = jet.du.squaredNorm(), scale_v = jet.dv.squaredNorm();
  if (!free_u || !free_v) {
    // Uphill curvature: fall back to the positive scale of the first derivatives.
    const double h = free_u ? a : c;
    const double fallback = free_u ? scale_u : scale_v;
    const double curvature = h > 1e-12 * fallback ? h : std::max(fallback, std::abs(h));
    const double g = free_u ? gradient[0] : gradient[1];
    const double step = curvature > 0 ? -g / curvature : 0;
    return free_u ? Eigen::Vector2d(std::clamp(step, box.low_u, box.high_u), 0)
                  : Eigen::Vector2d(0, std::clamp(step, box.low_v, box.high_v));
  }
  // Scale to unit first derivatives, so that the shift means the same in both parameters.
  const double su = scale_u > 0 ? 1 / std::sqrt(scale_u) : 1;
  const double sv = scale_v > 0 ? 1 / std::sqrt(scale_v) : 1;
  a *= su * su;
  b *= su * sv;
  c *= sv * sv;
  const double mean = (a + c) / 2, radius = std::hypot((a - c) / 2, b);
  const double lowest = mean - radius, size = std::max(1.0, std::abs(mean) + radius);
  constexpr double kIndefinite = 1e-9, kLeastCurvature = 1e-3;
  if (lowest < kIndefinite * size) {
    const double shift = kLeastCurvature * size - lowest + std::max(0.0, -lowest);
    a += shift;
    c += shift;
  }
  const Moves scaled{box.low_u / su, box.high_u / su, box.low_v / sv, box.high_v / sv};
  const Eigen::Vector2d step = BoxMinimum(a, b, c, {gradient[0] * su, gradient[1] * sv}, scaled);
  return {step[0] * su, step[1] * sv};
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
    const Moves moves{box.u0 - u, box.u1 - u, box.v0 - v, box.v1 - v};
    Eigen::Vector2d step = FootStep(jet, difference, free_u, free_v, gradient, moves);
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

SurfaceFoot LocalFootPoint(const NurbsSurface& surface,
                           const Eigen::Vector3d& q,
                           double u,
                           double v) {
  return LocalFootPoint(surface,
                        q,
                        u,
                        v,
                        {surface.basis_u().lower(),
                         surface.basis_u().upper(),
                         surface.basis_v().lower(),
                         surface.basis_v().upper()});
}

namespace {

constexpr int kSamples = 5;  // a piece is sampled at the midpoints of 5 × 5 cells

// Halving of Bézier pieces stops where a piece is nearly flat and evenly parameterized …
constexpr double kBend = 0.7;  // second differences over the mean step between Bézier points
constexpr double kWeightRatio = 3.0;  // greatest over least weight
constexpr double kFolded = 0.2;       // area of a cell along the mean normal, over the mean area
// … or small, or deep.
constexpr double kSmall = 1.0 / 64;  // diagonal of its box over that of the surface
constexpr int kDeepest = 14;         // halvings in one direction

// A rational Bézier piece: homogeneous x, y, z and w, each (p+1) × (q+1).
using BezierNet = std::array<Eigen::MatrixXd, 4>;

// De Casteljau at 1/2 along the rows: the lower half stays, the upper is returned.
BezierNet Halve(BezierNet& net) {
  BezierNet upper = net;
  const Eigen::Index p = net[0].rows() - 1;
  for (int d = 0; d < 4; ++d) {
    Eigen::MatrixXd& lower = net[d];
    for (Eigen::Index level = 1; level <= p; ++level) {
      upper[d].row(p - level + 1) = lower.row(p);
      for (Eigen::Index r = p; r >= level; --r) {
        lower.row(r) = ((lower.row(r) + lower.row(r - 1)) / 2).eval();
      }
    }
    upper[d].row(0) = lower.row(p);
  }
  return upper;
}

BezierNet Transposed(const BezierNet& net) {
  return {net[0].transpose(), net[1].transpose(), net[2].transpose(), net[3].transpose()};
}

// How a net bends: along u, along v, and in its twist.
struct Shape {
  Eigen::AlignedBox3d hull;
  bool bent_u = false, bent_v = false;
};

Shape ShapeOf(const BezierNet& net) {
  const Eigen::Index p = net[0].rows() - 1, q = net[0].cols() - 1;
  const auto point = [&](Eigen::Index r, Eigen::Index s) {
    return Eigen::Vector3d(Eigen::Vector3d(net[0](r, s), net[1](r, s), net[2](r, s)) /
                           net[3](r, s));
  };
  Shape shape;
  double step_u = 0, step_v = 0, bend_u = 0, bend_v = 0, twist = 0;
  for (Eigen::Index r = 0; r <= p; ++r) {
    for (Eigen::Index s = 0; s <= q; ++s) {
      const Eigen::Vector3d x = point(r, s);
      shape.hull.extend(x);
      if (r == 0) step_u = std::max(step_u, (point(p, s) - x).squaredNorm());
      if (s == 0) step_v = std::max(step_v, (point(r, q) - x).squaredNorm());
      if (r > 1) {
        bend_u = std::max(bend_u, (x - 2 * point(r - 1, s) + point(r - 2, s)).squaredNorm());
      }
      if (s > 1) {
        bend_v = std::max(bend_v, (x - 2 * point(r, s - 1) + point(r, s - 2)).squaredNorm());
      }
      if (r > 0 && s > 0) {
        twist = std::max(
            twist, (x - point(r - 1, s) - point(r, s - 1) + point(r - 1, s - 1)).squaredNorm());
      }
    }
  }
  step_u = std::sqrt(step_u) / static_cast<double>(p);
  step_v = std::sqrt(step_v) / static_cast<double>(q);
  bend_u = std::sqrt(bend_u);
  bend_v = std::sqrt(bend_v);
  twist = std::sqrt(twist);
  const Eigen::MatrixXd& w = net[3];
  const double ratio_u =
      (w.colwise().maxCoeff().array() / w.colwise().minCoeff().array()).maxCoeff();
  const double ratio_v =
      (w.rowwise().maxCoeff().array() / w.rowwise().minCoeff().array()).maxCoeff();
  const bool twisted = twist > kBend * std::max(step_u, step_v);
  shape.bent_u = bend_u > kBend * step_u || ratio_u > kWeightRatio || twisted;
  shape.bent_v = bend_v > kBend * step_v || ratio_v > kWeightRatio || twisted;
  return shape;
}

// The Bernstein polynomials of degree p (columns) at the sampled parameters (r + 1/2) / kSamples.
Eigen::MatrixXd BernsteinAtSamples(int p) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(kSamples, p + 1);
  for (int r = 0; r < kSamples; ++r) {
    const double t = (r + 0.5) / kSamples;
    result(r, 0) = 1;
    for (int level = 1; level <= p; ++level) {
      for (int j = level; j > 0; --j) result(r, j) = (1 - t) * result(r, j) + t * result(r, j - 1);
      result(r, 0) *= 1 - t;
    }
  }
  return result;
}

}  // namespace

// A binary tree of boxes over the Bézier pieces, bent ones halved.
struct SurfaceFootPoints::Tree {
  struct Piece {
    ParameterBox box;
    Eigen::AlignedBox3d hull;
    double reach;  // how far the surface may lie from the nearest sample
    bool folded;   // the samples' cells do not all face the same way
    Eigen::Matrix<double, kSamples * kSamples, 3> samples;  // v runs fastest
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
    const Eigen::Matrix3Xd& points = surface.control_points();
    small = kSmall * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
    bernstein_u = BernsteinAtSamples(p);
    bernstein_v = BernsteinAtSamples(q);
    const std::vector<int> spans_v = bv.Spans();
    std::vector<Eigen::MatrixXd> to_bezier_v;
    for (const int j : spans_v) to_bezier_v.push_back(BezierSpanMatrix(bv, j));
    for (const int i : bu.Spans()) {
      const Eigen::MatrixXd to_bezier_u = BezierSpanMatrix(bu, i);
      for (size_t k = 0; k < spans_v.size(); ++k) {
        const int j = spans_v[k];
        BezierNet net;
        for (auto& component : net) component.resize(p + 1, q + 1);
        for (int r = 0; r <= p; ++r) {
          for (int s = 0; s <= q; ++s) {
            const Eigen::Index column = Eigen::Index{i - p + r} * surface.size_v() + j - q + s;
            const double w = surface.weights()[column];
            for (int d = 0; d < 3; ++d) net[d](r, s) = w * points(d, column);
            net[3](r, s) = w;
          }
        }
        for (auto& component : net) {
          component = to_bezier_u * component * to_bezier_v[k].transpose();
        }
        // Derivatives at an upper knot are those of the next piece: a piece ends just before it.
        const auto end = [](const SplineBasis& basis, double knot) {
          return knot < basis.upper() ? std::nextafter(knot, basis.lower()) : knot;
        };
        AddPieces(
            std::move(net),
            {bu.knots()[i], end(bu, bu.knots()[i + 1]), bv.knots()[j], end(bv, bv.knots()[j + 1])},
            0,
            0);
      }
    }
  }

  // Halves the piece until it is nearly flat.
  void AddPieces(BezierNet net, const ParameterBox& box, int depth_u, int depth_v) {
    const Shape shape = ShapeOf(net);
    const bool small_enough = shape.hull.diagonal().norm() <= small;
    if (shape.bent_u && depth_u < kDeepest && !small_enough) {
      const double middle = box.u0 + (box.u1 - box.u0) / 2;
      BezierNet upper = Halve(net);
      AddPieces(std::move(net), {box.u0, middle, box.v0, box.v1}, depth_u + 1, depth_v);
      AddPieces(std::move(upper), {middle, box.u1, box.v0, box.v1}, depth_u + 1, depth_v);
    } else if (shape.bent_v && depth_v < kDeepest && !small_enough) {
      const double middle = box.v0 + (box.v1 - box.v0) / 2;
      BezierNet turned = Transposed(net);
      const BezierNet upper = Halve(turned);
      AddPieces(Transposed(turned), {box.u0, box.u1, box.v0, middle}, depth_u, depth_v + 1);
      AddPieces(Transposed(upper), {box.u0, box.u1, middle, box.v1}, depth_u, depth_v + 1);
    } else {
      AddPiece(net, box, shape.hull);
    }
  }

  void AddPiece(const BezierNet& net, const ParameterBox& box, Eigen::AlignedBox3d hull) {
    const double size =
        std::max(hull.min().cwiseAbs().maxCoeff(), hull.max().cwiseAbs().maxCoeff());
    const Eigen::Vector3d slack = Eigen::Vector3d::Constant(64 * kEpsilon * size);
    hull.min() -= slack;
    hull.max() += slack;
    Piece& piece = pieces.emplace_back();
    piece.box = box;
    piece.hull = hull;
    using Grid = Eigen::Matrix<double, kSamples, kSamples, Eigen::RowMajor>;
    const auto at_samples = [&](const Eigen::MatrixXd& component) {
      return Grid(bernstein_u * component * bernstein_v.transpose());
    };
    const Grid w = at_samples(net[3]);
    for (int d = 0; d < 3; ++d) {
      const Grid x = at_samples(net[d]).cwiseQuotient(w);
      piece.samples.col(d) =
          Eigen::Map<const Eigen::Matrix<double, kSamples * kSamples, 1>>(x.data());
    }
    // Twice the longest diagonal of a cell: pieces are nearly flat.
    double longest = 0;
    Eigen::Vector3d facing = Eigen::Vector3d::Zero();
    std::array<Eigen::Vector3d, (kSamples - 1) * (kSamples - 1)> faces;
    for (int r = 1; r < kSamples; ++r) {
      for (int s = 1; s < kSamples; ++s) {
        const int k = r * kSamples + s;
        const Eigen::Vector3d x = piece.samples.row(k) - piece.samples.row(k - kSamples - 1);
        const Eigen::Vector3d y = piece.samples.row(k - 1) - piece.samples.row(k - kSamples);
        longest = std::max({longest, x.squaredNorm(), y.squaredNorm()});
        Eigen::Vector3d& face = faces[(r - 1) * (kSamples - 1) + s - 1];
        face = x.cross(y);
        facing += face;
      }
    }
    piece.reach = 2 * std::sqrt(longest);
    facing /= static_cast<double>(faces.size());
    piece.folded = std::any_of(faces.begin(), faces.end(), [&](const Eigen::Vector3d& face) {
      return !(face.dot(facing) > kFolded * facing.squaredNorm());
    });
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

  // Newton steps from every sample that is no farther than its neighbours in the grid, or from all
  // where the piece is folded, if they may lead to a nearer point. At a corner of the surface the
  // steps from one sample reach one of two edges: both are tried.
  void Search(const Piece& piece,
              const Eigen::Vector3d& q,
              SurfaceFoot& best,
              bool& at_side) const {
    const Eigen::Array<double, kSamples * kSamples, 1> d =
        (piece.samples.rowwise() - q.transpose()).rowwise().squaredNorm();
    const auto search = [&](double u, double v) {
      const SurfaceFoot foot = LocalFootPoint(surface, q, u, v, piece.box);
      if (!(foot.distance < best.distance)) return;
      best = foot;
      at_side = foot.u == piece.box.u0 || foot.u == piece.box.u1 || foot.v == piece.box.v0 ||
                foot.v == piece.box.v1;
    };
    const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
    for (int r = 0; r < kSamples; ++r) {
      for (int s = 0; s < kSamples; ++s) {
        const int k = r * kSamples + s;
        const bool lowest = (r == 0 || d[k] <= d[k - kSamples]) &&
                            (r == kSamples - 1 || d[k] < d[k + kSamples]) &&
                            (s == 0 || d[k] <= d[k - 1]) && (s == kSamples - 1 || d[k] < d[k + 1]);
        if (!lowest && !piece.folded) continue;
        if (std::sqrt(d[k]) - piece.reach >= best.distance) continue;
        search(SampleU(piece, r), SampleV(piece, s));
        const bool at_u = (r == 0 && piece.box.u0 == bu.lower()) ||
                          (r == kSamples - 1 && piece.box.u1 == bu.upper());
        const bool at_v = (s == 0 && piece.box.v0 == bv.lower()) ||
                          (s == kSamples - 1 && piece.box.v1 == bv.upper());
        if (at_u && at_v) {
          search(r == 0 ? piece.box.u0 : piece.box.u1, SampleV(piece, s == 0 ? 1 : s - 1));
          search(SampleU(piece, r == 0 ? 1 : r - 1), s == 0 ? piece.box.v0 : piece.box.v1);
        }
      }
    }
  }

  NurbsSurface surface;
  double small = 0;
  Eigen::MatrixXd bernstein_u, bernstein_v;
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
  bool at_side = false;
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.bound >= best.distance * best.distance) continue;
    const Tree::Node& node = tree_->nodes[entry.node];
    if (node.piece >= 0) {
      tree_->Search(tree_->pieces[node.piece], q, best, at_side);
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
  // The descent may go on beyond the side of a piece.
  if (at_side) {
    const SurfaceFoot foot = LocalFootPoint(tree_->surface, q, best.u, best.v);
    if (foot.distance < best.distance) best = foot;
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

}  // namespace batten
