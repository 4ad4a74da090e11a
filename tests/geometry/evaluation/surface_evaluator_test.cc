// SPDX-License-Identifier: MIT
#include "batten/geometry/surface_evaluator.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "exact_shapes.h"
#include "extended_evaluation.h"
#include "fixtures.h"
#include "geometry/evaluation/kernel_tables.h"
#include "law_cases.h"
#include "nasty_surfaces.h"
#include "random_splines.h"

namespace batten::internal::surface_evaluator_test {

// What the header promises of rounding.
constexpr double kPromised = 1e-13;

Eigen::Vector3d CentreOf(const NurbsSurface& surface) {
  const auto& points = surface.control_points();
  return points.rowwise().minCoeff() / 2 + points.rowwise().maxCoeff() / 2;
}

// Half the longest side of the box.
double HalfSide(const NurbsSurface& surface) {
  return (surface.control_points().colwise() - CentreOf(surface)).cwiseAbs().maxCoeff();
}

// Columns point, du, dv, duu, duv, dvv.
using JetColumns = Eigen::Matrix<double, 3, 6>;

JetColumns Columns(const SurfaceJet& jet) {
  JetColumns columns;
  columns << jet.point, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv;
  return columns;
}

JetColumns Ordered(const LongMatrix& table) {
  JetColumns columns;
  const int order[6] = {0, 3, 1, 6, 4, 2};
  for (int d = 0; d < 6; ++d) columns.col(d) = table.col(order[d]).cast<double>();
  return columns;
}

// The surface with all control points half a side from the centre, which is the origin: its terms,
// added by their absolute values, are the sizes that errors are relative to.
NurbsSurface Spread(const NurbsSurface& surface) {
  return WithPoints(
      surface, Eigen::Matrix3Xd::Constant(3, surface.control_points().cols(), HalfSide(surface)));
}

JetColumns SizesAt(const NurbsSurface& spread, double u, double v) {
  return Ordered(ExtendedSurface(spread, u, v, 2, Eigen::Vector3d::Zero()).size);
}

// u, and the ends and the middle of its span.
std::vector<double> PlacesOnSpan(const SplineBasis& basis, double u) {
  const int span = basis.Span(u);
  const double low = basis.knots()[span], high = basis.knots()[span + 1];
  return {u, low, low + (high - low) / 2, std::nextafter(high, low)};
}

// The largest on the cell between knots.
JetColumns Sizes(const NurbsSurface& surface, double u, double v) {
  const NurbsSurface spread = Spread(surface);
  JetColumns sizes = JetColumns::Zero();
  for (double a : PlacesOnSpan(surface.basis_u(), u)) {
    for (double b : PlacesOnSpan(surface.basis_v(), v)) {
      sizes = sizes.cwiseMax(SizesAt(spread, a, b));
    }
  }
  return sizes;
}

// A parameter of the domain or within a period around it.
double AnyParameter(const SplineBasis& basis, RandomSplines& random) {
  const double length = basis.upper() - basis.lower();
  if (random.Integer(0, 4) > 0) return random.Parameter(basis);
  return random.Real(basis.lower() - length, basis.upper() + length);
}

Eigen::Matrix2Xd AnyParameters(const NurbsSurface& surface, int count, RandomSplines& random) {
  Eigen::Matrix2Xd parameters(2, count);
  for (int k = 0; k < count; ++k) {
    parameters.col(k) << AnyParameter(surface.basis_u(), random),
        AnyParameter(surface.basis_v(), random);
  }
  return parameters;
}

void ExpectRoundedJet(const SurfaceEvaluator& evaluator, double u, double v) {
  SCOPED_TRACE("u = " + std::to_string(u) + ", v = " + std::to_string(v));
  const NurbsSurface& surface = evaluator.surface();
  const double in_u = surface.basis_u().Clamp(u), in_v = surface.basis_v().Clamp(v);
  const Eigen::Vector3d centre = CentreOf(surface);
  JetColumns wanted = Ordered(ExtendedSurface(surface, in_u, in_v, 2, centre).value);
  wanted.col(0) += centre;
  JetColumns allowed = kPromised * Sizes(surface, in_u, in_v);
  allowed.col(0) += kEpsilon * wanted.col(0).cwiseAbs();
  const JetColumns error = (Columns(evaluator.JetAt(u, v)) - wanted).cwiseAbs();
  EXPECT_TRUE((error.array() <= allowed.array()).all()) << error << "\nallowed\n" << allowed;
  const Eigen::Vector3d point_error = (evaluator.At(u, v) - wanted.col(0)).cwiseAbs();
  EXPECT_TRUE((point_error.array() <= allowed.col(0).array()).all()) << point_error;
}

bool SameBits(const void* a, const void* b, size_t bytes) { return std::memcmp(a, b, bytes) == 0; }

// The surface with weights raised to a power, so that they differ less.
NurbsSurface Tempered(const NurbsSurface& surface, double power) {
  Eigen::VectorXd weights = surface.weights();
  for (double& w : weights) w = std::pow(w, power);
  return NurbsSurface(surface.basis_u(), surface.basis_v(), surface.control_points(), weights);
}

TEST(SurfaceEvaluatorTest, JetsAreRightWithinThePromisedRounding) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    for (const NurbsSurface& shape : {surface, Tempered(surface, 0.1)}) {
      const SurfaceEvaluator evaluator(shape);
      for (int k = 0; k < 6; ++k) {
        ExpectRoundedJet(evaluator,
                         AnyParameter(surface.basis_u(), random),
                         AnyParameter(surface.basis_v(), random));
      }
    }
  });
}

