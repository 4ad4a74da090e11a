// SPDX-License-Identifier: MIT
#include "fitting/surface/gap_bounds.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "batten/fitting/statistics.h"
#include "fitting/least_squares/fitting_bases.h"

namespace batten::internal {
namespace {

constexpr double kRimMargin = 0.07;     // share of the rim's range added to bounds of heights
constexpr double kRimSlack = 0.01;      // share of the rim's range tolerated without more knots
constexpr double kBorderMargin = 0.03;  // share of the range of all data
constexpr double kTiltMargin = 0.02;    // share of the width of the data's band about their plane
constexpr double kBallMargin = 0.1;     // share of the coarse fit's residual at the rim
constexpr double kNarrowBand = 0.5;     // band width over range of heights; below: a tilted sheet
constexpr double kTiltRounding = 1e-6;  // of the data's size: rounding in extrapolation
constexpr double kSlopeFactor = 1.2;
constexpr double kUsualSlope = 0.75;  // quantile of the rim's slopes, for heights
constexpr double kSteepSlope = 0.95;
constexpr double kCoarseSmoothing = 1e-3;
constexpr double kCoarseCell = 1.5;  // width of a coarse cell in reaches of the widest gap

double CellWidth(const SplineBasis& basis) {
  return (basis.upper() - basis.lower()) / static_cast<double>(basis.Spans().size());
}

// The weighted rms residual of the solution, all rows together.
double ResidualRms(const FittingProblem& problem, double residual_squares) {
  const Eigen::VectorXd& weights = problem.data().weights;
  const double sum = weights.size() > 0 ? weights.sum() : static_cast<double>(problem.size());
  return sum > 0 ? std::sqrt(std::max(0.0, residual_squares) / sum) : 0;
}

Eigen::MatrixXd AtParameters(const FittingProblem& problem,
                             const Eigen::MatrixXd& coefficients,
                             Eigen::Matrix2Xd parameters,
                             ThreadPool& pool) {
  auto data = std::make_shared<FittingData>();
  data->values = Eigen::MatrixXd::Zero(1, parameters.cols());
  data->parameters = std::move(parameters);
  return EvaluateAt(problem.WithData(std::move(data)), coefficients, pool);
}

Eigen::MatrixXd AtRim(const Eigen::MatrixXd& at_places, const DataGap& hole) {
  Eigen::MatrixXd rim(at_places.rows(), static_cast<Eigen::Index>(hole.rim.size()));
  for (Eigen::Index r = 0; r < rim.cols(); ++r)
    rim.col(r) = at_places.col(static_cast<Eigen::Index>(hole.rim[static_cast<size_t>(r)]));
  return rim;
}

// The slope of a net's values at the rim by differences across a place: a quantile of the greater
// of the two directions' slopes.
double SlopeAt(const DataGap& hole,
               const FittingProblem& problem,
               const GapMap& map,
               double share,
               const std::function<Eigen::MatrixXd(const Eigen::Matrix2Xd&)>& values) {
  const SplineBasis &bu = problem.basis_u(), &bv = problem.basis_v();
  const double half = map.side() / 2;
  Eigen::Matrix2Xd around(2, 4 * static_cast<Eigen::Index>(hole.rim.size()));
  Eigen::Index to = 0;
  for (const size_t r : hole.rim) {
    const Eigen::Vector2d at = map.Centre(hole.places[r]);
    around.col(to++) << std::max(bu.lower(), at[0] - half), at[1];
    around.col(to++) << std::min(bu.upper(), at[0] + half), at[1];
    around.col(to++) << at[0], std::max(bv.lower(), at[1] - half);
    around.col(to++) << at[0], std::min(bv.upper(), at[1] + half);
  }
  const Eigen::MatrixXd there = values(around);
  std::vector<double> slopes;
  for (Eigen::Index k = 0; k < to; k += 4) {
    slopes.push_back(std::hypot(
        (there.col(k + 1) - there.col(k)).norm() / (around(0, k + 1) - around(0, k)),
        (there.col(k + 3) - there.col(k + 2)).norm() / (around(1, k + 3) - around(1, k + 2))));
  }
  return Quantile(std::move(slopes), share);
}

// Bounds of a surface of heights, gap by gap.
class HeightBounds {
 public:
  HeightBounds(const FittingProblem& problem,
               const LinearSolution& free,
               const GapMap& map,
               Eigen::Index measured,
               ThreadPool& pool)
      : problem_(problem), free_(free), map_(map), pool_(pool) {
    const FittingData& data = problem.data();
    std::vector<Eigen::Index> counts;  // data that carry weight
    for (Eigen::Index k = 0; k < measured; ++k) {
      if (data.weights.size() == 0 || data.weights[k] > 0) counts.push_back(k);
    }
    const Eigen::VectorXd heights = data.values.row(0)(counts).transpose();
    low_ = heights.minCoeff();
    high_ = heights.maxCoeff();
    rounding_ = kTiltRounding * heights.cwiseAbs().maxCoeff();
    noise_ = ResidualRms(problem, free.residual_squares) + rounding_;
    Eigen::MatrixXd design(heights.size(), 3);
    design << Eigen::VectorXd::Ones(heights.size()),
        data.parameters(Eigen::indexing::all, counts).transpose();
    plane_ = design.colPivHouseholderQr().solve(heights);
    const Eigen::VectorXd above = heights - design * plane_;
    const double margin = kTiltMargin * (above.maxCoeff() - above.minCoeff()) + rounding_;
    band_low_ = above.minCoeff() - margin;
    band_high_ = above.maxCoeff() + margin;
  }

