// SPDX-License-Identifier: MIT
#include "batten/fitting/cloud_outliers.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "batten/fitting/local_quadric.h"
#include "batten/fitting/statistics.h"

namespace batten {
namespace {

constexpr int kPlaneNeighbours = 24;
constexpr int kReachNeighbour = 6;
constexpr double kAgrees = 3;         // a trusted point's offset in deviations of its neighbours
constexpr double kUsualScales = 2.5;  // a trusted place's deviation from its plane, …
constexpr double kFlat = 0.1;         // … or this share of its neighbours' reach
constexpr double kSparser = 2;        // than the points around it, or than the nearest surface
constexpr double kExact = 0.03;       // of the reach: less deviation is none
constexpr int kQuadricNeighbours = 30;
constexpr int kOthers[] = {
    3, 6, 10, 15, 21};              // of the nearest points, whose surroundings are asked
constexpr double kOff = 4.5;        // deviations that make an outlier
constexpr double kResolved = 0.06;  // of the reach: less is no deviation
constexpr int kCompanions = 2;      // trusted ones among the nearest
constexpr double kAway = 2.5;       // reaches from the nearest trusted point
constexpr double kLonelier = 3;
constexpr double kFillsSpace = 0.2;
constexpr double kMostLeverage = 4;  // beyond, a quadric says nothing of the place

// How every point stands to its neighbours.
struct Standing {
  Eigen::VectorXd offset;   // off the plane of its neighbours
  Eigen::VectorXd scale;    // of the neighbours' own deviations from that plane
  Eigen::VectorXd reach;    // distance of its sixth neighbour
  Eigen::VectorXi nearest;  // another point, the nearest or nearly so
};

Standing MeasureStanding(const Eigen::Matrix3Xd& points,
                         const NeighbourIndex& index,
                         ThreadPool& pool,
                         const Progress& progress) {
  const Eigen::Index m = points.cols();
  const int k = static_cast<int>(std::min<Eigen::Index>(kPlaneNeighbours + 1, m));
  Standing standing{Eigen::VectorXd(m), Eigen::VectorXd(m), Eigen::VectorXd(m), Eigen::VectorXi(m)};
  constexpr std::ptrdiff_t kChunk = 1 << 16;
  for (Eigen::Index start = 0; start < m; start += kChunk) {
    const Eigen::Index count = std::min<Eigen::Index>(kChunk, m - start);
    pool.For(count, 512, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      const std::vector<int> near = index.Nearest(points.middleCols(start + begin, end - begin), k);
      Eigen::Matrix3Xd local(3, k - 1);
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        const Eigen::Index point = start + i;
        const int* row = near.data() + (i - begin) * k;
        Eigen::Index others = 0;  // the point itself stays out of its own plane
        for (int j = 0; j < k && others < k - 1; ++j) {
          if (row[j] != point) local.col(others++) = points.col(row[j]) - points.col(point);
        }
        const AgreedPlane agreed = PlaneMostAgreeOn(local);
        standing.offset[point] = std::abs(agreed.plane.centre.dot(agreed.plane.normal));
        standing.scale[point] = agreed.scale;
        standing.nearest[point] = row[row[0] == point ? 1 : 0];
        standing.reach[point] = (points.col(row[kReachNeighbour]) - points.col(point)).norm();
      }
    });
    Report(progress,
           "prepare",
           0.3 + 0.6 * static_cast<double>(start + count) / static_cast<double>(m));
  }
  return standing;
}

double MedianOf(const Eigen::VectorXd& values) {
  return Median(std::vector<double>(values.begin(), values.end()));
}

