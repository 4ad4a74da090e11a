// SPDX-License-Identifier: MIT
#include "batten/geometry/lofted_surface.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "batten/geometry/compatible_curves.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/reparameterize.h"
#include "geometry/construction/curve_closure.h"
#include "geometry/construction/curves_together.h"
#include "geometry/construction/section_rows.h"
#include "geometry/construction/spline_interpolation.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

// What is interpolated across the sections: where, over which knots, and the given directions.
struct Crossing {
  SplineBasis basis;
  std::vector<SplineDatum> data;
  std::vector<double> parameters;  // of the sections
  Eigen::Matrix3Xd slopes;         // of the data of order 1, ∂S/∂v of a row of length one
};

void CheckLoft(const std::vector<NurbsCurve<3>>& sections, const LoftOptions& options) {
  const std::size_t least = options.closed ? 3 : 2;
  RequireThat(sections.size() >= least,
              "Loft",
              std::to_string(sections.size()) + " sections; at least " + std::to_string(least) +
                  " are needed" + (options.closed ? " where closed" : ""));
  RequireThat(options.degree >= 1 && options.degree <= kMaxDegree,
              "Loft",
              "degree = " + std::to_string(options.degree) + " is not in [1, " +
                  std::to_string(kMaxDegree) + "]");
  RequireThat(
      !options.closed || options.degree % 2 == 1,
      "Loft",
      "degree = " + std::to_string(options.degree) + " is even; closed lofts need an odd one");
  RequireThat(!options.closed || (!options.start && !options.end && !options.spine),
              "Loft",
              "closed: there is no end to have a direction, and no spine");
  RequireThat(!options.spine || (options.degree == 3 && !options.start && !options.end),
              "Loft",
              "spine: it gives the directions itself, at degree 3");
  for (const auto& end : {options.start, options.end}) {
    if (!end) continue;
    RequireThat(end->direction.allFinite() && end->direction.norm() > 0,
                "Loft",
                "an end's direction is zero or not finite");
    RequirePositive("Loft", "fullness", end->fullness);
    RequireThat(options.degree > 1, "Loft", "degree = 1 has no room for the direction of an end");
  }
  RequireThat(options.tolerance >= 0, "Loft", "tolerance is negative or not a number");
  RequireSameClosedness(sections, "Loft", "section");
}

// Knots averaged from the places of all data, a derivative's counting as one more.
SplineBasis BasisFor(int degree, const std::vector<SplineDatum>& data) {
  std::vector<double> places;
  for (const SplineDatum& datum : data) places.push_back(datum.at);
  return AveragedKnots(degree, places);
}

Crossing OpenCrossing(std::vector<double> parameters, const LoftOptions& options) {
  std::vector<SplineDatum> data;
  Eigen::Matrix3Xd slopes(3, 0);
  const auto add_end = [&](const LoftEnd& end, double at) {
    slopes.conservativeResize(3, slopes.cols() + 1);
    slopes.rightCols<1>() = end.direction.normalized() * end.fullness;
    data.push_back({at, 1});
  };
  for (const double at : parameters) {
    if (at == 1 && options.end) add_end(*options.end, 1);
    data.push_back({at});
    if (at == 0 && options.start) add_end(*options.start, 0);
  }
  const int degree = std::min(options.degree, static_cast<int>(data.size()) - 1);
  SplineBasis basis = BasisFor(degree, data);
  return {std::move(basis), std::move(data), std::move(parameters), std::move(slopes)};
}

Crossing ClosedCrossing(std::vector<double> parameters, int degree) {
  SplineBasis basis = PeriodicKnots(degree, parameters);
  parameters.pop_back();
  std::vector<SplineDatum> data;
  for (const double at : parameters) data.push_back({at});
  return {std::move(basis), std::move(data), std::move(parameters), {}};
}

