// SPDX-License-Identifier: MIT
#include "fitting/cloud/cloud_outliers.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "batten/fitting/statistics.h"
#include "fitting/cloud/cloud_constants.h"
#include "fitting/cloud/inlier_prescreen.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "fitting/neighbours/local_quadric.h"

namespace batten::internal {
namespace {

constexpr int kPlaneNeighbours = 24;
constexpr double kUsualScales = 2.5;  // usual deviations; beyond, the place is no plane …
constexpr double kFlat = 0.1;         // … nor a quadric, unless within this share of reach
constexpr double kSparser = 2;        // ratio of reaches; beyond, a point is sparser than others
constexpr int kQuadricNeighbours = 30;
constexpr int kLookedAt = 48;  // points searched for the inliers of a quadric
constexpr int kOthers[] = {
    3, 6, 10, 15, 21};              // ranks of the inliers whose neighbourhoods get a quadric
constexpr double kOff = 4.5;        // standard deviations from every quadric: an outlier
constexpr double kResolved = 0.06;  // share of the reach; smaller deviations count as this
constexpr int kCompanions = 2;      // inliers needed among the nearest six
constexpr double kAway = 2.5;       // reaches from the nearest inlier: off the surface
constexpr double kFillsSpace = 0.2;
constexpr double kMostNeighbourLeverage = 4;  // beyond, a quadric is not used

constexpr double kPays = 0.5;  // share of the points; below, the prescreen is discarded

// Statistics of a point relative to its neighbours.
struct PointStatistics {
  double offset = 0;         // distance from the plane of its neighbours
  double scale = 0;          // robust standard deviation of the neighbours from that plane
  double reach = 0;          // distance of its sixth neighbour
  double nearest_reach = 0;  // reach of the nearest other point, or nearly the nearest
  int nearest = 0;           // that point
};

// The statistics of the points asked for, and reaches of all.
class NeighbourStatistics {
 public:
  NeighbourStatistics(const Eigen::Matrix3Xd& points, const NeighbourIndex& index)
      : points_(points), index_(index) {}

  // Points measured so far; each keeps its place in the list.
  const std::vector<int>& asked() const { return asked_; }
  const PointStatistics& operator[](size_t i) const { return statistics_[i]; }

  // Measures points not measured yet, without the reaches of those nearest to them.
  void Ask(std::span<const int> chosen, ThreadPool& pool, const Progress& progress) {
    const auto old = std::ssize(asked_);
    asked_.insert(asked_.end(), chosen.begin(), chosen.end());
    statistics_.resize(asked_.size());
    if (rank_.empty()) rank_.assign(static_cast<size_t>(points_.cols()), -1);
    for (auto i = old; i < std::ssize(asked_); ++i) rank_[asked_[i]] = static_cast<int>(i);
    constexpr std::ptrdiff_t kChunk = 1 << 16;
    for (auto start = old; start < std::ssize(asked_); start += kChunk) {
      const auto count = std::min<std::ptrdiff_t>(kChunk, std::ssize(asked_) - start);
      pool.For(count, kSlowPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        Measure(start + begin, start + end);
      });
      Report(progress,
             "prepare",
             0.4 + 0.4 * static_cast<double>(start + count) / static_cast<double>(points_.cols()));
    }
  }

  // Adds the reach of each measured point's nearest point.
  void AskNearest(ThreadPool& pool) {
    pool.For(std::ssize(asked_), kSlowPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      std::vector<int> nearest;
      for (auto i = begin; i < end; ++i) nearest.push_back(statistics_[i].nearest);
      const std::vector<double> reaches = Reaches(nearest);
      for (auto i = begin; i < end; ++i) statistics_[i].nearest_reach = reaches[i - begin];
    });
  }

  // The distances of the sixth neighbours of points.
  std::vector<double> Reaches(std::span<const int> chosen) const {
    std::vector<double> reaches(chosen.size());
    std::vector<int> unknown;
    for (size_t i = 0; i < chosen.size(); ++i) {
      const int rank = rank_[chosen[i]];
      if (rank >= 0) reaches[i] = statistics_[rank].reach;
      if (rank < 0) unknown.push_back(chosen[i]);
    }
    if (unknown.empty()) return reaches;
    const int k = kReachNeighbour + 1;
    const std::vector<int> near = index_.Nearest(points_(Eigen::all, unknown), k);
    auto row = near.begin();
    for (size_t i = 0; i < chosen.size(); ++i) {
      if (rank_[chosen[i]] >= 0) continue;
      reaches[i] = (points_.col(row[kReachNeighbour]) - points_.col(chosen[i])).norm();
      row += k;
    }
    return reaches;
  }