TEST(SurfaceEvaluatorTest, BothFormsAreUsed) {
  RandomSplines random(1);
  for (int degree = 1; degree <= kHighestDegree; ++degree) {
    const NurbsSurface sheet = random.Sheet(degree, degree, 1);
    EXPECT_NE(SurfaceEvaluator(sheet).table().patches, nullptr) << degree;
    const NurbsSurface wild(sheet.basis_u(),
                            sheet.basis_v(),
                            sheet.control_points(),
                            random.Weights(sheet.control_points().cols()));
    EXPECT_EQ(SurfaceEvaluator(wild).table().patches, nullptr) << degree;
  }
}

TEST(SurfaceEvaluatorTest, AgreesOnNastySurfaces) {
  for (int kind = 0; kind < kNastyKinds; ++kind) {
    for (unsigned seed = 0; seed < 4; ++seed) {
      SCOPED_TRACE("kind " + std::to_string(kind) + ", seed " + std::to_string(seed));
      RandomSplines random(seed);
      const SurfaceEvaluator evaluator(NastySurface(kind, random));
      for (int k = 0; k < 20; ++k) {
        ExpectRoundedJet(evaluator,
                         AnyParameter(evaluator.surface().basis_u(), random),
                         AnyParameter(evaluator.surface().basis_v(), random));
      }
    }
  }
}

// Spans of lengths 10^-9 … 1, far from zero.
TEST(SurfaceEvaluatorTest, UnevenSpansLoseNothing) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    RandomSplines random(seed);
    const int degree = random.Integer(1, 5);
    std::vector<double> breaks(1, random.Coin() ? 0.0 : 1000.0);
    for (int k = random.Integer(2, 40); k > 0; --k) {
      breaks.push_back(breaks.back() + random.Logarithmic(1e-9, 1));
    }
    SplineBasis u = SplineBasis::Clamped(degree, breaks), v = random.Basis(random.Integer(1, 4));
    Eigen::Matrix3Xd points(3, u.size() * v.size());
    for (double& x : points.reshaped()) x = random.Real(-1, 1);
    const bool rational = random.Coin();
    const Eigen::VectorXd weights = rational ? random.Weights(points.cols()) : Eigen::VectorXd();
    const SurfaceEvaluator evaluator(NurbsSurface(u, v, points, weights));
    for (double knot : breaks) {
      for (double at : {knot, std::nextafter(knot, 1e9), std::nextafter(knot, -1e9)}) {
        ExpectRoundedJet(evaluator, at, random.Parameter(v));
      }
    }
  }
}

TEST(SurfaceEvaluatorTest, KnotsBelongToTheSpanOnTheirRight) {
  const SplineBasis creased(2, {0, 0, 0, 1, 1, 2, 2, 2});
  Eigen::Matrix3Xd points(3, 10);
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 2; ++j) points.col(2 * i + j) << i, j, i % 2;
  }
  const SurfaceEvaluator evaluator(NurbsSurface(creased, SplineBasis(1, {0, 0, 1, 1}), points));
  const double before = std::nextafter(1.0, 0.0);
  EXPECT_NEAR(evaluator.JetAt(1, 0.5).du[2], 2, 1e-12);
  EXPECT_NEAR(evaluator.JetAt(before, 0.5).du[2], -2, 1e-12);
  EXPECT_NEAR(evaluator.JetAt(2, 0.5).du[2], -2, 1e-12);  // the upper end: from the left
}