// Sections where the spine passes their middles, each crossed along it.
Crossing SpineCrossing(const SectionRows& sections, const NurbsCurve<3>& spine) {
  const CurveFootPoints<3> feet(spine);
  std::vector<double> at;
  Eigen::Matrix3Xd places(3, sections.count()), slopes(3, sections.count());
  for (Eigen::Index k = 0; k < sections.count(); ++k) {
    const Eigen::Vector3d middle =
        sections.points.col(k).reshaped(3, sections.rows()).rowwise().mean();
    const CurveFoot foot = feet.Nearest(middle);
    at.push_back(foot.u);
    const CurveJet<3> jet = spine.JetAt(foot.u);
    places.col(k) = jet.point;
    slopes.col(k) = jet.first;
    if (k == 0) continue;
    RequireThat(at[k] > at[k - 1],
                "Loft",
                "the spine passes section " + std::to_string(k + 1) + " at its parameter " +
                    RoundedText(at[k]) + ", not after section " + std::to_string(k) + " at " +
                    RoundedText(at[k - 1]) + ": sections are to follow one another along it");
  }
  const double length = at.back() - at.front();
  double chords = 0;
  for (Eigen::Index k = 1; k < sections.count(); ++k) {
    chords += (places.col(k) - places.col(k - 1)).norm();
  }
  Crossing crossing{SplineBasis(1, {0, 0, 1, 1}), {}, {}, slopes * (length / chords)};
  for (const double u : at) {
    const double v = u == at.back() ? 1 : (u - at.front()) / length;
    crossing.parameters.push_back(v);
    crossing.data.push_back({v});
    crossing.data.push_back({v, 1});
  }
  crossing.basis = BasisFor(3, crossing.data);
  return crossing;
}

Crossing CrossingOf(const SectionRows& sections, const LoftOptions& options) {
  std::vector<double> parameters = ChordParameters(sections, options.closed, "Loft");
  if (options.spine) return SpineCrossing(sections, *options.spine);
  if (options.closed) return ClosedCrossing(std::move(parameters), options.degree);
  return OpenCrossing(std::move(parameters), options);
}

// The values of the data of rows of `block` numbers each: sections' columns, and slopes times the
// length of the row. `weight_of` is what a slope is multiplied with.
Eigen::MatrixXd ValuesOf(const Crossing& crossing,
                         const Eigen::MatrixXd& columns,
                         const Eigen::VectorXd& lengths,
                         const Eigen::MatrixXd& weights,
                         bool homogeneous) {
  const Eigen::Index block = homogeneous ? 4 : 3;
  Eigen::MatrixXd values(columns.rows(), static_cast<Eigen::Index>(crossing.data.size()));
  Eigen::Index section = -1, slope = 0;
  for (std::size_t k = 0; k < crossing.data.size(); ++k) {
    const Eigen::Index column = static_cast<Eigen::Index>(k);
    if (crossing.data[k].order == 0) {
      values.col(column) = columns.col(++section);
      continue;
    }
    const Eigen::Index beside = crossing.data[k].at == 0   ? 0
                                : crossing.data[k].at == 1 ? columns.cols() - 1
                                                           : section;
    for (Eigen::Index i = 0; i < lengths.size(); ++i) {
      const double weight = homogeneous ? weights(i, beside) : 1;
      values.block(block * i, column, block, 1).setZero();
      values.block<3, 1>(block * i, column) = crossing.slopes.col(slope) * (lengths[i] * weight);
    }
    ++slope;
  }
  return values;
}

NurbsSurface EuclideanLoft(const SectionRows& sections,
                           const Crossing& crossing,
                           const Eigen::VectorXd& lengths) {
  const Eigen::MatrixXd points =
      Interpolated(crossing.basis,
                   crossing.data,
                   ValuesOf(crossing, sections.points, lengths, sections.weights, false));
  return SurfaceOfRows(sections.basis,
                       crossing.basis,
                       points,
                       sections.weights.col(0).replicate(1, crossing.basis.size()));
}

// What became of weights between sections, and the surface where they are sound.
struct HomogeneousLoft {
  std::optional<NurbsSurface> surface;
  Eigen::Index row = 0;
  double given_least = 0, given_greatest = 0, least = 0, greatest = 0;
};

