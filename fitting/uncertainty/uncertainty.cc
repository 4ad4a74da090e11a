// SPDX-License-Identifier: MIT
#include "batten/fitting/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/shared_constants.h"
#include "fitting/uncertainty/normal_form.h"

namespace batten {
using namespace internal;
namespace {

// M⁻¹AM⁻¹ is minus the derivative of (M + sA)⁻¹ by s at 0, and A ≤ M: central differences at this
// step are exact to its square.
constexpr double kStep = 1e-3;
constexpr double kHold = 1e9;      // weight of a held point against the heaviest of the others
constexpr double kJitter = 1e-12;  // of the greatest diagonal entry: unknowns without data

// The places of the images of the feet of points on a mirrored surface.
Eigen::Matrix2Xd ImagesOf(const NurbsSurface& surface,
                          const MirrorPlane& plane,
                          const Eigen::Matrix2Xd& parameters,
                          ThreadPool& pool) {
  Eigen::Matrix3Xd images(3, parameters.cols());
  for (Eigen::Index k = 0; k < images.cols(); ++k)
    images.col(k) = plane.Mirrored(surface.At(parameters(0, k), parameters(1, k)));
  const NurbsSurface whole(
      surface.basis_u(), surface.basis_v(), surface.control_points(), surface.weights());
  const std::vector<SurfaceFoot> feet = SurfaceFootPoints(whole).Nearest(images, pool);
  Eigen::Matrix2Xd places(2, images.cols());
  for (Eigen::Index k = 0; k < images.cols(); ++k)
    places.col(k) << feet[static_cast<size_t>(k)].u, feet[static_cast<size_t>(k)].v;
  return places;
}

}  // namespace

struct Uncertainty::State {
  DisplacementRows rows;
  WeighedPoints points;
  std::optional<Eigen::Matrix2Xd> images;  // of the feet, where the surface is mirrored
  ThreadPool pool;
  Eigen::SparseMatrix<double> spread;             // A; of mirrored surfaces what it spreads
  std::optional<SelectedInverse> less, more, at;  // (M ∓ step·A)⁻¹ and M⁻¹
  Eigen::MatrixXd bias;                           // of the control points: n × d, times Z
  double variance = 0, inflation = 1, freedom = 0;

  State(SplineShape shape, const FitEstimator& estimator, WeighedPoints weighed, int threads)
      : rows(std::move(shape), estimator), points(std::move(weighed)), pool(threads) {}

  SparseRow RowOf(Eigen::Index k) const {
    SparseRow row = rows.At(points.parameters(0, k), points.parameters(1, k));
    if (!images) return row;
    const SparseRow image = rows.At((*images)(0, k), (*images)(1, k));
    row.insert(row.end(), image.begin(), image.end());
    return Merged(std::move(row));
  }
  // What the fit takes of the variance of Σ w r over points, of the sum of whose rows this is the
  // form: of a mirrored surface half of each row is the image's.
  double Taken(const SparseRow& row) const {
    return images ? Prior(row) - Spread(row) / 4 : 2 * Prior(row) - Spread(row);
  }
  double Prior(const SparseRow& row) const { return (less->Form(row) + more->Form(row)) / 2; }
  double Spread(const SparseRow& row) const {
    return std::max(0.0, (less->Form(row) - more->Form(row)) / (2 * kStep));
  }

