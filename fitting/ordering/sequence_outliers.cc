// SPDX-License-Identifier: MIT
#include "fitting/ordering/sequence_outliers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "batten/fitting/statistics.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kFewestOfSequence = 8;
constexpr int kRounds = 10;              // three are enough but where a third are outliers
constexpr Eigen::Index kRunBlock = 8;    // steps are alike over three of them
constexpr double kStepQuantile = 0.3;    // of lengths half of which may lead to outliers and back
constexpr double kLeavingNoisy = 4;      // steps that leaving the line costs where noise turns it;
constexpr double kSkippingSmooth = 1.3;  // each point left out, where it hardly turns …
constexpr double kSkippingNoisy = 4;     // … and where noise turns it
constexpr Eigen::Index kTurnBlock = 16;
constexpr double kTurnQuantile = 0.14;  // three in a row are rarely free of outliers
constexpr double kNoisyTurn = 0.3;
constexpr double kStraightOn = 0.3;         // steps: at the end of a line that comes to a corner
constexpr Eigen::Index kFewSkipped = 4;     // steps around what is left out, whose chord is even
constexpr Eigen::Index kMostSkipped = 24;   // in a row
constexpr double kAsFar = 4;                // times the steps behind
constexpr int kReach = 4;                   // neighbours on either side
constexpr Eigen::Index kRareOthers = 50;    // one in so many points
constexpr Eigen::Index kFewestInGroup = 5;  // so many near each other in a row are no outliers
constexpr double kNearEachOther = 4;        // steps
constexpr double kVeryFar = 2.5;            // steps: farther than noise reaches
constexpr double kVeryFarFactor = 5;        // times the median deviation nearby
constexpr double kFar = 0.75;               // steps: off the line whatever the curve does
constexpr double kFarFactor = 10;           // times the median deviation nearby
constexpr double kFineFloor = 0.05;         // steps: nothing nearer is marked
constexpr double kFineFactor = 15;          // times what three quarters of the next ones keep
constexpr double kUneven = 6;               // steps over two: next to long ones
constexpr double kSuspicious = 4;           // times the median of the quick test

using Values = std::array<double, 4 * kReach>;

// The points still held to lie on the curve, in order; as a ring or not.
struct Line {
  const Eigen::Matrix3Xd& points;
  std::vector<Eigen::Index> kept;
  bool closed;

  Eigen::Index size() const { return static_cast<Eigen::Index>(kept.size()); }
  bool Has(Eigen::Index k) const { return closed || (k >= 0 && k < size()); }
  auto at(Eigen::Index k) const {
    const Eigen::Index n = size();
    if (k < 0) k += n;
    if (k >= n) k -= n;
    return points.col(kept[static_cast<size_t>(k)]);
  }
  void Remove(const std::vector<char>& marked) {
    size_t end = 0;
    for (size_t k = 0; k < kept.size(); ++k) {
      if (!marked[k]) kept[end++] = kept[k];
    }
    kept.resize(end);
  }
};

// A quantile of the values around each block, those of its neighbours included; zeros do not count.
std::vector<double> AroundBlocks(const std::vector<double>& values,
                                 double quantile,
                                 Eigen::Index block = kRunBlock) {
  const auto count = static_cast<Eigen::Index>(values.size());
  std::vector<double> result, sample;
  for (Eigen::Index begin = 0; begin < count; begin += block) {
    const Eigen::Index from = std::max<Eigen::Index>(0, std::min(begin, count - block) - block);
    const Eigen::Index to = std::min(count, std::max(begin, block) + 2 * block);
    sample.clear();
    for (Eigen::Index k = from; k < to; ++k) {
      if (values[static_cast<size_t>(k)] > 0) sample.push_back(values[static_cast<size_t>(k)]);
    }
    const auto place = static_cast<std::ptrdiff_t>(quantile * static_cast<double>(sample.size()));
    if (!sample.empty()) std::nth_element(sample.begin(), sample.begin() + place, sample.end());
    result.push_back(sample.empty() ? 0 : sample[static_cast<size_t>(place)]);
  }
  return result;
}