// Judges doubted points by the trusted ones.
class Tribunal {
 public:
  Tribunal(const Eigen::Matrix3Xd& points,
           const NeighbourIndex& index,
           const Standing& standing,
           double noise,
           double rounding)
      : points_(points), index_(index), standing_(standing), noise_(std::max(noise, rounding)) {
    const double typical = std::max(MedianOf(standing.scale), rounding);
    const double usual_reach = MedianOf(standing.reach);
    usual_scale_ = kUsualScales * typical;
    trusted_ = PointMask::Constant(points.cols(), false);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const double scale = standing.scale[i], reach = standing.reach[standing.nearest[i]];
      const double least = std::max(typical, kExact * std::min(reach, kLonelier * usual_reach));
      trusted_[i] = scale <= kUsualScales * least &&
                    standing.offset[i] <= kAgrees * std::max(least, scale) &&
                    standing.reach[i] <= kSparser * standing.reach[standing.nearest[i]];
    }
  }

  PointMask Outliers(ThreadPool& pool) {
    const double usual_reach = MedianOf(standing_.reach);
    TrustCurvedPlaces(pool);
    std::vector<Eigen::Index> doubted;
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      if (!trusted_[i] || standing_.reach[i] > kLonelier * usual_reach) doubted.push_back(i);
    }
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      if (trusted_[i]) trusted_list_.push_back(i);
    }
    PointMask outliers = PointMask::Constant(points_.cols(), false);
    if (std::ssize(trusted_list_) <= kQuadricNeighbours || doubted.empty()) return outliers;
    // Doubted points deep among their like find trusted ones in an index of these.
    trusted_index_.emplace(points_(Eigen::all, trusted_list_));
    std::vector<char> off(doubted.size());
    pool.For(std::ssize(doubted), 64, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        off[i] =
            static_cast<char>(Judge(doubted[i], TrustedNear(points_.col(doubted[i]), doubted[i])));
      }
    });
    for (size_t i = 0; i < doubted.size(); ++i) outliers[doubted[i]] = off[i] != 0;
    // Several off together, as dense as the surface, are structure.
    PointMask kept = outliers;
    pool.For(std::ssize(doubted), 64, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        if (off[i] == kOffSurface && InCompany(doubted[i], outliers)) kept[doubted[i]] = false;
      }
    });
    return kept;
  }

 private:
  enum Verdict { kGood, kOffSurface, kAlone };

  // Where a surface bends much within a few spacings, its points agree with quadrics. So do, by
  // chance, some of the points scattered far from it: trust spreads from neighbour to neighbour.
  void TrustCurvedPlaces(ThreadPool& pool) {
    std::vector<Eigen::Index> doubted;
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      if (!trusted_[i]) doubted.push_back(i);
    }
    std::vector<char> agrees(doubted.size());
    std::vector<int> near(doubted.size() * kReachNeighbour);
    pool.For(std::ssize(doubted), 64, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        agrees[i] = AgreesWithOwnQuadric(doubted[i], near.data() + i * kReachNeighbour);
      }
    });
    for (bool grown = true; grown;) {
      grown = false;
      for (size_t i = 0; i < doubted.size(); ++i) {
        if (!agrees[i] || trusted_[doubted[i]]) continue;
        const int* row = near.data() + i * kReachNeighbour;
        const auto companions = std::count_if(row, row + kReachNeighbour, [&](int j) {
          return trusted_[j] && standing_.reach[doubted[i]] <= kSparser * standing_.reach[j];
        });
        if (companions < kCompanions) continue;
        trusted_[doubted[i]] = true;
        grown = true;
      }
    }
  }

  bool AgreesWithOwnQuadric(Eigen::Index point, int* nearest) const {
    const Eigen::Vector3d p = points_.col(point);
    std::vector<int> near = index_.Nearest(p, kPlaneNeighbours + 1);
    near.erase(std::remove(near.begin(), near.end(), static_cast<int>(point)), near.end());
    std::copy_n(near.begin(), kReachNeighbour, nearest);
    const double reach = standing_.reach[near[0]];
    if (standing_.reach[point] > kSparser * reach) return false;
    const LocalQuadric quadric = LocalQuadric::MostAgreeOn(Around(p, near));
    const double scale = quadric.scale_of_most();
    if (scale > std::max(usual_scale_, kFlat * reach)) return false;
    return std::abs(quadric.Offset(Eigen::Vector3d::Zero())) <=
           kAgrees * std::max({noise_, kFlat / 2 * reach, scale}) *
               std::sqrt(1 + quadric.Leverage(Eigen::Vector3d::Zero()));
  }

  // Points relative to a place.
  Eigen::Matrix3Xd Around(const Eigen::Vector3d& place, const std::vector<int>& chosen) const {
    Eigen::Matrix3Xd local(3, static_cast<Eigen::Index>(chosen.size()));
    for (Eigen::Index j = 0; j < local.cols(); ++j) local.col(j) = points_.col(chosen[j]) - place;
    return local;
  }

  // `near` are the trusted points nearest to a point, and `index` holds these.
  Verdict Judge(Eigen::Index point, const std::vector<int>& near) const {
    const Eigen::Vector3d p = points_.col(point);
    std::vector<double> reaches;
    for (int j = 0; j < kReachNeighbour; ++j) reaches.push_back(standing_.reach[near[j]]);
    const double reach = Median(std::move(reaches)), own = standing_.reach[point];
    const double away = (points_.col(near[0]) - p).norm();
    if (own > kLonelier * reach) return kAlone;
    if (away > kAway * reach) return own > kSparser * reach ? kAlone : kOffSurface;
    if (trusted_[point]) return kGood;
    // Beside an edge it belongs to the neighbourhood of some point farther away.
    bool judged = false;
    for (const int other : kOthers) {
      const LocalQuadric quadric =
          LocalQuadric::MostAgreeOn(Around(p, NearestOthers(points_.col(near[other]), point)));
      const double leverage = quadric.Leverage(Eigen::Vector3d::Zero());
      if (leverage > kMostLeverage) continue;
      judged = true;
      const double deviation = std::max({noise_, kResolved * reach, quadric.robust_scale()});
      if (std::abs(quadric.Offset(Eigen::Vector3d::Zero())) <=
          kOff * deviation * std::sqrt(1 + leverage)) {
        return kGood;
      }
    }
    return judged ? kOffSurface : kGood;
  }

  // The points nearest to a place, without one of them.
  std::vector<int> NearestOthers(const Eigen::Vector3d& place, Eigen::Index without) const {
    std::vector<int> near = index_.Nearest(place, kQuadricNeighbours + 1);
    near.erase(std::remove(near.begin(), near.end(), static_cast<int>(without)), near.end());
    return near;
  }

  // The trusted points nearest to a place, without one of them.
  std::vector<int> TrustedNear(const Eigen::Vector3d& place, Eigen::Index without) const {
    std::vector<int> near = trusted_index_->Nearest(place, kQuadricNeighbours + 1);
    for (int& j : near) j = static_cast<int>(trusted_list_[j]);
    near.erase(std::remove(near.begin(), near.end(), without), near.end());
    if (std::ssize(near) > kQuadricNeighbours) near.pop_back();
    return near;
  }

  // Whether most of the points nearest to a point that is off are off too, and form something
  // thinner than space.
  bool InCompany(Eigen::Index point, const PointMask& outliers) const {
    if (standing_.scale[point] > kFillsSpace * standing_.reach[point]) return false;
    const std::vector<int> near = index_.Nearest(points_.col(point), kReachNeighbour + 1);
    return std::count_if(near.begin(), near.end(), [&](int j) {
             return j != point && outliers[j];
           }) > kReachNeighbour / 2;
  }

  const Eigen::Matrix3Xd& points_;
  const NeighbourIndex& index_;
  const Standing& standing_;
  double noise_;
  double usual_scale_;
  PointMask trusted_;
  std::vector<Eigen::Index> trusted_list_;
  std::optional<NeighbourIndex> trusted_index_;
};

}  // namespace

PointMask FindOutliers(const Eigen::Matrix3Xd& points,
                       const NeighbourIndex& index,
                       double spacing,
                       double noise,
                       ThreadPool& pool,
                       const Progress& progress) {
  const Standing standing = MeasureStanding(points, index, pool, progress);
  // Exact data: deviations are rounding or curvature.
  return Tribunal(points, index, standing, noise, 1e-9 * spacing).Outliers(pool);
}

}  // namespace batten
