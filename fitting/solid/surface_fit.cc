// SPDX-License-Identifier: MIT
#include "fitting/solid/surface_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>

#include "fitting/core/stopwatch.h"
#include "fitting/solid/surface_system.h"

namespace batten::internal {
namespace {

// Of the tangential distance against the normal one. It begins where alternation of feet and
// control points is stable and ends where Gauss-Newton steps are hardly damped any more. Measured
// on a known surface of 520 control points: ends of 1e-4 and 1e-2 give the same truth error.
constexpr double kFirstDamping = 0.1, kLeastDamping = 0.01, kMostDamping = 10;
constexpr double kStillFalls = 1e-3;  // relative fall of the sum of squares in two rounds

// Of the control mesh, from the faces around.
Eigen::Matrix3Xd VertexNormals(const QuadTopology& mesh, const Eigen::Matrix3Xd& points) {
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, points.cols());
  for (int face = 0; face < mesh.faces(); ++face) {
    const auto corner = mesh.corners().col(face);
    const Eigen::Vector3d one = points.col(corner[2]) - points.col(corner[0]);
    const Eigen::Vector3d two = points.col(corner[3]) - points.col(corner[1]);
    for (int k = 0; k < 4; ++k) normals.col(corner[k]) += one.cross(two);
  }
  for (int v = 0; v < points.cols(); ++v) normals.col(v).stableNormalize();
  return normals;
}

// Patches that turn over, or nearly, from one sample to the next.
std::vector<int> FoldedPatches(const LimitSurface& surface, int patches, ThreadPool& pool) {
  constexpr std::array kPlaces = {0.02, 0.3, 0.65, 0.98};
  constexpr auto kCount = int(kPlaces.size());
  constexpr double kLeast = 0.1;  // cosine: sound patches turn by less from sample to sample
  std::vector<char> folded(std::size_t(patches), 0);
  pool.For(patches, 64, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t patch = begin; patch < end; ++patch) {
      std::array<Eigen::Vector3d, kCount * kCount> normals;
      for (int i = 0; i < kCount; ++i) {
        for (int j = 0; j < kCount; ++j) {
          const SurfaceJet jet = surface.JetAt({static_cast<int>(patch), kPlaces[i], kPlaces[j]});
          normals[i * kCount + j] = jet.du.cross(jet.dv).stableNormalized();
          const bool bad =
              (i > 0 && normals[i * kCount + j].dot(normals[(i - 1) * kCount + j]) < kLeast) ||
              (j > 0 && normals[i * kCount + j].dot(normals[i * kCount + j - 1]) < kLeast);
          if (bad) folded[std::size_t(patch)] = 1;
        }
      }
    }
  });
  std::vector<int> found;
  for (int patch = 0; patch < patches; ++patch) {
    if (folded[std::size_t(patch)]) found.push_back(patch);
  }
  return found;
}

// Every tenth point is left out while smoothing is chosen.
bool LeftOut(std::size_t k) {
  constexpr std::uint64_t kSpread = 0x9E3779B97F4A7C15;
  return ((k + 1) * kSpread >> 32) % 10 == 0;
}

class Fitter {
 public:
  Fitter(const LimitStencils& stencils,
         const Eigen::Matrix3Xd& start,
         const SurfaceData& data,
         const SurfaceFitSettings& settings,
         ThreadPool& pool)
      : stencils_(stencils), data_(data), settings_(settings), pool_(pool), system_(stencils) {
    fit_.control_points = start;
    if (!data_.oriented) Orient();
  }

  // From stiff to soft, for as long as points left out are met better.
  LimitSurfaceFit Fit() && {
    if (settings_.smoothing) {
      fit_.smoothing = *settings_.smoothing;
      Rounds(settings_.max_iterations, false);
      return std::move(fit_);
    }
    constexpr double kStiffest = 1, kStep = 0.1, kSoftest = 1e-6;
    constexpr int kRounds = 5, kLastRounds = 12;
    constexpr double kChance = 1;     // standard errors
    constexpr std::size_t kIdle = 2;  // softer levels without a gain before the end
    struct Level {
      double smoothing, mean;
      Eigen::VectorXd squares;  // of the points left out
      Eigen::Matrix3Xd control_points;
    };
    // How much worse one level is than another, in standard errors of the difference point by
    // point.
    const auto worse = [](const Level& one, const Level& other) {
      const Eigen::ArrayXd difference = (one.squares - other.squares).array();
      const double mean = difference.mean();
      const double variance = (difference - mean).square().mean() / double(difference.size());
      return mean / std::sqrt(std::max(variance, std::numeric_limits<double>::min()));
    };
    std::vector<Level> levels;
    std::size_t best = 0;
    for (double smoothing = kStiffest; smoothing >= kSoftest; smoothing *= kStep) {
      fit_.smoothing = smoothing;
      Rounds(kRounds, true);
      const Eigen::VectorXd squares = SquaresLeftOut();
      levels.push_back({smoothing, squares.mean(), squares, fit_.control_points});
      if (levels.back().mean < levels[best].mean) best = levels.size() - 1;
      if (worse(levels.back(), levels[best]) > kChance || levels.size() > best + kIdle) break;
    }
    // The stiffest that is as good as the best but for chance.
    const auto chosen = std::find_if(levels.begin(), levels.end(), [&](const Level& level) {
      return worse(level, levels[best]) <= kChance;
    });
    fit_.smoothing = chosen->smoothing;
    fit_.control_points = chosen->control_points;
    fit_.held_out = chosen->squares;
    Rounds(kLastRounds, false);
    return std::move(fit_);
  }