  void Estimate(const FitEstimator& estimator);
  void Invert(const FitEstimator& estimator);
  void EstimateNoise();
  double Lambda(const FitEstimator& estimator, const Eigen::SparseMatrix<double>& fairness) const;
};

// λ of the fit, over the mean slope of the loss: A here has the points' own weights.
double Uncertainty::State::Lambda(const FitEstimator& estimator,
                                  const Eigen::SparseMatrix<double>& fairness) const {
  const double roughness = fairness.diagonal().sum();
  if (!(roughness > 0)) return 0;
  double trace = 0;
  for (Eigen::Index k = 0; k < points.size(); ++k) {
    const ShapePlace place =
        PlaceOn(rows.shape(), points.parameters(0, k), points.parameters(1, k));
    trace += points.weights[k] * points.pulled[k] * place.functions.squaredNorm();
  }
  return estimator.smoothing * trace / roughness / points.slope * (images ? 2 : 1);
}

void Uncertainty::State::Invert(const FitEstimator& estimator) {
  const Eigen::SparseMatrix<double> map = rows.Map(), fairness = rows.Fairness(estimator.energy);
  const double lambda = Lambda(estimator, fairness);
  spread = NormalForm(rows, points, [this](Eigen::Index k) { return RowOf(k); });
  Eigen::SparseMatrix<double> matrix = spread;
  if (images) {
    const auto at = [this](const Eigen::Matrix2Xd& feet) {
      return NormalForm(
          rows, points, [&](Eigen::Index k) { return rows.At(feet(0, k), feet(1, k)); });
    };
    matrix = at(points.parameters) + at(*images);
  }
  matrix += Eigen::SparseMatrix<double>(lambda * (map.transpose() * fairness * map));
  const double greatest = Eigen::VectorXd(spread.diagonal()).maxCoeff();
  std::vector<Eigen::Triplet<double>> added;
  for (int k = 0; k < rows.unknowns(); ++k) added.emplace_back(k, k, kJitter * greatest);
  // Weights are known to a factor e, and knots to a gap: what the data leave open stays there.
  const double rough =
      points.pulls.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, points.size()));
  for (int k = rows.first_weight(); k < rows.first_knot(); ++k) added.emplace_back(k, k, rough);
  for (size_t k = 0; k < rows.knot_gaps().size(); ++k) {
    const int at = rows.first_knot() + static_cast<int>(k);
    added.emplace_back(at, at, rough / (rows.knot_gaps()[k] * rows.knot_gaps()[k]));
  }
  for (Eigen::Index k = 0; k < estimator.held_points.cols(); ++k) {
    const SparseRow row = rows.At(estimator.held_points(0, k), estimator.held_points(1, k));
    for (const auto& [i, a] : row)
      for (const auto& [j, b] : row) added.emplace_back(i, j, kHold * greatest * a * b);
  }
  Eigen::SparseMatrix<double> more_terms(rows.unknowns(), rows.unknowns());
  more_terms.setFromTriplets(added.begin(), added.end());
  matrix += more_terms;
  less.emplace(Eigen::SparseMatrix<double>(matrix - kStep * spread));
  more.emplace(Eigen::SparseMatrix<double>(matrix + kStep * spread));
  at.emplace(matrix);
  const Eigen::MatrixXd rough_points = fairness * rows.shape().points.transpose();
  bias = -lambda * at->Solve(map.transpose() * rough_points);
}

void Uncertainty::State::EstimateNoise() {
  const Eigen::Index count = points.size();
  std::vector<double> taken(
      static_cast<size_t>((count + kSlowPointsPerTask - 1) / kSlowPointsPerTask), 0);
  pool.For(count, kSlowPointsPerTask, [&](Eigen::Index begin, Eigen::Index end) {
    for (Eigen::Index k = begin; k < end; ++k) {
      taken[static_cast<size_t>(begin / kSlowPointsPerTask)] += points.weights[k] * Taken(RowOf(k));
    }
  });
  double trace = 0;
  for (const double part : taken) trace += part;
  freedom = points.components * (static_cast<double>(count) - trace);
  if (!(freedom >= 1)) {
    throw std::invalid_argument(
        "Uncertainty: fit: its points leave no freedom to estimate their noise by: more points, or "
        "fewer control points, are needed");
  }
  const double squares = points.pulls.colwise().squaredNorm().dot(points.weights.transpose());
  variance = squares / freedom / (points.slope * points.slope);
}

void Uncertainty::State::Estimate(const FitEstimator& estimator) {
  Invert(estimator);
  EstimateNoise();
  inflation = SharedNoise(
      rows,
      points,
      [this](Eigen::Index k) { return RowOf(k); },
      [this](const SparseRow& row) { return Taken(row); },
      variance);
}