double OfBlock(const std::vector<double>& blocks, Eigen::Index k, Eigen::Index block = kRunBlock) {
  return blocks[std::min(static_cast<size_t>(k / block), blocks.size() - 1)];
}

std::vector<double> StepsOf(const Line& line) {
  std::vector<double> steps;
  for (Eigen::Index k = 1; k < line.size(); ++k) {
    steps.push_back((line.at(k) - line.at(k - 1)).norm());
  }
  if (line.closed) steps.push_back((line.at(0) - line.at(line.size() - 1)).norm());
  return steps;
}

// The share, from 0 to 1, by which noise turns the way around each block. Where it is wider than
// the steps, its own far points must not be left out.
std::vector<double> NoiseAround(const Line& line) {
  std::vector<double> turns;  // 1 - cos
  for (Eigen::Index k = 1; k + 1 < line.size(); ++k) {
    const Eigen::Vector3d to = line.at(k) - line.at(k - 1), on = line.at(k + 1) - line.at(k);
    const double lengths = std::sqrt(to.squaredNorm() * on.squaredNorm());
    const double turn = lengths > 0 ? 1 - to.dot(on) / lengths : 0;
    turns.push_back(std::max(turn, std::numeric_limits<double>::min()));
  }
  std::vector<double> result = AroundBlocks(turns, kTurnQuantile, kTurnBlock);
  for (double& turn : result) turn = std::min(1.0, std::sqrt(2 * turn) / kNoisyTurn);
  return result;
}

// The cheapest way: for each place the one before it on the way. A ring is gone around once and a
// stretch more, so that the beginning is judged with what comes before it.
std::vector<Eigen::Index> CheapestWay(const Line& line,
                                      const std::vector<double>& steps,
                                      const std::vector<double>& noise,
                                      Eigen::Index places) {
  std::vector<double> cost(static_cast<size_t>(places), 0);
  std::vector<Eigen::Index> before(static_cast<size_t>(places), -1);
  double skipped = std::numeric_limits<double>::infinity();  // least cost when one or more are
  for (Eigen::Index j = 1; j < places; ++j) {
    const double step = OfBlock(steps, j % line.size());
    const double unit = step > 0 ? 1 / step : 0;
    const double share = OfBlock(noise, j % line.size(), kTurnBlock);
    const double leaving = kLeavingNoisy * share;
    const double skipping = std::lerp(kSkippingSmooth, kSkippingNoisy, share);
    const Eigen::Vector3d place = line.at(j);
    const auto here = static_cast<size_t>(j);
    cost[here] = cost[here - 1] + unit * (place - line.at(j - 1)).norm();
    before[here] = j - 1;
    skipped = std::min(skipped, (j > 1 ? cost[here - 2] : 0.0) + leaving) + skipping;
    if (cost[here] <= skipped) continue;
    const Eigen::Index farthest = std::max<Eigen::Index>(0, j - 1 - kMostSkipped);
    double penalty = leaving;
    for (Eigen::Index i = j - 2; i >= farthest; --i) {
      penalty += skipping;
      const double other = cost[static_cast<size_t>(i)] + penalty;
      if (other >= cost[here]) continue;
      const double whole = other + unit * (place - line.at(i)).norm();
      if (whole >= cost[here]) continue;
      cost[here] = whole;
      before[here] = i;
    }
    const double first = kLeavingNoisy + kSkippingNoisy * static_cast<double>(j);
    if (j <= kMostSkipped && first < cost[here]) {
      cost[here] = first;
      before[here] = -1;
    }
  }
  Eigen::Index last = places - 1;
  double least = cost[static_cast<size_t>(last)];
  for (Eigen::Index k = 1; k <= std::min(kMostSkipped, places - 1); ++k) {
    const double whole = cost[static_cast<size_t>(places - 1 - k)] + kLeavingNoisy +
                         kSkippingNoisy * static_cast<double>(k);
    if (whole < least) {
      least = whole;
      last = places - 1 - k;
    }
  }
  std::vector<Eigen::Index> way;
  for (Eigen::Index k = last; k >= 0; k = before[static_cast<size_t>(k)]) way.push_back(k);
  std::reverse(way.begin(), way.end());
  return way;
}

