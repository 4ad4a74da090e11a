// SPDX-License-Identifier: MIT
#include "fitting/solid/surface_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "fitting/core/stopwatch.h"
#include "fitting/solid/patch_folds.h"
#include "fitting/solid/surface_system.h"

namespace batten::internal {
namespace {

// Of the tangential distance against the normal one. It begins where alternation of feet and
// control points is stable and ends where Gauss-Newton steps are hardly damped any more. Measured
// on a known surface of 520 control points: ends of 1e-4 and 1e-2 give the same truth error.
constexpr double kFirstDamping = 0.1, kLeastDamping = 0.01, kMostDamping = 10;
constexpr double kStillFalls = 1e-3;  // relative fall of the sum of squares in two rounds
constexpr double kChance = 1;         // standard errors

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

// `some`: without those left out.
bool Counts(const SurfaceData& data, std::size_t k, bool some) {
  return data.weights[Eigen::Index(k)] > 0 && !(some && data.left_out[Eigen::Index(k)]);
}

double SquareOf(const SurfaceData& data, std::size_t k, const LimitFoot& foot) {
  const auto i = Eigen::Index(k);
  return data.weights[i] * (foot.point - data.points.col(i)).squaredNorm();
}

// Over the points that are not left out.
double MeanSquare(const SurfaceData& data, const std::vector<LimitFoot>& feet) {
  double sum = 0, weight = 0;
  for (std::size_t k = 0; k < feet.size(); ++k) {
    if (!feet[k].found || !Counts(data, k, true)) continue;
    sum += SquareOf(data, k, feet[k]);
    weight += data.weights[Eigen::Index(k)];
  }
  return weight > 0 ? sum / weight : 0;
}

// The sum of squares. A point that finds no foot costs as the mean of the others: steps are not
// taken to lose points.
double Misfit(const SurfaceData& data, const std::vector<LimitFoot>& feet, bool some) {
  double sum = 0, weight = 0, all = 0;
  for (std::size_t k = 0; k < feet.size(); ++k) {
    if (!Counts(data, k, some)) continue;
    all += data.weights[Eigen::Index(k)];
    if (!feet[k].found) continue;
    sum += SquareOf(data, k, feet[k]);
    weight += data.weights[Eigen::Index(k)];
  }
  return weight > 0 ? sum * all / weight : 0;
}

// Weighted squares of the points left out.
Eigen::VectorXd SquaresLeftOut(const SurfaceData& data, const std::vector<LimitFoot>& feet) {
  std::vector<double> squares;
  for (std::size_t k = 0; k < feet.size(); ++k) {
    if (Counts(data, k, false) && data.left_out[Eigen::Index(k)])
      squares.push_back(SquareOf(data, k, feet[k]));
  }
  if (squares.empty()) squares.push_back(0);
  return Eigen::Map<const Eigen::VectorXd>(squares.data(), Eigen::Index(squares.size()));
}

std::vector<SurfaceDemand> Demands(const SurfaceData& data,
                                   const std::vector<LimitFoot>& feet,
                                   bool some) {
  std::vector<SurfaceDemand> demands;
  for (std::size_t k = 0; k < feet.size(); ++k) {
    const LimitFoot& foot = feet[k];
    const auto i = Eigen::Index(k);
    if (!foot.found || !Counts(data, k, some)) continue;
    demands.push_back({foot.place,
                       data.points.col(i),
                       foot.on_crease,
                       foot.on_crease ? foot.tangent : foot.normal,
                       data.weights[i]});
  }
  return demands;
}

// Gives normals without a sign that of the surface; where they contradict it, as estimates at thin
// ridges do, its own normal.
void Orient(const FootGround& ground, SurfaceData& data, ThreadPool& pool) {
  const std::vector<LimitFoot> feet =
      FeetOn(ground, data.points, Eigen::Matrix3Xd(3, 0), false, {}, pool);
  for (std::size_t k = 0; k < feet.size(); ++k) {
    auto normal = data.normals.col(Eigen::Index(k));
    const double cosine = normal.dot(feet[k].normal);
    if (std::abs(cosine) < kLeastCosine) {
      normal = feet[k].normal;
    } else if (cosine < 0) {
      normal = -normal;
    }
  }
  data.oriented = true;
}

// Gauss-Newton steps towards points. Keeps references.
class Descent {
 public:
  Descent(const LimitStencils& stencils,
          const SurfaceData& data,
          const SurfaceFitSettings& settings,
          ThreadPool& pool)
      : stencils_(stencils),
        data_(data),
        settings_(settings),
        pool_(pool),
        system_(stencils, settings.moves, pool) {
    for (int patch = 0; patch < stencils.patches(); ++patch) {
      const auto support = stencils.Support(patch);
      if (std::any_of(support.begin(), support.end(), [&](int v) { return settings.Moves(v); })) {
        patches_.push_back(patch);
      }
    }
  }

