// SPDX-License-Identifier: MIT
#include "fitting/surface/given_parameters.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/refused_data.h"
#include "batten/fitting/solve_linear.h"
#include "batten/fitting/trim_to_points.h"
#include "batten/geometry/knot_vectors.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr double kLineSquared = 1e-13;  // share of the spread across a line: rounding of the sums
constexpr int kScalingDegree = 3, kScalingSpans = 2;
constexpr double kFlattest = 1e-3;  // ratio of lengths beyond which scaling gives up

// The range of the parameters of one direction.
struct Side {
  double low = 0, high = 0;

  // From the user's parameter to [0, 1]; both ends are met exactly.
  double Inside(double parameter) const {
    return std::clamp((parameter - low) / (high - low), 0.0, 1.0);
  }
};

Side RangeOf(const Eigen::RowVectorXd& parameters, const char* name) {
  const Side side{parameters.minCoeff(), parameters.maxCoeff()};
  if (!(side.high > side.low)) {
    throw RefusedData(std::string("the given parameters ") + name +
                      " are all equal: a surface needs columns u and v");
  }
  // Room for knots between them.
  if (!(side.high - side.low >
        kRelativeRounding * std::max(std::abs(side.low), std::abs(side.high)))) {
    throw RefusedData(std::string("the given parameters ") + name +
                      " hardly differ against their size: subtract an origin from them");
  }
  return side;
}

void RequireSheet(const Eigen::Matrix3Xd& points) {
  if (points.cols() < kFewestSurfacePoints) {
    throw RefusedData("a surface needs at least 4 different points; there are " +
                      std::to_string(points.cols()));
  }
  const Eigen::Vector3d middle = points.rowwise().mean();
  const double size = (points.colwise() - middle).cwiseAbs().maxCoeff();
  if (size < kLeastSize) {
    throw RefusedData("the points differ by less than 1e-100: scale them up");
  }
  const Eigen::Matrix3Xd unit = (points.colwise() - middle) / size;
  const Eigen::Vector3d spread = EigenOf3(unit * unit.transpose()).values;
  if (!(spread[1] > kLineSquared * spread[2])) {
    throw RefusedData("the points lie on a line: they don't carry a surface");
  }
}

// Merges points that agree in place and in parameters.
MergedCloud MergeEqual(const PointCloud& cloud, const MergedCloud& places) {
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const Eigen::Index place = places.place[static_cast<size_t>(k)];
    if (cloud.parameters().col(k) == places.cloud.parameters().col(place)) continue;
    MergedCloud all{cloud, 0, std::vector<Eigen::Index>(static_cast<size_t>(cloud.size()))};
    std::iota(all.place.begin(), all.place.end(), Eigen::Index{0});
    return all;
  }
  return places;
}

// The lengths of the sides: means of |S_u| and |S_v| over the inliers, on a coarse fit.
Eigen::Vector2d MeanLengths(const PreparedCloud& prepared,
                            const SurfaceFitOptions& options,
                            ThreadPool& pool) {
  const int p = std::min(kScalingDegree, options.degree_u),
            q = std::min(kScalingDegree, options.degree_v);
  const FittingProblem coarse =
      prepared.base.ProblemOf(prepared.merged.cloud, prepared.used, p, q, kSurfaceSmoothing)
          .WithBases(SplineBasis::Uniform(p, p + kScalingSpans, 0, 1),
                     SplineBasis::Uniform(q, q + kScalingSpans, 0, 1));
  const NurbsSurface surface(
      coarse.basis_u(), coarse.basis_v(), SolveLinear(coarse, pool).coefficients);
  Eigen::Vector2d along = Eigen::Vector2d::Zero();
  const Eigen::Matrix2Xd& parameters = coarse.data().parameters;
  for (Eigen::Index k = 0; k < coarse.size(); ++k) {
    const SurfaceJet jet = surface.JetAt(parameters(0, k), parameters(1, k));
    along += Eigen::Vector2d(jet.du.norm(), jet.dv.norm());
  }
  return along.cwiseMax(kFlattest * along.maxCoeff()) / static_cast<double>(coarse.size());
}

}  // namespace

NurbsSurface GivenParameters::InUsersUnits(const NurbsSurface& surface) const {
  const Eigen::Vector2d from(surface.basis_u().lower(), surface.basis_v().lower());
  const Eigen::Vector2d to(surface.basis_u().upper(), surface.basis_v().upper());
  const Eigen::Vector2d scale = (high - low).cwiseQuotient(to - from);
  return NurbsSurface(Scaled(surface.basis_u(), low[0], high[0]),
                      Scaled(surface.basis_v(), low[1], high[1]),
                      surface.control_points(),
                      surface.weights())
      .WithTrims(MovedLoops(surface.trims(), scale, low - scale.cwiseProduct(from)));
}

GivenParameters PrepareGiven(const PointCloud& cloud,
                             const SurfaceFitOptions& options,
                             ThreadPool& pool,
                             StageClock& clock) {
  Report(options.progress, "prepare", 0);
  if (cloud.size() == 0) throw RefusedData("the cloud holds no points");
  if (cloud.parameters().cols() == 0) {
    throw RefusedData("the points have no parameters u and v");
  }
  const Side sides[2] = {RangeOf(cloud.parameters().row(0), "u"),
                         RangeOf(cloud.parameters().row(1), "v")};
  GivenParameters given;
  given.low = {sides[0].low, sides[1].low};
  given.high = {sides[0].high, sides[1].high};
  PreparedCloud& prepared = given.prepared;
  const MergedCloud places = MergeDuplicates(cloud);
  RequireSheet(places.cloud.points());
  CloudStatisticsOptions statistics;
  statistics.seed = options.seed;
  statistics.find_outliers = !options.keep_outliers;
  prepared.statistics = MeasureCloud(places.cloud.points(),
                                     NeighbourIndex(places.cloud.points()),
                                     statistics,
                                     pool,
                                     options.progress);
  prepared.merged = MergeEqual(cloud, places);
  const PointCloud& merged = prepared.merged.cloud;
  prepared.reached = prepared.used = PointMask::Constant(merged.size(), true);
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const auto at = static_cast<size_t>(k);
    prepared.used[prepared.merged.place[at]] = !prepared.statistics.outliers[places.place[at]];
  }
  prepared.statistics.outliers = !prepared.used;
  clock.Enter(&StageSeconds::parameterize);
  Parameterization& base = prepared.base;
  base.name = "given";
  base.why = "asked for";
  base.shape = "a smooth surface over the given parameters";
  base.exact = true;
  base.parameters.resize(2, merged.size());
  for (Eigen::Index k = 0; k < merged.size(); ++k) {
    for (int d = 0; d < 2; ++d) {
      base.parameters(d, k) = sides[d].Inside(merged.parameters()(d, k));
    }
  }
  const Eigen::Vector2d lengths = MeanLengths(prepared, options, pool);
  base.length_u = lengths[0];
  base.length_v = lengths[1];
  base.parameters = lengths.asDiagonal() * base.parameters;
  SortByPlace(prepared);
  return given;
}

}  // namespace batten::internal