// Whether point k continues the straight line of two points of the way, the nearer of which is the
// w-th and the farther the next on that side: a sharp corner.
bool GoesStraightOn(
    const Line& line, const std::vector<Eigen::Index>& way, size_t w, int side, Eigen::Index k) {
  if (side < 0 ? w == 0 : w + 1 == way.size()) return false;
  const Eigen::Index near = way[w], far = way[side < 0 ? w - 1 : w + 1];
  const Eigen::Vector3d step = line.at(near) - line.at(far);
  const double reach =
      2 * static_cast<double>(std::abs(k - near)) / static_cast<double>(std::abs(near - far));
  return DistanceFromSegment(line.at(k), line.at(near), line.at(near) + reach * step) <
         kStraightOn * step.norm();
}

// Whether the way through points between `from` and `to` turns sharply once at most, as a curve
// does that was sampled coarsely; outliers turn it where it leaves, at them and where it comes
// back.
bool TurnsAsACurve(const Line& line, Eigen::Index from, Eigen::Index to) {
  constexpr double kGentle = 0.5;  // cosine
  // Places of a ring are counted around it more than once.
  const auto at = [&](Eigen::Index k) { return line.at(line.closed ? k % line.size() : k); };
  int sharp = 0;
  for (Eigen::Index k = from; k <= to; ++k) {
    if (!line.Has(k - 1) || !line.Has(k + 1)) continue;
    const Eigen::Vector3d in = at(k) - at(k - 1), on = at(k + 1) - at(k);
    sharp += in.dot(on) < kGentle * in.norm() * on.norm();
  }
  return sharp <= 1;
}

// Whether points between `from` and `to` may be outliers: not many in a row are near each other (a
// part of the curve at the end of long steps).
bool MayBeOutliers(const Line& line, Eigen::Index from, Eigen::Index to, double usual) {
  Eigen::Index near_each_other = 1;
  for (Eigen::Index k = from; k < to; ++k) {
    const double step = (line.at(k + 1) - line.at(k)).norm();
    near_each_other =
        k > from && k + 1 < to && step <= kNearEachOther * usual ? near_each_other + 1 : 1;
    if (near_each_other >= kFewestInGroup) return false;
  }
  return true;
}

// Marks a few points before the first and behind the last point of the way, if they lie farther
// off than any step of the way is long, and the line has other outliers or even steps: a long step
// to an end may be a part of it.
void MarkEnds(const Line& line,
              const std::vector<Eigen::Index>& way,
              double usual,
              std::vector<char>& marked) {
  double longest = 0;
  for (size_t w = 1; w < way.size(); ++w) {
    if (way[w] != way[w - 1] + 1) continue;
    longest = std::max(longest, (line.at(way[w]) - line.at(way[w - 1])).norm());
  }
  const Eigen::Index end = line.size() - 1;
  const Eigen::Index first = way.front() <= kFewSkipped ? way.front() : 0;
  const Eigen::Index last = end - way.back() <= kFewSkipped ? way.back() : end;
  double uneven = 0;
  for (Eigen::Index k = first; k < last; ++k) {
    uneven = std::max(uneven, (line.at(k + 1) - line.at(k)).norm());
  }
  const auto others = std::count(marked.begin(), marked.end(), 1);
  if (uneven > kNearEachOther * usual && kRareOthers * others < line.size()) return;
  for (Eigen::Index k = 0; k < first; ++k) {
    marked[static_cast<size_t>(k)] = (line.at(k) - line.at(first)).norm() > longest;
  }
  for (Eigen::Index k = last + 1; k <= end; ++k) {
    marked[static_cast<size_t>(k)] = (line.at(k) - line.at(last)).norm() > longest;
  }
}