  // Steps from the fit's control points at its smoothing; `some`: without the points left out.
  void Run(int count, bool some, LimitSurfaceFit& fit) {
    constexpr int kRefuse = 4;  // failed steps in a row
    fit.feet = Feet(fit.control_points, {});
    std::vector<int> folded = FoldedPatches(stencils_, patches_, fit.control_points, pool_);
    double damping = kFirstDamping;
    int failed = 0;
    for (int round = 0; round < count; ++round) {
      Report(settings_.progress, "fit", double(round) / count);
      system_.Assemble(Demands(data_, fit.feet, some),
                       damping,
                       fit.control_points,
                       VertexNormals(stencils_.mesh(), fit.control_points),
                       {fit.smoothing, std::max(fit.smoothing, settings_.stretch)});
      const double cost = Cost(fit.feet, fit.control_points, some);
      auto tried = Tried(fit,
                         folded,
                         round == 0 ? std::vector<LimitFoot>() : fit.feet,
                         system_.Step(fit.control_points),
                         cost,
                         some);
      if (!tried) {
        damping = std::min(kMostDamping, damping * 5);
        if (++failed >= kRefuse) break;
        continue;
      }
      failed = 0;
      const bool settled = tried->cost > cost * (1 - kStillFalls);
      fit.control_points = std::move(tried->control_points);
      fit.feet = std::move(tried->feet);
      folded = std::move(tried->folded);
      fit.rounds.push_back({.stage = "joint",
                            .control_points_u = static_cast<int>(fit.control_points.cols()),
                            .control_points_v = 1,
                            .rms = std::sqrt(MeanSquare(data_, fit.feet)),
                            .max = 0,
                            .score = fit.smoothing,
                            .seconds = watch_.Lap()});
      damping = std::max(kLeastDamping, damping * 0.4);
      if (settled) break;
    }
  }

 private:
  struct Place {
    Eigen::Matrix3Xd control_points;
    std::vector<LimitFoot> feet;
    std::vector<int> folded;  // patches
    double cost = 0;
  };

  std::vector<LimitFoot> Feet(const Eigen::Matrix3Xd& points,
                              const std::vector<LimitFoot>& from) const {
    return FeetOn({LimitSurface(stencils_, points), stencils_.patches(), settings_.left_out},
                  data_.points,
                  data_.normals,
                  data_.oriented,
                  from,
                  pool_);
  }

  double Cost(const std::vector<LimitFoot>& feet, const Eigen::Matrix3Xd& points, bool some) const {
    return Misfit(data_, feet, some) + system_.Energy(points);
  }

  // Where the step leads, or a part of it, without folds and at no greater cost; none where it
  // does not.
  std::optional<Place> Tried(const LimitSurfaceFit& fit,
                             const std::vector<int>& folded,
                             const std::vector<LimitFoot>& from,
                             Eigen::Matrix3Xd step,
                             double most,
                             bool some) const {
    constexpr int kHalvings = 3;
    for (int halving = 0; halving < kHalvings; ++halving, step /= 2) {
      auto after = Unfold(stencils_, patches_, fit.control_points, folded, step, pool_);
      if (!after) continue;
      Place place{fit.control_points + step, {}, std::move(*after)};
      place.feet = Feet(place.control_points, from);
      place.cost = Cost(place.feet, place.control_points, some);
      if (place.cost <= most) return place;
    }
    return std::nullopt;
  }

