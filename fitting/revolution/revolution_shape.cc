// SPDX-License-Identifier: MIT
#include "fitting/revolution/revolution_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "batten/fitting/robust_loss.h"
#include "batten/fitting/statistics.h"
#include "fitting/flattening/winding_number.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr int kMostSpans = 40, kLeastSpans = 4;
constexpr double kNodesASpan = 20;
constexpr double kSpan = 2;           // least length of a span in reaches
constexpr double kSpanInScatter = 6;  // least length of a span in rms distances of the nodes
constexpr double kBeyond = 5;         // reaches by which an open profile is extended
constexpr int kStraight = 20;         // places on each straight extension
constexpr double kEnd = 8;            // reaches from which its direction is fitted
constexpr double kSlip = 3;           // greatest error in reaches of steps along the profile
constexpr double kClosedAlong = 0.5;  // of the places round the axis
constexpr double kAsGood = 1.3;       // misfits of a preferred axis against the best one
constexpr double kSame = 2e-4;        // sizes; smaller differences of rms distance do not count
constexpr double kGoodInNoise = 0.7;  // noises; below, no other axis is tried
constexpr double kGoodInSizes = 2e-3;
constexpr int kSweeps = 30;
constexpr int kRefinements = 6;
constexpr double kFarBehind = 1.5;
constexpr double kHardlyMoves = 0.9;
constexpr double kCauchy = 4;

// Lengths along the profile, as far as the graph tells.
struct Lengths {
  std::vector<double> values;
  std::vector<bool> known;
  double period = 0;  // 0: open
};

Eigen::Vector2d TangentOf(const SamplesAboutAxis& seen, Eigen::Index i) {
  return {-seen.normals(1, i), seen.normals(0, i)};
}

// Smooths the lengths by averaging the neighbours' predictions, a few times.
void Relax(const RevolutionSamples& round, const GraphSteps& graph, Lengths& lengths) {
  std::vector<double> sums(lengths.values.size()), counts(lengths.values.size());
  const auto& edges = round.graph.edges;
  std::vector<double> steps = graph.steps;
  if (lengths.period > 0) {
    for (size_t e = 0; e < edges.size(); ++e) {
      const double misfit =
          lengths.values[edges[e].second] - lengths.values[edges[e].first] - steps[e];
      steps[e] += lengths.period * std::round(misfit / lengths.period);
    }
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    std::fill(sums.begin(), sums.end(), 0);
    std::fill(counts.begin(), counts.end(), 0);
    for (size_t e = 0; e < edges.size(); ++e) {
      const auto [i, j] = edges[e];
      if (!lengths.known[i] || !lengths.known[j]) continue;
      sums[j] += lengths.values[i] + steps[e];
      sums[i] += lengths.values[j] - steps[e];
      ++counts[i];
      ++counts[j];
    }
    for (size_t i = 0; i < sums.size(); ++i) {
      if (counts[i] > 0) lengths.values[i] = 0.5 * (lengths.values[i] + sums[i] / counts[i]);
    }
  }
}

Lengths IntegrateProfile(const RevolutionSamples& round, const SamplesAboutAxis& seen) {
  GraphSteps graph{&round.graph.edges, {}, seen.size()};
  for (const auto& [i, j] : round.graph.edges) {
    const Eigen::Vector2d step = seen.places.col(j) - seen.places.col(i);
    graph.steps.push_back(step.dot(TangentOf(seen, i) + TangentOf(seen, j)) / 2);
  }
  // An edge over the axis joins places of one length and does no harm.
  const std::vector<bool> everything(static_cast<size_t>(seen.size()), true);
  const Unwrapped all = Unwrap(graph, everything, std::numeric_limits<double>::infinity());
  std::vector<int> sizes;
  for (const int part : all.part) {
    if (part < 0) continue;
    if (part >= static_cast<int>(sizes.size())) sizes.resize(static_cast<size_t>(part) + 1, 0);
    ++sizes[part];
  }
  Lengths lengths{all.values, std::vector<bool>(all.part.size(), false), 0};
  if (sizes.empty()) return lengths;
  const auto main = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (size_t i = 0; i < all.part.size(); ++i) {
    lengths.known[i] = all.part[i] == main;
    if (!lengths.known[i]) continue;
    low = std::min(low, all.values[i]);
    high = std::max(high, all.values[i]);
  }
  // Round a closed profile the tree's branches come from both sides, and may spiral: values reach
  // over one to two periods.
  const double slip = std::max((high - low) / 4, kSlip * seen.reach);
  const Unwrapped main_part = Unwrap(graph, lengths.known, slip);
  if (!main_part.seams.empty()) {
    const std::vector<double> angles(seen.angles.begin(), seen.angles.end());
    // The band is wide enough where the shape comes nearest to the axis.
    const double narrowest = seen.places.row(0).minCoeff();
    const double width =
        std::min(kChartBand * seen.reach / std::max(narrowest, 1e-300), std::numbers::pi);
    if (ClosedFraction(graph, lengths.known, slip, angles, width, 2 * std::numbers::pi) >=
        kClosedAlong) {
      std::vector<double> periods;
      for (const double misfit : main_part.misfits) periods.push_back(std::abs(misfit));
      lengths.period = Median(std::move(periods));
    }
  }
  Relax(round, graph, lengths);
  return lengths;
}

