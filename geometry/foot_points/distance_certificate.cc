// SPDX-License-Identifier: MIT
#include "geometry/foot_points/distance_certificate.h"
#include "geometry/numeric/constants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten::internal {
namespace {

constexpr double kMiss = 2e-11;  // of the shape's size
// Rounding of a coefficient of F over the square of the lengths that enter it: a handful of
// operations on products whose sums have a few dozen terms of both signs.
constexpr double kRounding = 8 * kEpsilon;
// A distance far above the size is given to some units in its last place, of which this is the
// share of its square: more than the rounding above for points ten sizes away.
constexpr double kFarRounding = 4 * kRounding;
constexpr int kDeepest = 100;

}  // namespace

double AcceptableFootMiss(const FootTable& table, double squared) {
  const double epsilon = kMiss * table.size;
  return epsilon * (2 * std::sqrt(squared) + epsilon) + kFarRounding * squared;
}

bool IsCertified(const FootTable& table, const FoundFoot& found) {
  constexpr double kWithTrimsAndRounding = 8;
  const double squared = found.distance * found.distance;
  return found.lower_bound * found.lower_bound >=
         squared - kWithTrimsAndRounding * AcceptableFootMiss(table, squared);
}

DistanceCertificate::DistanceCertificate(const FootTable& table,
                                         const Eigen::Vector3d& q,
                                         const FoundFoot& start,
                                         std::vector<double>& arena,
                                         const TrimRegion* region,
                                         int most_work)
    : table_(table),
      q_(q),
      arena_(arena),
      region_(region),
      best_piece_(start.piece),
      best_x_(start.x),
      best_y_(start.y),
      squared_(start.distance * start.distance),
      epsilon_(kMiss * table.size),
      proved_(std::numeric_limits<double>::infinity()),
      most_work_(most_work) {}

FoundFoot DistanceCertificate::result() const {
  const double d = std::sqrt(squared_);
  const double bound = proved_ > 0 ? std::min(d, std::sqrt(proved_)) : 0;
  return {best_piece_, best_x_, best_y_, d, bound};
}

// Four times as much with a region: nothing on its loops, which are certified to twice as much and
// deviate by as much again, may look nearer.
double DistanceCertificate::AcceptableMiss() const {
  const double miss = AcceptableFootMiss(table_, squared_);
  return region_ == nullptr ? miss : 4 * miss;
}

bool DistanceCertificate::InRegion(double x, double y) const {
  const int cells_v = table_.v.cells();
  return region_->Contains(table_.u.At(piece_ / cells_v, x), table_.v.At(piece_ % cells_v, y));
}

bool DistanceCertificate::Outside(const LocalBox& box) const {
  const int cell_u = piece_ / table_.v.cells(), cell_v = piece_ % table_.v.cells();
  return region_->CoverOf({table_.u.At(cell_u, box.x0),
                           table_.u.At(cell_u, box.x1),
                           table_.v.At(cell_v, box.y0),
                           table_.v.At(cell_v, box.y1)}) == TrimRegion::Cover::kOutside;
}

void DistanceCertificate::Check(int piece, double box_squared, bool cut) {
  // What lies within an acceptable miss needs no proof: the bound is then zero.
  if (squared_ <= epsilon_ * epsilon_) {
    proved_ = 0;
    return;
  }
  piece_ = piece;
  cut_ = cut;
  local_q_ = q_ - table_.centres[piece];
  form_ = {table_.local(piece),
           table_.degree_u(),
           table_.degree_v(),
           table_.rational,
           table_.monomial()};
  const double* rows = table_.squares(piece);
  const int padded = table_.padded();
  const double q2 = local_q_.squaredNorm();
  const double reach = std::sqrt(q2) + table_.radii[piece];
  for (;;) {
    wanted_ = AcceptableMiss();
    const double rounding = kRounding * (reach * reach + squared_);
    const bool exact = rounding > wanted_;
    // Two halves a level.
    const size_t level = padded + 4 * size_t(table_.degree_u() + 1) * (table_.degree_v() + 1);
    const size_t needed = 2 * (kDeepest + 2) * level + kReadPast;
    if (arena_.size() < needed) arena_.resize(needed);
    Cell cell{{-1, 1, -1, 1}, table_.degree_u(), table_.degree_v(), arena_.data(), nullptr};
    const double shift = q2 - squared_ + (exact ? -rounding : wanted_ + rounding);
    tolerance_ = exact ? 0 : wanted_ + rounding;
    margin_ = 0;
    const double least = FillSquares(rows, padded, table_.rational, local_q_.data(), shift, cell.f);
    if (least >= 0) {
      Certify(least);
      return;
    }
    size_t used = padded;
    if (exact) {
      cell.net = arena_.data() + used;
      used += cell.numbers();
      const double* bezier = table_.bezier(piece);
      for (int k = 0; k < cell.numbers(); ++k) {
        cell.net[k] = k % 4 == 3 ? bezier[k] : bezier[k] - local_q_[k % 4] * bezier[k | 3];
      }
      const double exact_least = SquaresOfNet(cell);
      if (exact_least >= 0) {
        Certify(exact_least);
        return;
      }
    }
    const PointClass verdict = CheckCell(cell, 0, used);
    if (verdict == PointClass::kNothingNearer) return;
    if (verdict == PointClass::kUndecided) {
      proved_ = std::min(proved_, box_squared);
      return;
    }
  }
}

