// SPDX-License-Identifier: MIT
// ApproximateGrid.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "batten/fitting/approximate_grid.h"
#include "batten/geometry/surface_evaluator.h"
#include "fitting/grid/grid_input.h"
#include "fitting/grid/grid_knot_placement.h"
#include "fitting/grid/net_distance.h"
#include "fitting/grid/value_span.h"
#include "fitting/linear/coefficient_order.h"

namespace batten {
using namespace internal;
namespace {

constexpr Eigen::Index kSamples = 200;  // a direction, at least
constexpr Eigen::Index kCurves = 48;    // that the search of a direction looks at, about
constexpr double kOptimistic = 1.25;    // tolerances: pairs of a larger summed error are not tried
constexpr double kSurely = 0.8;         // tolerances: below, more spans are not tried
constexpr double kFartherOut = 1.25;    // spans beyond those one direction needs, as a factor
constexpr int kSpansFarther = 3;        // and more
constexpr int kFewSpans = 24;           // numbers of spans up to it are all tried
constexpr double kLeastShare = 0.1;     // of the tolerance, for each direction's own error
constexpr double kMostDoubt = 0.5;      // of the tolerance
constexpr double kRoomForProof = 0.98;  // of the tolerance: larger sampled errors fail at once
constexpr double kMostLines = 800;      // lines of the refined nets in the proof, at most

// The indices of every `step`-th line, and of the last where the direction is open.
std::vector<int> Every(int step, int lines, bool closed) {
  std::vector<int> kept;
  for (int k = 0; k < lines; k += step) kept.push_back(k);
  if (!closed && kept.back() != lines - 1) kept.push_back(lines - 1);
  return kept;
}

// The parameters of these lines, and where the direction closes also the last, at which it is back
// at the first.
Eigen::VectorXd Picked(const Eigen::VectorXd& t, const std::vector<int>& kept, bool closed) {
  const auto count = static_cast<Eigen::Index>(kept.size());
  Eigen::VectorXd picked(count + (closed ? 1 : 0));
  for (Eigen::Index k = 0; k < count; ++k) picked[k] = t[kept[static_cast<size_t>(k)]];
  if (closed) picked[count] = t[t.size() - 1];
  return picked;
}

// Samples of one direction: the grid's parameters and others between them.
Eigen::VectorXd SampleParameters(const Eigen::VectorXd& lines, const SplineBasis& basis) {
  std::vector<double> ends(lines.begin(), lines.end());
  const double low = basis.lower(), high = basis.upper();
  if (ends.front() > low) ends.insert(ends.begin(), low);
  ends.push_back(high);
  const auto steps = static_cast<Eigen::Index>(ends.size()) - 1;
  const auto each = std::max<Eigen::Index>(1, (kSamples + steps - 1) / steps);
  std::vector<double> samples;
  for (size_t k = 0; k + 1 < ends.size(); ++k) {
    for (Eigen::Index s = 0; s < each; ++s) {
      const double share = static_cast<double>(s) / static_cast<double>(each);
      const double t = (1 - share) * ends[k] + share * ends[k + 1];
      if (samples.empty() || t > samples.back()) samples.push_back(t);
    }
  }
  if (!basis.periodic() && high > samples.back()) samples.push_back(high);
  return Eigen::Map<const Eigen::VectorXd>(samples.data(),
                                           static_cast<Eigen::Index>(samples.size()));
}

Eigen::VectorXd Thinned(const Eigen::VectorXd& samples) {
  const Eigen::Index step = std::max<Eigen::Index>(1, samples.size() / kCurves);
  std::vector<double> kept;
  for (Eigen::Index k = 0; k < samples.size(); k += step) kept.push_back(samples[k]);
  if (kept.back() != samples[samples.size() - 1]) kept.push_back(samples[samples.size() - 1]);
  return Eigen::Map<const Eigen::VectorXd>(kept.data(), static_cast<Eigen::Index>(kept.size()));
}

PointNet Sampled(const SurfaceEvaluator& surface,
                 const Eigen::VectorXd& u,
                 const Eigen::VectorXd& v,
                 ThreadPool& pool) {
  SurfaceGrid grid;
  surface.Grid(Values(u), Values(v), grid, pool);
  return {static_cast<int>(u.size()), static_cast<int>(v.size()), std::move(grid.points), {}};
}

// Knots of one direction and the largest error of the lines' fits over them.
struct Choice {
  SplineBasis basis;
  double error;
  int control_points;  // that differ
};

struct Candidate {
  const Choice *u, *v;
  int control_points;
};

// The search for a surface within the tolerance of the one through all points.
class ToleranceSearch {
 public:
  // Directions that are not thinned keep the knots of the interpolant.
  ToleranceSearch(
      const InterpolatedGrid& through, double tolerance, bool thin_u, bool thin_v, ThreadPool& pool)
      : through_(through.surface),
        tolerance_(tolerance),
        thin_u_(thin_u),
        thin_v_(thin_v),
        pool_(pool) {
    const SplineBasis &basis_u = through_.basis_u(), &basis_v = through_.basis_v();
    const SurfaceEvaluator evaluator(through_);
    samples_ = {SampleParameters(through.parameters.u, basis_u),
                SampleParameters(through.parameters.v, basis_v)};
    net_ = Sampled(evaluator, samples_.u, samples_.v, pool);
    const Eigen::Vector3d middle = MiddleOf(net_);
    PointNet lines_u = Sampled(evaluator, samples_.u, Thinned(samples_.v), pool),
             lines_v = Transposed(Sampled(evaluator, Thinned(samples_.u), samples_.v, pool));
    lines_u.points.colwise() -= middle;
    lines_v.points.colwise() -= middle;
    const CollapsedLines poles = PolesOf(net_, {basis_u.periodic(), basis_v.periodic()});
    const auto search =
        [](const SplineBasis& basis, const Eigen::VectorXd& t, bool meet_ends, PointNet& lines) {
          return GridKnotSearch(basis.degree(),
                                t,
                                std::move(lines.points),
                                basis.lower(),
                                basis.upper(),
                                basis.periodic(),
                                meet_ends);
        };
    u_ = search(basis_u, samples_.u, poles.any_row(), lines_u);
    v_ = search(basis_v, samples_.v, poles.any_column(), lines_v);
  }