 private:
  // Gives normals without a sign that of the surface the fit begins from; where they contradict it,
  // as estimates at thin ridges do, its own normal.
  void Orient() {
    const std::vector<LimitFoot> feet = FeetOn(
        {LimitSurface(stencils_, fit_.control_points), stencils_.patches(), settings_.left_out},
        data_.points,
        Eigen::Matrix3Xd(3, 0),
        false,
        {},
        pool_);
    for (std::size_t k = 0; k < feet.size(); ++k) {
      auto normal = data_.normals.col(Eigen::Index(k));
      const double cosine = normal.dot(feet[k].normal);
      if (std::abs(cosine) < kLeastCosine) {
        normal = feet[k].normal;
      } else if (cosine < 0) {
        normal = -normal;
      }
    }
    data_.oriented = true;
  }

  bool Counts(std::size_t k, bool some) const {
    return data_.weights[Eigen::Index(k)] > 0 && !(some && LeftOut(k));
  }

  // Over the points that count or, if `left_out`, over those left out.
  double MeanSquare(const std::vector<LimitFoot>& feet, bool left_out) const {
    double sum = 0, weight = 0;
    for (std::size_t k = 0; k < feet.size(); ++k) {
      const auto i = Eigen::Index(k);
      if (!feet[k].found || !(data_.weights[i] > 0) || LeftOut(k) != left_out) continue;
      sum += data_.weights[i] * (feet[k].point - data_.points.col(i)).squaredNorm();
      weight += data_.weights[i];
    }
    return weight > 0 ? sum / weight : 0;
  }

  // Weighted squares of the points left out.
  Eigen::VectorXd SquaresLeftOut() const {
    std::vector<double> squares;
    for (std::size_t k = 0; k < fit_.feet.size(); ++k) {
      const auto i = Eigen::Index(k);
      if (!(data_.weights[i] > 0) || !LeftOut(k)) continue;
      const LimitFoot& foot = fit_.feet[k];
      squares.push_back(data_.weights[i] * (foot.point - data_.points.col(i)).squaredNorm());
    }
    if (squares.empty()) squares.push_back(0);
    return Eigen::Map<const Eigen::VectorXd>(squares.data(), Eigen::Index(squares.size()));
  }

  std::vector<SurfaceDemand> Demands(bool some) const {
    std::vector<SurfaceDemand> demands;
    for (std::size_t k = 0; k < fit_.feet.size(); ++k) {
      const LimitFoot& foot = fit_.feet[k];
      const auto i = Eigen::Index(k);
      if (!foot.found || !Counts(k, some)) continue;
      demands.push_back({foot.place,
                         data_.points.col(i),
                         foot.on_crease,
                         foot.on_crease ? foot.tangent : foot.normal,
                         data_.weights[i]});
    }
    return demands;
  }

  std::vector<LimitFoot> Feet(const Eigen::Matrix3Xd& points,
                              const std::vector<LimitFoot>& from) const {
    return FeetOn({LimitSurface(stencils_, points), stencils_.patches(), settings_.left_out},
                  data_.points,
                  data_.normals,
                  data_.oriented,
                  from,
                  pool_);
  }

  // Steps at one smoothing; `some`: without the points left out.
  void Rounds(int count, bool some) {
    constexpr int kRefuse = 4;  // failed steps in a row
    fit_.feet = Feet(fit_.control_points, {});
    folded_ =
        FoldedPatches(LimitSurface(stencils_, fit_.control_points), stencils_.patches(), pool_);
    double damping = kFirstDamping;
    int failed = 0;
    for (int round = 0; round < count; ++round) {
      Report(settings_.progress, "fit", double(round) / count);
      const std::vector<SurfaceDemand> demands = Demands(some);
      system_.Assemble(demands,
                       damping,
                       fit_.control_points,
                       VertexNormals(stencils_.mesh(), fit_.control_points),
                       {fit_.smoothing, std::max(fit_.smoothing, settings_.stretch)});
      const double cost = Cost(fit_.feet, fit_.control_points, some);
      Eigen::Matrix3Xd step = system_.Step(fit_.control_points);
      constexpr int kHalvings = 3;
      bool taken = false;
      double its = 0;
      Eigen::Matrix3Xd tried;
      std::vector<LimitFoot> feet;
      for (int halving = 0; halving < kHalvings && !taken; ++halving, step /= 2) {
        if (!Unfolded(step)) continue;
        tried = fit_.control_points + step;
        feet = Feet(tried, round == 0 ? std::vector<LimitFoot>() : fit_.feet);
        its = Cost(feet, tried, some);
        taken = its <= cost;
      }
      if (!taken) {
        damping = std::min(kMostDamping, damping * 5);
        if (++failed >= kRefuse) break;
        continue;
      }
      failed = 0;
      const bool settled = its > cost * (1 - kStillFalls);
      fit_.control_points = tried;
      folded_ = unfolded_;
      fit_.feet = std::move(feet);
      fit_.rounds.push_back({.stage = "joint",
                             .control_points_u = static_cast<int>(tried.cols()),
                             .control_points_v = 1,
                             .rms = std::sqrt(MeanSquare(fit_.feet, false)),
                             .max = 0,
                             .score = fit_.smoothing,
                             .seconds = watch_.Lap()});
      damping = std::max(kLeastDamping, damping * 0.4);
      if (settled) break;
    }
  }

