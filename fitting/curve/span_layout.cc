// SPDX-License-Identifier: MIT
#include "fitting/curve/span_layout.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/geometry/knot_vectors.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

// How many of `spans` each piece gets by its share, one at least; the sum is right where there are
// enough.
std::vector<int> Shares(const std::vector<double>& sizes, int spans) {
  double left = 0;
  for (const double size : sizes) left += size;
  std::vector<int> shares;
  for (size_t k = 0; k < sizes.size(); ++k) {
    const int others = static_cast<int>(sizes.size() - k) - 1;
    const int fair = left > 0 ? static_cast<int>(std::lround(spans * sizes[k] / left)) : 1;
    shares.push_back(std::max(1, std::min(fair, spans - others)));
    spans -= shares.back();
    left -= sizes[k];
  }
  return shares;
}

}  // namespace

SpanLayout::SpanLayout(int degree,
                       std::vector<double> breaks,
                       std::vector<double> corners,
                       bool closed)
    : degree_(degree), breaks_(std::move(breaks)), corners_(std::move(corners)), closed_(closed) {
  if (breaks_.size() < 2) Reject("SpanLayout", "fewer than two breaks");
  for (size_t k = 1; k < breaks_.size(); ++k) {
    if (!(breaks_[k - 1] < breaks_[k])) Reject("SpanLayout", "the breaks do not increase");
  }
  std::sort(corners_.begin(), corners_.end());
  corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
  for (const double corner : corners_) {
    const bool inner = corner > breaks_.front() && corner < breaks_.back();
    if (!std::binary_search(breaks_.begin(), breaks_.end(), corner) ||
        !(inner || (closed && corner == breaks_.front())))
      Reject("SpanLayout", "a corner is not among the breaks");
  }
}

SpanLayout SpanLayout::Equal(int degree,
                             int spans,
                             double lower,
                             double upper,
                             const std::vector<double>& corners,
                             bool closed) {
  std::vector<double> ends{lower};
  for (const double corner : corners) {
    if (corner > lower && corner < upper) ends.push_back(corner);
  }
  std::sort(ends.begin(), ends.end());
  ends.push_back(upper);
  return SpanLayout(degree, ends, corners, closed)
      .Resampled(std::max(spans, static_cast<int>(ends.size()) - 1));
}

bool SpanLayout::IsCorner(int break_index) const {
  const double at = closed_ && break_index == spans() ? breaks_.front()
                                                      : breaks_[static_cast<size_t>(break_index)];
  return std::binary_search(corners_.begin(), corners_.end(), at);
}

int SpanLayout::control_points() const {
  return spans() + (closed_ ? 0 : degree_) + (degree_ - 1) * static_cast<int>(corners_.size());
}

SplineBasis SpanLayout::Basis() const {
  std::vector<double> knots;
  const double front = breaks_.front(), back = breaks_.back();
  for (const double at : breaks_) {
    const bool end = at == front || at == back;
    const int times = closed_ && at == back                                      ? 1
                      : !closed_ && end                                          ? degree_ + 1
                      : std::binary_search(corners_.begin(), corners_.end(), at) ? degree_
                                                                                 : 1;
    knots.insert(knots.end(), static_cast<size_t>(times), at);
  }
  return closed_ ? PeriodicKnots(degree_, knots) : SplineBasis(degree_, std::move(knots));
}

int SpanLayout::SpanOf(double parameter) const {
  const auto above = std::upper_bound(breaks_.begin(), breaks_.end(), parameter);
  return std::clamp(static_cast<int>(above - breaks_.begin()) - 1, 0, spans() - 1);
}

SpanLayout SpanLayout::Halved(const std::vector<bool>& where) const {
  std::vector<double> breaks{breaks_.front()};
  for (size_t k = 0; k + 1 < breaks_.size(); ++k) {
    const double middle = breaks_[k] + (breaks_[k + 1] - breaks_[k]) / 2;
    if (where[k] && breaks_[k] < middle && middle < breaks_[k + 1]) breaks.push_back(middle);
    breaks.push_back(breaks_[k + 1]);
  }
  return WithBreaks(std::move(breaks));
}

SpanLayout SpanLayout::Without(int break_index) const {
  std::vector<double> breaks = breaks_;
  breaks.erase(breaks.begin() + break_index);
  return WithBreaks(std::move(breaks));
}

std::vector<int> SpanLayout::Pieces() const {
  std::vector<int> pieces{0};
  for (int k = 1; k < spans(); ++k) {
    if (IsCorner(k)) pieces.push_back(k);
  }
  pieces.push_back(spans());
  return pieces;
}

SpanLayout SpanLayout::Resampled(int spans) const {
  const std::vector<int> pieces = Pieces();
  // Where every piece is one span, its length is what it is worth.
  const bool bare = static_cast<int>(pieces.size()) == this->spans() + 1;
  std::vector<double> sizes;
  for (size_t k = 0; k + 1 < pieces.size(); ++k) {
    sizes.push_back(bare ? breaks_[static_cast<size_t>(pieces[k + 1])] -
                               breaks_[static_cast<size_t>(pieces[k])]
                         : pieces[k + 1] - pieces[k]);
  }
  const std::vector<int> shares = Shares(sizes, spans);
  std::vector<double> breaks{breaks_.front()};
  for (size_t k = 0; k < sizes.size(); ++k) {
    const int count = pieces[k + 1] - pieces[k];
    for (int step = 1; step < shares[k]; ++step) {
      const double place = static_cast<double>(count) * step / shares[k];
      const int below = std::min(static_cast<int>(place), count - 1);
      const auto at = static_cast<size_t>(pieces[k] + below);
      breaks.push_back(breaks_[at] + (place - below) * (breaks_[at + 1] - breaks_[at]));
    }
    breaks.push_back(breaks_[static_cast<size_t>(pieces[k + 1])]);
  }
  return WithBreaks(std::move(breaks));
}

SpanLayout SpanLayout::WithBreaks(std::vector<double> breaks) const {
  return SpanLayout(degree_, std::move(breaks), corners_, closed_);
}

}  // namespace batten::internal