  std::optional<ToleratedGrid> Find(const Progress& progress) {
    // If no candidate keeps the tolerance, the search repeats with a smaller share of it.
    for (double share = 1; share > kLeastShare; share *= 0.7) {
      const std::vector<Choice> us =
                                    ChoicesOf(*u_, through_.basis_u(), thin_u_, share * tolerance_),
                                vs =
                                    ChoicesOf(*v_, through_.basis_v(), thin_v_, share * tolerance_);
      const std::vector<Candidate> candidates = Candidates(us, vs, share * tolerance_);
      double done = 0;
      for (const Candidate& candidate : candidates) {
        Report(progress, "grid", 0.3 + 0.5 * done++ / static_cast<double>(candidates.size()));
        if (auto kept = Try(candidate)) return kept;
      }
    }
    return std::nullopt;
  }

 private:
  // Numbers of spans that are enough for this direction alone and some more, fewer control points
  // first; at last the knots of the surface through all points.
  std::vector<Choice> ChoicesOf(GridKnotSearch& search,
                                const SplineBasis& through,
                                bool thin,
                                double tolerance) {
    const int all = DistinctCount(through);
    if (!thin) return {{through, 0, all}};
    const int most = search.SpansBelow(all);
    const int least = search.SpansFor(tolerance, most, pool_);
    const int last = std::min(static_cast<int>(kFartherOut * least) + kSpansFarther, most);
    std::vector<Choice> choices;
    for (int spans = least; spans <= last; spans += std::max(1, least / kFewSpans)) {
      const GridKnotPlacement& best = search.Best(spans, pool_);
      choices.push_back({search.BasisOf(best.breaks), best.error, search.ControlPoints(spans)});
    }
    choices.push_back({through, 0, all});
    return choices;
  }

  // Pairs with fewer control points than interpolation, the fewest first, whose errors together are
  // near the tolerance at most.
  std::vector<Candidate> Candidates(const std::vector<Choice>& us,
                                    const std::vector<Choice>& vs,
                                    double tolerance) {
    std::vector<Candidate> candidates;
    for (const Choice& u : us) {
      for (const Choice& v : vs) {
        const int count = u.control_points * v.control_points;
        if (count >= us.back().control_points * vs.back().control_points) break;
        const double together = u.error + v.error;
        if (!(together <= kOptimistic * tolerance)) continue;
        if (tried_.insert({u.control_points, v.control_points}).second) {
          candidates.push_back({&u, &v, count});
        }
        if (together <= kSurely * tolerance) break;  // more spans of v would only cost more
      }
    }
    std::stable_sort(candidates.begin(), candidates.end(), [](const auto& x, const auto& y) {
      return x.control_points < y.control_points;
    });
    return candidates;
  }

  std::optional<ToleratedGrid> Try(const Candidate& candidate);