  const LimitStencils& stencils_;
  const SurfaceData& data_;
  const SurfaceFitSettings& settings_;
  ThreadPool& pool_;
  SurfaceSystem system_;
  std::vector<int> patches_;  // that move
  Stopwatch watch_;
};

// A surface fitted without the points left out.
struct Level {
  double smoothing, mean;
  Eigen::VectorXd squares;  // of the points left out
  Eigen::Matrix3Xd control_points;
};

// From stiff to soft, for as long as points left out are met better.
Level ChooseSmoothing(const SurfaceData& data, Descent& descent, LimitSurfaceFit& fit) {
  constexpr double kStiffest = 1;  // from softer ones steps end in poorer places
  constexpr double kStep = 0.1, kSoftest = 1e-6;
  constexpr int kRounds = 5;
  constexpr std::size_t kIdle = 2;  // softer levels without a gain before the end
  std::vector<Level> levels;
  std::size_t best = 0;
  for (double smoothing = kStiffest; smoothing >= kSoftest; smoothing *= kStep) {
    fit.smoothing = smoothing;
    descent.Run(kRounds, true, fit);
    const Eigen::VectorXd squares = SquaresLeftOut(data, fit.feet);
    levels.push_back({smoothing, squares.mean(), squares, fit.control_points});
    if (levels.back().mean < levels[best].mean) best = levels.size() - 1;
    if (Worse(levels.back().squares, levels[best].squares) > kChance ||
        levels.size() > best + kIdle)
      break;
  }
  // The stiffest that is as good as the best but for chance.
  return *std::find_if(levels.begin(), levels.end(), [&](const Level& level) {
    return Worse(level.squares, levels[best].squares) <= kChance;
  });
}

// The last steps towards all points, at the smoothing of a level and from where it led.
void FitAll(const Level& level,
            const SurfaceFitSettings& settings,
            Descent& descent,
            LimitSurfaceFit& fit) {
  for (Eigen::Index v = 0; v < fit.control_points.cols(); ++v) {
    if (settings.Moves(v)) fit.control_points.col(v) = level.control_points.col(v);
  }
  fit.smoothing = level.smoothing;
  fit.without = level.control_points;
  fit.held_out = level.squares;
  constexpr int kLastRounds = 12;
  descent.Run(kLastRounds, false, fit);
}

}  // namespace

PointMask EveryTenth(Eigen::Index points) {
  return PointMask::NullaryExpr(points, [](Eigen::Index k) {  // spread by the golden ratio, 64 bits
    return ((std::uint64_t(k) + 1) * 0x9E3779B97F4A7C15 >> 32) % 10 == 0;
  });
}

double Worse(const Eigen::VectorXd& one, const Eigen::VectorXd& other) {
  const Eigen::ArrayXd difference = (one - other).array();
  const double mean = difference.mean();
  const double variance = (difference - mean).square().mean() / double(difference.size());
  return mean / std::sqrt(std::max(variance, std::numeric_limits<double>::min()));
}

LimitSurfaceFit FitLimitSurface(const LimitStencils& stencils,
                                const Eigen::Matrix3Xd& start,
                                const SurfaceData& data,
                                const SurfaceFitSettings& settings,
                                ThreadPool& pool) {
  LimitSurfaceFit fit;
  fit.control_points = start;
  SurfaceData oriented = data;
  Descent descent(stencils, oriented, settings, pool);
  if (!data.oriented) {
    Orient({LimitSurface(stencils, start), stencils.patches(), settings.left_out}, oriented, pool);
  }
  if (settings.smoothing) {
    fit.smoothing = *settings.smoothing;
    descent.Run(settings.max_iterations, false, fit);
    return fit;
  }
  FitAll(ChooseSmoothing(oriented, descent, fit), settings, descent, fit);
  return fit;
}

std::optional<LimitSurfaceFit> FitFiner(const LimitStencils& stencils,
                                        const LimitSurfaceFit& coarse,
                                        const SurfaceData& data,
                                        const SurfaceFitSettings& settings,
                                        ThreadPool& pool) {
  LimitSurfaceFit fit;
  fit.control_points = coarse.without;
  SurfaceData oriented = data;
  const LimitSurface start(stencils, coarse.without);
  const FootGround ground{start, stencils.patches(), settings.left_out};
  if (!data.oriented) Orient(ground, oriented, pool);
  const Eigen::VectorXd before =
      SquaresLeftOut(oriented, FeetOn(ground, data.points, oriented.normals, true, {}, pool));
  Descent descent(stencils, oriented, settings, pool);
  const Level level = ChooseSmoothing(oriented, descent, fit);
  if (!(Worse(before, level.squares) > kChance)) return std::nullopt;
  fit.control_points = coarse.control_points;
  FitAll(level, settings, descent, fit);
  return fit;
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
