// SPDX-License-Identifier: MIT
#include "fitting/surface/gap_regularization.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/insert_knots.h"
#include "fitting/core/rules.h"
#include "fitting/least_squares/penalised_system.h"
#include "fitting/linear/coefficient_order.h"
#include "fitting/surface/gap_bounds.h"
#include "fitting/surface/gap_map.h"

namespace batten::internal {
namespace {

constexpr int kHalvings = 3;
constexpr double kHardlySeen = 1e-4;     // of the mean Σ w N² of control points; below: free
constexpr double kDisturbance = 0.03;    // share of the noise variance that data may move by
constexpr double kMostSeen = 0.11;       // largest such share of the mean where data may be missed
constexpr double kWild = 0.1;            // excess in radii of the bounds that costs rim data …
constexpr double kWildBeyond = 2;        // … and beyond the outline of a bent sheet
constexpr int kSteps = 16;               // steps between the free surface and the membrane
constexpr double kFillSmoothing = 1e-5;  // smoothing of the spline fitted to the membrane
constexpr double kNarrowest = 1;         // spacings: no cell gets narrower

void RequireSheet(const FittingProblem& problem) {
  const auto reject = [](const std::string& rule) {
    throw std::invalid_argument("SolveWithGapRegularization: " + rule);
  };
  if (problem.is_curve()) reject("the problem is a curve's, not a surface's");
  if (problem.data().values.rows() != 1 && problem.data().values.rows() != 3)
    reject("the data's values have neither one row nor three");
}

// A control net over its problem's bases.
struct Net {
  FittingProblem problem;
  Eigen::MatrixXd coefficients;
};

// The same surface over more knots.
Net Refined(const Net& net, const std::vector<double>& in_u, const std::vector<double>& in_v) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, net.coefficients.cols());
  points.topRows(net.coefficients.rows()) = net.coefficients;
  NurbsSurface surface(net.problem.basis_u(), net.problem.basis_v(), points);
  if (!in_u.empty()) surface = RefineKnots(surface, Direction::kU, in_u);
  if (!in_v.empty()) surface = RefineKnots(surface, Direction::kV, in_v);
  return {net.problem.WithBases(surface.basis_u(), surface.basis_v()),
          surface.control_points().topRows(net.coefficients.rows())};
}

// Marks control points that data determine hardly or not at all: Σ w N² of each against the mean of
// all.
std::vector<char> Unseen(const FittingProblem& problem, double hardly) {
  const SplineBasis &bu = problem.basis_u(), &bv = problem.basis_v();
  const int p = bu.degree(), q = bv.degree();
  const FittingData& data = problem.data();
  Eigen::MatrixXd seen = Eigen::MatrixXd::Zero(bv.size(), bu.size());
  double Nu[kMaxDegree + 1], Nv[kMaxDegree + 1];
  for (Eigen::Index k = 0; k < problem.size(); ++k) {
    const double u = data.parameters(0, k), v = data.parameters(1, k);
    const double weight = data.weights.size() > 0 ? data.weights[k] : 1.0;
    const int su = bu.Span(u), sv = bv.Span(v);
    bu.Values(su, u, Nu);
    bv.Values(sv, v, Nv);
    for (int r = 0; r <= p; ++r) {
      for (int s = 0; s <= q; ++s) {
        const double N = Nu[r] * Nv[s];
        seen(DistinctIndex(bv, sv - q + s), DistinctIndex(bu, su - p + r)) += weight * N * N;
      }
    }
  }
  for (int i = 0; i < bu.size(); ++i) {
    for (int j = 0; j < bv.size(); ++j)
      seen(j, i) = seen(DistinctIndex(bv, j), DistinctIndex(bu, i));
  }
  const double least = hardly * seen.mean();
  std::vector<char> unseen(static_cast<size_t>(seen.size()));
  for (Eigen::Index k = 0; k < seen.size(); ++k)
    unseen[static_cast<size_t>(k)] = seen.data()[k] <= least;
  return unseen;
}

class Holding {
 public:
  Holding(const GapMap& map, const std::vector<GapBounds>& bounds, ThreadPool& pool)
      : map_(map), bounds_(bounds), pool_(pool) {
    for (size_t k = 0; k < bounds.size(); ++k) {
      if (bounds[k].centre.cols() > 0) held_.push_back(k);
    }
  }

  bool any() const { return !held_.empty(); }