HomogeneousLoft LoftHomogeneous(const SectionRows& sections,
                                const Crossing& crossing,
                                const Eigen::VectorXd& lengths) {
  const Eigen::Vector3d middle =
      sections.points.reshaped(3, sections.rows() * sections.count()).rowwise().mean();
  Eigen::MatrixXd columns(4 * sections.rows(), sections.count());
  for (Eigen::Index k = 0; k < sections.count(); ++k) {
    for (Eigen::Index i = 0; i < sections.rows(); ++i) {
      const double weight = sections.weights(i, k);
      columns.block<3, 1>(4 * i, k) = weight * (sections.points.block<3, 1>(3 * i, k) - middle);
      columns(4 * i + 3, k) = weight;
    }
  }
  const Eigen::MatrixXd net = Interpolated(
      crossing.basis, crossing.data, ValuesOf(crossing, columns, lengths, sections.weights, true));
  Eigen::MatrixXd points(3 * sections.rows(), net.cols()), weights(sections.rows(), net.cols());
  for (Eigen::Index i = 0; i < sections.rows(); ++i) {
    weights.row(i) = net.row(4 * i + 3);
    const double least = sections.weights.row(i).minCoeff();
    const double greatest = sections.weights.row(i).maxCoeff();
    const double found_least = weights.row(i).minCoeff(), found = weights.row(i).maxCoeff();
    if (!(found_least >= least / 2 && found <= 2 * greatest)) {
      return {std::nullopt, i, least, greatest, found_least, found};
    }
    for (Eigen::Index j = 0; j < net.cols(); ++j) {
      points.block<3, 1>(3 * i, j) = middle + net.block<3, 1>(4 * i, j) / weights(i, j);
    }
  }
  return {SurfaceOfRows(sections.basis, crossing.basis, points, weights)};
}

double MeanLength(const Eigen::MatrixXd& chords) { return chords.rowwise().sum().mean(); }

// Lengths by which directions are multiplied, one for each row: with a spine the row's own.
Eigen::VectorXd RowLengths(const SectionRows& sections, const LoftOptions& options) {
  const Eigen::MatrixXd chords = ChordLengths(sections, options.closed);
  if (options.spine) return chords.rowwise().sum();
  return Eigen::VectorXd::Constant(sections.rows(), MeanLength(chords));
}

LoftedSurface LoftPolynomials(const std::vector<NurbsCurve<3>>& sections,
                              const LoftOptions& options) {
  CurvesTogether cubics = AsCubics(sections, options.tolerance, "Loft");
  const SectionRows rows = SectionRowsOf(cubics.curves);
  const Crossing crossing = CrossingOf(rows, options);
  return {EuclideanLoft(rows, crossing, RowLengths(rows, options)),
          crossing.parameters,
          {},
          cubics.error};
}

LoftedSurface LoftAligned(const std::vector<NurbsCurve<3>>& sections, const LoftOptions& options) {
  std::vector<NurbsCurve<3>> compatible = Compatible(sections);
  SectionRows rows = SectionRowsOf(compatible);
  if (!SameWeights(rows)) {
    for (NurbsCurve<3>& curve : compatible) curve = WithEndWeights(curve, 1, 1);
    compatible = Compatible(std::move(compatible));
    rows = SectionRowsOf(compatible);
  }
  const Crossing crossing = CrossingOf(rows, options);
  const Eigen::VectorXd lengths = RowLengths(rows, options);
  if (SameWeights(rows)) {
    return {EuclideanLoft(rows, crossing, lengths), crossing.parameters, {}, 0};
  }
  HomogeneousLoft loft = LoftHomogeneous(rows, crossing, lengths);
  if (loft.surface) return {std::move(*loft.surface), crossing.parameters, {}, 0};
  if (options.tolerance > 0) return LoftPolynomials(compatible, options);
  RequireThat(false,
              "Loft",
              "weights of control point " + std::to_string(loft.row) + " are " +
                  RoundedText(loft.given_least) + " to " + RoundedText(loft.given_greatest) +
                  " in the sections and would run from " + RoundedText(loft.least) + " to " +
                  RoundedText(loft.greatest) +
                  " between them, beyond half and twice that: give a tolerance, within which "
                  "sections without weights stand for them");
  return {std::move(*loft.surface), {}, {}, 0};
}

}  // namespace

LoftedSurface Loft(const std::vector<NurbsCurve<3>>& sections, const LoftOptions& options) {
  CheckLoft(sections, options);
  if (!options.align) {
    LoftedSurface lofted = LoftAligned(sections, options);
    lofted.changes.resize(sections.size());
    RequireArea(lofted.surface, "Loft");
    return lofted;
  }
  AlignedCurves aligned = Aligned(sections);
  LoftedSurface lofted = LoftAligned(aligned.curves, options);
  lofted.changes = std::move(aligned.changes);
  RequireArea(lofted.surface, "Loft");
  return lofted;
}

}  // namespace batten