TEST(SurfaceEvaluatorTest, OutsideParametersAreThoseOfTheDomain) {
  RandomSplines random(5);
  for (int k = 0; k < 60; ++k) {
    const BasisKind u_kind = KindOfBasis(k % 3), v_kind = KindOfBasis(k / 3 % 3);
    const SurfaceEvaluator evaluator(
        random.Surface(random.Integer(1, 5), random.Integer(1, 5), k % 2 == 1, u_kind, v_kind));
    const SplineBasis &bu = evaluator.surface().basis_u(), &bv = evaluator.surface().basis_v();
    const double u = random.Real(-50, 50), v = random.Real(-50, 50);
    EXPECT_EQ(evaluator.At(u, v), evaluator.At(bu.Clamp(u), bv.Clamp(v)));
    EXPECT_EQ(evaluator.JetAt(u, v).duv, evaluator.JetAt(bu.Clamp(u), bv.Clamp(v)).duv);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_THROW(evaluator.At(NAN, v), std::invalid_argument);
    EXPECT_THROW(evaluator.NormalAt(u, NAN), std::invalid_argument);
    if (bu.periodic()) {
      EXPECT_THROW(evaluator.JetAt(kInfinity, v), std::invalid_argument);
    } else {
      EXPECT_EQ(evaluator.At(kInfinity, v), evaluator.At(bu.upper(), v));
      EXPECT_EQ(evaluator.At(-kInfinity, v), evaluator.At(bu.lower(), v));
    }
  }
}

TEST(SurfaceEvaluatorTest, OneOrManyAndAnyNumberOfThreadsAreTheSameBits) {
  ThreadPool two(2), five(5);
  for (int k = 0; k < 12; ++k) {
    SCOPED_TRACE(k);
    RandomSplines random(static_cast<unsigned>(k));
    const int degree = k % 3 == 0 ? 3 : random.Integer(1, 7);
    const NurbsSurface surface = random.Surface(degree, degree, k % 2 == 1, KindOfBasis(k / 4));
    const SurfaceEvaluator evaluator(k % 4 == 3 ? Tempered(surface, 0.1) : surface);
    const Eigen::Matrix2Xd at = AnyParameters(surface, 9001, random);
    Eigen::Matrix3Xd one, other;
    std::vector<SurfaceJet> jets, other_jets;
    evaluator.Points(at, one);
    evaluator.Jets(at, jets);
    for (ThreadPool* pool : {&two, &five}) {
      evaluator.Points(at, other, *pool);
      EXPECT_EQ(one, other);
      evaluator.Jets(at, other_jets, *pool);
      EXPECT_TRUE(SameBits(jets.data(), other_jets.data(), jets.size() * sizeof(SurfaceJet)));
    }
    for (Eigen::Index i = 0; i < at.cols(); i += 7) {
      ASSERT_EQ(evaluator.At(at(0, i), at(1, i)), one.col(i));
      const SurfaceJet jet = evaluator.JetAt(at(0, i), at(1, i));
      ASSERT_TRUE(SameBits(&jet, &jets[static_cast<size_t>(i)], sizeof jet));
    }
    std::vector<double> us, vs;
    for (int i = 0; i < 61; ++i) us.push_back(at(0, i));
    for (int i = 0; i < 613; ++i) vs.push_back(at(1, i));
    std::sort(vs.begin(), vs.begin() + 400);
    SurfaceGrid grid, other_grid;
    evaluator.Grid(us, vs, grid);
    evaluator.Grid(us, vs, other_grid, five);
    EXPECT_EQ(grid.points, other_grid.points);
    EXPECT_EQ(grid.normals, other_grid.normals);
    for (int i = 0; i < 61; i += 9) {
      for (int j = 0; j < 613; j += 5) {
        SurfaceGrid single;
        evaluator.Grid({&us[static_cast<size_t>(i)], 1}, {&vs[static_cast<size_t>(j)], 1}, single);
        ASSERT_EQ(single.points.col(0), grid.points.col(613 * i + j));
        ASSERT_EQ(single.normals.col(0), grid.normals.col(613 * i + j));
      }
    }
  }
}

