// SPDX-License-Identifier: MIT
// Grids and scattered points against what independent implementations found.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "batten/fitting/approximate_grid.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/interpolate_grid.h"
#include "batten/fitting/solve_linear.h"
#include "fixtures.h"

namespace batten::internal::grid_fixtures_test {

using fixtures::ExpectClose;
using fixtures::Json;

PointNet NetOf(const Json& grid) {
  PointNet net{static_cast<int>(grid.size()), static_cast<int>(grid.at(0).size()), {}, {}};
  net.points.resize(3, Eigen::Index{net.rows} * net.columns);
  for (int i = 0; i < net.rows; ++i) {
    net.points.middleCols(Eigen::Index{i} * net.columns, net.columns) =
        fixtures::Columns(grid.at(static_cast<size_t>(i)));
  }
  return net;
}

GridParameterization ParameterizationOf(const Json& input) {
  return input.at("parameters_method") == "chord" ? GridParameterization::kChord
                                                  : GridParameterization::kCentripetal;
}

void ExpectSameGrid(const InterpolatedGrid& got, const Json& expected, double tolerance) {
  ExpectClose(got.parameters.u, fixtures::Vector(expected.at("parameters_u")), tolerance);
  ExpectClose(got.parameters.v, fixtures::Vector(expected.at("parameters_v")), tolerance);
  const NurbsSurface surface = fixtures::Surface(expected.at("surface"));
  ASSERT_EQ(got.surface.size_u(), surface.size_u());
  ASSERT_EQ(got.surface.size_v(), surface.size_v());
  ExpectClose(got.surface.control_points(), surface.control_points(), tolerance);
}

TEST(GridFixturesTest, InterpolationAndLeastSquaresOfGridsAgree) {
  ThreadPool pool;
  int cases = 0;
  for (const Json& c : fixtures::Cases("surface_fitting.json")) {
    const Json& input = c.at("input");
    if (!input.contains("grid")) continue;
    SCOPED_TRACE(c.at("name").get<std::string>());
    const PointNet net = NetOf(input.at("grid"));
    if (input.at("mode") == "interpolate") {
      GridInterpolationOptions options{input.at("degree_u"), input.at("degree_v")};
      options.parameterization = ParameterizationOf(input);
      options.knots = GridKnots::kAveraged;
      ExpectSameGrid(InterpolateGrid(net, options, pool), c.at("expected"), c.at("tol"));
    } else {
      GridLeastSquaresOptions options{input.at("degree_u"), input.at("degree_v")};
      options.parameterization = ParameterizationOf(input);
      options.control_u = input.at("ctrlpts_u");
      options.control_v = input.at("ctrlpts_v");
      ExpectSameGrid(LeastSquaresGrid(net, options, pool), c.at("expected"), c.at("tol"));
    }
    ++cases;
  }
  EXPECT_EQ(cases, 10);
}

TEST(GridFixturesTest, LeastSquaresOfScatteredPointsAgree) {
  ThreadPool pool;
  int cases = 0;
  for (const Json& c : fixtures::Cases("surface_fitting.json")) {
    const Json& input = c.at("input");
    if (!input.contains("uv")) continue;
    SCOPED_TRACE(c.at("name").get<std::string>());
    auto data = std::make_shared<FittingData>();
    data->parameters = fixtures::Columns(input.at("uv"));
    data->values = fixtures::Columns(input.at("points"));
    const SplineBasis u(input.at("degree_u"), input.at("knots_u")),
        v(input.at("degree_v"), input.at("knots_v"));
    const auto count = static_cast<double>(data->parameters.cols());
    const LinearSolution solution = SolveLinear(FittingProblem(u, v, std::move(data), 0), pool);
    EXPECT_FALSE(solution.regularised);
    Json points = Json::array();
    for (const Json& row : c.at("expected").at("points")) {
      points.insert(points.end(), row.begin(), row.end());
    }
    ExpectClose(solution.coefficients, fixtures::Columns(points), c.at("tol"));
    EXPECT_NEAR(std::sqrt(solution.residual_squares / count),
                c.at("expected").at("rms"),
                c.at("tol").get<double>());
    ++cases;
  }
  EXPECT_EQ(cases, 8);
}

}  // namespace batten::internal::grid_fixtures_test
