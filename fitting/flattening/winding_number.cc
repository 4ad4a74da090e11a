// SPDX-License-Identifier: MIT
#include "fitting/flattening/winding_number.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace batten::internal {
namespace {

struct Step {
  int other;
  double step;
};

// Steps away from every node, over the edges both of whose ends are members.
std::vector<std::vector<Step>> StepsAway(const GraphSteps& graph,
                                         const std::vector<bool>& members) {
  std::vector<std::vector<Step>> away(static_cast<size_t>(graph.nodes));
  for (size_t e = 0; e < graph.steps.size(); ++e) {
    const auto [i, j] = (*graph.edges)[e];
    if (!members[i] || !members[j]) continue;
    away[i].push_back({j, graph.steps[e]});
    away[j].push_back({i, -graph.steps[e]});
  }
  return away;
}

}  // namespace

Unwrapped Unwrap(const GraphSteps& graph, const std::vector<bool>& members, double slip) {
  const std::vector<std::vector<Step>> away = StepsAway(graph, members);
  Unwrapped result;
  result.values.assign(static_cast<size_t>(graph.nodes), 0);
  result.part.assign(static_cast<size_t>(graph.nodes), -1);
  int parts = 0;
  for (int start = 0; start < graph.nodes; ++start) {
    if (!members[start] || result.part[start] >= 0) continue;
    result.part[start] = parts;
    for (std::deque<int> next{start}; !next.empty(); next.pop_front()) {
      const int i = next.front();
      for (const auto& [j, step] : away[i]) {
        if (result.part[j] >= 0) continue;
        result.part[j] = parts;
        result.values[j] = result.values[i] + step;
        next.push_back(j);
      }
    }
    ++parts;
  }
  for (size_t e = 0; e < graph.steps.size(); ++e) {
    const auto [i, j] = (*graph.edges)[e];
    if (!members[i] || !members[j]) continue;
    const double misfit = result.values[j] - result.values[i] - graph.steps[e];
    if (std::abs(misfit) <= slip) continue;
    result.seams.push_back(static_cast<int>(e));
    result.misfits.push_back(misfit);
  }
  return result;
}

double ClosedFraction(const GraphSteps& graph,
                      const std::vector<bool>& members,
                      double slip,
                      const std::vector<double>& across,
                      double width,
                      double period) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (Eigen::Index i = 0; i < graph.nodes; ++i) {
    if (!members[i]) continue;
    low = std::min(low, across[i]);
    high = std::max(high, across[i]);
  }
  if (!(high >= low)) return 0;
  if (period > 0) {
    low = 0;
    high = period;
  }
  constexpr double kMostBands = 400;
  const double half = std::max(width / 2, (high - low) / kMostBands) + 1e-300;
  const int halves = std::max(1, static_cast<int>(std::ceil((high - low) / half)));
  const auto half_of = [&](double x) {
    if (period > 0) x -= period * std::floor(x / period);
    return std::clamp(static_cast<int>((x - low) / half), 0, halves - 1);
  };
  // Members and edges of a band are gathered from its two halves, so that all is done in one pass.
  std::vector<std::vector<int>> own(static_cast<size_t>(halves));
  for (int i = 0; i < graph.nodes; ++i) {
    if (members[i]) own[half_of(across[i])].push_back(i);
  }
  const std::vector<std::vector<Step>> away = StepsAway(graph, members);
  std::vector<int> visited(static_cast<size_t>(graph.nodes), -1);
  std::vector<int> inside(static_cast<size_t>(graph.nodes), -1);
  std::vector<double> value(static_cast<size_t>(graph.nodes), 0);
  const auto winds = [&](const std::vector<int>& band, int mark) {
    for (const int i : band) inside[i] = mark;
    for (const int start : band) {
      if (visited[start] == mark) continue;
      visited[start] = mark;
      value[start] = 0;
      for (std::deque<int> next{start}; !next.empty(); next.pop_front()) {
        const int i = next.front();
        for (const auto& [j, step] : away[i]) {
          if (inside[j] != mark) continue;
          if (visited[j] != mark) {
            visited[j] = mark;
            value[j] = value[i] + step;
            next.push_back(j);
          } else if (std::abs(value[i] + step - value[j]) > slip) {
            return true;
          }
        }
      }
    }
    return false;
  };
  int bands = 0, wound = 0;
  const int last = period > 0 && halves > 2 ? halves : std::max(1, halves - 1);
  for (int b = 0; b < last; ++b) {
    std::vector<int> band = own[b];
    const int next = (b + 1) % halves;
    if (next != b) band.insert(band.end(), own[next].begin(), own[next].end());
    if (band.size() < 3) continue;
    ++bands;
    if (winds(band, b)) ++wound;
  }
  return bands > 0 ? static_cast<double>(wound) / bands : 0;
}

}  // namespace batten::internal