// Marks of what the cheapest way leaves out between two of its points, if it lies farther from the
// straight way than two of its steps are long: else it may be a corner of a line with few points.
std::vector<char> LeftOut(const Line& line) {
  const Eigen::Index count = line.size();
  const Eigen::Index places = line.closed ? count + std::min(count, 4 * kMostSkipped) : count;
  const std::vector<double> steps = AroundBlocks(StepsOf(line), kStepQuantile);
  const std::vector<double> noise = NoiseAround(line);
  const std::vector<Eigen::Index> way = CheapestWay(line, steps, noise, places);
  std::vector<char> marked(static_cast<size_t>(count), 0);
  for (size_t w = 1; w < way.size(); ++w) {
    const Eigen::Index from = way[w - 1], to = way[w];
    marked[static_cast<size_t>(to % count)] = 0;  // the second time around a ring counts
    if (to == from + 1) continue;
    const double length = (line.at(to) - line.at(from)).norm();
    const double share = to - from <= kFewSkipped ? 2 / static_cast<double>(to - from) : 1;
    // Where noise turns the way about, its turns tell nothing.
    const bool may_be =
        MayBeOutliers(line, from, to, OfBlock(steps, from % count)) &&
        (OfBlock(noise, from % count, kTurnBlock) == 1 || !TurnsAsACurve(line, from, to));
    for (Eigen::Index k = from + 1; k < to; ++k) {
      marked[static_cast<size_t>(k % count)] =
          may_be && DistanceFromSegment(line.at(k), line.at(from), line.at(to)) > share * length &&
          !GoesStraightOn(line, way, w - 1, -1, k) && !GoesStraightOn(line, way, w, 1, k);
    }
  }
  if (!line.closed) MarkEnds(line, way, OfBlock(steps, 0), marked);
  return marked;
}

// Deviations of points from lines of their neighbours, none of which counts alone.
class Deviations {
 public:
  explicit Deviations(const Line& line)
      : line_(line), known_(line.kept.size(), std::numeric_limits<double>::quiet_NaN()) {}

  // The least of three: off the chords over it, off the lines of those before and of those behind.
  double at(Eigen::Index k) {
    if (line_.closed) k = (k + line_.size()) % line_.size();
    double& known = known_[static_cast<size_t>(k)];
    if (std::isnan(known)) known = std::min({OffChords(k), OffLine(k, -1), OffLine(k, 1)});
    return known;
  }

 private:
  static double Ranked(Values& values, int count, double share) {
    if (count == 0) return std::numeric_limits<double>::infinity();
    const auto place = static_cast<std::ptrdiff_t>(share * (count - 1));
    std::nth_element(values.begin(), values.begin() + place, values.begin() + count);
    return values[static_cast<size_t>(place)];
  }

  double OffChords(Eigen::Index k) const {
    Values distances;
    int count = 0;
    for (int a = 1; a <= kReach && line_.Has(k - a); ++a) {
      for (int b = 1; b <= kReach && line_.Has(k + b); ++b) {
        distances[count++] = DistanceFromSegment(line_.at(k), line_.at(k - a), line_.at(k + b));
      }
    }
    return Ranked(distances, count, 0.35);
  }

  // Straight on from two points on one side, as far as uneven steps would lead.
  double OffLine(Eigen::Index k, int side) const {
    Values distances;
    int count = 0;
    for (int a = 1; a <= kReach && line_.Has(k + side * a); ++a) {
      for (int b = a + 1; b <= kReach && line_.Has(k + side * b); ++b) {
        const Eigen::Vector3d near = line_.at(k + side * a), far = line_.at(k + side * b);
        const double steps = kAsFar * a / (b - a);
        distances[count++] = DistanceFromSegment(line_.at(k), near, near + steps * (near - far));
      }
    }
    return Ranked(distances, count, 0.5);
  }

  const Line& line_;
  std::vector<double> known_;
};

