// SPDX-License-Identifier: MIT
#include "geometry/construction/section_rows.h"

#include <cmath>
#include <string>
#include <utility>

#include "geometry/numeric/constants.h"
#include "geometry/numeric/construction_checks.h"

namespace batten::internal {

SectionRows SectionRowsOf(const std::vector<NurbsCurve<3>>& compatible) {
  const Eigen::Index rows = compatible.front().control_points().cols();
  const Eigen::Index count = static_cast<Eigen::Index>(compatible.size());
  SectionRows sections{
      compatible.front().basis(), Eigen::MatrixXd(3 * rows, count), Eigen::MatrixXd(rows, count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::VectorXd& weights = compatible[k].weights();
    sections.points.col(k) = compatible[k].control_points().reshaped();
    const bool rational = compatible[k].rational();
    sections.weights.col(k) =
        rational ? Eigen::VectorXd(weights / std::exp(weights.array().log().mean()))
                 : Eigen::VectorXd::Ones(rows);
  }
  return sections;
}

bool SameWeights(const SectionRows& sections) {
  constexpr double kSame = 1e-13;
  const Eigen::ArrayXd least = sections.weights.rowwise().minCoeff();
  const Eigen::ArrayXd greatest = sections.weights.rowwise().maxCoeff();
  return ((greatest - least) <= kSame * greatest).all();
}

Eigen::MatrixXd ChordLengths(const SectionRows& sections, bool closed) {
  const Eigen::Index steps = sections.count() - (closed ? 0 : 1);
  Eigen::MatrixXd lengths(sections.rows(), steps);
  for (Eigen::Index k = 0; k < steps; ++k) {
    const Eigen::VectorXd step =
        sections.points.col((k + 1) % sections.count()) - sections.points.col(k);
    lengths.col(k) = step.reshaped(3, sections.rows()).colwise().norm().transpose();
  }
  return lengths;
}

std::vector<double> ChordParameters(const SectionRows& sections,
                                    bool closed,
                                    const char* function) {
  const Eigen::MatrixXd lengths = ChordLengths(sections, closed);
  const double rounding = 16 * kEpsilon * sections.points.cwiseAbs().maxCoeff();
  for (Eigen::Index k = 0; k < lengths.cols(); ++k) {
    const double apart = lengths.col(k).maxCoeff();
    RequireThat(apart > rounding,
                function,
                "sections " + std::to_string(k + 1) + " and " +
                    std::to_string((k + 1) % sections.count() + 1) +
                    " are the same curve: their control points are at most " + RoundedText(apart) +
                    " apart");
  }
  const Eigen::VectorXd totals = lengths.rowwise().sum();
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(lengths.cols());
  int rows = 0;
  for (Eigen::Index i = 0; i < lengths.rows(); ++i) {
    if (!(totals[i] > rounding)) continue;
    shares += lengths.row(i).transpose() / totals[i];
    ++rows;
  }
  std::vector<double> parameters = {0};
  for (const double share : shares) parameters.push_back(parameters.back() + share / rows);
  parameters.back() = 1;
  return parameters;
}

NurbsSurface SurfaceOfRows(const SplineBasis& along,
                           const SplineBasis& across,
                           const Eigen::MatrixXd& points,
                           const Eigen::MatrixXd& weights) {
  const Eigen::Index rows = weights.rows(), columns = weights.cols();
  Eigen::Matrix3Xd net(3, rows * columns);
  Eigen::VectorXd net_weights(rows * columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      net.col(i * columns + j) = points.block<3, 1>(3 * i, j);
      net_weights[i * columns + j] = weights(i, j);
    }
  }
  return NurbsSurface(along, across, std::move(net), std::move(net_weights));
}

}  // namespace batten::internal