struct Tangent {
  Eigen::Vector2d place, direction;
};

// Returns the tangent of the parabola fitted to the places near an end of their parameters, no
// farther than `width` from it.
Tangent TangentAt(const Eigen::Matrix2Xd& places,
                  const Eigen::VectorXd& parameters,
                  const Eigen::VectorXd& weights,
                  double end,
                  double width) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Identity() * 1e-9;
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (Eigen::Index k = 0; k < parameters.size(); ++k) {
    const double x = (parameters[k] - end) / width;
    if (std::abs(x) > 1) continue;
    const Eigen::Vector3d row(1, x, x * x);
    normal += weights[k] * row * row.transpose();
    right += weights[k] * row * places.col(k).transpose();
  }
  const Eigen::Matrix<double, 3, 2> c = SymmetricSolution(normal, right);
  Tangent tangent{c.row(0).transpose(), c.row(1).transpose() / width};
  const double speed = tangent.direction.norm();
  if (speed > 0) tangent.direction /= speed;
  return tangent;
}

// Iterative refinement of axis, profile and the nodes' foot points in turn.
class RevolutionSearch {
 public:
  RevolutionSearch(const RevolutionSamples& round, const AxisFrame& frame, ThreadPool& pool)
      : round_(round), pool_(pool) {
    shape_.frame = frame;
    shape_.seen = CylindricalCoordinates(round, frame);
    const Lengths lengths = IntegrateProfile(round, shape_.seen);
    for (Eigen::Index i = 0; i < round.count(); ++i) {
      if (lengths.known[i]) used_.push_back(i);
    }
    if (static_cast<Eigen::Index>(used_.size()) < 2 * kLeastSpans) {
      shape_.misfit = HUGE_VAL;
      return;
    }
    shape_.closed_along = lengths.period > 0;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const Eigen::Index i : used_) {
      low = std::min(low, lengths.values[i]);
      high = std::max(high, lengths.values[i]);
    }
    const double reach = shape_.seen.reach;
    if (!(high > low) || !(reach > 0)) {
      shape_.misfit = HUGE_VAL;
      return;
    }
    const double beyond = shape_.closed_along ? 0 : kBeyond * reach;
    const double range = shape_.closed_along ? lengths.period : high - low + 2 * beyond;
    const double spans =
        std::min(static_cast<double>(used_.size()) / kNodesASpan, range / (kSpan * reach));
    spans_ = static_cast<int>(std::clamp(spans, 1.0 * kLeastSpans, 1.0 * kMostSpans));
    parameters_.resize(static_cast<Eigen::Index>(used_.size()));
    for (Eigen::Index k = 0; k < parameters_.size(); ++k) {
      double s = lengths.values[used_[k]] - low + beyond;
      if (shape_.closed_along) s -= range * std::floor(s / range);
      parameters_[k] = std::clamp(s, 0.0, range);
    }
    weights_ = Eigen::VectorXd::Ones(parameters_.size());
    const Eigen::VectorXd integrated = parameters_;
    FitProfile(range);
    Project();
    // Spans shorter than the scatter of the nodes would let the curve follow the noise.
    const int steady =
        static_cast<int>(std::min(range / (kSpanInScatter * rms_), 1.0 * kMostSpans));
    if (steady < spans_) {
      spans_ = std::max(kLeastSpans, steady);
      parameters_ = integrated;
      FitProfile(range);
      Project();
    }
    FitProfile(range);
    Project();
  }

  bool found() const { return shape_.profile.has_value(); }
  double rms() const { return rms_; }
  bool closed() const { return shape_.closed_along; }
  const AxisFrame& frame() const { return shape_.frame; }

  // `best` is the best rms distance of other searches; a search that stays far behind it stops.
  void Refine(double best) {
    for (int round = 0; round < kRefinements && found(); ++round) {
      const double before = rms_;
      MoveAxis();
      FitProfile(shape_.profile->range());
      Project();
      if (rms_ > kFarBehind * best && rms_ > kHardlyMoves * before) return;
    }
  }

  RevolutionEstimate Take() && {
    if (found()) {
      shape_.feet.assign(static_cast<size_t>(round_.count()), 0);
      for (Eigen::Index k = 0; k < parameters_.size(); ++k) shape_.feet[used_[k]] = parameters_[k];
      shape_.low = parameters_.minCoeff();
      shape_.high = parameters_.maxCoeff();
    }
    return std::move(shape_);
  }

 private:
  void FitProfile(double range) {
    Eigen::Matrix2Xd places = shape_.seen.places(Eigen::all, used_);
    if (shape_.closed_along) {
      shape_.profile.emplace(places, parameters_, weights_, range, spans_, true, pool_);
      return;
    }
    // Beyond its ends an open profile goes straight on.
    const Eigen::Index n = parameters_.size();
    const double low = parameters_.minCoeff(), high = parameters_.maxCoeff();
    Eigen::Matrix2Xd all(2, n + 2 * kStraight);
    Eigen::VectorXd at(all.cols()), weights(all.cols());
    all.leftCols(n) = places;
    at.head(n) = parameters_;
    weights.head(n) = weights_;
    const double weight = static_cast<double>(n) / range * kBeyond * shape_.seen.reach / kStraight;
    weights.tail(2 * kStraight).setConstant(weight);
    const double width = std::min(kEnd * shape_.seen.reach, (high - low) / 2);
    const Tangent first = TangentAt(places, parameters_, weights_, low, width),
                  last = TangentAt(places, parameters_, weights_, high, width);
    for (int i = 0; i < kStraight; ++i) {
      const double part = (i + 0.5) / kStraight;
      const double before = low * (1 - part), behind = high + (range - high) * part;
      at[n + i] = before;
      all.col(n + i) = first.place + (before - low) * first.direction;
      at[n + kStraight + i] = behind;
      all.col(n + kStraight + i) = last.place + (behind - high) * last.direction;
    }
    shape_.profile.emplace(all, at, weights, range, spans_, false, pool_);
  }

  // Updates the foot points, and the weights from the nodes' distances.
  void Project() {
    const BaseProfile& profile = *shape_.profile;
    const auto n = static_cast<Eigen::Index>(used_.size());
    off_.resize(n);
    normals_.resize(2, n);
    pool_.For(n, 128, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (auto k = begin; k < end; ++k) {
        const Eigen::Vector2d place = shape_.seen.places.col(used_[k]);
        parameters_[k] = profile.Foot(place);
        const BaseProfile::Jet jet = profile.At(parameters_[k]);
        normals_.col(k) = Eigen::Vector2d(jet.first[1], -jet.first[0]).normalized();
        off_[k] = (place - jet.place).dot(normals_.col(k));
      }
    });
    const double scale = RobustScale(off_);
    rms_ = std::sqrt(off_.squaredNorm() / static_cast<double>(n));
    shape_.misfit = rms_ / std::max(shape_.seen.mean_radius, 1e-300);
    if (!(scale > 0)) return;
    weights_ = (1 + (off_ / (kCauchy * scale)).array().square()).inverse();
  }

  // Makes a Gauss–Newton step of tilt, shift and offsets of the profile, piecewise linear along it.
  void MoveAxis() {
    const int hats = std::clamp(spans_, 4, 16);
    const double range = shape_.profile->range();
    const double unit = round_.size;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(4 + hats + 1, 4 + hats + 1);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(4 + hats + 1);
    for (Eigen::Index k = 0; k < off_.size(); ++k) {
      const Eigen::Index i = used_[k];
      const double r = shape_.seen.places(0, i), z = shape_.seen.places(1, i);
      const double cosine = std::cos(shape_.seen.angles[i]), sine = std::sin(shape_.seen.angles[i]);
      const double nr = normals_(0, k), nz = normals_(1, k);
      const double lever = (r * nz - z * nr) / unit;
      const double at = std::clamp(parameters_[k] / range * hats, 0.0, hats - 1e-9);
      const int hat = static_cast<int>(at);
      const int next = shape_.closed_along ? (hat + 1) % hats : hat + 1;
      const double part = at - hat;
      const int columns[6] = {0, 1, 2, 3, 4 + hat, 4 + next};
      const double row[6] = {nr * cosine, nr * sine, lever * sine, -lever * cosine, 1 - part, part};
      for (int a = 0; a < 6; ++a) {
        right[columns[a]] -= weights_[k] * row[a] * off_[k];
        for (int b = 0; b < 6; ++b) {
          normal(columns[a], columns[b]) += weights_[k] * row[a] * row[b];
        }
      }
    }
    constexpr double kHeld = 1e-6;  // what the nodes leave open stays
    normal.diagonal().array() += kHeld * weights_.sum();
    const Eigen::VectorXd step = SymmetricSolution(normal, right);
    if (!step.allFinite()) return;
    constexpr double kLongest = 0.3;
    const double length =
        std::max(step.segment<2>(0).norm() / unit, step.segment<2>(2).norm() / unit);
    const double shorter = length > kLongest ? kLongest / length : 1;
    const AxisFrame moved =
        shape_.frame.Moved(shorter / unit * Eigen::Vector3d(step[2], step[3], 0),
                           shorter * Eigen::Vector3d(step[0], step[1], 0));
    shape_.frame = moved;
    shape_.seen = CylindricalCoordinates(round_, moved);
  }

  const RevolutionSamples& round_;
  ThreadPool& pool_;
  RevolutionEstimate shape_;
  std::vector<Eigen::Index> used_;  // nodes that have a place along the profile
  Eigen::VectorXd parameters_, weights_, off_;
  Eigen::Matrix2Xd normals_;
  int spans_ = kLeastSpans;
  double rms_ = HUGE_VAL;  // distance of the nodes
};

}  // namespace

