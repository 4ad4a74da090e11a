// SPDX-License-Identifier: MIT
#include "batten/geometry/curvature_range.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "batten/geometry/curvature.h"
#include "geometry/bezier/spline_pieces.h"
#include "batten/geometry/trim_region.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/constants.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kUnbounded = 1e7;  // times one over the size
constexpr double kFinest = 1e-8;    // of a span

// Beyond the bound a curvature is infinite.
double Limited(double curvature, double size) {
  return std::abs(curvature) * size > kUnbounded ? std::copysign(kInfinity, curvature) : curvature;
}

// Times sign; −∞ where there is none, so that it is never the greatest.
double CurvatureOfPiece(const CurvePiece& piece, double t, double sign) {
  const CurvePieceJet jet = JetOf(piece, t);
  const auto curvature = CurvatureOf(jet.first, jet.second, jet.third);
  return curvature ? sign * curvature->curvature : -kInfinity;
}

// The greatest value of f in [low, high]. [Kiefer 1953]
template <typename Function>
double GoldenSection(Function f, double low, double high) {
  constexpr double kRatio = 0.6180339887498949;
  double a = high - kRatio * (high - low), b = low + kRatio * (high - low);
  double fa = f(a), fb = f(b);
  double greatest = std::max(fa, fb);
  while (high - low > kFinest) {
    if (fa > fb) {
      high = b;
      b = a;
      fb = fa;
      a = high - kRatio * (high - low);
      fa = f(a);
      greatest = std::max(greatest, fa);
    } else {
      low = a;
      a = b;
      fa = fb;
      b = low + kRatio * (high - low);
      fb = f(b);
      greatest = std::max(greatest, fb);
    }
  }
  return greatest;
}

double GreatestOn(const CurvePiece& piece, double sign) {
  const int count = 4 * piece.degree() + 8;
  const auto f = [&](double t) { return CurvatureOfPiece(piece, t, sign); };
  std::vector<double> samples;
  for (int k = 0; k <= count; ++k) samples.push_back(f(static_cast<double>(k) / count));
  double greatest = *std::max_element(samples.begin(), samples.end());
  for (int k = 0; k <= count; ++k) {
    const int before = std::max(0, k - 1), after = std::min(count, k + 1);
    if (samples[k] < samples[before] || samples[k] < samples[after]) continue;
    greatest = std::max(
        greatest,
        GoldenSection(f, static_cast<double>(before) / count, static_cast<double>(after) / count));
  }
  return greatest;
}

// The upper principal curvature of the piece turned by `sign`, at regular places. Nothing counts
// outside the region.
class PieceCurvature {
 public:
  PieceCurvature(const SurfacePiece& piece, const TrimRegion& region, int side)
      : piece_(piece), region_(region) {
    double du = 0, dv = 0;
    for (int i = 0; i <= side; ++i) {
      for (int j = 0; j <= side; ++j) {
        jets_.push_back(JetOf(piece, static_cast<double>(i) / side, static_cast<double>(j) / side));
        du = std::max(du, jets_.back().du.norm());
        dv = std::max(dv, jets_.back().dv.norm());
      }
    }
    constexpr double kRegular = 1e-4;
    least_ = kRegular * du * dv;
  }

  const std::vector<SurfaceJet>& jets() const { return jets_; }

  std::optional<SurfaceCurvature> Of(const SurfaceJet& jet) const {
    if (!(jet.du.cross(jet.dv).norm() > least_)) return std::nullopt;
    return CurvatureOf(jet);
  }

  bool Counts(const Eigen::Vector2d& at) const {
    return region_.Contains(piece_.u0 + at[0] * (piece_.u1 - piece_.u0),
                            piece_.v0 + at[1] * (piece_.v1 - piece_.v0));
  }

  double At(const Eigen::Vector2d& at, double sign) const {
    if (!Counts(at)) return -kInfinity;
    const auto curvature = Of(JetOf(piece_, at[0], at[1]));
    if (!curvature) return -kInfinity;
    return sign > 0 ? curvature->principal_high : -curvature->principal_low;
  }

  // What curvature does a millionth of a piece inside a place where it is none.
  std::optional<SurfaceCurvature> Beside(const Eigen::Vector2d& at) const {
    constexpr double kBeside = 1e-6;
    const auto inward = [](double x) { return x < 0.5 ? x + kBeside : x - kBeside; };
    return CurvatureOf(JetOf(piece_, inward(at[0]), inward(at[1])));
  }

 private:
  const SurfacePiece& piece_;
  const TrimRegion& region_;
  std::vector<SurfaceJet> jets_;
  double least_ = 0;
};

// Steps to the best of eight neighbours: twice as long after each that leads upwards, half as long
// where none does.
double Climbed(const PieceCurvature& curvature, Eigen::Vector2d at, double step, double sign) {
  constexpr int kMostSteps = 400;
  const double longest = step;
  double greatest = curvature.At(at, sign);
  for (int count = 0; step > kFinest && count < kMostSteps; ++count) {
    Eigen::Vector2d best = at;
    for (const int x : {-1, 0, 1}) {
      for (const int y : {-1, 0, 1}) {
        const Eigen::Vector2d next =
            (at + step * Eigen::Vector2d(x, y)).cwiseMax(0.0).cwiseMin(1.0);
        const double value = next == at ? greatest : curvature.At(next, sign);
        if (value <= greatest) continue;
        greatest = value;
        best = next;
      }
    }
    step = best == at ? step / 2 : std::min(2 * step, longest);
    at = best;
  }
  return greatest;
}

// A sample and where it is.
struct Sample {
  double value = -kInfinity;
  int i = 0, j = 0;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
};