// F of a cell from its net about q; returns its least coefficient.
double DistanceCertificate::SquaresOfNet(const Cell& cell) {
  const int count = (cell.p + 1) * (cell.q + 1);
  double part[4][26 * 26];
  double reach = 0;
  for (int k = 0; k < count; ++k) {
    for (int d = 0; d < 4; ++d) part[d][k] = cell.net[4 * k + d];
    const double length =
        part[0][k] * part[0][k] + part[1][k] * part[1][k] + part[2][k] * part[2][k];
    reach = std::max(reach, length / (part[3][k] * part[3][k]));
  }
  // Raised by what may be missed but lowered by the rounding where that is more.
  const double rounding = kRounding * (reach + squared_);
  const double raise = std::min(wanted_, 2 * wanted_ - rounding);
  tolerance_ = raise + rounding;
  margin_ = wanted_ - raise;
  std::fill_n(cell.f, cell.values(), 0.0);
  for (int k = 0; k < 3; ++k) AddProduct(part[k], part[k], cell.p, cell.q, 1, cell.f);
  AddProduct(part[3], part[3], cell.p, cell.q, raise - squared_, cell.f);
  return LeastCoefficient(cell.f, cell.values());
}

// Downhill from a place of the region as far as that leads to one: in the piece, else in the box,
// else not at all.
FootPlace DistanceCertificate::DescendInRegion(const LocalBox& box, double x, double y) const {
  FootPlace place = DescendInPiece(form_, local_q_.data(), x, y, {-1, 1, -1, 1}, 0);
  if (Counts(place.x, place.y)) return place;
  place = DescendInPiece(form_, local_q_.data(), x, y, box, 0);
  if (Counts(place.x, place.y)) return place;
  Eigen::Vector3d position;
  EvaluatePosition(form_, x, y, position.data());
  return {x, y, (position - local_q_).squaredNorm(), 0, 0, 0};
}

// Follows the surface downhill from a place of the cell.
DistanceCertificate::PointClass DistanceCertificate::Try(const LocalBox& box, double x, double y) {
  const FootPlace place = DescendInRegion(box, x, y);
  if (!(place.squared < squared_)) return PointClass::kUndecided;
  best_piece_ = piece_;
  best_x_ = place.x;
  best_y_ = place.y;
  const bool counts = squared_ - place.squared > wanted_ / 2;
  squared_ = place.squared;
  return counts ? PointClass::kNearer : PointClass::kUndecided;
}

// F ≥ least ≥ 0 on the cell. Weights being at most one, |S − q|² ≥ d² − tolerance + least there.
DistanceCertificate::PointClass DistanceCertificate::Certify(double least) {
  proved_ = std::min(proved_, squared_ - tolerance_ + least);
  return PointClass::kNothingNearer;
}

DistanceCertificate::Cell DistanceCertificate::Take(const Cell& like, size_t& used) {
  const size_t needed = static_cast<size_t>(like.values()) + (like.net ? like.numbers() : 0);
  Cell cell = like;
  cell.f = arena_.data() + used;
  cell.net = like.net ? cell.f + like.values() : nullptr;
  used += needed;
  return cell;
}