  // Shortens the step where patches would fold, until none does that did not before; false where
  // that does not help.
  bool Unfolded(Eigen::Matrix3Xd& step) {
    constexpr int kTries = 5;
    const auto folded_at = [&](const Eigen::Matrix3Xd& points) {
      return FoldedPatches(LimitSurface(stencils_, points), stencils_.patches(), pool_);
    };
    const std::vector<int>& before = folded_;
    for (int round = 0; round < kTries; ++round) {
      std::vector<int> fresh;
      const std::vector<int> after = folded_at(fit_.control_points + step);
      std::set_difference(
          after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(fresh));
      if (fresh.empty()) {
        unfolded_ = after;
        return true;
      }
      std::vector<bool> shortened(std::size_t(step.cols()), false);
      for (const int patch : fresh) {
        for (const int vertex : stencils_.Support(patch)) shortened[std::size_t(vertex)] = true;
      }
      constexpr double kShorter = 0.4;
      for (Eigen::Index v = 0; v < step.cols(); ++v) {
        if (shortened[std::size_t(v)]) step.col(v) *= kShorter;
      }
    }
    return false;
  }

  // A point that finds no foot costs as the mean of the others: steps are not taken to lose points.
  double Cost(const std::vector<LimitFoot>& feet, const Eigen::Matrix3Xd& points, bool some) const {
    double sum = 0, weight = 0, all = 0;
    for (std::size_t k = 0; k < feet.size(); ++k) {
      if (!Counts(k, some)) continue;
      const auto i = Eigen::Index(k);
      all += data_.weights[i];
      if (!feet[k].found) continue;
      sum += data_.weights[i] * (feet[k].point - data_.points.col(i)).squaredNorm();
      weight += data_.weights[i];
    }
    return (weight > 0 ? sum * all / weight : 0) + system_.Energy(points);
  }

  const LimitStencils& stencils_;
  SurfaceData data_;
  const SurfaceFitSettings& settings_;
  ThreadPool& pool_;
  SurfaceSystem system_;
  LimitSurfaceFit fit_;
  std::vector<int> folded_, unfolded_;  // patches: of the control points, of the step tried last
  Stopwatch watch_;
};

}  // namespace

LimitSurfaceFit FitLimitSurface(const LimitStencils& stencils,
                                const Eigen::Matrix3Xd& start,
                                const SurfaceData& data,
                                const SurfaceFitSettings& settings,
                                ThreadPool& pool) {
  return Fitter(stencils, start, data, settings, pool).Fit();
}

Eigen::Matrix3Xd ControlPointsThrough(const QuadTopology& mesh, const Eigen::Matrix3Xd& vertices) {
  Eigen::Matrix3Xd points = vertices;
  // Limit positions weigh their own control point by 4/9 or more, so this contracts; more rounds
  // would follow the layout's noise.
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3Xd limits(3, points.cols());
    for (int v = 0; v < mesh.vertices(); ++v) {
      const int n = mesh.Valence(v);
      int h = mesh.Outgoing(v);
      if (mesh.Creases(v) > 0) {
        limits.col(v) = points.col(v);
        if (mesh.IsCorner(v)) continue;
        limits.col(v) *= 2.0 / 3;
        for (int k = 0; k < n; ++k, h = mesh.Turned(h)) {
          if (mesh.IsCrease(h)) limits.col(v) += points.col(mesh.Origin(QuadTopology::Next(h))) / 6;
        }
        continue;
      }
      Eigen::Vector3d limit = points.col(v) * n / (n + 5.0);
      for (int k = 0; k < n; ++k, h = mesh.Turned(h)) {
        const int next = QuadTopology::Next(h);
        limit += (4 * points.col(mesh.Origin(next)) +
                  points.col(mesh.Origin(QuadTopology::Next(next)))) /
                 (n * (n + 5.0));
      }
      limits.col(v) = limit;
    }
    points += vertices - limits;
  }
  return points;
}

}  // namespace batten::internal
