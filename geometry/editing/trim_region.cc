// SPDX-License-Identifier: MIT
#include "batten/geometry/trim_region.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/editing/monotone_arcs.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kNear = 1e-12;    // of the domain: places that near to a loop are on it
constexpr double kArcMargin = 1e-11;  // arcs count as entering squares that near to them
constexpr int kOutside = -1, kInside = -2;

// An arc along a side of the domain: the part that counts lies on one side of it only.
bool AlongDomain(const MonotoneArc& arc) {
  for (const int axis : {0, 1}) {
    for (const double side : {0.0, 1.0}) {
      if (std::max(std::abs(arc.from[axis] - side), std::abs(arc.to[axis] - side)) <= kNear) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

// Works in the unit domain. Rows are divided into squares; squares side by side that arcs enter
// form a run, and an arc's part in one row lies in one run.
class TrimRegion::Index {
 public:
  explicit Index(const NurbsSurface& surface)
      : domain_(surface), arcs_(MonotoneArcs(surface.trims(), domain_)) {
    for (const MonotoneArc& arc : arcs_) {
      box_.extend(arc.from).extend(arc.to);
      along_domain_.push_back(AlongDomain(arc));
    }
    box_.min().array() -= 2 * kArcMargin;
    box_.max().array() += 2 * kArcMargin;
    constexpr double kFewest = 64, kMost = 1024;
    count_ = static_cast<int>(
        std::clamp(8 * std::sqrt(static_cast<double>(arcs_.size())), kFewest, kMost));
    size_ = box_.sizes() / count_;
    const std::vector<std::vector<Stretch>> rows = Stretches();
    squares_.reserve(static_cast<size_t>(count_) * count_);
    for (int row = 0; row < count_; ++row) FillRow(row, rows[row]);
  }

  const UnitDomain& domain() const { return domain_; }

  bool Contains(const Eigen::Vector2d& place) const {
    if (!box_.contains(place)) return false;
    const int square = squares_[Square(place, 1) * count_ + Square(place, 0)];
    return square < 0 ? square == kInside : InRun(runs_[square], place);
  }

  // Whether arcs meet the box; those along the domain's sides only where asked for.
  bool Cuts(const Eigen::AlignedBox2d& box, bool along_domain) const {
    const Eigen::AlignedBox2d seen = box_.intersection(box);
    if (seen.isEmpty()) return false;
    const int first = Square(seen.min(), 0), last = Square(seen.max(), 0);
    for (int row = Square(seen.min(), 1); row <= Square(seen.max(), 1); ++row) {
      int before = kOutside;
      for (int k = first; k <= last; ++k) {
        const int square = squares_[row * count_ + k];
        if (square < 0 || square == before) continue;
        before = square;
        for (int i = runs_[square].first; i < runs_[square].last; ++i) {
          const int arc = members_[i];
          if (along_domain_[arc] && !along_domain) continue;
          if (Meets(arcs_[arc], box)) return true;
        }
      }
    }
    return false;
  }

 private:
  // The squares first … last of a row that an arc enters.
  struct Stretch {
    int first, last, arc;
  };
  // Arcs members_[first … last − 1], and whether the places right of the run are inside.
  struct Run {
    int first, last;
    bool inside_beyond;
  };

  int Square(const Eigen::Vector2d& place, int axis) const {
    const double k = (place[axis] - box_.min()[axis]) / size_[axis];
    return static_cast<int>(std::clamp(k, 0.0, count_ - 1.0));
  }

  std::vector<std::vector<Stretch>> Stretches() const {
    std::vector<std::vector<Stretch>> rows(count_);
    for (int k = 0; k < static_cast<int>(arcs_.size()); ++k) {
      const MonotoneArc& arc = arcs_[k];
      const auto square = [&](double value, int axis) {
        return Square(Eigen::Vector2d::Constant(value), axis);
      };
      const int top = square(arc.High(1) + kArcMargin, 1);
      for (int row = square(arc.Low(1) - kArcMargin, 1); row <= top; ++row) {
        const double y0 = box_.min()[1] + row * size_[1] - kArcMargin;
        const double y1 = y0 + size_[1] + 2 * kArcMargin;
        double x0 = arc.from[0], x1 = arc.to[0];
        if (arc.from[1] != arc.to[1]) {
          x0 = arc.At(arc.Where(1, y0))[0];
          x1 = arc.At(arc.Where(1, y1))[0];
        }
        const auto [low, high] = std::minmax(x0, x1);
        rows[row].push_back({square(low - kArcMargin, 0), square(high + kArcMargin, 0), k});
      }
    }
    return rows;
  }

  // From right to left, knowing what lies right of each square.
  void FillRow(int row, std::vector<Stretch> stretches) {
    std::vector<int> squares(count_, kOutside);
    std::sort(stretches.begin(), stretches.end(), [](const Stretch& a, const Stretch& b) {
      return a.last != b.last ? a.last > b.last : a.arc < b.arc;
    });
    const double middle = box_.min()[1] + (row + 0.5) * size_[1];
    bool inside = false;
    int k = count_ - 1;
    for (size_t i = 0; i < stretches.size();) {
      for (; k > stretches[i].last; --k) squares[k] = inside ? kInside : kOutside;
      const int run = static_cast<int>(runs_.size());
      runs_.push_back({static_cast<int>(members_.size()), 0, inside});
      int first = stretches[i].first;
      for (; i < stretches.size() && stretches[i].last >= first - 1; ++i) {
        first = std::min(first, stretches[i].first);
        members_.push_back(stretches[i].arc);
        if (Spans(arcs_[stretches[i].arc], middle)) inside = !inside;
      }
      runs_.back().last = static_cast<int>(members_.size());
      for (; k >= first; --k) squares[k] = run;
    }
    for (; k >= 0; --k) squares[k] = inside ? kInside : kOutside;
    squares_.insert(squares_.end(), squares.begin(), squares.end());
  }

  // The lower end belongs to an arc, the upper does not: at a shared end one of two is counted
  // where the loop passes, both or none where it turns back.
  static bool Spans(const MonotoneArc& arc, double y) { return arc.Low(1) <= y && y < arc.High(1); }

  bool InRun(const Run& run, const Eigen::Vector2d& place) const {
    bool inside = run.inside_beyond;
    for (int i = run.first; i < run.last; ++i) {
      const MonotoneArc& arc = arcs_[members_[i]];
      const double x = place[0], y = place[1];
      if (y < arc.Low(1) - kNear || y > arc.High(1) + kNear || x > arc.High(0) + kNear) continue;
      if (x < arc.Low(0) - kNear) {
        if (Spans(arc, y)) inside = !inside;
        continue;
      }
      const int side = arc.SideOf(place, kNear);
      if (side == 0) return true;
      if (side < 0 && Spans(arc, y)) inside = !inside;
    }
    return inside;
  }

  UnitDomain domain_;
  std::vector<MonotoneArc> arcs_;
  std::vector<bool> along_domain_;
  Eigen::AlignedBox2d box_;
  int count_;
  Eigen::Vector2d size_;
  std::vector<int> squares_;  // row by row: kOutside, kInside or a run
  std::vector<Run> runs_;
  std::vector<int> members_;
};

TrimRegion::TrimRegion(const NurbsSurface& surface)
    : basis_u_(surface.basis_u()), basis_v_(surface.basis_v()) {
  if (surface.trimmed()) index_ = std::make_unique<const Index>(surface);
}
TrimRegion::~TrimRegion() = default;
TrimRegion::TrimRegion(TrimRegion&&) noexcept = default;
TrimRegion& TrimRegion::operator=(TrimRegion&&) noexcept = default;

bool TrimRegion::Contains(double u, double v) const {
  const Eigen::Vector2d uv(basis_u_.Clamp(u), basis_v_.Clamp(v));
  if (index_ == nullptr) return true;
  const Eigen::Vector2d place = index_->domain()(uv);
  if (index_->Contains(place)) return true;
  // On a seam: the other side of it.
  const bool periodic[2] = {basis_u_.periodic(), basis_v_.periodic()};
  Eigen::Vector2d other = place;
  bool seam[2] = {false, false};
  for (const int axis : {0, 1}) {
    seam[axis] = periodic[axis] && std::abs(place[axis] - 0.5) >= 0.5 - kNear;
    if (seam[axis]) other[axis] = place[axis] > 0.5 ? 0 : 1;
  }
  if (seam[0] && index_->Contains({other[0], place[1]})) return true;
  if (seam[1] && index_->Contains({place[0], other[1]})) return true;
  return seam[0] && seam[1] && index_->Contains(other);
}

namespace {

// The parts of [a, b] in the unit interval: the whole interval where it is longer, two parts where
// it runs over the seam.
struct Stretches {
  std::vector<std::pair<double, double>> parts;

  Stretches(double a, double b, bool periodic) {
    if (!periodic) {
      parts.emplace_back(std::clamp(a, 0.0, 1.0), std::clamp(b, 0.0, 1.0));
      return;
    }
    if (b - a >= 1) {
      parts.emplace_back(0, 1);
      return;
    }
    const double turns = a > 0 && b < 1 ? 0 : std::floor(a);
    a -= turns;
    b -= turns;
    parts.emplace_back(a, std::min(b, 1.0));
    if (b >= 1 - kNear) parts.emplace_back(0, std::max(0.0, b - 1));
    if (a <= kNear) parts.emplace_back(1, 1);
  }
};

}  // namespace

TrimRegion::Cover TrimRegion::CoverOf(const ParameterBox& box) const {
  if (index_ == nullptr) return Cover::kInside;
  const UnitDomain& domain = index_->domain();
  const Eigen::Vector2d low = domain({box.u0, box.v0}), high = domain({box.u1, box.v1});
  const Stretches in_x(low[0], high[0], basis_u_.periodic());
  const Stretches in_y(low[1], high[1], basis_v_.periodic());
  const Eigen::Vector2d middle((in_x.parts[0].first + in_x.parts[0].second) / 2,
                               (in_y.parts[0].first + in_y.parts[0].second) / 2);
  const bool inside = index_->Contains(middle);
  for (const auto& [x0, x1] : in_x.parts) {
    for (const auto& [y0, y1] : in_y.parts) {
      const bool broad = x0 < x1 && y0 < y1;
      if (broad && index_->Contains({(x0 + x1) / 2, (y0 + y1) / 2}) != inside) return Cover::kCut;
      const Eigen::Vector2d margin = Eigen::Vector2d::Constant(2 * kNear);
      const Eigen::AlignedBox2d part(Eigen::Vector2d(x0, y0) - margin,
                                     Eigen::Vector2d(x1, y1) + margin);
      // Inside, a loop along the domain's side leaves everything to its own side.
      if (index_->Cuts(part, !inside)) return Cover::kCut;
    }
  }
  return inside ? Cover::kInside : Cover::kOutside;
}

}  // namespace batten