// A quantile of the deviations of the neighbours up to `reach` places away.
double Nearby(const Line& line, Deviations& deviations, Eigen::Index k, int reach, double share) {
  Values values;
  int count = 0;
  for (int away = 1; away <= reach; ++away) {
    for (const int side : {-1, 1}) {
      if (line.Has(k + side * away)) values[count++] = deviations.at(k + side * away);
    }
  }
  const auto place = static_cast<std::ptrdiff_t>(share * (count - 1));
  std::nth_element(values.begin(), values.begin() + place, values.begin() + count);
  return values[static_cast<size_t>(place)];
}

bool IsOff(const Line& line, Deviations& deviations, Eigen::Index k, double step, double usual) {
  const double off = deviations.at(k);
  if (!(off > kFineFloor * step)) return false;
  if (off > kFar * step) {
    const double near = std::max(Nearby(line, deviations, k, 2 * kReach, 0.5), usual);
    if (off > (off > kVeryFar * step ? kVeryFarFactor : kFarFactor) * near) return true;
  }
  return off > kFineFactor * std::max(Nearby(line, deviations, k, kReach, 0.75), usual);
}

// Marks of points off the lines of their neighbours. A quick look at the chord from the neighbour
// before to the one behind clears most.
std::vector<char> OffTheLine(const Line& line) {
  const Eigen::Index count = line.size();
  std::vector<double> quick(static_cast<size_t>(count), 0);
  for (Eigen::Index k = 0; k < count; ++k) {
    if (!line.Has(k - 1) || !line.Has(k + 1)) continue;
    quick[static_cast<size_t>(k)] = DistanceFromSegment(line.at(k), line.at(k - 1), line.at(k + 1));
  }
  const std::vector<double> medians = AroundBlocks(quick, 0.5);
  const std::vector<double> steps = AroundBlocks(StepsOf(line), kStepQuantile);
  std::vector<char> marked(static_cast<size_t>(count), 0);
  Deviations deviations(line);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double median = OfBlock(medians, k);
    if (quick[static_cast<size_t>(k)] <= kSuspicious * median) continue;
    const double step = OfBlock(steps, k), across = (line.at(k + 1) - line.at(k - 1)).norm();
    if (across > kUneven * step) continue;
    marked[static_cast<size_t>(k)] =
        IsOff(line, deviations, k, std::max(step, 0.5 * across), 0.1 * median);
  }
  return marked;
}

// Whether no point stands out from the line through those beside it more than chance has it among
// so many: then none is an outlier, and looking closer is not needed.
bool HasNoOutliers(const Eigen::Matrix3Xd& points) {
  constexpr Eigen::Index kManyPoints = 5000, kSample = 2000;
  constexpr double kAmongMany = 5.5;  // medians: 6.6 standard deviations in one direction
  if (points.cols() < kManyPoints) return false;
  const auto bend = [&](Eigen::Index k) {
    return (points.col(k - 1) - 2 * points.col(k) + points.col(k + 1)).squaredNorm();
  };
  std::vector<double> sample;
  for (Eigen::Index k = 1; k + 1 < points.cols(); k += points.cols() / kSample)
    sample.push_back(bend(k));
  const double most = kAmongMany * kAmongMany * Median(std::move(sample));
  for (Eigen::Index k = 1; k + 1 < points.cols(); ++k) {
    if (!(bend(k) <= most)) return false;
  }
  return true;
}

}  // namespace

PointMask FindSequenceOutliers(const Eigen::Matrix3Xd& points, bool closed) {
  if (HasNoOutliers(points)) return PointMask::Constant(points.cols(), false);
  Line line{points, {}, closed};
  for (Eigen::Index k = 0; k < points.cols(); ++k) line.kept.push_back(k);
  for (int round = 0; round < kRounds && line.size() >= kFewestOfSequence; ++round) {
    const Eigen::Index before = line.size();
    line.Remove(LeftOut(line));
    if (line.size() >= kFewestOfSequence) line.Remove(OffTheLine(line));
    if (line.size() == before) break;
  }
  PointMask sequence_outliers = PointMask::Constant(points.cols(), true);
  for (const Eigen::Index k : line.kept) sequence_outliers[k] = false;
  return sequence_outliers;
}

}  // namespace batten::internal
