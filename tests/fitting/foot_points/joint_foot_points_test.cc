// SPDX-License-Identifier: MIT
#include "fitting/foot_points/joint_foot_points.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "joint_cases.h"
#include "tolerances.h"

namespace batten::internal::joint_foot_points_test {

void ForShapes(const std::function<void(RandomSplines&, const JointCase&, const TensorShape&)>& law,
               JointKind change = {}) {
  unsigned seed = 0;
  for (JointKind kind : JointKinds()) {
    kind.least_degree = change.least_degree;
    kind.noise = change.noise;
    for (int repeat = 0; repeat < 4; ++repeat) {
      SCOPED_TRACE("seed " + std::to_string(++seed) + ", " + kind.Name());
      RandomSplines random(seed);
      const JointCase c = RandomJointCase(random, kind);
      law(random, c, ShapeOf(c.problem, c.net, c.weights));
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

FootPointSet Project(const TensorShape& shape,
                     const FittingData& data,
                     bool orthogonal,
                     int threads = 1,
                     std::vector<std::uint8_t> held = {}) {
  ThreadPool pool(threads);
  FootPointSet feet;
  FootProjector(data.values, orthogonal, pool, std::move(held))
      .Project(shape, data.parameters, feet);
  return feet;
}

struct Tangents {
  Eigen::VectorXd point, u, v;  // a curve's v is empty
};

Tangents TangentsAt(const TensorShape& shape, double u, double v) {
  if (shape.basis_v) {
    const SurfaceJet jet =
        NurbsSurface(shape.basis_u, *shape.basis_v, shape.net, shape.weights).JetAt(u, v);
    return {jet.point, jet.du, jet.dv};
  }
  if (shape.dimension() == 2) {
    const auto jet = NurbsCurve<2>(shape.basis_u, shape.net, shape.weights).JetAt(u);
    return {jet.point, jet.first, {}};
  }
  const auto jet = NurbsCurve<3>(shape.basis_u, shape.net, shape.weights).JetAt(u);
  return {jet.point, jet.first, {}};
}

bool Held(const SplineBasis& basis, double u) {
  return !basis.periodic() && (u == basis.lower() || u == basis.upper());
}

TEST(TensorShapeTest, HasFunctionsThatGiveItsPoints) {
  ForShapes([](RandomSplines&, const JointCase& c, const TensorShape& shape) {
    std::vector<double> R(static_cast<size_t>(shape.functions()));
    for (const auto uv : c.problem.data().parameters.colwise()) {
      const int span_u = shape.basis_u.Span(uv[0]);
      const int span_v = shape.basis_v ? shape.basis_v->Span(uv[1]) : 0;
      shape.Rational(span_u, span_v, uv[0], uv[1], R.data());
      Eigen::VectorXd point = Eigen::VectorXd::Zero(shape.dimension());
      double sum = 0;
      for (int k = 0; k < shape.functions(); ++k) {
        point += R[static_cast<size_t>(k)] * shape.net.col(shape.ControlPoint(span_u, span_v, k));
        sum += R[static_cast<size_t>(k)];
      }
      EXPECT_NEAR(sum, 1, kRounding);
      const Eigen::VectorXd expected = PointOf(shape, uv[0], uv[1]).head(shape.dimension());
      EXPECT_LE((point - expected).norm(), kRounding * shape.net.cwiseAbs().maxCoeff());
    }
  });
}

TEST(FootProjectorTest, HasTheDifferenceOfShapeAndDatumAtItsParameters) {
  ForShapes([](RandomSplines&, const JointCase& c, const TensorShape& shape) {
    const FittingData& data = c.problem.data();
    for (const bool orthogonal : {false, true}) {
      const FootPointSet feet = Project(shape, data, orthogonal);
      ASSERT_EQ(feet.parameters.cols(), data.values.cols());
      double squares = 0;
      for (Eigen::Index k = 0; k < data.values.cols(); ++k) {
        const Eigen::VectorXd expected =
            TangentsAt(shape, feet.parameters(0, k), feet.parameters(1, k)).point -
            data.values.col(k);
        EXPECT_LE((feet.difference.col(k) - expected).norm(), kRounding * 10);
        squares += expected.squaredNorm();
      }
      EXPECT_NEAR(feet.SquaredDistances(), squares, kIterated * squares);
    }
  });
}

TEST(FootProjectorTest, LeavesParametersAloneWhereDistancesAreNotOrthogonal) {
  ForShapes([](RandomSplines&, const JointCase& c, const TensorShape& shape) {
    const FootPointSet feet = Project(shape, c.problem.data(), false);
    EXPECT_EQ(feet.parameters, c.problem.data().parameters);
    for (const auto count : feet.directions) EXPECT_EQ(count, 0);
  });
}

TEST(FootProjectorTest, KeepsParametersThatAreHeldAndFindsTheNearestPlaceAlongTheOthers) {
  int along = 0;
  ForShapes(
      [&](RandomSplines&, const JointCase& c, const TensorShape& shape) {
        if (!shape.basis_v) return;
        const FittingData& data = c.problem.data();
        std::vector<std::uint8_t> held(static_cast<size_t>(data.values.cols()));
        for (size_t k = 0; k < held.size(); ++k) held[k] = static_cast<std::uint8_t>(k % 4);
        const FootPointSet feet = Project(shape, data, true, 1, held),
                           free = Project(shape, data, true);
        for (Eigen::Index k = 0; k < data.values.cols(); ++k) {
          const int sides = held[static_cast<size_t>(k)];
          if (sides == 0) {
            EXPECT_EQ(feet.parameters.col(k), free.parameters.col(k));
            continue;
          }
          for (const int row : {0, 1}) {
            const SplineBasis& basis = row == 0 ? shape.basis_u : *shape.basis_v;
            if ((sides & (row + 1)) != 0) {
              EXPECT_EQ(feet.parameters(row, k), data.parameters(row, k));
            } else if (!Held(basis, feet.parameters(row, k))) {
              const Tangents t = TangentsAt(shape, feet.parameters(0, k), feet.parameters(1, k));
              const Eigen::VectorXd difference = feet.difference.col(k);
              EXPECT_LE(std::abs(difference.dot((row == 0 ? t.u : t.v).normalized())),
                        kHalfDigits * difference.norm());
              EXPECT_EQ(feet.directions[static_cast<size_t>(k)], 2);
              ++along;
            }
          }
          if (sides == 3) {
            EXPECT_EQ(feet.directions[static_cast<size_t>(k)], 0);
          }
        }
      },
      {.least_degree = 2});  // without kinks, which steps only come near
  EXPECT_GT(along, 100);
}

TEST(FootProjectorTest, KeepsWhatMovingTheFootPointCanNotUndo) {
  int free = 0, edges = 0, ends = 0;
  ForShapes(
      [&](RandomSplines&, const JointCase& c, const TensorShape& shape) {
        const FittingData& data = c.problem.data();
        const FootPointSet feet = Project(shape, data, true);
        for (Eigen::Index k = 0; k < data.values.cols(); ++k) {
          const double u = feet.parameters(0, k), v = feet.parameters(1, k);
          ASSERT_GE(u, shape.basis_u.lower());
          ASSERT_LE(u, shape.basis_u.upper());
          const Tangents t = TangentsAt(shape, u, v);
          const Eigen::VectorXd difference = feet.difference.col(k);
          const bool held_u = Held(shape.basis_u, u),
                     held_v = shape.basis_v && Held(*shape.basis_v, v);
          // Along a direction that is not held the residual does not point: the place of a minimum
          // carries half of the digits, relative to the distance.
          const double at_right_angles = kHalfDigits * difference.norm();
          if (!held_u) {
            EXPECT_LE(std::abs(difference.dot(t.u.normalized())), at_right_angles) << k;
          }
          if (shape.basis_v && !held_v) {
            EXPECT_LE(std::abs(difference.dot(t.v.normalized())), at_right_angles) << k;
          }
          const int count = feet.directions[static_cast<size_t>(k)];
          const int expected = shape.basis_v ? (held_u && held_v   ? 0
                                                : held_u || held_v ? 2
                                                                   : 1)
                               : held_u      ? 0
                                             : shape.dimension() - 1;
          ASSERT_EQ(count, expected) << k;
          ++(count == 0 ? ends : held_u || held_v ? edges : free);
          if (count == 0) continue;
          const Eigen::VectorXd a = feet.first.col(k);
          EXPECT_NEAR(a.norm(), 1, kRounding);
          double kept = std::pow(a.dot(difference), 2);
          if (!held_u) {
            EXPECT_LE(std::abs(a.dot(t.u.normalized())), kIterated);
          }
          if (shape.basis_v && !held_v) {
            EXPECT_LE(std::abs(a.dot(t.v.normalized())), kIterated);
          }
          if (count == 2) {
            const Eigen::VectorXd b = feet.second.col(k);
            EXPECT_NEAR(b.norm(), 1, kRounding);
            EXPECT_NEAR(a.dot(b), 0, kIterated);
            if (!held_u) {
              EXPECT_LE(std::abs(b.dot(t.u.normalized())), kIterated);
            }
            if (shape.basis_v && !held_v) {
              EXPECT_LE(std::abs(b.dot(t.v.normalized())), kIterated);
            }
            kept += std::pow(b.dot(difference), 2);
          }
          // All of the distance is in the directions that count.
          EXPECT_NEAR(kept, difference.squaredNorm(), kIterated * difference.squaredNorm());
        }
      },
      {.noise = 0.05, .least_degree = 2});
  EXPECT_GT(free, 1000);
  EXPECT_GT(edges, 10);
  EXPECT_GT(ends, 10);
}

TEST(FootProjectorTest, IsNeverFartherThanItsStart) {
  ForShapes([](RandomSplines&, const JointCase& c, const TensorShape& shape) {
    const FittingData& data = c.problem.data();
    const FootPointSet start = Project(shape, data, false), foot = Project(shape, data, true);
    for (Eigen::Index k = 0; k < data.values.cols(); ++k) {
      EXPECT_LE(foot.difference.col(k).norm(),
                start.difference.col(k).norm() * (1 + kRounding) + kRounding);
    }
  });
}

TEST(FootProjectorTest, GivesTheSameBitsForEveryNumberOfThreads) {
  ForShapes([](RandomSplines&, const JointCase& c, const TensorShape& shape) {
    const FootPointSet one = Project(shape, c.problem.data(), true);
    const FootPointSet more = Project(shape, c.problem.data(), true, 3);
    EXPECT_EQ(one.parameters, more.parameters);
    EXPECT_EQ(one.difference, more.difference);
    EXPECT_EQ(one.directions, more.directions);
  });
}

Facing WatchedFacing(const TensorShape& shape, const Eigen::Matrix2Xd& feet) {
  ThreadPool pool(1);
  Facing facing = FacingOf(shape, pool);
  facing.Watch(shape, feet);
  return facing;
}

TensorShape Moved(const TensorShape& shape, RandomSplines& random, double distance) {
  TensorShape moved = shape;
  for (double& x : moved.net.reshaped()) x += random.Real(-distance, distance);
  if (shape.basis_u.periodic()) {
    const Eigen::Index copies = Eigen::Index{shape.basis_u.degree()} * shape.size_v();
    moved.net.rightCols(copies) = moved.net.leftCols(copies).eval();
  }
  return moved;
}

TEST(FacingTest, HasUnitDirectionsThatAreNormalsOrTangents) {
  ForShapes([](RandomSplines&, const JointCase& c, const TensorShape& shape) {
    const Facing facing = WatchedFacing(shape, c.problem.data().parameters);
    const std::vector<int> spans_u = shape.basis_u.Spans();
    const auto place = [](const SplineBasis& basis, Eigen::Index g) {
      const int span = basis.Spans()[static_cast<size_t>(g / 4)];
      const double a = basis.knots()[span], b = basis.knots()[span + 1];
      return a + (b - a) * (static_cast<double>(g % 4) + 0.5) / 4;
    };
    const Eigen::Index columns = shape.basis_v ? 4 * std::ssize(shape.basis_v->Spans()) : 1;
    ASSERT_EQ(facing.columns, columns);
    ASSERT_EQ(facing.directions.cols(), 4 * std::ssize(spans_u) * columns);
    for (Eigen::Index g = 0; g < facing.directions.cols(); ++g) {
      const Tangents t = TangentsAt(shape,
                                    place(shape.basis_u, g / columns),
                                    shape.basis_v ? place(*shape.basis_v, g % columns) : 0);
      const Eigen::VectorXd direction = facing.directions.col(g);
      EXPECT_NEAR(direction.norm(), 1, kRounding);
      if (shape.basis_v) {
        const Eigen::Vector3d normal = Eigen::Vector3d(t.u).cross(Eigen::Vector3d(t.v));
        EXPECT_NEAR(direction.dot(normal.normalized()), 1, kRounding);
      } else {
        EXPECT_NEAR(direction.dot(t.u.normalized()), 1, kRounding);
      }
    }
  });
}

TEST(FacingTest, KeepsItselfAndBearsSmallMoves) {
  ForShapes([](RandomSplines& random, const JointCase& c, const TensorShape& shape) {
    const Facing facing = WatchedFacing(shape, c.problem.data().parameters);
    EXPECT_TRUE(facing.Keeps(facing));
    ThreadPool pool(1);
    EXPECT_TRUE(FacingOf(Moved(shape, random, 0.01), pool).Keeps(facing));
  });
}

TEST(FacingTest, RefusesAShapeThatHasTurnedOver) {
  ForShapes([](RandomSplines&, const JointCase& c, const TensorShape& shape) {
    const Facing facing = WatchedFacing(shape, c.problem.data().parameters);
    TensorShape turned = shape;
    if (shape.basis_v) {
      turned.net.row(0) *= -1;
    } else {
      turned.net *= -1;
    }
    ThreadPool pool(1);
    EXPECT_FALSE(FacingOf(turned, pool).Keeps(facing));
  });
}

TEST(FacingTest, RefusesAShapeThatHasFolded) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const bool curve = seed % 2 == 0;
    const JointCase c = RandomJointCase(random, {.curve = curve, .count = 2000, .least_degree = 2});
    const TensorShape shape = ShapeOf(c.problem, c.net, c.weights);
    const Facing facing = WatchedFacing(shape, c.problem.data().parameters);
    // One row of control points of the middle is drawn back over those before it.
    TensorShape folded = shape;
    const int size_v = shape.size_v(), row = shape.basis_u.size() / 2;
    folded.net.row(0).segment(row * size_v, size_v).array() -= 8;
    ThreadPool pool(1);
    EXPECT_FALSE(FacingOf(folded, pool).Keeps(facing));
  }
}

// What no datum lies on may turn over.
TEST(FacingTest, WatchesOnlyWhereThereAreData) {
  ForShapes([](RandomSplines& random, const JointCase& c, const TensorShape& shape) {
    Eigen::Matrix2Xd feet = c.problem.data().parameters;
    const double middle = (shape.basis_u.lower() + shape.basis_u.upper()) / 2;
    for (double& u : feet.row(0)) u = random.Real(middle, shape.basis_u.upper());
    const Facing facing = WatchedFacing(shape, feet);
    const auto per_span = static_cast<size_t>(facing.columns);
    const std::vector<int> spans = shape.basis_u.Spans();
    size_t watched = 0;
    ASSERT_EQ(facing.watched.size(), static_cast<size_t>(facing.directions.cols()));
    for (size_t g = 0; g < facing.watched.size(); ++g) {
      const int span = spans[g / per_span / 4];
      const double a = shape.basis_u.knots()[span], b = shape.basis_u.knots()[span + 1];
      const double place = a + (b - a) * (static_cast<double>(g / per_span % 4) + 0.5) / 4;
      if (place < middle) {
        EXPECT_FALSE(facing.watched[g]) << g;
      }
      watched += facing.watched[g] ? 1 : 0;
    }
    EXPECT_GT(watched, 0u);
    Facing other = facing;
    for (size_t g = 0; g < facing.watched.size(); ++g) {
      if (!facing.watched[g]) other.directions.col(static_cast<Eigen::Index>(g)) *= -1;
    }
    EXPECT_TRUE(other.Keeps(facing));
    for (size_t g = 0; g < facing.watched.size(); ++g) {
      if (facing.watched[g]) {
        other.directions.col(static_cast<Eigen::Index>(g)) *= -1;
        break;
      }
    }
    EXPECT_FALSE(other.Keeps(facing));
  });
}

TEST(FacingTest, DoesNotKeepWhatHasOtherCells) {
  RandomSplines random(1);
  ThreadPool pool(1);
  const JointCase a = RandomJointCase(random, {});
  const TensorShape shape = ShapeOf(a.problem, a.net, a.weights);
  Facing facing = WatchedFacing(shape, a.problem.data().parameters);
  Facing fewer = facing;
  fewer.directions = facing.directions.leftCols(facing.directions.cols() - 1).eval();
  EXPECT_FALSE(fewer.Keeps(facing));
}

}  // namespace batten::internal::joint_foot_points_test
