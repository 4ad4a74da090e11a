// SPDX-License-Identifier: MIT
#include "geometry/measure/trimmed_box.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "geometry/editing/monotone_arcs.h"
#include "geometry/bezier/spline_pieces.h"
#include "batten/geometry/trim_region.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

constexpr double kNegligible = 1e-12;  // of the size of the control points' box

// The greatest value of f in [low, high]. [Kiefer 1953]
template <typename Function>
double GoldenSection(const Function& f, double low, double high) {
  constexpr double kRatio = 0.6180339887498949;
  constexpr double kFinest = 1e-9;
  double a = high - kRatio * (high - low), b = low + kRatio * (high - low);
  double fa = f(a), fb = f(b);
  double greatest = std::max(fa, fb);
  while (high - low > kFinest) {
    if (fa > fb) {
      high = b;
      b = a;
      fb = fa;
      a = high - kRatio * (high - low);
      fa = f(a);
    } else {
      low = a;
      a = b;
      fa = fb;
      b = low + kRatio * (high - low);
      fb = f(b);
    }
    greatest = std::max({greatest, fa, fb});
  }
  return greatest;
}

// A coordinate, or minus it, as a rational function over a part of the domain; a net of one row or
// column is that of an edge, of one point a corner.
struct TrimmedPatch {
  Eigen::ArrayXXd numerator, weight;
  ParameterBox box;
  double reach = 0;

  void FindReach() { reach = (numerator / weight).maxCoeff(); }
  TrimmedPatch Turned() const {
    return {numerator.transpose(), weight.transpose(), {box.v0, box.v1, box.u0, box.u1}, reach};
  }
};

// Whether the function does not fall along the rows' direction: for all pairs of columns j, l the
// Bernstein coefficients of the derivative's numerator, taken together, are not negative.
bool Rises(const Eigen::ArrayXXd& numerator, const Eigen::ArrayXXd& weight) {
  for (Eigen::Index i = 0; i + 1 < numerator.rows(); ++i) {
    for (Eigen::Index j = 0; j < numerator.cols(); ++j) {
      for (Eigen::Index l = 0; l <= j; ++l) {
        const double sum = numerator(i + 1, j) * weight(i, l) + numerator(i + 1, l) * weight(i, j) -
                           numerator(i, j) * weight(i + 1, l) - numerator(i, l) * weight(i + 1, j);
        if (sum < 0) return false;
      }
    }
  }
  return true;
}

// The edge with the greatest values, where the function is monotone along u.
bool ToFarEdgeInU(TrimmedPatch& patch) {
  if (patch.numerator.rows() == 1) return false;
  Eigen::Index row = -1;
  if (Rises(patch.numerator, patch.weight)) {
    row = patch.numerator.rows() - 1;
  } else if (Rises(-patch.numerator, patch.weight)) {
    row = 0;
  }
  if (row < 0) return false;
  patch.numerator = patch.numerator.row(row).eval();
  patch.weight = patch.weight.row(row).eval();
  (row == 0 ? patch.box.u1 : patch.box.u0) = row == 0 ? patch.box.u0 : patch.box.u1;
  patch.FindReach();
  return true;
}

bool ToFarEdge(TrimmedPatch& patch) {
  if (ToFarEdgeInU(patch)) return true;
  TrimmedPatch turned = patch.Turned();
  if (!ToFarEdgeInU(turned)) return false;
  patch = turned.Turned();
  return true;
}

// De Casteljau at the middle of the rows.
std::pair<TrimmedPatch, TrimmedPatch> HalvedInU(const TrimmedPatch& patch) {
  TrimmedPatch low = patch, high = patch;
  const double middle = patch.box.u0 + (patch.box.u1 - patch.box.u0) / 2;
  for (Eigen::ArrayXXd TrimmedPatch::*net : {&TrimmedPatch::numerator, &TrimmedPatch::weight}) {
    Eigen::ArrayXXd& rest = high.*net;
    const Eigen::Index p = rest.rows() - 1;
    for (Eigen::Index k = 1; k <= p; ++k) {
      for (Eigen::Index i = 0; i <= p - k; ++i) rest.row(i) = (rest.row(i) + rest.row(i + 1)) / 2;
      (low.*net).row(k) = rest.row(0);
    }
  }
  low.box.u1 = high.box.u0 = middle;
  low.FindReach();
  high.FindReach();
  return {std::move(low), std::move(high)};
}

double TrimmedVariation(const Eigen::ArrayXXd& values) {
  const Eigen::Index p = values.rows() - 1;
  return p == 0 ? -1 : (values.bottomRows(p) - values.topRows(p)).abs().maxCoeff();
}

std::pair<TrimmedPatch, TrimmedPatch> Halved(const TrimmedPatch& patch) {
  const Eigen::ArrayXXd values = patch.numerator / patch.weight;
  if (TrimmedVariation(values) >= TrimmedVariation(values.transpose())) return HalvedInU(patch);
  const auto [low, high] = HalvedInU(patch.Turned());
  return {low.Turned(), high.Turned()};
}

class BoxFinder {
 public:
  explicit BoxFinder(const NurbsSurface& surface)
      : surface_(surface),
        region_(surface),
        pieces_(surface),
        centre_(surface.control_points().col(0)) {
    const Eigen::Matrix3Xd& points = surface.control_points();
    size_ = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  }