// A corner where F is negative is a nearer place if it counts.
DistanceCertificate::PointClass DistanceCertificate::Corner(const Cell& cell) {
  const int m = 2 * cell.p, n = 2 * cell.q, w = n + 1;
  double corners[4] = {cell.f[0], cell.f[n], cell.f[m * w], cell.f[m * w + n]};
  if (margin_ > 0) {
    const int last = cell.p * (cell.q + 1);
    const int at[4] = {0, cell.q, last, last + cell.q};
    for (int k = 0; k < 4; ++k) {
      const double weight = cell.net[4 * at[k] + 3];
      corners[k] += margin_ * weight * weight;
    }
  }
  const auto x = [&](int k) { return k < 2 ? cell.box.x0 : cell.box.x1; };
  const auto y = [&](int k) { return k % 2 ? cell.box.y1 : cell.box.y0; };
  int lowest = -1;
  for (int k = 0; k < 4; ++k) {
    const double below = lowest < 0 ? 0 : corners[lowest];
    if (corners[k] < below && Counts(x(k), y(k))) lowest = k;
  }
  return lowest < 0 ? PointClass::kNothingNearer : Try(cell.box, x(lowest), y(lowest));
}

// Newton's method for an F that is convex but for second derivatives of at least −bend, from the
// best place where that lies in the cell.
DistanceCertificate::PointClass DistanceCertificate::CheckConvex(const Cell& cell, double bend) {
  const int m = 2 * cell.p, n = 2 * cell.q;
  const double wide = cell.box.x1 - cell.box.x0, high = cell.box.y1 - cell.box.y0;
  double x = 0.5, y = 0.5;
  if (best_piece_ == piece_ && best_x_ >= cell.box.x0 && best_x_ <= cell.box.x1 &&
      best_y_ >= cell.box.y0 && best_y_ <= cell.box.y1) {
    if (wide > 0) x = (best_x_ - cell.box.x0) / wide;
    if (high > 0) y = (best_y_ - cell.box.y0) / high;
  } else {
    const auto least = static_cast<int>(std::min_element(cell.f, cell.f + cell.values()) - cell.f);
    if (m > 0) x = double(least / (n + 1)) / m;
    if (n > 0) y = double(least % (n + 1)) / n;
  }
  PolynomialJet jet = EvaluateBernstein(cell.f, m, n, x, y);
  for (int step = 0; step < 40; ++step) {
    if (jet.value < 0) {
      const double at_x = cell.box.x0 + x * wide, at_y = cell.box.y0 + y * high;
      return Counts(at_x, at_y) ? Try(cell.box, at_x, at_y) : Certify(0);
    }
    // A convex function lies above its tangent plane, this one below it by bend/2 times the square.
    const double far_x = std::max(x, 1 - x), far_y = std::max(y, 1 - y);
    const double falls_x =
        m > 0 ? std::max(jet.gx * x, -jet.gx * (1 - x)) + bend / 2 * far_x * far_x : 0;
    const double falls_y =
        n > 0 ? std::max(jet.gy * y, -jet.gy * (1 - y)) + bend / 2 * far_y * far_y : 0;
    const double least = jet.value - falls_x - falls_y;
    if (least >= 0) return Certify(least);
    double dx, dy;
    BoxMinimum(m > 0 ? jet.hxx + 2 * bend : 1,
               m > 0 && n > 0 ? jet.hxy : 0,
               n > 0 ? jet.hyy + 2 * bend : 1,
               m > 0 ? jet.gx : 0,
               n > 0 ? jet.gy : 0,
               {-x, 1 - x, -y, 1 - y},
               &dx,
               &dy);
    bool moved = false;
    for (int halving = 0; halving < 40 && !moved; ++halving, dx /= 2, dy /= 2) {
      const double nx = ClampTo(x + dx, 0, 1), ny = ClampTo(y + dy, 0, 1);
      const PolynomialJet trial = EvaluateBernstein(cell.f, m, n, nx, ny);
      if (!(trial.value < jet.value)) continue;
      moved = true;
      x = nx;
      y = ny;
      jet = trial;
    }
    if (!moved) return PointClass::kUndecided;
  }
  return PointClass::kUndecided;
}