 private:
  void Measure(std::ptrdiff_t begin, std::ptrdiff_t end) {
    const std::span<const int> chosen(asked_.data() + begin, static_cast<size_t>(end - begin));
    const int k = static_cast<int>(std::min<Eigen::Index>(kPlaneNeighbours + 1, points_.cols()));
    const std::vector<int> near = index_.Nearest(points_(Eigen::all, chosen), k);
    Eigen::Matrix3Xd local(3, k - 1);
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      const int point = asked_[i];
      const int* row = near.data() + (i - begin) * k;
      Eigen::Index others = 0;  // the point itself stays out of its own plane
      for (int j = 0; j < k && others < k - 1; ++j) {
        if (row[j] != point) local.col(others++) = points_.col(row[j]) - points_.col(point);
      }
      const AgreedPlane agreed = PlaneMostAgreeOn(local);
      PointStatistics& standing = statistics_[i];
      standing.offset = std::abs(agreed.plane.centre.dot(agreed.plane.normal));
      standing.scale = agreed.scale;
      standing.nearest = row[row[0] == point ? 1 : 0];
      standing.reach = (points_.col(row[kReachNeighbour]) - points_.col(point)).norm();
    }
  }

  const Eigen::Matrix3Xd& points_;
  const NeighbourIndex& index_;
  std::vector<int> asked_, rank_;
  std::vector<PointStatistics> statistics_;
};

// Median deviation and reach of the points.
struct Usual {
  double scale = 0, reach = 0;
};

// Computes weighted medians: a measured point under the mask `sampled` represents `stands_for`
// points, every other one itself.
Usual UsualOf(const NeighbourStatistics& standings, const PointMask& sampled, double stands_for) {
  std::vector<std::pair<double, double>> scales, reaches;
  for (size_t i = 0; i < standings.asked().size(); ++i) {
    const double weight = sampled[standings.asked()[i]] ? stands_for : 1;
    scales.emplace_back(standings[i].scale, weight);
    reaches.emplace_back(standings[i].reach, weight);
  }
  return {WeightedMedian(std::move(scales)), WeightedMedian(std::move(reaches))};
}

// The points nearest to a place, one less than `count` without one of them.
std::vector<int> NearestOthers(const NeighbourIndex& index,
                               const Eigen::Vector3d& place,
                               int without,
                               int count) {
  std::vector<int> near = index.Nearest(place, count);
  near.erase(std::remove(near.begin(), near.end(), without), near.end());
  return near;
}

// Classifies candidate points by the inliers near them.
class OutlierClassifier {
 public:
  // Inliers are the points `screened` and, of those measured, the ones that agree with their
  // neighbours.
  OutlierClassifier(const Eigen::Matrix3Xd& points,
                    const NeighbourIndex& index,
                    const NeighbourStatistics& standings,
                    const Usual& usual,
                    PointMask screened,
                    double noise)
      : points_(points),
        index_(index),
        statistics_(standings),
        noise_(noise),
        usual_scale_(kUsualScales * usual.scale),
        usual_reach_(usual.reach),
        inliers_(std::move(screened)) {
    for (size_t i = 0; i < standings.asked().size(); ++i) {
      const PointStatistics& own = standings[i];
      const double least = std::max(
          usual.scale, kExactInReaches * std::min(own.nearest_reach, kLonelier * usual.reach));
      inliers_[standings.asked()[i]] = own.scale <= kUsualScales * least &&
                                       own.offset <= kThreeSigmas * std::max(least, own.scale) &&
                                       own.reach <= kSparser * own.nearest_reach;
    }
  }