  const NurbsSurface& through_;
  double tolerance_;
  bool thin_u_, thin_v_;
  ThreadPool& pool_;
  GridParameters samples_;
  PointNet net_;
  std::optional<GridKnotSearch> u_, v_;
  std::set<std::pair<int, int>> tried_;
};

std::optional<ToleratedGrid> ToleranceSearch::Try(const Candidate& candidate) {
  NurbsSurface surface =
      LeastSquaresOver(candidate.u->basis, candidate.v->basis, net_, samples_, {}, pool_);
  const PointNet at = Sampled(SurfaceEvaluator(surface), samples_.u, samples_.v, pool_);
  const double sampled = (at.points - net_.points).colwise().norm().maxCoeff();
  if (!(sampled <= kRoomForProof * tolerance_)) return std::nullopt;
  double bound = NetDistance(surface, through_);
  if (bound > tolerance_) {
    // The excess of the bound falls with the square of the cuts.
    const auto cuts =
        static_cast<int>(std::ceil(std::sqrt((bound - sampled) / (tolerance_ - sampled)))) + 1;
    const double lines = std::sqrt(static_cast<double>(through_.control_points().cols()));
    if (cuts * lines > kMostLines) return std::nullopt;
    bound = NetDistance(surface, through_, cuts);
  }
  if (bound <= tolerance_) return ToleratedGrid{std::move(surface), {}, bound, false};
  return std::nullopt;
}

// Richardson estimate of the interpolant's error between the points in one direction: a part of its
// distance from the interpolant of every second line, assuming errors that fall with the power p +
// 1 of the step. 0 for few lines, which allow no estimate.
double DoubtOf(const PointNet& net,
               const InterpolatedGrid& through,
               const GridInterpolationOptions& options,
               bool along_u,
               ThreadPool& pool) {
  const int degree = along_u ? options.degree_u : options.degree_v;
  const std::vector<int> rows = Every(along_u ? 2 : 1, net.rows, options.closed.u),
                         columns = Every(along_u ? 1 : 2, net.columns, options.closed.v);
  if (static_cast<int>((along_u ? rows : columns).size()) <= degree + 1) return 0;
  const PointNet half = WithLines(net, along_u, along_u ? rows : columns);
  GridInterpolationOptions coarse = options;
  coarse.parameterization = GridParameterization::kGiven;
  const GridParameters all =
      ParametersFor(net, options.parameterization, options.parameters, options.closed);
  coarse.parameters = {Picked(all.u, rows, options.closed.u),
                       Picked(all.v, columns, options.closed.v)};
  const InterpolatedGrid other = InterpolateGrid(half, coarse, pool);
  const GridParameters at{SampleParameters(through.parameters.u, through.surface.basis_u()),
                          SampleParameters(through.parameters.v, through.surface.basis_v())};
  // Closed domains begin at knots: the first line of both is where they agree.
  const auto moved = [](const Eigen::VectorXd& t, double from, double to) -> Eigen::VectorXd {
    return t.array() + (to - from);
  };
  const PointNet fine = Sampled(SurfaceEvaluator(through.surface), at.u, at.v, pool),
                 rough = Sampled(SurfaceEvaluator(other.surface),
                                 moved(at.u, through.parameters.u[0], other.parameters.u[0]),
                                 moved(at.v, through.parameters.v[0], other.parameters.v[0]),
                                 pool);
  const double apart = (fine.points - rough.points).colwise().norm().maxCoeff();
  return apart / (std::pow(2, degree + 1) - 1);
}

}  // namespace

ToleratedGrid ApproximateGrid(const PointNet& net,
                              double tolerance,
                              const GridInterpolationOptions& options,
                              ThreadPool& pool,
                              const Progress& progress) {
  if (!(tolerance > 0 && std::isfinite(tolerance))) {
    throw std::invalid_argument("ApproximateGrid: the tolerance must be positive");
  }
  InterpolatedGrid through = InterpolateGrid(net, options, pool);
  Report(progress, "grid", 0.2);
  // The interpolation error of each direction; where their sum is too large, the worse direction
  // keeps all its lines.
  double unsure_u = DoubtOf(net, through, options, true, pool),
         unsure_v = DoubtOf(net, through, options, false, pool);
  struct {
    bool u = true, v = true;
  } thin;
  const double most = kMostDoubt * tolerance;
  if (unsure_u + unsure_v > most) {
    (unsure_u > unsure_v ? thin.u : thin.v) = false;
    (thin.u ? unsure_v : unsure_u) = 0;
  }
  std::optional<ToleratedGrid> found;
  if (unsure_u + unsure_v <= most) {
    found = ToleranceSearch(through, tolerance - unsure_u - unsure_v, thin.u, thin.v, pool)
                .Find(progress);
  }
  if (!found) return {std::move(through.surface), std::move(through.parameters), 0, true};
  found->parameters = std::move(through.parameters);
  return *std::move(found);
}

}  // namespace batten