Uncertainty::Uncertainty(const SurfaceFit& fit, const PointCloud& cloud, int threads)
    : state_(std::make_unique<State>(
          SplineShape(fit.surface), fit.estimator, Weigh(fit, cloud), threads)) {
  if (fit.estimator.symmetric) {
    state_->images =
        ImagesOf(fit.surface, *fit.estimator.symmetric, state_->points.parameters, state_->pool);
  }
  state_->Estimate(fit.estimator);
}

Uncertainty::Uncertainty(const CurveFit<2>& fit, const PointCloud& cloud, int threads)
    : state_(std::make_unique<State>(
          SplineShape(fit.curve), fit.estimator, Weigh(fit, cloud), threads)) {
  state_->Estimate(fit.estimator);
}

Uncertainty::Uncertainty(const CurveFit<3>& fit, const PointCloud& cloud, int threads)
    : state_(std::make_unique<State>(
          SplineShape(fit.curve), fit.estimator, Weigh(fit, cloud), threads)) {
  state_->Estimate(fit.estimator);
}

Uncertainty::~Uncertainty() = default;
Uncertainty::Uncertainty(Uncertainty&&) noexcept = default;
Uncertainty& Uncertainty::operator=(Uncertainty&&) noexcept = default;

double Uncertainty::noise() const { return std::sqrt(state_->variance); }
double Uncertainty::inflation() const { return state_->inflation; }
double Uncertainty::freedom() const { return state_->freedom; }

std::vector<PlaceUncertainty> Uncertainty::At(const Eigen::Matrix2Xd& parameters) const {
  State& state = *state_;
  std::vector<PlaceUncertainty> places(static_cast<size_t>(parameters.cols()));
  const Eigen::SparseMatrix<double> map = state.rows.Map();
  const Eigen::MatrixXd moved = map * state.bias;
  const int size_v = state.rows.shape().size_v();
  state.pool.For(parameters.cols(), kSlowPointsPerTask, [&](Eigen::Index begin, Eigen::Index end) {
    for (Eigen::Index k = begin; k < end; ++k) {
      const double u = parameters(0, k), v = parameters(1, k);
      const SparseRow row = state.rows.At(u, v);
      const double prior = state.Prior(row), spread = state.Spread(row);
      PlaceUncertainty& place = places[static_cast<size_t>(k)];
      place.deviation = std::sqrt(state.variance * state.inflation * spread);
      place.support = prior > 0 ? std::min(1.0, spread / prior) : 1;
      const ShapePlace on = PlaceOn(state.rows.shape(), u, v);
      Eigen::Vector3d shift = Eigen::Vector3d::Zero();
      for (int i = 0, f = 0; i < on.count_u; ++i) {
        for (int j = 0; j < on.count_v; ++j, ++f)
          shift.head(moved.cols()) +=
              on.functions[f] * moved.row(on.Index(i, j, size_v)).transpose();
      }
      place.bias = on.normal.dot(shift);
    }
  });
  return places;
}

PlaceUncertainty Uncertainty::At(double u, double v) const {
  return At(Eigen::Matrix2Xd(Eigen::Vector2d(u, v))).front();
}

Eigen::MatrixXd Uncertainty::Covariance(const std::vector<ShapeFunctional>& functionals) const {
  const State& state = *state_;
  const int unknowns = state.rows.unknowns();
  Eigen::MatrixXd columns =
      Eigen::MatrixXd::Zero(unknowns, static_cast<Eigen::Index>(functionals.size()));
  for (size_t k = 0; k < functionals.size(); ++k) {
    for (const DisplacementTerm& term : functionals[k])
      for (const auto& [index, value] : state.rows.At(term.u, term.v))
        columns(index, static_cast<Eigen::Index>(k)) += term.factor * value;
  }
  const Eigen::MatrixXd solved = state.at->Solve(columns);
  return state.variance * state.inflation * solved.transpose() * (state.spread * solved);
}

}  // namespace batten
