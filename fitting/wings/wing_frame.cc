// SPDX-License-Identifier: MIT
#include "fitting/wings/wing_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>

#include "batten/fitting/statistics.h"
#include "fitting/core/mask_indices.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr int kReweightings = 6;        // of a line's fit
constexpr double kFar = 3;              // scales: a place that counts a tenth
constexpr Eigen::Index kFewest = 30;    // points of an end
constexpr double kFacesAway = 0.7;      // cosine of a nose's normals to the chord, at first …
constexpr double kFacesStraight = 0.9;  // … and last
constexpr double kLeastChord = 3;       // h
constexpr double kTipShare = 0.005;     // of a line's points beyond its ends
constexpr double kNoseFrom = 0.02, kNoseTo = 0.08;  // of the chord: where the nose's radius is read
constexpr double kOnNose = 8;         // radii from the nose: sides by height, not by label
constexpr int kSteps = 12;            // of the search for a section
constexpr double kBeyond = 0.4;       // of the span: farthest sections
constexpr double kLeastAround = 0.4;  // share of places along the edge that have moat points
constexpr int kAlong = 20;

Eigen::RowVector4d Powers(double v) {
  const double t = 2 * v - 1;
  return {1, t, t * t, t * t * t};
}

// Means of the labelled points around each of some points, within the reach.
Eigen::Matrix3Xd OutwardOf(const Eigen::Matrix3Xd& points,
                           const SheetSides& sides,
                           const std::vector<Eigen::Index>& some) {
  constexpr int kAround = 60;
  const std::vector<Eigen::Index> known = IndicesOf(sides.labelled);
  const Eigen::Matrix3Xd places = points(Eigen::all, known);
  const std::vector<int> near = NeighbourIndex(places).Nearest(points(Eigen::all, some), kAround);
  Eigen::Matrix3Xd outward(3, some.size());
  for (size_t i = 0; i < some.size(); ++i) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (size_t j = 0; j < kAround; ++j) mean += places.col(near[i * kAround + j]) / kAround;
    outward.col(static_cast<Eigen::Index>(i)) = points.col(some[i]) - mean;
  }
  return outward;
}

Eigen::Vector3d PrincipalAxis(const Eigen::Matrix3Xd& vectors) {
  return EigenOf3(vectors * vectors.transpose()).vectors.col(2);
}

// Frame of the cloud: along the line, outwards across it, and normal to both.
struct LineFrame {
  Eigen::Vector3d centre, along, outward;
};

// The line through points that are nearly straight, between their ends.
WingLine LineThrough(const Eigen::Matrix3Xd& points,
                     const std::vector<Eigen::Index>& some,
                     const LineFrame& frame) {
  std::vector<double> ways;
  for (const Eigen::Index k : some) ways.push_back(frame.along.dot(points.col(k) - frame.centre));
  const double low = Quantile(ways, kTipShare), high = Quantile(ways, 1 - kTipShare);
  Eigen::VectorXd v(std::ssize(some));
  for (size_t i = 0; i < some.size(); ++i)
    v[static_cast<Eigen::Index>(i)] = (ways[i] - low) / (high - low);
  return WingLine(v, points(Eigen::all, some));
}

}  // namespace

WingLine::WingLine(const Eigen::VectorXd& v, const Eigen::Matrix3Xd& places)
    : coefficients_(Eigen::Matrix3Xd::Zero(3, 4)) {
  Eigen::MatrixX4d rows(v.size(), 4);
  for (Eigen::Index k = 0; k < v.size(); ++k) rows.row(k) = Powers(v[k]);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(v.size());
  for (int round = 0; round < kReweightings; ++round) {
    const Eigen::MatrixX4d weighted = weights.asDiagonal() * rows;
    const Eigen::MatrixX3d values = weights.asDiagonal() * places.transpose();
    coefficients_ = LeastSquares(weighted, values).transpose();
    const Eigen::VectorXd off =
        (places - coefficients_ * rows.transpose()).colwise().norm().transpose();
    const double scale = Median(std::vector<double>(off.begin(), off.end()));
    if (!(scale > 0)) break;
    weights = (1 + (off / (kFar * scale)).array().square()).rsqrt().matrix().cwiseAbs2();
  }
}

Eigen::Vector3d WingLine::At(double v) const { return coefficients_ * Powers(v).transpose(); }

Eigen::Matrix3Xd WingLine::BezierPoints(double from, double to) const {
  // Interpolation at thirds.
  Eigen::Matrix4d bernstein;
  Eigen::Matrix<double, 4, 3> places;
  for (int k = 0; k < 4; ++k) {
    const double t = k / 3.0, s = 1 - t;
    bernstein.row(k) << s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t;
    places.row(k) = At(from + (to - from) * t).transpose();
  }
  return LeastSquares(bernstein, places).transpose();
}

Eigen::Matrix3d WingFrame::AxesAt(double v) const {
  constexpr double kStep = 1e-3;
  const Eigen::Vector3d chord_way = (edge.At(v) - nose.At(v)).normalized();
  const Eigen::Vector3d ahead =
      edge.At(v + kStep) - edge.At(v - kStep) + nose.At(v + kStep) - nose.At(v - kStep);
  const Eigen::Vector3d across = ahead.cross(chord_way).normalized();
  Eigen::Matrix3d axes;
  axes << chord_way, across, chord_way.cross(across);
  return axes;
}