// Only one side of the cell can hold the least value: an edge, one degree less in dimension.
DistanceCertificate::PointClass DistanceCertificate::CheckSide(
    const Cell& cell, bool first, bool low, int depth, size_t used) {
  Cell like = cell;
  if (first) {
    like.p = 0;
    (low ? like.box.x1 : like.box.x0) = low ? cell.box.x0 : cell.box.x1;
  } else {
    like.q = 0;
    (low ? like.box.y1 : like.box.y0) = low ? cell.box.y0 : cell.box.y1;
  }
  Cell side = Take(like, used);
  const int m = 2 * cell.p, n = 2 * cell.q;
  for (int k = 0; k < side.values(); ++k) {
    side.f[k] = first ? cell.f[(low ? 0 : m) * (n + 1) + k] : cell.f[k * (n + 1) + (low ? 0 : n)];
  }
  if (side.net) {
    const int points = first ? cell.q + 1 : cell.p + 1;
    for (int k = 0; k < points; ++k) {
      const int from =
          first ? (low ? 0 : cell.p) * (cell.q + 1) + k : k * (cell.q + 1) + (low ? 0 : cell.q);
      std::copy_n(cell.net + 4 * from, 4, side.net + 4 * k);
    }
    const double least = SquaresOfNet(side);
    if (least >= 0) return Certify(least);
  }
  return CheckCell(side, depth + 1, used);
}

DistanceCertificate::PointClass DistanceCertificate::CheckHalves(const Cell& cell,
                                                                 bool first,
                                                                 int depth,
                                                                 size_t used) {
  Cell halves[2] = {Take(cell, used), Take(cell, used)};
  const auto halve = first ? HalveFirst : HalveSecond;
  if (cell.net) {
    halve(cell.net, cell.p, cell.q, 4, halves[0].net, halves[1].net);
  } else {
    halve(cell.f, 2 * cell.p, 2 * cell.q, 1, halves[0].f, halves[1].f);
  }
  if (first) {
    halves[0].box.x1 = halves[1].box.x0 = cell.box.x0 + (cell.box.x1 - cell.box.x0) / 2;
  } else {
    halves[0].box.y1 = halves[1].box.y0 = cell.box.y0 + (cell.box.y1 - cell.box.y0) / 2;
  }
  for (const Cell& half : halves) {
    const double least = half.net ? SquaresOfNet(half) : LeastCoefficient(half.f, half.values());
    const PointClass verdict = least >= 0 ? Certify(least) : CheckCell(half, depth + 1, used);
    if (verdict != PointClass::kNothingNearer) return verdict;
  }
  return PointClass::kNothingNearer;
}

// The cell has a negative coefficient.
DistanceCertificate::PointClass DistanceCertificate::CheckCell(const Cell& cell,
                                                               int depth,
                                                               size_t used) {
  work_ += cell.values();
  if (work_ > most_work_ || depth > kDeepest) return PointClass::kUndecided;
  const PointClass corner = Corner(cell);
  if (corner != PointClass::kNothingNearer) return corner;
  const PolynomialBounds bounds = BoundsOf(cell.f, 2 * cell.p, 2 * cell.q);
  if (margin_ == 0 && -bounds.lowest <= tolerance_) {
    const PointClass verdict = CheckConvex(cell, std::max(0.0, -bounds.lowest));
    if (verdict != PointClass::kUndecided) return verdict;
  }
  const size_t level = 2 * static_cast<size_t>(cell.values() + cell.numbers());
  if (used + level + kReadPast > arena_.size()) return PointClass::kUndecided;
  if (cell.p > 0 && (bounds.rises_x || bounds.falls_x)) {
    return CheckSide(cell, true, bounds.rises_x, depth, used);
  }
  if (cell.q > 0 && (bounds.rises_y || bounds.falls_y)) {
    return CheckSide(cell, false, bounds.rises_y, depth, used);
  }
  if (cut_ && Outside(cell.box)) return PointClass::kNothingNearer;
  if (cell.p == 0 && cell.q == 0) return PointClass::kUndecided;
  const bool first = cell.q == 0 || (cell.p > 0 && bounds.bend_x >= bounds.bend_y);
  return CheckHalves(cell, first, depth, used);
}

}  // namespace batten::internal