  GapBounds Of(const DataGap& hole, const Eigen::MatrixXd& there) const {
    if (hole.at_border && KeepsToTilt(hole, there)) return {};
    const Eigen::MatrixXd rim = AtRim(there, hole);
    // The gap's edge runs between its own outermost places and those next to them.
    const Eigen::MatrixXd shore = AtPlaces(problem_, free_.coefficients, map_, hole.shore, pool_);
    const double low = std::max(rim.minCoeff(), std::min(rim.maxCoeff(), shore.minCoeff())),
                 high = std::min(rim.maxCoeff(), std::max(low, shore.maxCoeff()));
    const double margin = kRimMargin * (high - low) + noise_;
    const double slope =
        hole.at_border
            ? kSlopeFactor * SlopeAt(hole,
                                     problem_,
                                     map_,
                                     kUsualSlope,
                                     [&](const auto& at) {
                                       return AtParameters(problem_, free_.coefficients, at, pool_);
                                     })
            : 0;
    const double farthest = kBorderMargin * (high_ - low_) + noise_;
    GapBounds bounds;
    bounds.slack = kRimSlack * (high - low);
    bounds.centre.resize(1, there.cols());
    bounds.radius.resize(there.cols());
    for (Eigen::Index k = 0; k < there.cols(); ++k) {
      const double way = slope * hole.distance[static_cast<size_t>(k)];
      double bottom = low - margin - way, top = high + margin + way;
      if (hole.at_border) {
        bottom = std::max(bottom, std::min(low, low_ - farthest));
        top = std::min(top, std::max(high, high_ + farthest));
      }
      bounds.centre(0, k) = (bottom + top) / 2;
      bounds.radius[k] = (top - bottom) / 2;
    }
    if (bounds.Excess(there) <= 0) return {};
    bounds.fill = map_.HarmonicFill(hole, rim);
    return bounds;
  }

 private:
  // Whether heights stay in a band about the plane of the data that is hardly wider than the data's
  // own band. A tilted sheet is continued with its tilt in gaps.
  bool KeepsToTilt(const DataGap& hole, const Eigen::MatrixXd& there) const {
    if (band_high_ - band_low_ > kNarrowBand * (high_ - low_) + 2 * rounding_) return false;
    for (Eigen::Index k = 0; k < there.cols(); ++k) {
      const Eigen::Vector2d at = map_.Centre(hole.places[static_cast<size_t>(k)]);
      const double above = there(0, k) - plane_[0] - plane_.tail<2>().dot(at);
      if (above < band_low_ || above > band_high_) return false;
    }
    return true;
  }

  const FittingProblem& problem_;
  const LinearSolution& free_;
  const GapMap& map_;
  ThreadPool& pool_;
  double low_, high_, rounding_, noise_, band_low_, band_high_;
  Eigen::Vector3d plane_;
};

// Bounds of a surface of points: balls about a coarse fit whose cells are at least as wide as the
// widest gap is deep, so that the data around a gap determine it there.
class PointBounds {
 public:
  PointBounds(const FittingProblem& problem,
              const LinearSolution& free,
              const GapMap& map,
              double reach,
              ThreadPool& pool)
      : problem_(problem),
        free_(free),
        map_(map),
        pool_(pool),
        coarse_(Coarse(problem, kCoarseCell * reach)) {
    coarse_net_ = SolveLinear(coarse_, pool).coefficients;
    const double size = (problem.data().values.colwise() - problem.data().values.rowwise().mean())
                            .cwiseAbs()
                            .maxCoeff();
    noise_ = ResidualRms(problem, free.residual_squares) + kTiltRounding * size;
  }

