// SPDX-License-Identifier: MIT
#include "geometry/bezier/steady_sections.h"

#include <cmath>
#include <numbers>

#include "geometry/bezier/bezier_span.h"

namespace batten::internal {
namespace {

constexpr double kSteady = 4;
constexpr int kMostSectionHalvings = 24;

// Where a coefficient has vanished in rounding, halving can't help.
bool IsSteady(const Eigen::MatrixXd& bezier) {
  return !(bezier.minCoeff() > 0) ||
         (bezier.rowwise().maxCoeff().array() <= kSteady * bezier.rowwise().minCoeff().array())
             .all();
}

// De Casteljau at the middle; `bezier` becomes the right half.
Eigen::MatrixXd TakeLeftHalf(Eigen::MatrixXd& bezier) {
  const Eigen::Index p = bezier.cols() - 1;
  Eigen::MatrixXd left = bezier;
  for (Eigen::Index r = 1; r <= p; ++r) {
    for (Eigen::Index j = 0; j <= p - r; ++j) {
      bezier.col(j) = (bezier.col(j) + bezier.col(j + 1)) / 2;
    }
    left.col(r) = bezier.col(0);
  }
  return left;
}

void Halve(Eigen::MatrixXd bezier,
           const Section& section,
           int halvings,
           std::vector<Section>& sections) {
  const double middle = section.lower + (section.upper - section.lower) / 2;
  if (halvings == 0 || !(section.lower < middle && middle < section.upper) || IsSteady(bezier)) {
    sections.push_back(section);
    return;
  }
  // The triangle's last diagonal, read upwards, is the right half.
  const Eigen::MatrixXd left = TakeLeftHalf(bezier);
  Halve(left, {section.lower, middle}, halvings - 1, sections);
  Halve(std::move(bezier), {middle, section.upper}, halvings - 1, sections);
}

}  // namespace

std::vector<Section> SteadySections(const SplineBasis& basis, const Eigen::MatrixXd& weights) {
  const int p = basis.degree();
  std::vector<Section> sections;
  for (const int span : basis.Spans()) {
    const Eigen::MatrixXd bezier =
        weights.middleCols(span - p, p + 1) * BezierSpanMatrix(basis, span).transpose();
    Halve(bezier, {basis.knots()[span], basis.knots()[span + 1]}, kMostSectionHalvings, sections);
  }
  return sections;
}

std::vector<double> WithEnds(const Section& section, int count) {
  std::vector<double> nodes(count);
  for (int k = 0; k < count; ++k) {
    const double t = std::pow(std::sin(std::numbers::pi * k / (2 * (count - 1))), 2);
    nodes[k] = section.lower + t * (section.upper - section.lower);
  }
  nodes.back() = section.upper;
  return nodes;
}

std::vector<double> Inside(const Section& section, int count) {
  std::vector<double> nodes(count);
  for (int k = 0; k < count; ++k) {
    const double t = std::pow(std::sin(std::numbers::pi * (2 * k + 1) / (4 * count)), 2);
    nodes[k] = section.lower + t * (section.upper - section.lower);
  }
  return nodes;
}

}  // namespace batten::internal