WingPlace WingFrame::PlaceOf(const Eigen::Vector3d& point) const {
  const auto off = [&](double v) { return (point - edge.At(v)).dot(AxesAt(v).col(2)); };
  double v = 0.5, here = off(v);
  for (int step = 0; step < kSteps; ++step) {
    constexpr double kStep = 1e-4;
    const double slope = (off(v + kStep) - here) / kStep;
    if (!(std::abs(slope) > 0)) break;
    const double next = std::clamp(v - here / slope, -kBeyond, 1 + kBeyond);
    const double moved = std::abs(next - v);
    v = next;
    here = off(v);
    if (moved < 1e-9) break;
  }
  const Eigen::Matrix3d axes = AxesAt(v);
  const Eigen::Vector3d way = point - edge.At(v);
  const double own = ChordAt(v);
  return {v, 1 + way.dot(axes.col(0)) / own, way.dot(axes.col(1)) / own};
}

bool WingFrame::IsAtNose(const WingPlace& place) const {
  return place.along < kOnNose * nose_radius;
}

double WingFrame::Around(const WingPlace& place, int side) const {
  const double focus = nose_radius / 2;
  const std::complex<double> root = std::sqrt(std::complex(place.along - focus, place.above));
  const double amount = std::abs(root.real()) / std::sqrt(1 - focus);
  const bool by_label = side != 0 && !IsAtNose(place);
  return (by_label ? side > 0 : place.above > 0) ? amount : -amount;
}

std::vector<std::vector<Eigen::Index>> EndsOfSections(const Eigen::Matrix3Xd& points,
                                                      const SheetSides& sides) {
  const std::vector<Eigen::Index> moat = IndicesOf(sides.moat);
  if (std::ssize(moat) < kFewest) return {};
  const Eigen::Matrix3Xd outward = OutwardOf(points, sides, moat);
  const Eigen::Vector3d axis = PrincipalAxis(outward);
  std::vector<std::vector<Eigen::Index>> ends(2);
  for (size_t i = 0; i < moat.size(); ++i)
    ends[axis.dot(outward.col(static_cast<Eigen::Index>(i))) > 0 ? 0 : 1].push_back(moat[i]);
  if (ends[1].size() > ends[0].size()) std::swap(ends[0], ends[1]);
  if (std::ssize(ends[1]) < kFewest) ends.pop_back();
  return ends;
}

WingFrame FrameOf(const Eigen::Matrix3Xd& points,
                  const SheetSides& sides,
                  const std::vector<Eigen::Index>& edge,
                  const std::vector<Eigen::Index>& other_end) {
  WingFrame wing;
  LineFrame frame;
  const Eigen::Matrix3Xd places = points(Eigen::all, edge);
  frame.centre = places.rowwise().mean();
  frame.along = PrincipalAxis(places.colwise() - frame.centre);
  frame.outward = OutwardOf(points, sides, edge).rowwise().mean();
  frame.outward -= frame.along * frame.along.dot(frame.outward);
  frame.outward.normalize();
  wing.edge = LineThrough(points, edge, frame);
  // Signs of the normals: outwards, by the flow through closed sections.
  const Eigen::Vector3d middle = points.rowwise().mean();
  double flow = 0;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (!sides.labelled[k]) continue;
    const auto across = [&](const Eigen::Vector3d& x) {
      return (x - frame.along * frame.along.dot(x)).eval();
    };
    flow += across(sides.normals.col(k)).dot(across(points.col(k) - middle));
  }
  wing.facing = flow < 0 ? -1 : 1;
  // The nose: first across the whole wing, then section by section.
  for (const double cosine : {kFacesAway, kFacesStraight}) {
    std::vector<Eigen::Index> nose = other_end;
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      if (!sides.labelled[k]) continue;
      const Eigen::Vector3d to_edge =
          cosine == kFacesAway
              ? frame.outward
              : wing.AxesAt(std::clamp(wing.PlaceOf(points.col(k)).v, 0.0, 1.0)).col(0);
      if (wing.facing * sides.normals.col(k).dot(to_edge) < -cosine) nose.push_back(k);
    }
    if (std::ssize(nose) < kFewest) {
      wing.failure_reason = "no nose was found opposite to the edge";
      return wing;
    }
    wing.nose = LineThrough(points, nose, frame);
  }
  for (const double v : {0.0, 0.5, 1.0}) {
    if (wing.ChordAt(v) > kLeastChord * sides.spacing) continue;
    wing.failure_reason = "its edge and its nose meet";
    return wing;
  }
  wing.chord = (wing.ChordAt(0) + 2 * wing.ChordAt(0.5) + wing.ChordAt(1)) / 4;
  wing.span =
      ((wing.edge.At(1) - wing.edge.At(0)).norm() + (wing.nose.At(1) - wing.nose.At(0)).norm()) / 2;
  std::vector<double> radii;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (!sides.labelled[k]) continue;
    const WingPlace place = wing.PlaceOf(points.col(k));
    if (place.along > kNoseFrom && place.along < kNoseTo)
      radii.push_back(place.above * place.above / (2 * place.along));
  }
  if (std::ssize(radii) < kFewest) {
    wing.failure_reason = "too few points lie about the nose";
    return wing;
  }
  wing.nose_radius = Median(std::move(radii));
  std::vector<bool> filled(kAlong, false);
  for (const Eigen::Index k : edge) {
    const double v = wing.PlaceOf(points.col(k)).v;
    if (!std::isfinite(v)) continue;
    filled[static_cast<size_t>(std::clamp(v * kAlong, 0.0, kAlong - 1.0))] = true;
  }
  if (std::count(filled.begin(), filled.end(), true) < kLeastAround * kAlong)
    wing.failure_reason = "its sides do not meet along a whole edge";
  return wing;
}

}  // namespace batten::internal
