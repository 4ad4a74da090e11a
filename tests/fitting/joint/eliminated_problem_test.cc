// SPDX-License-Identifier: MIT
#include "fitting/joint/eliminated_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "joint_cases.h"
#include "tolerances.h"

namespace batten::internal::eliminated_problem_test {

using testing::HasSubstr;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Half the sum of squares over all cells; `jacobian` asks for the rows that carry derivatives.
double Cost(const EliminatedProblem& cells, bool jacobian) {
  double cost = 0;
  Eigen::VectorXd residual(cells.rows());
  RowMajor J(cells.rows(), cells.columns());
  for (int c = 0; c < cells.cells(); ++c) {
    cells.Evaluate(c, residual.data(), jacobian ? J.data() : nullptr);
    cost += residual.squaredNorm() / 2;
  }
  return cost;
}

// Where every unknown is kept, in the order of the assembled system: control points, weights, gaps.
std::vector<double*> Unknowns(EliminatedProblem& cells) {
  std::vector<double*> unknowns;
  for (int b = 0; b < cells.blocks(); ++b) {
    for (int d = 0; d < cells.dimension(); ++d) unknowns.push_back(cells.point(b) + d);
  }
  if (cells.free_weights()) {
    for (int b = 0; b < cells.blocks(); ++b) unknowns.push_back(cells.log_weight(b));
  }
  for (int d = 0; d < cells.directions(); ++d) {
    for (int g = 0; g < cells.gaps(d); ++g) unknowns.push_back(cells.log_gaps(d) + g);
  }
  return unknowns;
}

// The column of the assembled system for every column of a cell's rows.
std::vector<int> ColumnsOf(const EliminatedProblem& cells, int cell) {
  std::vector<int> columns;
  const int dim = cells.dimension(), blocks = cells.blocks();
  for (const int b : cells.BlocksOf(cell)) {
    for (int d = 0; d < dim; ++d) columns.push_back(dim * b + d);
  }
  int next = dim * blocks;
  if (cells.free_weights()) {
    for (const int b : cells.BlocksOf(cell)) columns.push_back(next + b);
    next += blocks;
  }
  for (int d = 0; d < cells.directions(); ++d) {
    for (int g = 0; g < cells.gaps(d); ++g) columns.push_back(next++);
  }
  return columns;
}

struct System {
  Eigen::MatrixXd matrix;    // Σ JᵀJ
  Eigen::VectorXd gradient;  // Σ Jᵀr
};

System Assemble(EliminatedProblem& cells) {
  const auto n = static_cast<Eigen::Index>(Unknowns(cells).size());
  System system{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  Eigen::VectorXd residual(cells.rows());
  RowMajor J(cells.rows(), cells.columns());
  for (int c = 0; c < cells.cells(); ++c) {
    cells.Evaluate(c, residual.data(), J.data());
    const std::vector<int> columns = ColumnsOf(cells, c);
    const Eigen::MatrixXd form = J.transpose() * J;
    const Eigen::VectorXd pull = J.transpose() * residual;
    for (size_t a = 0; a < columns.size(); ++a) {
      system.gradient[columns[a]] += pull[static_cast<Eigen::Index>(a)];
      for (size_t b = 0; b < columns.size(); ++b) {
        system.matrix(columns[a], columns[b]) +=
            form(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
      }
    }
  }
  return system;
}

// All eight combinations of what may be free; knots only where they can be.
std::vector<JointOptions> Freedoms(const JointKind& kind) {
  std::vector<JointOptions> all;
  for (const bool weights : {false, true}) {
    for (const bool u : {false, true}) {
      for (const bool v : {false, true}) {
        if ((u && kind.periodic) || (v && kind.curve)) continue;
        JointOptions options;
        options.free_weights = weights;
        options.free_knots_u = u;
        options.free_knots_v = v;
        all.push_back(options);
      }
    }
  }
  return all;
}

std::string Name(const JointOptions& options) {
  return std::string(options.orthogonal ? "orthogonal" : "at parameters") +
         (options.free_weights ? ", weights" : "") + (options.free_knots_u ? ", knots u" : "") +
         (options.free_knots_v ? ", knots v" : "") + ", loss " +
         std::to_string(static_cast<int>(options.loss));
}

using Law = std::function<void(const JointCase&, const JointOptions&, EliminatedProblem&)>;

// Every kind of shape with every freedom, losses and orthogonality in turn; fairness and the prior
// of weights are large enough to be seen.
void ForCases(JointKind (*change)(JointKind), const std::vector<Loss>& losses, const Law& law) {
  unsigned seed = 0;
  for (const JointKind& any : JointKinds()) {
    const JointKind kind = change(any);
    for (JointOptions options : Freedoms(kind)) {
      for (const bool orthogonal : {false, true}) {
        ++seed;
        options.orthogonal = orthogonal;
        options.loss = losses[seed % losses.size()];
        options.loss_scale = 0.03;
        options.fairness = 1e-3;
        options.weight_prior = 0.5;
        SCOPED_TRACE("seed " + std::to_string(seed) + ", " + kind.Name() + ", " + Name(options));
        RandomSplines random(seed);
        const JointCase c = RandomJointCase(random, kind);
        ThreadPool pool(1);
        EliminatedProblem cells(c.problem, c.net, c.weights, options, pool);
        law(c, options, cells);
        if (testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

JointKind Same(JointKind kind) { return kind; }

// Of degree one a shape has kinks, where the foot points of a whole wedge of points are: there the
// distance has no normal, and differences see points enter and leave.
JointKind Smooth(JointKind kind) {
  kind.least_degree = 2;
  return kind;
}

JointKind Exact(JointKind kind) {
  kind.noise = 0;
  kind.count = 150;
  return kind;
}

class JointCellsLossTest : public testing::TestWithParam<Loss> {};

TEST_P(JointCellsLossTest, HasTheSameCostWithAndWithoutDerivatives) {
  ForCases(Same, {GetParam()}, [](const JointCase&, const JointOptions&, EliminatedProblem& cells) {
    ASSERT_TRUE(cells.Project());
    cells.Accept();
    const double plain = Cost(cells, false);
    EXPECT_GT(plain, 0);
    EXPECT_NEAR(Cost(cells, true), plain, kIterated * plain);
  });
}

// Foot points move while the unknowns do; eliminated rightly, the gradient of the whole is what the
// rows say, since at a foot point the cost does not change with its parameters.
TEST_P(JointCellsLossTest, HasTheGradientThatDifferencesFind) {
  ForCases(
      Smooth, {GetParam()}, [](const JointCase&, const JointOptions&, EliminatedProblem& cells) {
        cells.damping = 0;
        ASSERT_TRUE(cells.Project());
        cells.Accept();
        const Eigen::VectorXd gradient = Assemble(cells).gradient;
        const double scale = gradient.cwiseAbs().maxCoeff();
        ASSERT_GT(scale, 0);
        const std::vector<double*> unknowns = Unknowns(cells);
        constexpr double kStep = 1e-6;
        for (size_t k = 0; k < unknowns.size(); k += unknowns.size() / 12 + 1) {
          const double middle = *unknowns[k];
          *unknowns[k] = middle + kStep;
          ASSERT_TRUE(cells.Project());
          const double above = Cost(cells, false);
          *unknowns[k] = middle - kStep;
          ASSERT_TRUE(cells.Project());
          const double below = Cost(cells, false);
          *unknowns[k] = middle;
          // Points that pass a corner of the loss or an end of the domain make the error linear in
          // the step; the rounding of the cost over the step is the rest.
          EXPECT_NEAR(gradient[static_cast<Eigen::Index>(k)],
                      (above - below) / (2 * kStep),
                      1e-5 * scale + 1e-9 * (above + below))
              << "unknown " << k << " of " << unknowns.size();
        }
      });
}

INSTANTIATE_TEST_SUITE_P(Losses,
                         JointCellsLossTest,
                         testing::Values(Loss::kNone, Loss::kHuber, Loss::kCauchy, Loss::kTukey));

// Data on the shape: no residual, so the matrix is that of the derivatives alone.
TEST(EliminatedProblemTest, HasTheNormalMatrixOfTheShapesOwnDerivatives) {
  ForCases(
      Exact, {Loss::kNone}, [](const JointCase& c, const JointOptions& given, EliminatedProblem&) {
        JointOptions options = given;
        options.orthogonal = false;
        options.fairness = options.weight_prior = 0;
        ThreadPool pool(1);
        EliminatedProblem cells(c.problem, c.net, c.weights, options, pool);
        cells.damping = 0;
        ASSERT_TRUE(cells.Project());
        cells.Accept();
        const Eigen::MatrixXd matrix = Assemble(cells).matrix;
        const FittingData& data = c.problem.data();
        const std::vector<double*> unknowns = Unknowns(cells);
        const Eigen::Index dim = c.net.rows(), m = data.values.cols();
        Eigen::MatrixXd J(dim * m, static_cast<Eigen::Index>(unknowns.size()));
        const auto points = [&] {
          const TensorShape& shape = cells.shape();
          Eigen::VectorXd all(dim * m);
          for (Eigen::Index k = 0; k < m; ++k) {
            const double root = data.weights.size() > 0 ? std::sqrt(data.weights[k]) : 1;
            all.segment(dim * k, dim) =
                root * PointOf(shape, data.parameters(0, k), data.parameters(1, k)).head(dim);
          }
          return all;
        };
        constexpr double kStep = 1e-5;
        for (size_t k = 0; k < unknowns.size(); ++k) {
          const double middle = *unknowns[k];
          *unknowns[k] = middle + kStep;
          ASSERT_TRUE(cells.Project());
          J.col(static_cast<Eigen::Index>(k)) = points();
          *unknowns[k] = middle - kStep;
          ASSERT_TRUE(cells.Project());
          J.col(static_cast<Eigen::Index>(k)) -= points();
          *unknowns[k] = middle;
        }
        J /= 2 * kStep;
        const Eigen::MatrixXd expected = J.transpose() * J;
        // Differences; where a moving knot of degree 2 passes a point, they are right to the step
        // only.
        EXPECT_LE((matrix - expected).cwiseAbs().maxCoeff(),
                  2 * kStep * expected.cwiseAbs().maxCoeff());
      });
}

// A step x costs ½ x·D·x more for the damping, D being what damping adds to the matrix.
TEST(EliminatedProblemTest, DampsByTheFormThatItAddsToTheMatrix) {
  ForCases(Same,
           {Loss::kNone, Loss::kCauchy},
           [](const JointCase& c, const JointOptions& options, EliminatedProblem& damped) {
             if (options.free_knots_u || options.free_knots_v)
               return;  // knots are not linear in the gaps
             ThreadPool pool(1);
             EliminatedProblem free(c.problem, c.net, c.weights, options, pool);
             free.damping = 0;
             damped.damping = 0.7;
             for (EliminatedProblem* cells : {&free, &damped}) {
               ASSERT_TRUE(cells->Project());
               cells->Accept();
             }
             const System plain = Assemble(free), heavy = Assemble(damped);
             const Eigen::MatrixXd more = heavy.matrix - plain.matrix;
             EXPECT_LE((heavy.gradient - plain.gradient).cwiseAbs().maxCoeff(),
                       kIterated * plain.gradient.cwiseAbs().maxCoeff());
             const std::vector<double*> unknowns[] = {Unknowns(free), Unknowns(damped)};
             RandomSplines random(1);
             Eigen::VectorXd step(more.rows());
             for (Eigen::Index k = 0; k < step.size(); ++k) {
               step[k] = random.Real(-1e-2, 1e-2);
               for (const auto& of : unknowns) *of[static_cast<size_t>(k)] += step[k];
             }
             ASSERT_TRUE(free.Project());
             ASSERT_TRUE(damped.Project());
             const double expected = step.dot(more * step) / 2, cost = Cost(free, false);
             EXPECT_GT(expected, 0);
             EXPECT_NEAR(Cost(damped, false) - cost, expected, kIterated * (expected + cost));
           });
}

TEST(EliminatedProblemTest, ReturnsToTheCostOfTheStateItCameFrom) {
  ForCases(
      Smooth, {Loss::kNone}, [](const JointCase&, const JointOptions&, EliminatedProblem& cells) {
        ASSERT_TRUE(cells.Project());
        cells.Accept();
        const double cost = Cost(cells, false);
        const std::vector<double*> unknowns = Unknowns(cells);
        std::vector<double> before;
        for (double* x : unknowns) {
          before.push_back(*x);
          *x += 1e-3;
        }
        ASSERT_TRUE(cells.Project());
        for (size_t k = 0; k < unknowns.size(); ++k) *unknowns[k] = before[k];
        ASSERT_TRUE(cells.Project());
        EXPECT_NEAR(Cost(cells, false), cost, kIterated * cost);
      });
}

// What no step may lead to: not finite, weights or gaps far from those accepted.
TEST(EliminatedProblemTest, RefusesStepsThatAreTooFar) {
  ForCases(Smooth,
           {Loss::kNone},
           [](const JointCase&, const JointOptions& options, EliminatedProblem& cells) {
             ASSERT_TRUE(cells.Project());
             cells.Accept();
             const auto refuses = [&](double& unknown, double value) {
               const double before = unknown;
               unknown = value;
               const bool refused = !cells.Project();
               unknown = before;
               return refused;
             };
             EXPECT_TRUE(refuses(*cells.point(0), std::nan("")));
             EXPECT_TRUE(refuses(*cells.point(0), INFINITY));
             if (options.free_weights) {
               EXPECT_TRUE(refuses(*cells.log_weight(0), std::nan("")));
               EXPECT_TRUE(refuses(*cells.log_weight(0), *cells.log_weight(0) + 3));
               EXPECT_TRUE(refuses(*cells.log_weight(0), 1e3));
             }
             for (int d = 0; d < cells.directions(); ++d) {
               if (!cells.free_knots(d)) continue;
               EXPECT_TRUE(refuses(*cells.log_gaps(d), std::nan("")));
               EXPECT_TRUE(refuses(*cells.log_gaps(d), -1e3));
               EXPECT_TRUE(refuses(*cells.log_gaps(d), 1e3));
             }
             EXPECT_TRUE(cells.Project());
           });
}

TEST(EliminatedProblemTest, HasTheKnotsDerivativesThatDifferencesFind) {
  ForCases(
      Same, {Loss::kNone}, [](const JointCase&, const JointOptions&, EliminatedProblem& cells) {
        ASSERT_TRUE(cells.Project());
        cells.Accept();
        for (int d = 0; d < cells.directions(); ++d) {
          if (!cells.free_knots(d)) continue;
          const auto knots = [&] {
            const SplineBasis& basis = d == 0 ? cells.shape().basis_u : *cells.shape().basis_v;
            return Eigen::Map<const Eigen::VectorXd>(basis.knots().data(),
                                                     std::ssize(basis.knots()))
                .eval();
          };
          const Eigen::MatrixXd chain = cells.KnotChain(d);
          ASSERT_EQ(chain.cols(), cells.gaps(d));
          for (int g = 0; g < cells.gaps(d); ++g) {
            constexpr double kStep = 1e-6;
            double& x = cells.log_gaps(d)[g];
            const double middle = x;
            x = middle + kStep;
            ASSERT_TRUE(cells.Project());
            const Eigen::VectorXd above = knots();
            x = middle - kStep;
            ASSERT_TRUE(cells.Project());
            const Eigen::VectorXd below = knots();
            x = middle;
            EXPECT_LE((chain.col(g) - (above - below) / (2 * kStep)).cwiseAbs().maxCoeff(),
                      kHalfDigits);
          }
        }
      });
}

TEST(EliminatedProblemTest, GivesCopiesOfPeriodicControlPointsOneBlock) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const JointCase c =
        RandomJointCase(random, {.curve = seed % 2 == 0, .rational = true, .periodic = true});
    ThreadPool pool(1);
    JointOptions options;
    options.free_weights = true;
    EliminatedProblem cells(c.problem, c.net, c.weights, options, pool);
    const int size_v = c.problem.is_curve() ? 1 : c.problem.basis_v().size();
    const int round = (c.problem.basis_u().size() - c.problem.basis_u().degree()) * size_v;
    EXPECT_EQ(cells.blocks(), round);
    for (int k = 0; k < c.net.cols(); ++k) EXPECT_EQ(cells.BlockOf(k), k % round);
    ASSERT_TRUE(cells.Project());
    cells.Accept();
    for (int b = 0; b < cells.blocks(); ++b) {
      *cells.point(b) += random.Real(-1e-2, 1e-2);
      *cells.log_weight(b) += random.Real(-1e-2, 1e-2);
    }
    ASSERT_TRUE(cells.Project());
    const TensorShape& shape = cells.shape();
    for (int k = round; k < c.net.cols(); ++k) {
      EXPECT_EQ(shape.net.col(k), shape.net.col(k - round));
      EXPECT_EQ(shape.weights[k], shape.weights[k - round]);
    }
  }
}

// A common factor of all weights is no change of the shape: data alone do not resist it.
TEST(EliminatedProblemTest, DoesNotSeeACommonFactorOfWeights) {
  ForCases(Exact,
           {Loss::kNone},
           [](const JointCase& c, const JointOptions& options, EliminatedProblem& cells) {
             if (!options.free_weights) return;
             ASSERT_TRUE(cells.Project());
             // A start's common factor is taken out.
             ThreadPool pool(1);
             EliminatedProblem scaled(c.problem, c.net, 37 * c.weights, options, pool);
             ASSERT_TRUE(scaled.Project());
             EXPECT_LE((scaled.log_weights() - cells.log_weights()).cwiseAbs().maxCoeff(),
                       kRounding);
             EXPECT_NEAR(cells.log_weights().sum(), 0, kRounding);
           });
}

TEST(EliminatedProblemTest, GivesTheSameBitsForEveryNumberOfThreads) {
  unsigned seed = 100;
  for (const JointKind& kind : JointKinds()) {
    SCOPED_TRACE("seed " + std::to_string(++seed) + ", " + kind.Name());
    RandomSplines random(seed);
    JointKind many = kind;
    many.count = 3000;
    const JointCase c = RandomJointCase(random, many);
    JointOptions options;
    options.free_weights = true;
    options.free_knots_u = !kind.periodic;
    std::vector<double> costs;
    for (const int threads : {1, 2, 3}) {
      ThreadPool pool(threads);
      EliminatedProblem cells(c.problem, c.net, c.weights, options, pool);
      ASSERT_TRUE(cells.Project());
      cells.Accept();
      costs.push_back(Cost(cells, true));
    }
    EXPECT_EQ(costs[0], costs[1]);
    EXPECT_EQ(costs[0], costs[2]);
  }
}

TEST(EliminatedProblemTest, RefusesWhatDoesNotGoTogether) {
  RandomSplines random(1);
  const JointCase c = RandomJointCase(random, {});
  const JointOptions options;
  ThreadPool pool(1);
  const auto refusal = [&](const FittingProblem& problem,
                           const Eigen::MatrixXd& net,
                           const Eigen::VectorXd& weights) -> std::string {
    try {
      EliminatedProblem(problem, net, weights, options, pool);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  const Eigen::Index n = c.net.cols();
  EXPECT_EQ(refusal(c.problem, c.net, c.weights), "accepted");
  EXPECT_EQ(refusal(c.problem, c.net, {}), "accepted");
  EXPECT_THAT(refusal(c.problem, c.net.leftCols(n - 1), {}), HasSubstr("as many"));
  EXPECT_THAT(refusal(c.problem, c.net, c.weights.head(n - 1)), HasSubstr("as many"));
  EXPECT_THAT(refusal(c.problem, c.net.topRows(2), {}), HasSubstr("dimension"));
  Eigen::MatrixXd net = c.net;
  net(1, 2) = std::nan("");
  EXPECT_THAT(refusal(c.problem, net, {}), HasSubstr("finite"));
  for (const double bad : {0.0, -1.0, std::nan(""), double(INFINITY)}) {
    Eigen::VectorXd weights = c.weights;
    weights[3] = bad;
    EXPECT_THAT(refusal(c.problem, c.net, weights), HasSubstr("weights")) << bad;
  }
  auto flat = std::make_shared<FittingData>(c.problem.data());
  flat->values = flat->values.topRows(2).eval();
  const FittingProblem plane(c.problem.basis_u(), c.problem.basis_v(), flat, 0);
  EXPECT_THAT(refusal(plane, c.net.topRows(2), {}), HasSubstr("three coordinates"));
  const JointCase tube = RandomJointCase(random, {.periodic = true});
  JointOptions knots;
  knots.free_knots_u = true;
  EXPECT_THROW(EliminatedProblem(tube.problem, tube.net, tube.weights, knots, pool),
               std::invalid_argument);
}

}  // namespace batten::internal::eliminated_problem_test