// A direction is as good as the tangents: what rounding may turn them by. Below 2^-20 of their
// sizes a grid asks NurbsSurface::NormalAt.
void ExpectGridNormals(const SurfaceEvaluator& evaluator,
                       const std::vector<double>& us,
                       const std::vector<double>& vs) {
  SurfaceGrid grid;
  evaluator.Grid(us, vs, grid);
  const NurbsSurface& surface = evaluator.surface();
  const NurbsSurface spread = Spread(surface);
  for (size_t i = 0; i < us.size(); ++i) {
    for (size_t j = 0; j < vs.size(); ++j) {
      SCOPED_TRACE("u = " + std::to_string(us[i]) + ", v = " + std::to_string(vs[j]));
      const Eigen::Index k = static_cast<Eigen::Index>(i * vs.size() + j);
      const double u = surface.basis_u().Clamp(us[i]), v = surface.basis_v().Clamp(vs[j]);
      const JetColumns sizes = SizesAt(spread, u, v);
      const Eigen::Vector3d point = surface.At(u, v);
      const Eigen::Vector3d error = (grid.points.col(k) - point).cwiseAbs();
      EXPECT_LE(error.maxCoeff(), kPromised * sizes(0, 0) + kEpsilon * point.cwiseAbs().maxCoeff());
      const auto wanted = surface.NormalAt(u, v);
      const Eigen::Vector3d got = grid.normals.col(k);
      const auto alone = evaluator.NormalAt(us[i], vs[j]);
      EXPECT_EQ(alone.value_or(Eigen::Vector3d::Zero()), got);
      if (!wanted) continue;
      const SurfaceJet jet = surface.JetAt(u, v);
      const double sine = jet.du.cross(jet.dv).norm();
      const double turn = sizes.col(1).norm() * jet.dv.norm() + sizes.col(2).norm() * jet.du.norm();
      EXPECT_LE((got - *wanted).norm(), kPromised * turn / sine + 4 * kEpsilon);
    }
  }
}

TEST(SurfaceEvaluatorTest, GridsHaveThePointsAndNormalsOfTheSurface) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const SurfaceEvaluator evaluator(surface);
    std::vector<double> us, vs;
    for (int k = 0; k < 4; ++k) us.push_back(AnyParameter(surface.basis_u(), random));
    for (int k = 0; k < 11; ++k) vs.push_back(AnyParameter(surface.basis_v(), random));
    ExpectGridNormals(evaluator, us, vs);
    std::sort(vs.begin(), vs.end());
    ExpectGridNormals(evaluator, us, vs);
  });
}

// At poles and tips the answer is that of NurbsSurface, to the bit.
TEST(SurfaceEvaluatorTest, NormalsOfCollapsedEdgesAreThoseOfTheSurface) {
  const std::vector<double> around = {0.07, 0.25, 0.7}, along = {0, 0.1, 0.5, 1};
  for (const NurbsSurface& surface : {Sphere(2), Cone(1, 2)}) {
    const SurfaceEvaluator evaluator(surface);
    ExpectGridNormals(evaluator, around, along);
    for (double u : around) EXPECT_EQ(evaluator.NormalAt(u, 0), surface.NormalAt(u, 0));
  }
}

TEST(SurfaceEvaluatorTest, NormalsThatDoNotExistAreZero) {
  RandomSplines random(3);
  const NurbsSurface surface = random.Surface(2, 3, false);
  Eigen::Matrix3Xd points = surface.control_points();
  for (auto point : points.colwise()) point = (point[0] * Eigen::Vector3d(1, 2, 4)).eval();
  const SurfaceEvaluator line(WithPoints(surface, points));
  points.setConstant(0.3);
  const SurfaceEvaluator point(WithPoints(surface, points));
  const std::vector<double> us = {surface.basis_u().lower(), surface.basis_u().upper()};
  const std::vector<double> vs = {surface.basis_v().lower(), surface.basis_v().upper()};
  for (const SurfaceEvaluator& evaluator : {line, point}) {
    SurfaceGrid grid;
    evaluator.Grid(us, vs, grid);
    EXPECT_EQ(grid.normals, (Eigen::Matrix3Xd::Zero(3, 4)));
    EXPECT_FALSE(evaluator.NormalAt(us[0], vs[0]));
  }
  EXPECT_EQ(point.At(0, 0), Eigen::Vector3d::Constant(0.3));
}

// Powers of two change no digit.
TEST(SurfaceEvaluatorTest, ScalingByPowersOfTwoScalesTheAnswers) {
  RandomSplines random(11);
  for (int k = 0; k < 20; ++k) {
    const NurbsSurface surface = random.Surface(random.Integer(1, 6), 3, k % 2 == 1);
    const SurfaceEvaluator evaluator(surface);
    for (double scale : {0x1p-30, 0x1p30}) {
      const SurfaceEvaluator scaled(WithPoints(surface, scale * surface.control_points()));
      const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
      EXPECT_EQ(Columns(scaled.JetAt(u, v)), scale * Columns(evaluator.JetAt(u, v)));
      EXPECT_EQ(scaled.NormalAt(u, v), evaluator.NormalAt(u, v));
    }
  }
}

