// SPDX-License-Identifier: MIT
#include "fitting/wings/wing_layout.h"

#include <Eigen/QR>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/nurbs_surface.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/wings/density_end.h"
#include "fitting/wings/sheet_sides.h"
#include "fitting/wings/wing_frame.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr int kEdgeRounds = 3;
// Window of the search for an end, in h and noises: wide against both, narrow against the shape.
constexpr double kWindowInSpacings = 5, kWindowInNoises = 12;
constexpr double kTipWindow = 6;     // h
constexpr double kWedgeFrom = 8;     // noises of thickness: sides are clear beyond
constexpr double kWedgeTo = 0.12;    // of the chord: the wedge at the edge ends here
constexpr double kMostBlunt = 0.25;  // thickness at the edge over that amid its wedge
constexpr Eigen::Index kFewestInWedge = 60;
constexpr int kModelCells = 24, kModelCellsAlong = 3;  // of the net by which sides are dealt out
constexpr int kPins = 200;                             // places of the edge in that net
constexpr double kPinWeight = 100;
constexpr double kModelSmoothing = 1e-6;
constexpr int kEdgeSamples = 41;

// Even in 0 … 1 by the point's coordinates alone, so that no order of the points counts.
// [SplitMix64: Steele, Lea & Flood 2014]
double EvenBy(const Eigen::Vector3d& point) {
  std::uint64_t bits = 0x9e3779b97f4a7c15u;
  for (const double x : point) {
    bits += std::bit_cast<std::uint64_t>(x);
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
    bits ^= bits >> 31;
  }
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

class WingLayer {
 public:
  WingLayer(const Eigen::Matrix3Xd& points,
            const SheetSides& sides,
            double noise,
            double margin,
            ThreadPool& pool)
      : points_(points),
        sides_(sides),
        noise_(std::max(noise, 1e-3 * sides.spacing)),
        margin_(margin),
        pool_(pool),
        places_(static_cast<size_t>(points.cols())),
        side_(static_cast<size_t>(points.cols()), 0),
        around_(points.cols()),
        share_(points.cols()) {}

  WingParameters Run(WingFrame frame) {
    frame_ = std::move(frame);
    for (int round = 0; round < kEdgeRounds; ++round) {
      Place();
      if (!MoveEdge()) return Failed("no line was found where its sides end");
    }
    Place();
    if (const double blunt = Bluntness(); !(blunt < kMostBlunt))
      return Failed("its sides do not meet in a sharp edge: " + Percent(blunt) +
                    " of their distance is left there");
    for (Eigen::Index k = 0; k < points_.cols(); ++k)
      around_[k] = frame_.Around(places_[static_cast<size_t>(k)], side_[static_cast<size_t>(k)]);
    if (!CutTips()) return Failed("no lines were found where its tips end");
    DealOutSides();
    return Result();
  }

 private:
  static WingParameters Failed(std::string reason) {
    WingParameters failed;
    failed.failure_reason = std::move(reason);
    return failed;
  }

  void Place() {
    pool_.For(points_.cols(), 1000, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t k = begin; k < end; ++k) {
        WingPlace& place = places_[static_cast<size_t>(k)];
        place = frame_.PlaceOf(points_.col(k));
        if (!sides_.labelled[k]) continue;
        const Eigen::Vector3d across = frame_.AxesAt(place.v).col(1);
        side_[static_cast<size_t>(k)] =
            frame_.facing * sides_.normals.col(k).dot(across) > 0 ? 1 : -1;
      }
    });
  }

  const WingPlace& At(Eigen::Index k) const { return places_[static_cast<size_t>(k)]; }

  // Moves the edge to where points end, and between the sides.
  bool MoveEdge() {
    std::vector<Eigen::Index> near;
    const double window = std::max(kWindowInSpacings * sides_.spacing, kWindowInNoises * noise_);
    for (Eigen::Index k = 0; k < points_.cols(); ++k)
      if (At(k).v >= 0 && At(k).v <= 1 && (1 - At(k).along) * frame_.chord < 3 * window)
        near.push_back(k);
    const auto count = std::ssize(near);
    EndingPoints ending{Eigen::MatrixXd(count, 4), Eigen::VectorXd(count), Eigen::VectorXd(count)};
    for (Eigen::Index i = 0; i < count; ++i) {
      const WingPlace& place = At(near[static_cast<size_t>(i)]);
      const double t = 2 * place.v - 1;
      ending.along.row(i) << 1, t, t * t, t * t * t;
      ending.reach[i] = (place.along - 1) * frame_.ChordAt(place.v);
      ending.place[i] = place.v;
    }
    const std::optional<Eigen::VectorXd> end = EndOfPoints(ending, noise_, window);
    if (!end) return false;
    // Heights over the chord: a line along the edge, and slopes of both sides before it.
    std::vector<Eigen::Index> wedge;
    for (Eigen::Index i = 0; i < count; ++i)
      if (ending.reach[i] > ending.along.row(i).dot(*end) - window) wedge.push_back(i);
    if (std::ssize(wedge) < kFewestInWedge) return false;
    Eigen::MatrixXd rows(std::ssize(wedge), 6);
    Eigen::VectorXd heights(std::ssize(wedge));
    for (Eigen::Index r = 0; r < rows.rows(); ++r) {
      const Eigen::Index i = wedge[static_cast<size_t>(r)], k = near[static_cast<size_t>(i)];
      const double before = ending.along.row(i).dot(*end) - ending.reach[i];
      rows.row(r) << ending.along.row(i), before, before * side_[static_cast<size_t>(k)];
      heights[r] = At(k).above * frame_.ChordAt(At(k).v);
    }
    const Eigen::VectorXd lines = rows.colPivHouseholderQr().solve(heights);
    Eigen::VectorXd v(kEdgeSamples);
    Eigen::Matrix3Xd moved(3, kEdgeSamples);
    for (int s = 0; s < kEdgeSamples; ++s) {
      v[s] = s / (kEdgeSamples - 1.0);
      const double t = 2 * v[s] - 1;
      const Eigen::Vector4d powers(1, t, t * t, t * t * t);
      const Eigen::Matrix3d axes = frame_.AxesAt(v[s]);
      moved.col(s) = frame_.edge.At(v[s]) + axes.col(0) * powers.dot(*end) +
                     axes.col(1) * powers.dot(lines.head<4>());
    }
    frame_.edge = WingLine(v, moved);
    return true;
  }

  // What is left of the sides' distance at the edge, by straight sides in the wedge before it, over
  // their distance amid the wedge.
  double Bluntness() {
    std::vector<Eigen::Index> wedge;
    for (Eigen::Index k = 0; k < points_.cols(); ++k) {
      const WingPlace& place = At(k);
      const double before = 1 - place.along;
      if (side_[static_cast<size_t>(k)] == 0 || place.v < 0 || place.v > 1 || before > kWedgeTo)
        continue;
      if (std::abs(place.above) * frame_.chord * 2 > kWedgeFrom * noise_) wedge.push_back(k);
    }
    if (std::ssize(wedge) < kFewestInWedge) return HUGE_VAL;
    Eigen::MatrixX4d rows(std::ssize(wedge), 4);
    Eigen::VectorXd heights(std::ssize(wedge));
    double middle = 0;
    for (Eigen::Index r = 0; r < rows.rows(); ++r) {
      const Eigen::Index k = wedge[static_cast<size_t>(r)];
      const double before = 1 - At(k).along;
      const int side = side_[static_cast<size_t>(k)];
      rows.row(r) << side, side * before, 1, before;
      heights[r] = At(k).above;
      middle += before / static_cast<double>(rows.rows());
    }
    const Eigen::Vector4d line = rows.colPivHouseholderQr().solve(heights);
    slope_ = line[1];
    return line[0] / (line[0] + line[1] * middle);
  }

  // Functions of `around` that a tip's line is a sum of: equal at both sides of the edge.
  static Eigen::RowVector4d OfTip(double around) {
    const double square = around * around;
    return {1, square, around * (square - 1), square * (square - 1)};
  }

  // Scales v so that tips are at 0 and 1.
  bool CutTips() {
    const auto count = points_.cols();
    std::array<Eigen::VectorXd, 2> ends;
    for (int tip = 0; tip < 2; ++tip) {
      EndingPoints ending{
          Eigen::MatrixXd(count, 4), Eigen::VectorXd(count), Eigen::VectorXd(count)};
      for (Eigen::Index k = 0; k < count; ++k) {
        const double around = std::clamp(around_[k], -1.0, 1.0);
        ending.along.row(k) = OfTip(around);
        ending.reach[k] = (tip == 0 ? -At(k).v : At(k).v - 1) * frame_.span;
        ending.place[k] = (around + 1) / 2;
      }
      const std::optional<Eigen::VectorXd> end = EndOfPoints(
          ending, noise_, std::max(kTipWindow * sides_.spacing, kWindowInNoises * noise_));
      if (!end) return false;
      ends[static_cast<size_t>(tip)] = *end / frame_.span;
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::RowVector4d row = OfTip(std::clamp(around_[k], -1.0, 1.0));
      const double low = -row.dot(ends[0]), high = 1 + row.dot(ends[1]);
      share_[k] = (At(k).v - low) / (high - low);
    }
    const Eigen::RowVector4d at_edge = OfTip(1);
    edge_from_ = -at_edge.dot(ends[0]);
    edge_to_ = 1 + at_edge.dot(ends[1]);
    return true;
  }

  double beyond() const { return margin_ / frame_.span; }
  double EdgeAt(double share) const { return edge_from_ + share * (edge_to_ - edge_from_); }

  // A net through the points whose side is clear and the edge.
  NurbsSurface Model(const std::vector<Eigen::Index>& clear) const {
    const auto count = std::ssize(clear);
    auto data = std::make_shared<FittingData>();
    data->parameters.resize(2, count + 2 * kPins);
    data->values.resize(3, count + 2 * kPins);
    data->weights = Eigen::VectorXd::Ones(count + 2 * kPins);
    data->weights.tail(2 * kPins).setConstant(kPinWeight);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index k = clear[static_cast<size_t>(i)];
      data->parameters.col(i) = Parameters(around_[k], share_[k]);
      data->values.col(i) = points_.col(k);
    }
    for (int pin = 0; pin < kPins; ++pin) {
      const double share = -beyond() + (1 + 2 * beyond()) * pin / (kPins - 1.0);
      for (int side = 0; side < 2; ++side) {
        data->parameters.col(count + 2 * pin + side) = Parameters(2 * side - 1, share);
        data->values.col(count + 2 * pin + side) = frame_.edge.At(EdgeAt(share));
      }
    }
    const FittingProblem problem(FittingBasis(3, kModelCells, -1, 1),
                                 FittingBasis(3, kModelCellsAlong, -beyond(), 1 + beyond()),
                                 data,
                                 kModelSmoothing);
    return {problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool_).coefficients};
  }

  Eigen::Vector2d Parameters(double around, double share) const {
    return {std::clamp(around, -1.0, 1.0), std::clamp(share, -beyond(), 1 + beyond())};
  }

  // Gives points whose side is not clear one by its probability beside a net of the others.
  void DealOutSides() {
    std::vector<Eigen::Index> clear, unclear;
    for (Eigen::Index k = 0; k < points_.cols(); ++k) {
      const double thickness = 2 * slope_ * (1 - At(k).along) * frame_.chord;
      const bool is_clear =
          frame_.IsAtNose(At(k)) || (side_[static_cast<size_t>(k)] != 0 &&
                                     (At(k).along < 0.5 || thickness > kWedgeFrom * noise_));
      (is_clear ? clear : unclear).push_back(k);
    }
    if (unclear.empty()) return;
    const NurbsSurface model = Model(clear);
    const auto count = std::ssize(unclear);
    const Eigen::Matrix3Xd places = points_(Eigen::all, unclear);
    std::array<Eigen::VectorXd, 2> distances;
    for (int side = 0; side < 2; ++side) {
      Eigen::Matrix2Xd start(2, count);
      for (Eigen::Index i = 0; i < count; ++i) {
        const Eigen::Index k = unclear[static_cast<size_t>(i)];
        const double amount = std::abs(around_[k]);
        start.col(i) = Parameters(side == 0 ? -amount : amount, share_[k]);
      }
      distances[static_cast<size_t>(side)] = DistancesFrom(model, places, start, pool_).distances;
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index k = unclear[static_cast<size_t>(i)];
      const double odds = (distances[0][i] * distances[0][i] - distances[1][i] * distances[1][i]) /
                          (2 * noise_ * noise_);
      const double upper = 1 / (1 + std::exp(-std::clamp(odds, -500.0, 500.0)));
      const bool on_upper = EvenBy(points_.col(k)) < upper;
      around_[k] = std::copysign(around_[k], on_upper ? 1.0 : -1.0);
    }
  }

  WingParameters Result() const {
    WingParameters result;
    result.length_u = 2 * frame_.chord;
    result.length_v = frame_.span * (1 + 2 * beyond());
    result.parameters.resize(2, points_.cols());
    for (Eigen::Index k = 0; k < points_.cols(); ++k) {
      const Eigen::Vector2d at = Parameters(around_[k], share_[k]);
      result.parameters.col(k) << std::clamp(
          (at[0] + 1) / 2 * result.length_u, 0.0, result.length_u),
          std::clamp((at[1] + beyond()) * frame_.span, 0.0, result.length_v);
    }
    result.edge.emplace(SplineBasis::Uniform(3, 4, 0, result.length_v),
                        frame_.edge.BezierPoints(EdgeAt(-beyond()), EdgeAt(1 + beyond())));
    return result;
  }

  const Eigen::Matrix3Xd& points_;
  const SheetSides& sides_;
  double noise_, margin_;
  ThreadPool& pool_;
  WingFrame frame_;
  std::vector<WingPlace> places_;
  std::vector<int> side_;               // 1 upper, −1 lower, 0 unknown
  Eigen::VectorXd around_, share_;      // −1 … 1 round the nose, 0 … 1 from tip to tip
  double slope_ = 0;                    // of either side before the edge, to the chord
  double edge_from_ = 0, edge_to_ = 1;  // the edge's tips, in its own v
};

}  // namespace

WingParameters LayWing(const Eigen::Matrix3Xd& points,
                       const NeighbourIndex& index,
                       double noise,
                       double margin,
                       ThreadPool& pool) {
  WingParameters result;
  const SheetSides sides = TellSidesApart(points, index, noise);
  if (!sides.ok()) {
    result.failure_reason = sides.failure_reason;
    return result;
  }
  const std::vector<std::vector<Eigen::Index>> ends = EndsOfSections(points, sides);
  result.failure_reason = "no sides of a thin section meet";
  for (size_t end = 0; end < ends.size(); ++end) {
    WingFrame frame = FrameOf(
        points, sides, ends[end], ends.size() > 1 ? ends[1 - end] : std::vector<Eigen::Index>{});
    if (!frame.ok()) {
      result.failure_reason = frame.failure_reason;
      continue;
    }
    result = WingLayer(points, sides, noise, margin, pool).Run(std::move(frame));
    if (result.ok()) break;
  }
  return result;
}

}  // namespace batten::internal