  Eigen::AlignedBox3d Box() const {
    Eigen::AlignedBox3d box(centre_, centre_);
    for (int d = 0; d < 3; ++d) {
      for (const double sign : {-1.0, 1.0}) {
        (sign < 0 ? box.min() : box.max())[d] =
            centre_[d] + sign * GreatestInside(d, sign, GreatestOnLoops(d, sign));
      }
    }
    return box;
  }

 private:
  double ValueAt(const Eigen::Vector2d& uv, int d, double sign) const {
    return sign * (surface_.At(uv[0], uv[1])[d] - centre_[d]);
  }

  double GreatestOnLoops(int d, double sign) const {
    const UnitDomain domain(surface_);
    double greatest = -kInfinity;
    for (const MonotoneArc& arc : MonotoneArcs(surface_.trims(), domain)) {
      std::vector<double> cuts{0, 1};
      for (const int axis : {0, 1}) {
        const SplineBasis& basis = axis == 0 ? surface_.basis_u() : surface_.basis_v();
        for (const int span : basis.Spans()) {
          const double line = (basis.knots()[span] - domain.lower[axis]) / domain.length[axis];
          if (line > arc.Low(axis) && line < arc.High(axis)) cuts.push_back(arc.Where(axis, line));
        }
      }
      std::sort(cuts.begin(), cuts.end());
      const auto f = [&](double t) { return ValueAt(domain.Back(arc.At(t)), d, sign); };
      for (size_t k = 0; k + 1 < cuts.size(); ++k) {
        greatest = std::max(greatest, GreatestOf(f, cuts[k], cuts[k + 1]));
      }
    }
    return greatest;
  }

  template <typename Function>
  double GreatestOf(const Function& f, double t0, double t1) const {
    const int count = 8 * (surface_.basis_u().degree() + surface_.basis_v().degree());
    const auto place = [&](int k) { return t0 + (t1 - t0) * k / count; };
    std::vector<double> samples;
    for (int k = 0; k <= count; ++k) samples.push_back(f(place(k)));
    const auto best = std::max_element(samples.begin(), samples.end());
    double greatest = *best;
    // A sample that is far from the greatest is not followed.
    const double spread = *best - *std::min_element(samples.begin(), samples.end());
    for (int k = 0; k <= count; ++k) {
      const int before = std::max(0, k - 1), after = std::min(count, k + 1);
      if (samples[k] < samples[before] || samples[k] < samples[after]) continue;
      if (samples[k] < *best - spread / 4) continue;
      greatest = std::max(greatest, GoldenSection(f, place(before), place(after)));
    }
    return greatest;
  }

  TrimmedPatch PatchOf(const SurfacePiece& piece, int d, double sign) const {
    const auto net = [&](int row) {
      return Eigen::ArrayXXd(
          piece.points.row(row).reshaped(piece.q + 1, piece.p + 1).transpose().array());
    };
    TrimmedPatch patch{sign * net(d), net(3), {piece.u0, piece.u1, piece.v0, piece.v1}, 0};
    patch.FindReach();
    return patch;
  }

  void SeeCorners(const TrimmedPatch& patch, bool inside, double& attained) const {
    const Eigen::Index p = patch.numerator.rows() - 1, q = patch.numerator.cols() - 1;
    for (const Eigen::Index i : {Eigen::Index{0}, p}) {
      for (const Eigen::Index j : {Eigen::Index{0}, q}) {
        const double value = patch.numerator(i, j) / patch.weight(i, j);
        if (value <= attained) continue;
        const double u = i == 0 ? patch.box.u0 : patch.box.u1;
        const double v = j == 0 ? patch.box.v0 : patch.box.v1;
        if (inside || region_.Contains(u, v)) attained = value;
      }
    }
  }

  double GreatestInside(int d, double sign, double attained) const {
    constexpr int kMostSplits = 20000;
    const double negligible = kNegligible * size_;
    const auto less = [](const TrimmedPatch& a, const TrimmedPatch& b) {
      return a.reach < b.reach;
    };
    std::vector<TrimmedPatch> heap;
    const auto add = [&](TrimmedPatch patch) {
      if (patch.reach <= attained + negligible) return;
      const TrimRegion::Cover cover = region_.CoverOf(patch.box);
      if (cover == TrimRegion::Cover::kOutside) return;
      while (cover == TrimRegion::Cover::kCut && ToFarEdge(patch)) {
      }
      SeeCorners(patch, cover == TrimRegion::Cover::kInside, attained);
      if (patch.numerator.size() == 1) return;
      heap.push_back(std::move(patch));
      std::push_heap(heap.begin(), heap.end(), less);
    };
    for (int i = 0; i < pieces_.count_u(); ++i) {
      for (int j = 0; j < pieces_.count_v(); ++j) {
        add(PatchOf(pieces_.Piece(i, j, centre_), d, sign));
      }
    }
    for (int count = 0; !heap.empty() && heap.front().reach > attained + negligible; ++count) {
      if (count == kMostSplits) return heap.front().reach;
      std::pop_heap(heap.begin(), heap.end(), less);
      const TrimmedPatch farthest = std::move(heap.back());
      heap.pop_back();
      auto [low, high] = Halved(farthest);
      add(std::move(low));
      add(std::move(high));
    }
    return attained;
  }

  const NurbsSurface& surface_;
  TrimRegion region_;
  SurfacePieces pieces_;
  Eigen::Vector3d centre_;
  double size_;
};

}  // namespace

Eigen::AlignedBox3d TrimmedBox(const NurbsSurface& surface) { return BoxFinder(surface).Box(); }

}  // namespace batten::internal