  struct Outcome {
    Net net;
    std::vector<size_t> out;      // gaps that are not within their bounds
    std::vector<size_t> changed;  // gaps drawn towards the membrane
    bool wild = false;            // some gap exceeds its bounds by far
  };
  Outcome Hold(const Net& free, double hardly) const {
    const std::vector<int> owner = Owners(free, hardly);
    Outcome outcome{free, {}, {}, false};
    const Eigen::MatrixXd filled = Fill(free, owner);
    for (const size_t hole : held_) {
      const std::vector<int>& places = map_.gaps()[hole].places;
      const Eigen::MatrixXd from = AtPlaces(free.problem, free.coefficients, map_, places, pool_);
      const Eigen::MatrixXd to = AtPlaces(free.problem, filled, map_, places, pool_);
      double share = 0, least = bounds_[hole].Excess(from);
      for (int step = 1; step <= kSteps && least > 0; ++step) {
        const double t = static_cast<double>(step) / kSteps;
        const double excess = bounds_[hole].Excess((1 - t) * from + t * to);
        if (excess >= least) continue;
        least = excess;
        share = t;
      }
      if (least > bounds_[hole].slack) outcome.out.push_back(hole);
      // The fit at the outline of a bent sheet takes precedence over the surface beyond it.
      const bool beyond = filled.rows() == 3 && map_.gaps()[hole].at_border;
      outcome.wild |= least > (beyond ? kWildBeyond : kWild) * bounds_[hole].radius.maxCoeff();
      if (share == 0) continue;
      outcome.changed.push_back(hole);
      for (Eigen::Index k = 0; k < filled.cols(); ++k) {
        if (owner[static_cast<size_t>(k)] != static_cast<int>(hole)) continue;
        outcome.net.coefficients.col(k) =
            (1 - share) * free.coefficients.col(k) + share * filled.col(k);
      }
    }
    return outcome;
  }

  // Halves the cells across the gaps that leave their bounds; returns nothing where that is not
  // possible. Only gaps with data all around get knots; regions beyond the outline do not.
  Net Halved(const Net& net,
             std::vector<size_t> out,
             double narrowest,
             int most_control_points) const {
    std::erase_if(out, [&](size_t hole) { return map_.gaps()[hole].at_border; });
    std::vector<double> in_u, in_v;
    for (const bool along_u : {true, false}) {
      const SplineBasis& basis = along_u ? net.problem.basis_u() : net.problem.basis_v();
      std::vector<double>& knots = along_u ? in_u : in_v;
      for (const int span : basis.Spans()) {
        const double a = basis.knots()[static_cast<size_t>(span)],
                     b = basis.knots()[static_cast<size_t>(span) + 1];
        if ((b - a) / 2 < narrowest) continue;
        const bool crosses = std::any_of(out.begin(), out.end(), [&](size_t hole) {
          const auto [low, high] = Extent(map_.gaps()[hole], along_u ? 0 : 1);
          return low < b && high > a;
        });
        if (crosses) knots.push_back((a + b) / 2);
      }
    }
    const double size = (net.problem.basis_u().size() + static_cast<double>(in_u.size())) *
                        (net.problem.basis_v().size() + static_cast<double>(in_v.size()));
    if (size > most_control_points || in_u.size() + in_v.size() == 0) return net;
    return Refined(net, in_u, in_v);
  }

 private:
  std::pair<double, double> Extent(const DataGap& hole, int coordinate) const {
    double low = map_.Centre(hole.places.front())[coordinate], high = low;
    for (const int place : hole.places) {
      low = std::min(low, map_.Centre(place)[coordinate]);
      high = std::max(high, map_.Centre(place)[coordinate]);
    }
    return {low, high};
  }

  // The held gap that each control point without data lies in, or −1.
  std::vector<int> Owners(const Net& net, double hardly) const {
    const SplineBasis &bu = net.problem.basis_u(), &bv = net.problem.basis_v();
    const std::vector<char> unseen = Unseen(net.problem, hardly);
    std::vector<int> owner(unseen.size(), -1);
    for (int i = 0; i < bu.size(); ++i) {
      for (int j = 0; j < bv.size(); ++j) {
        const auto k = static_cast<size_t>(i * bv.size() + j);
        if (!unseen[k]) continue;
        const int hole = map_.GapAt({bu.Clamp(bu.Greville(i)), bv.Clamp(bv.Greville(j))});
        if (hole >= 0 && bounds_[static_cast<size_t>(hole)].centre.cols() > 0) owner[k] = hole;
      }
    }
    return owner;
  }

