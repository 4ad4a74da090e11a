// SPDX-License-Identifier: MIT
// The jobs of batten that `compare` times, one a call: prints a line of name=value (seconds on the
// wall and of the processor, numbers, errors against the truth). KIND is that of the cloud.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "batten/fitting/cloud_rows.h"
#include "batten/fitting/fit_curve.h"
#include "batten/fitting/fit_surface.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/surface_evaluator.h"
#include "fitting/joint/joint_optimization.h"
#include "jittered_shell.h"
#include "job_clouds.h"
#include "job_results.h"

using namespace batten;
using namespace batten::internal;

namespace batten::internal {
namespace {

using Words = std::span<const std::string>;

constexpr int kDegree = 3;

void PrintErrors(const Eigen::VectorXd& distances) {
  std::printf(" rms=%.4e max=%.4e",
              std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size())),
              distances.cwiseAbs().maxCoeff());
}

void MakeCloud(Words words) { WriteColumns(words[2], CloudOfKind(words[0], std::stol(words[1]))); }

// Heights over the points' own x and y in the unit square.
FittingProblem HeightProblem(const std::shared_ptr<const FittingData>& data, int net) {
  const SplineBasis basis = SplineBasis::Uniform(kDegree, net, 0, 1);
  return FittingProblem(basis, basis, data, 0);
}

std::shared_ptr<const FittingData> HeightsOf(const Eigen::Matrix3Xd& points) {
  auto data = std::make_shared<FittingData>();
  data->parameters = points.topRows<2>();
  data->values = points.row(2);
  return data;
}

// A spline of heights as a surface: x and y are the parameters.
NurbsSurface HeightSurface(const FittingProblem& problem, const Eigen::MatrixXd& heights) {
  const SplineBasis &u = problem.basis_u(), &v = problem.basis_v();
  Eigen::Matrix3Xd net(3, heights.cols());
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      const Eigen::Index k = Eigen::Index{i} * v.size() + j;
      net.col(k) << u.Greville(i), v.Greville(j), heights(0, k);
    }
  }
  return NurbsSurface(u, v, net);
}

void LeastSquares(Words words) {
  const int net = std::stoi(words[1]);
  const auto data = HeightsOf(ReadPoints(words[0]));
  ThreadPool pool(1);
  JobRuns runs;
  const Eigen::MatrixXd heights =
      RunJob(runs, [&] { return SolveLinear(HeightProblem(data, net), pool).coefficients; });
  const Eigen::Matrix3Xd truth = TruthGrid(Franke, 201);
  Eigen::Matrix3Xd found;
  SurfaceEvaluator(HeightSurface(HeightProblem(data, net), heights))
      .Points(truth.topRows<2>(), found);
  runs.PrintSeconds();
  std::printf(" numbers=%d", net * net);
  PrintErrors((found - truth).row(2).transpose());
}

void Surface(Words words) {
  PointCloud cloud = PointCloud::FromWorld(ReadPoints(words[1]));
  SurfaceFitOptions options;
  options.threads = std::stoi(words[2]);
  JobRuns runs;
  const SurfaceFit fit = RunJob(runs, [&] { return FitSurface(cloud, options); });
  ThreadPool pool(0);
  runs.PrintSeconds();
  std::printf(" numbers=%d", fit.surface.size_u() * fit.surface.size_v());
  PrintErrors(DistancesTo(fit.surface, TruthOfKind(words[0], cloud.size()), pool).distances);
}

// Points in memory of the caller's own, as who calls the library has them: the copy counts.
void SurfaceOfArray(Words words) {
  const Eigen::Matrix3Xd array = ReadPoints(words[1]);
  const std::span<const double> numbers(array.data(), static_cast<size_t>(array.size()));
  SurfaceFitOptions options;
  options.threads = std::stoi(words[2]);
  JobRuns runs;
  const SurfaceFit fit =
      RunJob(runs, [&] { return FitSurface(CloudFromCoordinates(numbers), options); });
  ThreadPool pool(0);
  runs.PrintSeconds();
  std::printf(" numbers=%d", fit.surface.size_u() * fit.surface.size_v());
  PrintErrors(DistancesTo(fit.surface, TruthGrid(Franke, 201), pool).distances);
}