RevolutionEstimate FindRevolution(const RevolutionSamples& round, ThreadPool& pool) {
  std::vector<AxisFrame> axes =
      AxesOfRotation(round.nodes().places, round.nodes().normals, round.centre, round.size);
  const std::vector<AxisFrame> others = AxesOfInertia(round.nodes().places, round.centre);
  axes.insert(axes.end(), others.begin(), others.end());
  const double good = kGoodInNoise * round.noise + kGoodInSizes * round.size;
  std::optional<RevolutionSearch> best;
  for (const AxisFrame& axis : axes) {
    RevolutionSearch search(round, axis, pool);
    search.Refine(best ? best->rms() : HUGE_VAL);
    if (!best || search.rms() < best->rms()) best.emplace(std::move(search));
    if (best->rms() < good) break;
  }
  {  // the profile integrated about a better axis
    RevolutionSearch search(round, best->frame(), pool);
    search.Refine(HUGE_VAL);
    if (search.rms() < best->rms() || (search.closed() && !best->closed())) {
      best.emplace(std::move(search));
    }
  }
  return std::move(*best).Take();
}

RevolutionEstimate WithPreferredAxis(RevolutionEstimate found,
                                     const RevolutionSamples& round,
                                     const std::optional<AxisFrame>& preferred,
                                     ThreadPool& pool) {
  if (!preferred) return found;
  RevolutionSearch search(round, *preferred, pool);
  const double rms = found.misfit * found.seen.mean_radius;
  if (search.found() && search.rms() <= kAsGood * rms + kSame * round.size)
    return std::move(search).Take();
  return found;
}

}  // namespace batten::internal
