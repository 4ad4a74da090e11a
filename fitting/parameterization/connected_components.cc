// SPDX-License-Identifier: MIT
#include "fitting/parameterization/connected_components.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_mask.h"
#include "fitting/neighbours/signed_sets.h"
#include "fitting/parameterization/empty_area_fraction.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kComponentSample = 20000;
constexpr int kNeighbours = 9;       // with the point itself
constexpr double kApart = 10;        // neighbour distances between detached components
constexpr double kLeastPart = 0.02;  // share of the points in the largest component

// Components of places of a plane that are joined to their neighbours.
struct Joined {
  std::vector<int> part;      // of every place
  std::vector<double> reach;  // the distance of its farthest neighbour
};

Joined JoinNeighbours(const Eigen::Matrix3Xd& plan) {
  const Eigen::Index count = plan.cols();
  const std::vector<int> near = NeighbourIndex(plan).Nearest(plan, kNeighbours);
  SignedSets parts(count);
  Joined joined{std::vector<int>(static_cast<size_t>(count)),
                std::vector<double>(static_cast<size_t>(count))};
  for (Eigen::Index k = 0; k < count; ++k) {
    for (int j = 0; j < kNeighbours; ++j) {
      const int other = near[k * kNeighbours + j];
      parts.Join(static_cast<int>(k), other);
      joined.reach[k] = (plan.col(other) - plan.col(k)).norm();
    }
  }
  for (Eigen::Index k = 0; k < count; ++k) joined.part[k] = parts.Find(static_cast<int>(k)).first;
  return joined;
}

// Finds the components that join the largest, directly or through others, within a multiple of
// their own neighbour distances.
std::vector<char> HangTogether(const Eigen::Matrix3Xd& plan, const Joined& joined, int largest) {
  std::vector<char> together(joined.part.size(), 0);  // of a part
  together[largest] = 1;
  for (bool more = true; more;) {
    more = false;
    std::vector<int> main, rest;
    for (int k = 0; k < std::ssize(joined.part); ++k)
      (together[joined.part[k]] ? main : rest).push_back(k);
    if (rest.empty()) break;
    const Eigen::Matrix3Xd body = plan(Eigen::all, main);
    const std::vector<int> next = NeighbourIndex(body).Nearest(plan(Eigen::all, rest), 1);
    for (size_t r = 0; r < rest.size(); ++r) {
      const double gap = (body.col(next[r]) - plan.col(rest[r])).norm();
      const double reach = std::max(joined.reach[rest[r]], joined.reach[main[next[r]]]);
      if (gap > kApart * reach || together[joined.part[rest[r]]]) continue;
      together[joined.part[rest[r]]] = 1;
      more = true;
    }
  }
  return together;
}

// Whether places are clearly connected: they fill more than half of the tiles that would hold nine
// each if they were spread evenly, and the filled tiles are one component. Gaps are then at most
// two tiles wide, far less than ten neighbour distances.
bool ClearlyHangTogether(const Eigen::Matrix3Xd& plan) {
  constexpr double kLeastFilled = 0.5;
  const Eigen::Vector2d low = plan.topRows<2>().rowwise().minCoeff();
  const Eigen::Vector2d extent = plan.topRows<2>().rowwise().maxCoeff() - low;
  const double side = std::sqrt(extent.prod() * kPointsOfATile / static_cast<double>(plan.cols()));
  if (!(side > 0)) return false;
  const auto most = static_cast<double>(plan.cols());
  if (!((extent / side).maxCoeff() < most)) return false;
  const int nu = static_cast<int>(extent[0] / side) + 1,
            nv = static_cast<int>(extent[1] / side) + 1;
  std::vector<char> filled(static_cast<size_t>(nu) * static_cast<size_t>(nv), 0);
  for (const auto place : plan.colwise()) {
    const int i = std::min(nu - 1, static_cast<int>((place[0] - low[0]) / side));
    const int j = std::min(nv - 1, static_cast<int>((place[1] - low[1]) / side));
    filled[i * nv + j] = 1;
  }
  const auto count = std::count(filled.begin(), filled.end(), 1);
  if (static_cast<double>(count) < kLeastFilled * nu * nv) return false;
  std::vector<int> front{
      static_cast<int>(std::find(filled.begin(), filled.end(), 1) - filled.begin())};
  filled[front.front()] = 0;
  std::ptrdiff_t seen = 0;
  while (!front.empty()) {
    const int i = front.back() / nv, j = front.back() % nv;
    front.pop_back();
    ++seen;
    for (int a = std::max(0, i - 1); a <= std::min(nu - 1, i + 1); ++a) {
      for (int b = std::max(0, j - 1); b <= std::min(nv - 1, j + 1); ++b) {
        if (!filled[a * nv + b]) continue;
        filled[a * nv + b] = 0;
        front.push_back(a * nv + b);
      }
    }
  }
  return seen == count;
}

}  // namespace

double DetachedFraction(const Eigen::Matrix2Xd& places, std::uint64_t seed) {
  const std::vector<Eigen::Index> sample = SampleIndices(places.cols(), kComponentSample, seed);
  if (std::ssize(sample) <= kNeighbours) return 0;
  Eigen::Matrix3Xd plan = PointsInSpace(places(Eigen::all, sample));
  if (ClearlyHangTogether(plan)) return 0;
  std::vector<Eigen::Index> points(sample.size(), 1);  // that a place stands for
  const auto all = static_cast<double>(sample.size());
  for (;;) {
    const Joined joined = JoinNeighbours(plan);
    std::vector<Eigen::Index> sizes(points.size(), 0);
    for (size_t k = 0; k < points.size(); ++k) sizes[joined.part[k]] += points[k];
    const auto largest = std::max_element(sizes.begin(), sizes.end());
    if (static_cast<double>(*largest) >= kLeastPart * all) {
      const std::vector<char> together =
          HangTogether(plan, joined, static_cast<int>(largest - sizes.begin()));
      Eigen::Index apart = 0;
      for (size_t part = 0; part < sizes.size(); ++part)
        if (!together[part]) apart += sizes[part];
      return static_cast<double>(apart) / all;
    }
    // Points over each other form many small components: one place represents each.
    std::vector<int> first;
    for (int k = 0; k < std::ssize(sizes); ++k)
      if (sizes[k] > 0) first.push_back(k);
    plan = plan(Eigen::all, first).eval();
    points.clear();
    for (const int k : first) points.push_back(sizes[k]);
  }
}

}  // namespace batten::internal
