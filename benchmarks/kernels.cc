// SPDX-License-Identifier: MIT
// The kernels that fits spend their time in, one thread.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#include <flann/algorithms/kdtree_single_index.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <flann/flann.hpp>
#pragma GCC diagnostic pop

#include "batten/fitting/cloud_parts.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/knots/knot_grid_selection.h"
#include "fitting/least_squares/fitting_bases.h"
#include "geometry/numeric/point_kd_tree.h"
#include "known_clouds.h"

namespace batten::internal {
namespace {

FittingProblem Problem(Eigen::Index count, int cells) {
  const Eigen::Matrix3Xd points = Scatter(Franke, count, 1e-3, 0, 1);
  auto data = std::make_shared<FittingData>();
  data->parameters = points.topRows<2>();
  data->values = points.row(2);
  return FittingProblem(
      FittingBasis(3, cells, 0, 1), FittingBasis(3, cells, 0, 1), std::move(data), 1e-4);
}

void LinearSolve(benchmark::State& state) {
  ThreadPool pool(1);
  const FittingProblem problem = Problem(state.range(1), static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(SolveLinear(problem, pool));
  state.SetItemsProcessed(state.iterations() * problem.size());
}
BENCHMARK(LinearSolve)
    ->Args({21, 100000})
    ->Args({21, 1000000})
    ->Args({61, 1000000})
    ->Unit(benchmark::kMillisecond);

constexpr int kNeighbours = 25;

// The neighbours of every point of a cloud, in the order of the file.
void Neighbours(benchmark::State& state) {
  const Eigen::Matrix3Xd points = Scatter(Franke, state.range(0), 1e-3, 0, 1);
  const NeighbourIndex index(points);
  for (auto _ : state) benchmark::DoNotOptimize(index.Nearest(points, kNeighbours));
  state.SetItemsProcessed(state.iterations() * points.cols());
}
BENCHMARK(Neighbours)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);

// The same by FLANN.
void NeighboursByFlann(benchmark::State& state) {
  Eigen::Matrix3Xf points = Scatter(Franke, state.range(0), 1e-3, 0, 1).cast<float>();
  const auto count = static_cast<size_t>(points.cols());
  const flann::Matrix<float> rows(points.data(), count, 3);
  flann::KDTreeSingleIndex<flann::L2_3D<float>> index(rows,
                                                      flann::KDTreeSingleIndexParams(15, false));
  index.buildIndex();
  std::vector<int> found(count * kNeighbours);
  std::vector<float> distances(found.size());
  flann::Matrix<int> found_rows(found.data(), count, kNeighbours);
  flann::Matrix<float> distance_rows(distances.data(), count, kNeighbours);
  flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED);
  parameters.cores = 1;
  for (auto _ : state) index.knnSearch(rows, found_rows, distance_rows, kNeighbours, parameters);
  state.SetItemsProcessed(state.iterations() * points.cols());
}
BENCHMARK(NeighboursByFlann)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);

// The nearest one of a million points beside each of a hundred thousand places in no order.
Eigen::Matrix3Xd Places() { return Scatter(Franke, 100000, 0.01, 0, 2); }

void NearestOne(benchmark::State& state) {
  const PointKdTree tree(Scatter(Franke, state.range(0), 1e-3, 0, 1));
  const Eigen::Matrix3Xd places = Places();
  for (auto _ : state) {
    for (Eigen::Index k = 0; k < places.cols(); ++k)
      benchmark::DoNotOptimize(tree.Nearest(places.col(k).data()));
  }
  state.SetItemsProcessed(state.iterations() * places.cols());
}
BENCHMARK(NearestOne)->Arg(3000)->Arg(1000000)->Unit(benchmark::kMillisecond);

// The same by the index of many neighbours, asked one by one as searches of feet do.
void NearestOneByIndex(benchmark::State& state) {
  const NeighbourIndex index(Scatter(Franke, state.range(0), 1e-3, 0, 1));
  const Eigen::Matrix3Xd places = Places();
  for (auto _ : state) {
    for (Eigen::Index k = 0; k < places.cols(); ++k)
      benchmark::DoNotOptimize(index.Nearest(places.col(k), 1));
  }
  state.SetItemsProcessed(state.iterations() * places.cols());
}
BENCHMARK(NearestOneByIndex)->Arg(3000)->Arg(1000000)->Unit(benchmark::kMillisecond);

// Two sheets above each other, a quarter of the side apart.
Eigen::Matrix3Xd TwoSheets(Eigen::Index count) {
  Eigen::Matrix3Xd points = Scatter(Franke, count, 1e-3, 0, 1);
  for (Eigen::Index k = 0; k < count; k += 2) points(2, k) += 0.25;
  return points;
}

void Parts(benchmark::State& state) {
  ThreadPool pool(1);
  const PointCloud cloud(TwoSheets(state.range(0)));
  std::size_t parts = 0;
  for (auto _ : state) parts = FindCloudParts(cloud, pool).parts.size();
  state.counters["parts"] = static_cast<double>(parts);
}
BENCHMARK(Parts)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);

// The same by PCL, within five spacings, as parts are told apart.
std::size_t ClustersByPcl(const Eigen::Matrix3Xf& points, double reach) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (const auto point : points.colwise()) cloud->push_back({point[0], point[1], point[2]});
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  tree->setInputCloud(cloud);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(reach);
  extraction.setSearchMethod(tree);
  extraction.setInputCloud(cloud);
  std::vector<pcl::PointIndices> clusters;
  extraction.extract(clusters);
  return clusters.size();
}

void PartsByPcl(benchmark::State& state) {
  const Eigen::Matrix3Xf points = TwoSheets(state.range(0)).cast<float>();
  const double spacing = std::sqrt(2.0 / static_cast<double>(state.range(0)));
  std::size_t parts = 0;
  for (auto _ : state) parts = ClustersByPcl(points, 5 * spacing);
  state.counters["parts"] = static_cast<double>(parts);
}
BENCHMARK(PartsByPcl)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);

// A sheet with 72 000 points on its left half and 500 on its right.
Eigen::Matrix3Xd UnevenSheet() {
  constexpr Eigen::Index kLeft = 72000, kRight = 500;
  Eigen::Matrix3Xd points(3, kLeft + kRight);
  points << Scatter(Franke, kLeft, 1e-3, 0, 1), Scatter(Franke, kRight, 1e-3, 0, 1);
  points.row(0).tail(kRight).array() += 1;
  return points;
}

void UnevenParts(benchmark::State& state) {
  ThreadPool pool(1);
  const PointCloud cloud(UnevenSheet());
  CloudParts found;
  for (auto _ : state) found = FindCloudParts(cloud, pool);
  state.counters["parts"] = static_cast<double>(found.parts.size());
  state.counters["stray"] = static_cast<double>(found.stray);
}
BENCHMARK(UnevenParts)->Unit(benchmark::kMillisecond);

void UnevenPartsByPcl(benchmark::State& state) {
  const Eigen::Matrix3Xf points = UnevenSheet().cast<float>();
  std::size_t parts = 0;
  for (auto _ : state) parts = ClustersByPcl(points, 5 * std::sqrt(1.0 / 72000));
  state.counters["parts"] = static_cast<double>(parts);
}
BENCHMARK(UnevenPartsByPcl)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace batten::internal

BENCHMARK_MAIN();