TEST(SurfaceEvaluatorTest, FarFromTheOriginDerivativesKeepAllDigits) {
  RandomSplines random(12);
  for (int k = 0; k < 20; ++k) {
    const NurbsSurface raw = random.Surface(3, random.Integer(1, 6), k % 2 == 1);
    Eigen::Matrix3Xd points = raw.control_points();
    for (double& x : points.reshaped()) x = std::round(x * 0x1p20) * 0x1p-20;
    const NurbsSurface surface = WithPoints(raw, points);
    const SurfaceEvaluator near(surface),
        far(surface.Translated(Eigen::Vector3d::Constant(0x1p30)));
    const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
    EXPECT_EQ(Columns(near.JetAt(u, v)).rightCols<5>(), Columns(far.JetAt(u, v)).rightCols<5>());
  }
}

// A patch of degree 11 × 11 has 4.6 kB.
TEST(SurfaceEvaluatorTest, LargeNetsDoWithoutPatches) {
  for (int size : {60, 97}) {
    const SplineBasis basis = SplineBasis::Uniform(11, size, 0, 1);
    Eigen::Matrix3Xd points(3, size * size);
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) {
        const double u = basis.Greville(i), v = basis.Greville(j);
        points.col(i * size + j) << u, v, std::sin(4 * u + 7 * v);
      }
    }
    const SurfaceEvaluator evaluator(NurbsSurface(basis, basis, points));
    EXPECT_EQ(evaluator.table().patches == nullptr, size == 97);
    RandomSplines random(4);
    for (int k = 0; k < 5; ++k) ExpectRoundedJet(evaluator, random.Real(0, 1), random.Real(0, 1));
  }
}

TEST(SurfaceEvaluatorTest, ACopyOutlivesItsOriginal) {
  RandomSplines random(2);
  auto original = std::make_unique<SurfaceEvaluator>(random.Surface(3, 3, true));
  const Eigen::Vector3d point = original->At(0.1, 0.2), outside = original->At(100, -100);
  const SurfaceEvaluator copy = *original;
  original.reset();
  EXPECT_EQ(copy.At(0.1, 0.2), point);
  EXPECT_EQ(copy.At(100, -100), outside);
}

TEST(SurfaceEvaluatorTest, NothingAskedNothingGiven) {
  RandomSplines random(2);
  const SurfaceEvaluator evaluator(random.Surface(3, 3, true));
  Eigen::Matrix3Xd points(3, 5);
  std::vector<SurfaceJet> jets(3);
  SurfaceGrid grid;
  ThreadPool pool(2);
  evaluator.Points(Eigen::Matrix2Xd(2, 0), points);
  evaluator.Jets(Eigen::Matrix2Xd(2, 0), jets, pool);
  evaluator.Grid({}, std::vector<double>{0.5}, grid, pool);
  EXPECT_EQ(points.cols() + static_cast<Eigen::Index>(jets.size()) + grid.points.cols(), 0);
  evaluator.Grid(std::vector<double>{0.5}, {}, grid);
  EXPECT_EQ(grid.normals.cols(), 0);
}

TEST(SurfaceEvaluatorTest, AgreesWithOtherImplementations) {
  fixtures::CheckAll(
      "surface_eval.json",
      [](const fixtures::Json& input, const fixtures::Json& expected, double tolerance) {
        const SurfaceEvaluator evaluator(fixtures::Surface(input.at("surface")));
        const double u = input.at("u"), v = input.at("v");
        if (expected.contains("point")) {
          fixtures::ExpectClose(
              evaluator.At(u, v), fixtures::Vector(expected.at("point")), tolerance);
        } else if (expected.contains("derivs")) {
          const fixtures::Json& table = expected.at("derivs");
          const int order = input.at("order");
          const JetColumns jet = Columns(evaluator.JetAt(u, v));
          const int column[3][3] = {{0, 2, 5}, {1, 4, -1}, {3, -1, -1}};
          // One scale for the whole table, as the files say.
          double largest = 1;
          for (const auto& row : table) {
            for (const auto& d : row) {
              largest = std::max(largest, fixtures::Vector(d).cwiseAbs().maxCoeff());
            }
          }
          for (int k = 0; k <= std::min(order, 2); ++k) {
            for (int l = 0; k + l <= std::min(order, 2); ++l) {
              const Eigen::Vector3d wanted = fixtures::Vector(table.at(k).at(l));
              EXPECT_LE((jet.col(column[k][l]) - wanted).cwiseAbs().maxCoeff(), tolerance * largest)
                  << k << ' ' << l;
            }
          }
        }
      });
}

}  // namespace batten::internal::surface_evaluator_test