template <int Dim>
void FitAndPrintCurve(const KnownCurve& known, const PointCloud& cloud, int threads) {
  constexpr int kChords = 20000;
  CurveFitOptions options;
  options.threads = threads;
  JobRuns runs;
  const NurbsCurve<Dim> curve = RunJob(runs, [&] { return FitCurve<Dim>(cloud, options); }).curve;
  const SplineBasis& basis = curve.basis();
  Eigen::Matrix3Xd line = Eigen::Matrix3Xd::Zero(3, kChords + 1);
  for (int k = 0; k <= kChords; ++k) {
    line.col(k).template head<Dim>() =
        curve.At(basis.lower() + (basis.upper() - basis.lower()) * k / kChords);
  }
  const TruthError error = ErrorAgainst(known, line);
  runs.PrintSeconds();
  std::printf(" numbers=%d rms=%.4e max=%.4e",
              basis.size() - (basis.periodic() ? basis.degree() : 0),
              error.rms,
              std::max(error.max, error.back));
}

void Curve(Words words) {
  const KnownCurve known = CurveOfKind(words[0]);
  const PointCloud cloud = PointCloud::FromWorld(ReadPoints(words[1]), known.dimension);
  const int threads = std::stoi(words[2]);
  if (known.dimension == 2) {
    FitAndPrintCurve<2>(known, cloud, threads);
  } else {
    FitAndPrintCurve<3>(known, cloud, threads);
  }
}

// Points of a curve in a row, as other programs leave them.
void MeasureCurve(Words words) {
  const TruthError error = ErrorAgainst(CurveOfKind(words[0]), ReadPoints(words[1]));
  std::printf("rms=%.4e max=%.4e", error.rms, std::max(error.max, error.back));
}

// As comparators read it: the net's sizes, both knot vectors, control points, v fastest.
void WriteSheet(const std::string& path, const NurbsSurface& sheet) {
  std::ofstream out(path, std::ios::binary);
  const double sizes[] = {static_cast<double>(sheet.size_u()), static_cast<double>(sheet.size_v())};
  WriteDoubles(out, sizes, 2);
  for (const SplineBasis* basis : {&sheet.basis_u(), &sheet.basis_v()}) {
    WriteDoubles(out, basis->knots().data(), static_cast<Eigen::Index>(basis->knots().size()));
  }
  WriteDoubles(out, sheet.control_points().data(), sheet.control_points().size());
  if (!out.flush()) throw std::runtime_error("can't write " + path);
}

NurbsSurface ReadSheet(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const auto read = [&](size_t count) {
    std::vector<double> numbers(count);
    if (!in.read(reinterpret_cast<char*>(numbers.data()),
                 static_cast<std::streamsize>(count * sizeof(double)))) {
      throw std::runtime_error("can't read a sheet from " + path);
    }
    return numbers;
  };
  const std::vector<double> sizes = read(2);
  const auto basis = [&](double size) {
    return SplineBasis(kDegree, read(static_cast<size_t>(size) + kDegree + 1));
  };
  const SplineBasis u = basis(sizes[0]), v = basis(sizes[1]);
  const std::vector<double> net = read(size_t{3} * static_cast<size_t>(u.size() * v.size()));
  return NurbsSurface(u, v, Eigen::Map<const Eigen::Matrix3Xd>(net.data(), 3, u.size() * v.size()));
}

// A sheet of 24 × 24 control points fitted to heights, and starts of the points' feet on it: their
// own x and y, which the noise shifts.
void FeetCase(Words words) {
  const Eigen::Matrix3Xd points = ReadPoints(words[0]);
  ThreadPool pool(0);
  const FittingProblem problem = HeightProblem(HeightsOf(points), 24);
  WriteSheet(words[1], HeightSurface(problem, SolveLinear(problem, pool).coefficients));
  WriteColumns(words[2], Eigen::Matrix2Xd(points.topRows<2>()));
}

void FootPointSet(Words words) {
  const Eigen::Matrix3Xd points = ReadPoints(words[1]).leftCols(std::stol(words[3]));
  const SurfaceFootPoints finder(ReadSheet(words[2]));
  ThreadPool pool(std::stoi(words[4]));
  const bool near = words[0] == "near";
  const Eigen::Matrix2Xd starts = points.topRows<2>();
  JobRuns runs;
  const std::vector<SurfaceFoot> feet = RunJob(runs, [&] {
    return near ? finder.Near(points, starts, pool) : finder.Nearest(points, pool);
  });
  double squares = 0;
  for (const SurfaceFoot& foot : feet) squares += foot.distance * foot.distance;
  runs.PrintSeconds();
  std::printf(" rms=%.4e", std::sqrt(squares / static_cast<double>(feet.size())));
}