  PointMask Outliers(ThreadPool& pool) {
    TrustCurvedPlaces(pool);
    std::vector<int> candidates;  // places in the list of those asked
    for (size_t i = 0; i < statistics_.asked().size(); ++i) {
      if (!inliers_[statistics_.asked()[i]] || statistics_[i].reach > kLonelier * usual_reach_)
        candidates.push_back(static_cast<int>(i));
    }
    PointMask outliers = PointMask::Constant(points_.cols(), false);
    if (inliers_.count() <= kQuadricNeighbours || candidates.empty()) return outliers;
    const std::vector<PointClass> classes = JudgeAll(candidates, pool);
    for (size_t i = 0; i < candidates.size(); ++i)
      outliers[PointOf(candidates[i])] = classes[i] != kGood;
    // Several points off the surface together, as dense as it, are structure.
    PointMask kept = outliers;
    pool.For(std::ssize(candidates), 64, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        if (classes[i] == kOffSurface && AmongOutliers(candidates[i], outliers))
          kept[PointOf(candidates[i])] = false;
      }
    });
    return kept;
  }

 private:
  enum PointClass : char { kUnjudged, kGood, kOffSurface, kAlone };

  int PointOf(int place) const { return statistics_.asked()[static_cast<size_t>(place)]; }

  // Adds inliers where the surface bends much within a few spacings: points that agree with a
  // quadric. Some scattered points do so by chance; so a point must also be next to inliers.
  void TrustCurvedPlaces(ThreadPool& pool) {
    std::vector<int> candidates;
    for (size_t i = 0; i < statistics_.asked().size(); ++i) {
      if (!inliers_[statistics_.asked()[i]]) candidates.push_back(static_cast<int>(i));
    }
    struct Nearest {
      int point[kReachNeighbour];
      bool as_dense[kReachNeighbour];
    };
    std::vector<char> agrees(candidates.size());
    std::vector<Nearest> near(candidates.size());
    pool.For(std::ssize(candidates), 64, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        agrees[i] = AgreesWithOwnQuadric(candidates[i], near[i].point);
        if (!agrees[i]) continue;
        const std::vector<double> reaches = statistics_.Reaches(near[i].point);
        for (int j = 0; j < kReachNeighbour; ++j)
          near[i].as_dense[j] = statistics_[candidates[i]].reach <= kSparser * reaches[j];
      }
    });
    for (bool grown = true; grown;) {
      grown = false;
      for (size_t i = 0; i < candidates.size(); ++i) {
        const int point = PointOf(candidates[i]);
        if (!agrees[i] || inliers_[point]) continue;
        int companions = 0;
        for (int j = 0; j < kReachNeighbour; ++j)
          companions += inliers_[near[i].point[j]] && near[i].as_dense[j] ? 1 : 0;
        if (companions < kCompanions) continue;
        inliers_[point] = true;
        grown = true;
      }
    }
  }

  bool AgreesWithOwnQuadric(int place, int* nearest) const {
    const int point = PointOf(place);
    const Eigen::Vector3d p = points_.col(point);
    const PointStatistics& standing = statistics_[place];
    const std::vector<int> near = NearestOthers(index_, p, point, kPlaneNeighbours + 1);
    std::copy_n(near.begin(), kReachNeighbour, nearest);
    const double reach = standing.nearest_reach;
    if (standing.reach > kSparser * reach) return false;
    const LocalQuadric quadric = LocalQuadric::MostAgreeOn(points_(Eigen::all, near).colwise() - p);
    const double scale = quadric.scale_of_most();
    if (scale > std::max(usual_scale_, kFlat * reach)) return false;
    return std::abs(quadric.Offset(Eigen::Vector3d::Zero())) <=
           kThreeSigmas * std::max({noise_, kFlat / 2 * reach, scale}) *
               std::sqrt(1 + quadric.Leverage(Eigen::Vector3d::Zero()));
  }

  // Classifies every candidate. Nearly all have enough inliers among the points around them; for
  // those deep among outliers an index of the inliers is searched.
  std::vector<PointClass> JudgeAll(const std::vector<int>& candidates, ThreadPool& pool) const {
    std::vector<PointClass> classes(candidates.size(), kUnjudged);
    pool.For(std::ssize(candidates), 64, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        std::vector<int> near = InliersAround(PointOf(candidates[i]));
        if (std::ssize(near) == kQuadricNeighbours) classes[i] = Judge(candidates[i], near);
      }
    });
    std::vector<size_t> deep;
    for (size_t i = 0; i < candidates.size(); ++i) {
      if (classes[i] == kUnjudged) deep.push_back(i);
    }
    if (deep.empty()) return classes;
    std::vector<int> list;
    for (const int point : index_.order()) {
      if (inliers_[point]) list.push_back(point);
    }
    const NeighbourIndex index(points_(Eigen::all, list), pool);
    pool.For(std::ssize(deep), 64, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        const int place = candidates[deep[i]];
        std::vector<int> near = index.Nearest(points_.col(PointOf(place)), kQuadricNeighbours + 1);
        for (int& j : near) j = list[j];
        near.erase(std::remove(near.begin(), near.end(), PointOf(place)), near.end());
        if (std::ssize(near) > kQuadricNeighbours) near.pop_back();
        classes[deep[i]] = Judge(place, near);
      }
    });
    return classes;
  }

  // The inliers nearest to a point without itself; fewer if it is deep among outliers.
  std::vector<int> InliersAround(int point) const {
    std::vector<int> near = index_.Nearest(points_.col(point), kLookedAt);
    const auto last =
        std::remove_if(near.begin(), near.end(), [&](int j) { return j == point || !inliers_[j]; });
    near.resize(std::min<size_t>(last - near.begin(), kQuadricNeighbours));
    return near;
  }

  // Classifies a candidate; `near` are the inliers nearest to it.
  PointClass Judge(int place, const std::vector<int>& near) const {
    const int point = PointOf(place);
    const Eigen::Vector3d p = points_.col(point);
    const double reach = Median(statistics_.Reaches({near.data(), kReachNeighbour}));
    const double own = statistics_[place].reach;
    const double away = (points_.col(near[0]) - p).norm();
    if (own > kLonelier * reach) return kAlone;
    if (away > kAway * reach) return own > kSparser * reach ? kAlone : kOffSurface;
    if (inliers_[point]) return kGood;
    // Beside an edge it belongs to the neighbourhood of some point farther away.
    bool judged = false;
    for (const int other : kOthers) {
      const std::vector<int> others =
          NearestOthers(index_, points_.col(near[other]), point, kQuadricNeighbours + 1);
      const LocalQuadric quadric =
          LocalQuadric::MostAgreeOn(points_(Eigen::all, others).colwise() - p);
      const double leverage = quadric.Leverage(Eigen::Vector3d::Zero());
      if (leverage > kMostNeighbourLeverage) continue;
      judged = true;
      const double deviation = std::max({noise_, kResolved * reach, quadric.robust_scale()});
      if (std::abs(quadric.Offset(Eigen::Vector3d::Zero())) <=
          kOff * deviation * std::sqrt(1 + leverage)) {
        return kGood;
      }
    }
    return judged ? kOffSurface : kGood;
  }

  // Whether most of the points nearest to a point that is off are off too, and form something
  // thinner than space.
  bool AmongOutliers(int place, const PointMask& outliers) const {
    const int point = PointOf(place);
    if (statistics_[place].scale > kFillsSpace * statistics_[place].reach) return false;
    const std::vector<int> near = index_.Nearest(points_.col(point), kReachNeighbour + 1);
    return std::count_if(near.begin(), near.end(), [&](int j) {
             return j != point && outliers[j];
           }) > kReachNeighbour / 2;
  }

  const Eigen::Matrix3Xd& points_;
  const NeighbourIndex& index_;
  const NeighbourStatistics& statistics_;
  double noise_, usual_scale_, usual_reach_;
  PointMask inliers_;
};