  // The net whose control points inside held gaps follow the membranes there; the others stay.
  Eigen::MatrixXd Fill(const Net& net, const std::vector<int>& owner) const {
    auto data = std::make_shared<FittingData>();
    Eigen::Index count = 0;
    for (const size_t hole : held_) count += bounds_[hole].fill.cols();
    data->parameters.resize(2, count);
    data->values.resize(net.coefficients.rows(), count);
    Eigen::Index to = 0;
    for (const size_t hole : held_) {
      data->values.middleCols(to, bounds_[hole].fill.cols()) = bounds_[hole].fill;
      for (const int place : map_.gaps()[hole].places)
        data->parameters.col(to++) = map_.Centre(place);
    }
    const PenalisedSystem system(net.problem.WithData(std::move(data)), pool_);
    BlockBandedMatrix matrix = system.Matrix(kFillSmoothing, 1);
    std::vector<char> fixed(static_cast<size_t>(system.unknowns()), 0);
    Eigen::MatrixXd kept = Eigen::MatrixXd::Zero(system.unknowns(), net.coefficients.rows());
    for (size_t k = 0; k < owner.size(); ++k) {
      if (owner[k] >= 0) continue;
      const Eigen::Index row = system.RowOf(static_cast<Eigen::Index>(k));
      fixed[static_cast<size_t>(row)] = 1;
      kept.row(row) = net.coefficients.col(static_cast<Eigen::Index>(k)).transpose();
    }
    Eigen::MatrixXd rows = system.rhs() - matrix.Times(kept);
    const double unit = matrix.Trace() / system.unknowns();
    FixRows(matrix, fixed, unit);
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
      if (fixed[static_cast<size_t>(row)]) rows.row(row) = unit * kept.row(row);
    }
    if (!matrix.Factor()) return net.coefficients;
    matrix.Solve(rows);
    Eigen::MatrixXd filled = system.Net(rows);
    for (Eigen::Index k = 0; k < filled.cols(); ++k) {
      if (owner[static_cast<size_t>(k)] < 0) filled.col(k) = net.coefficients.col(k);
    }
    if (!filled.allFinite()) return net.coefficients;
    return WithPolesClosed(
        std::move(filled), net.problem.basis_u(), net.problem.basis_v(), net.problem.poles());
  }

  // Rows and columns of fixed unknowns become those of the identity, times a unit.
  static void FixRows(BlockBandedMatrix& matrix, const std::vector<char>& fixed, double unit) {
    const int b = matrix.block_size();
    for (int row = 0; row < matrix.blocks(); ++row) {
      for (int below = 0; below <= std::min(matrix.bandwidth(), row); ++below) {
        auto block = matrix.at(row, below);
        for (int a = 0; a < b; ++a) {
          if (fixed[static_cast<size_t>(row * b + a)]) block.row(a).setZero();
          if (fixed[static_cast<size_t>((row - below) * b + a)]) block.col(a).setZero();
        }
        for (int a = 0; below == 0 && a < b; ++a) {
          if (fixed[static_cast<size_t>(row * b + a)]) block(a, a) = unit;
        }
      }
    }
  }

  const GapMap& map_;
  const std::vector<GapBounds>& bounds_;
  ThreadPool& pool_;
  std::vector<size_t> held_;
};

double SumOfSquares(const FittingProblem& problem, const Eigen::MatrixXd& errors) {
  const Eigen::VectorXd squares = errors.colwise().squaredNorm();
  const Eigen::VectorXd& weights = problem.data().weights;
  return weights.size() > 0 ? weights.dot(squares) : squares.sum();
}

}  // namespace

GapRegularizationResult SolveWithGapRegularization(const FittingProblem& problem,
                                                   const GapRegularizationOptions& options,
                                                   ThreadPool& pool) {
  RequireSheet(problem);
  GapRegularizationResult result{problem, SolveLinear(problem, pool)};
  const GapMap map(problem, options.measured, options.spacing);
  result.empty_area_fraction = map.gap_share();
  const std::vector<GapBounds> bounds =
      BoundsOfGaps(problem, result.solution, map, options.measured, pool);
  const Holding holding(map, bounds, pool);
  if (!holding.any() || !Acts(Rule::kGaps)) return result;

  // A small share of the variance from noise, σ² for each control point.
  const double budget = kDisturbance * result.solution.residual_squares * problem.unknowns() /
                        static_cast<double>(problem.size());
  const Eigen::MatrixXd before = EvaluateAt(problem, result.solution.coefficients, pool);
  const auto at_data = [&](const Net& net) {
    return EvaluateAt(net.problem, net.coefficients, pool);
  };
  Net net{problem, result.solution.coefficients};
  Holding::Outcome outcome = holding.Hold(net, kHardlySeen);
  for (int halving = 0;; ++halving) {
    const bool disturbed = SumOfSquares(problem, at_data(outcome.net) - before) > budget;
    if (!disturbed && outcome.out.empty()) break;
    Net halved = halving == kHalvings ? net
                                      : holding.Halved(net,
                                                       disturbed ? outcome.changed : outcome.out,
                                                       kNarrowest * options.spacing,
                                                       options.most_control_points);
    if (halved.coefficients.cols() == net.coefficients.cols()) {
      if (disturbed) outcome = holding.Hold(net, 0);
      // Misfit at the rim is accepted to bound an overshooting surface.
      for (double hardly = 10 * kHardlySeen;
           options.gives_way && outcome.wild && hardly <= kMostSeen;
           hardly *= 10) {
        outcome = holding.Hold(net, hardly);
      }
      break;
    }
    net = std::move(halved);
    outcome = holding.Hold(net, kHardlySeen);
  }
  if (outcome.changed.empty()) return result;
  result.solution.residual_squares =
      SumOfSquares(problem, at_data(outcome.net) - problem.data().values);
  result.problem = outcome.net.problem;
  result.solution.coefficients = std::move(outcome.net.coefficients);
  for (const size_t hole : outcome.changed) {
    ++result.gaps_held;
    result.places_held += static_cast<Eigen::Index>(map.gaps()[hole].places.size());
  }
  return result;
}

}  // namespace batten::internal