// Places at random parameters of a sheet.
void Evaluate(Words words) {
  const SurfaceEvaluator sheet(ReadSheet(words[0]));
  Eigen::Matrix2Xd parameters(2, std::stol(words[1]));
  std::mt19937_64 random(1);
  for (double& x : parameters.reshaped()) x = std::uniform_real_distribution<double>()(random);
  ThreadPool pool(std::stoi(words[2]));
  JobRuns runs;
  const Eigen::Matrix3Xd found = RunJob(runs, [&] {
    Eigen::Matrix3Xd points;
    sheet.Points(parameters, points, pool);
    return points;
  });
  runs.PrintSeconds();
  std::printf(" rms=%.4e", found.norm() / std::sqrt(static_cast<double>(found.cols())));
}

// 20 000 points of S2 whose parameters are off by up to a fifth of a cell, 24 × 24 control points.
FittingProblem JointProblem() {
  ShellKind kind;
  kind.points = 20000;
  kind.net = 24;
  kind.jitter = 0.2;
  kind.seed = 1;
  return JitteredShell(kind);
}

NurbsSurface SheetOf(const FittingProblem& problem, const Eigen::MatrixXd& net) {
  return NurbsSurface(problem.basis_u(), problem.basis_v(), net);
}

void JointCase(Words words) {
  ThreadPool pool(0);
  const FittingProblem problem = JointProblem();
  WriteSheet(words[0], SheetOf(problem, SolveLinear(problem, pool).coefficients));
  WriteColumns(words[1], problem.data().values);
  WriteColumns(words[2], problem.data().parameters);
}

// Seconds are those of one iteration, start and end shared among them.
void Joint(Words words) {
  ThreadPool pool(std::stoi(words[0]));
  const FittingProblem problem = JointProblem();
  const Eigen::MatrixXd net = SolveLinear(problem, pool).coefficients;
  JointOptions options;
  options.max_iterations = 10;
  options.least_gain = 0;
  const JobClock clock;
  const JointResult result = OptimizeJointly(problem, net, {}, options, pool);
  const double steps = std::max(1, result.iterations);
  const double wall = clock.Wall() / steps, cpu = clock.Cpu() / steps;
  std::printf("wall=%.6g cpu=%.6g steps=%d rms=%.4e",
              wall,
              cpu,
              result.iterations,
              ShellTruthRms(SheetOf(result.problem, result.control_points), pool));
}

// A sheet of the shell by another program.
void MeasureSheet(Words words) {
  ThreadPool pool(0);
  std::printf("rms=%.4e", ShellTruthRms(ReadSheet(words[0]), pool));
}

struct Job {
  size_t words;
  const char* usage;
  void (*run)(Words);
};

const std::map<std::string, Job> kJobs = {
    {"cloud", {3, "KIND COUNT CLOUD.f64", MakeCloud}},
    {"least_squares", {2, "CLOUD.f64 NET", LeastSquares}},
    {"surface", {3, "KIND CLOUD.f64 THREADS", Surface}},
    {"surface_of_array", {3, "KIND CLOUD.f64 THREADS", SurfaceOfArray}},
    {"evaluate", {3, "SHEET.f64 COUNT THREADS", Evaluate}},
    {"curve", {3, "KIND CLOUD.f64 THREADS", Curve}},
    {"measure_curve", {2, "KIND LINE.f64", MeasureCurve}},
    {"feet_case", {3, "CLOUD.f64 SHEET.f64 STARTS.f64", FeetCase}},
    {"feet", {5, "global|near CLOUD.f64 SHEET.f64 COUNT THREADS", FootPointSet}},
    {"joint_case", {3, "SHEET.f64 CLOUD.f64 STARTS.f64", JointCase}},
    {"joint", {1, "THREADS", Joint}},
    {"measure_sheet", {1, "SHEET.f64", MeasureSheet}},
};

}  // namespace
}  // namespace batten::internal

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto job = words.empty() ? kJobs.end() : kJobs.find(words[0]);
  if (job == kJobs.end() || words.size() != job->second.words + 1) {
    for (const auto& [name, known] : kJobs) {
      std::fprintf(stderr, "usage: jobs %s %s\n", name.c_str(), known.usage);
    }
    return 2;
  }
  try {
    job->second.run(Words(words).subspan(1));
    std::printf("\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "jobs: %s\n", error.what());
    return 1;
  }
  return 0;
}