// The best samples of different pieces, the best first.
class BestSamples {
 public:
  void See(const Sample& sample) {
    if (sample.value <= best_.back().value) return;
    best_.back() = sample;
    std::sort(best_.begin(), best_.end(), [](const Sample& a, const Sample& b) {
      return a.value > b.value;
    });
  }
  const std::array<Sample, 8>& best() const { return best_; }

 private:
  std::array<Sample, 8> best_;
};

// Places of the trim loops by the piece they lie in, in its own parameters.
class PlacesOnLoops {
 public:
  explicit PlacesOnLoops(const NurbsSurface& surface)
      : in_u_(BreaksIn(surface.basis_u())), in_v_(BreaksIn(surface.basis_v())) {
    constexpr double kTolerance = 1e-3;  // of the domain
    const double side = std::min(in_u_.back() - in_u_[0], in_v_.back() - in_v_[0]);
    places_.resize((in_u_.size() - 1) * (in_v_.size() - 1));
    for (const NurbsCurve<2>& loop : surface.trims()) {
      const Polygon polygon = LoopPolyline(loop, kTolerance * side);
      for (const Eigen::Vector2d place : polygon.points.colwise()) Add(place);
    }
  }

  const std::vector<Eigen::Vector2d>& In(int i, int j) const {
    return places_[i * (in_v_.size() - 1) + j];
  }

 private:
  static int IndexOf(const std::vector<double>& breaks, double u) {
    const auto beyond = std::upper_bound(breaks.begin(), breaks.end(), u) - breaks.begin();
    return std::clamp(static_cast<int>(beyond) - 1, 0, static_cast<int>(breaks.size()) - 2);
  }

  void Add(const Eigen::Vector2d& uv) {
    const int i = IndexOf(in_u_, uv[0]), j = IndexOf(in_v_, uv[1]);
    const Eigen::Vector2d at((uv[0] - in_u_[i]) / (in_u_[i + 1] - in_u_[i]),
                             (uv[1] - in_v_[j]) / (in_v_[j + 1] - in_v_[j]));
    places_[i * (in_v_.size() - 1) + j].push_back(at.cwiseMax(0.0).cwiseMin(1.0));
  }

  std::vector<double> in_u_, in_v_;
  std::vector<std::vector<Eigen::Vector2d>> places_;
};

}  // namespace

template <int Dim>
std::optional<CurvatureInterval> CurvatureRange(const NurbsCurve<Dim>& curve) {
  const double size = BoxDiagonal(curve.control_points());
  double low = -kInfinity, high = -kInfinity;
  for (const CurvePiece& piece : PiecesOf(curve)) {
    low = std::max(low, GreatestOn(piece, -1));
    high = std::max(high, GreatestOn(piece, 1));
  }
  if (high < 0) return std::nullopt;
  return CurvatureInterval{Limited(-low, size), Limited(high, size)};
}

template std::optional<CurvatureInterval> CurvatureRange(const NurbsCurve<2>&);
template std::optional<CurvatureInterval> CurvatureRange(const NurbsCurve<3>&);

std::optional<CurvatureInterval> CurvatureRange(const NurbsSurface& surface) {
  constexpr double kMostSamples = 400000;
  const SurfacePieces pieces(surface);
  const double size = BoxDiagonal(surface.control_points());
  const double cells = static_cast<double>(pieces.count_u()) * pieces.count_v();
  const int wanted = 2 * std::max(surface.basis_u().degree(), surface.basis_v().degree()) + 2;
  const int side = std::clamp(static_cast<int>(std::sqrt(kMostSamples / cells)) - 1, 2, wanted);
  const TrimRegion region(surface);
  const PlacesOnLoops on_loops(surface);
  BestSamples lowest, highest;
  bool down = false, up = false;  // without bound
  for (int i = 0; i < pieces.count_u(); ++i) {
    for (int j = 0; j < pieces.count_v(); ++j) {
      const SurfacePiece piece = pieces.Piece(i, j);
      const PieceCurvature curvature(piece, region, side);
      Sample low{-kInfinity, i, j}, high = low;
      for (int k = 0; k < static_cast<int>(curvature.jets().size()); ++k) {
        const Eigen::Vector2d at =
            Eigen::Vector2d(k / (side + 1), k % (side + 1)) / static_cast<double>(side);
        if (!curvature.Counts(at)) continue;
        if (const auto here = curvature.Of(curvature.jets()[k])) {
          if (-here->principal_low > low.value) low = {-here->principal_low, i, j, at};
          if (here->principal_high > high.value) high = {here->principal_high, i, j, at};
        } else if (const auto beside = curvature.Beside(at)) {
          constexpr double kGrows = 1e5;
          down = down || beside->principal_low * size < -kGrows;
          up = up || beside->principal_high * size > kGrows;
        }
      }
      for (const Eigen::Vector2d& at : on_loops.In(i, j)) {
        const double below = curvature.At(at, -1), above = curvature.At(at, 1);
        if (below > low.value) low = {below, i, j, at};
        if (above > high.value) high = {above, i, j, at};
      }
      lowest.See(low);
      highest.See(high);
    }
  }
  const auto climb = [&](const BestSamples& samples, double sign) {
    double greatest = -kInfinity;
    for (const Sample& sample : samples.best()) {
      if (sample.value == -kInfinity) break;
      const SurfacePiece piece = pieces.Piece(sample.i, sample.j);
      greatest = std::max(
          greatest, Climbed(PieceCurvature(piece, region, side), sample.at, 1.0 / side, sign));
    }
    return greatest;
  };
  CurvatureInterval range{-climb(lowest, -1), climb(highest, 1)};
  if (range.min > range.max) return std::nullopt;
  range = {Limited(range.min, size), Limited(range.max, size)};
  if (down) range.min = -kInfinity;
  if (up) range.max = kInfinity;
  return range;
}

}  // namespace batten