// The prescreened inliers of a cloud, or none if they are few: such a cloud is rough, outliers near
// its few smooth places could pass as inliers, and little time would be saved.
PointMask Screened(const Eigen::Matrix3Xd& points,
                   const NeighbourIndex& index,
                   const Usual& usual,
                   ThreadPool& pool) {
  PointMask good = PrescreenInliers(points, index, usual.scale, usual.reach, pool);
  if (static_cast<double>(good.count()) < kPays * static_cast<double>(points.cols()))
    good.setConstant(false);
  return good;
}

}  // namespace

PointMask FindOutliers(const Eigen::Matrix3Xd& points,
                       const NeighbourIndex& index,
                       double spacing,
                       double noise,
                       ThreadPool& pool,
                       const Progress& progress) {
  // Exact data: deviations are rounding or curvature.
  const double rounding = kRelativelyEqual * spacing;
  const auto order = index.order();
  NeighbourStatistics standings(points, index);
  std::vector<int> sample;
  for (const Eigen::Index i : SampleIndices(points.cols(), kTypical, 1)) sample.push_back(order[i]);
  standings.Ask(sample, pool, progress);
  PointMask good = PointMask::Constant(points.cols(), false);
  Usual usual = UsualOf(standings, good, 1);
  if (points.cols() > kTypical) {
    good = Screened(points, index, {std::max(usual.scale, rounding), usual.reach}, pool);
    PointMask asked = good;
    Eigen::Index good_asked = 0;
    for (const int point : sample) {
      good_asked += good[point] ? 1 : 0;
      asked[point] = true;
    }
    std::vector<int> rest;
    for (const int point : order) {
      if (!asked[point]) rest.push_back(point);
    }
    standings.Ask(rest, pool, progress);
    // The sample alone is a coarse estimate; now every point that the prescreen left is measured.
    usual = UsualOf(standings,
                    good,
                    static_cast<double>(good.count()) /
                        static_cast<double>(std::max<Eigen::Index>(1, good_asked)));
  }
  usual.scale = std::max(usual.scale, rounding);
  standings.AskNearest(pool);
  return OutlierClassifier(
             points, index, standings, usual, std::move(good), std::max(noise, rounding))
      .Outliers(pool);
}

}  // namespace batten::internal