  GapBounds Of(const DataGap& hole, const Eigen::MatrixXd& there) const {
    const Eigen::MatrixXd trend = AtPlaces(coarse_, coarse_net_, map_, hole.places, pool_);
    const Eigen::MatrixXd left = AtRim(there - trend, hole);
    const Eigen::VectorXd middle = left.rowwise().mean();
    const double radius = (left.colwise() - middle).colwise().norm().maxCoeff();
    GapBounds bounds;
    bounds.centre = trend.colwise() + middle;
    const double slope = SlopeAt(hole, problem_, map_, kSteepSlope, [&](const auto& at) {
      return (AtParameters(problem_, free_.coefficients, at, pool_) -
              AtParameters(coarse_, coarse_net_, at, pool_))
          .eval();
    });
    const double way = slope * (hole.at_border ? kSlopeFactor : kSlopeFactor / 2);
    bounds.radius = Eigen::VectorXd::Constant(there.cols(), (1 + kBallMargin) * radius + noise_);
    for (Eigen::Index k = 0; k < there.cols(); ++k)
      bounds.radius[k] += way * hole.distance[static_cast<size_t>(k)];
    if (bounds.Excess(there) <= 0) return {};
    bounds.slack = kBallMargin * radius;
    bounds.fill = trend + map_.HarmonicFill(hole, left);
    return bounds;
  }

 private:
  static FittingProblem Coarse(const FittingProblem& problem, double width) {
    const auto basis = [&](const SplineBasis& fine) {
      const int cells = static_cast<int>(std::min((fine.upper() - fine.lower()) / width,
                                                  static_cast<double>(fine.Spans().size())));
      if (fine.periodic()) return FittingBasisLike(fine, fine.degree(), cells);
      return SplineBasis::Uniform(
          fine.degree(), fine.degree() + std::max(1, cells), fine.lower(), fine.upper());
    };
    return problem.WithBases(basis(problem.basis_u()), basis(problem.basis_v()))
        .WithSmoothing(std::max(problem.smoothing(), kCoarseSmoothing));
  }

  const FittingProblem& problem_;
  const LinearSolution& free_;
  const GapMap& map_;
  ThreadPool& pool_;
  FittingProblem coarse_;
  Eigen::MatrixXd coarse_net_;
  double noise_;
};

}  // namespace

Eigen::MatrixXd AtPlaces(const FittingProblem& problem,
                         const Eigen::MatrixXd& coefficients,
                         const GapMap& map,
                         const std::vector<int>& places,
                         ThreadPool& pool) {
  Eigen::Matrix2Xd parameters(2, static_cast<Eigen::Index>(places.size()));
  for (Eigen::Index k = 0; k < parameters.cols(); ++k)
    parameters.col(k) = map.Centre(places[static_cast<size_t>(k)]);
  return AtParameters(problem, coefficients, std::move(parameters), pool);
}

std::vector<GapBounds> BoundsOfGaps(const FittingProblem& problem,
                                    const LinearSolution& free,
                                    const GapMap& map,
                                    Eigen::Index measured,
                                    ThreadPool& pool) {
  const std::vector<DataGap>& gaps = map.gaps();
  const double cell = std::max(CellWidth(problem.basis_u()), CellWidth(problem.basis_v()));
  const auto matters = [&](const DataGap& hole) { return hole.reach > cell && !hole.rim.empty(); };
  std::vector<GapBounds> bounds(gaps.size());
  double reach = 0;
  for (const DataGap& hole : gaps) {
    if (matters(hole)) reach = std::max(reach, hole.reach);
  }
  if (reach == 0) return bounds;
  const auto fill = [&](const auto& of) {
    for (size_t k = 0; k < gaps.size(); ++k) {
      if (!matters(gaps[k])) continue;
      bounds[k] = of.Of(gaps[k], AtPlaces(problem, free.coefficients, map, gaps[k].places, pool));
    }
  };
  if (problem.data().values.rows() == 1) {
    fill(HeightBounds(problem, free, map, measured, pool));
  } else {
    fill(PointBounds(problem, free, map, reach, pool));
  }
  return bounds;
}

}  // namespace batten::internal
