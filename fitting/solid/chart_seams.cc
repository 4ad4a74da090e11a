// SPDX-License-Identifier: MIT
#include "fitting/solid/chart_seams.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

namespace batten::internal {
ChartSeams::ChartSeams(const TriangleTopology& topology,
                       const std::vector<std::complex<double>>& planar_edges,
                       const std::vector<double>& crosses,
                       const std::vector<int>& held)
    : topology_(topology),
      turn_(std::size_t(topology.half_edges()), 0),
      line_(std::size_t(topology.half_edges()), 0),  // seams all, whose lines have no numbers yet
      forward_(std::size_t(topology.half_edges()), 1) {
  Comb(planar_edges, crosses);
  FindAnchors(held);
  PruneSeams();
  NumberLines();
}

// Breadth first over the triangles: the edges passed are no seams.
void ChartSeams::Comb(const std::vector<std::complex<double>>& planar_edges,
                      const std::vector<double>& crosses) {
  for (const double angle : crosses) directions_.push_back(std::polar(1.0, angle));
  // How many quarter turns the cross beyond is ahead of that carried across.
  const auto ahead = [&](int h) {
    const int twin = topology_.Twin(h);
    const std::complex<double> carried = -directions_[std::size_t(h / 3)] *
                                         planar_edges[std::size_t(twin)] /
                                         planar_edges[std::size_t(h)];
    const double angle = std::arg(directions_[std::size_t(twin / 3)] / carried);
    return static_cast<int>(std::lround(angle / (std::numbers::pi / 2)));
  };
  component_.assign(std::size_t(topology_.triangles()), -1);
  int components = 0;
  for (int first = 0; first < topology_.triangles(); ++first) {
    if (component_[std::size_t(first)] >= 0) continue;
    std::deque<int> open = {first};
    component_[std::size_t(first)] = components;
    while (!open.empty()) {
      const int t = open.front();
      open.pop_front();
      for (int h = 3 * t; h < 3 * t + 3; ++h) {
        const int twin = topology_.Twin(h), beside = twin / 3;
        if (component_[std::size_t(beside)] >= 0) continue;
        component_[std::size_t(beside)] = components;
        const Gaussian back = PowerOfI(-ahead(h));
        directions_[std::size_t(beside)] *=
            std::complex<double>(double(back.real()), double(back.imag()));
        line_[std::size_t(h)] = line_[std::size_t(twin)] = -1;
        open.push_back(beside);
      }
    }
    ++components;
  }
  for (int h = 0; h < topology_.half_edges(); ++h) {
    if (!IsSeam(h) || topology_.Twin(h) < h) continue;
    turn_[std::size_t(h)] = -ahead(h) & 3;
    turn_[std::size_t(topology_.Twin(h))] = -turn_[std::size_t(h)] & 3;
  }
}

int ChartSeams::TurnAbout(int vertex) const {
  int turn = 0;
  const int first = topology_.Outgoing(vertex);
  int h = first;
  do {
    turn += Turn(TriangleTopology::Previous(h));
    h = topology_.Turned(h);
  } while (h != first);
  return turn & 3;
}

void ChartSeams::FindAnchors(const std::vector<int>& held) {
  const int components = *std::max_element(component_.begin(), component_.end()) + 1;
  std::vector<char> has(std::size_t(components), 0);
  const auto component = [&](int v) { return component_[std::size_t(topology_.Outgoing(v) / 3)]; };
  std::vector<char> is_held(std::size_t(topology_.vertices()), 0);
  for (const int v : held) is_held[std::size_t(v)] = 1;
  for (int v = 0; v < topology_.vertices(); ++v) {
    if (TurnAbout(v) == 0 && !is_held[std::size_t(v)]) continue;
    anchors_.push_back(v);
    if (!has[std::size_t(component(v))]) pinned_.push_back(v);
    has[std::size_t(component(v))] = 1;
  }
  for (int v = 0; v < topology_.vertices(); ++v) {
    if (has[std::size_t(component(v))]) continue;
    anchors_.push_back(v);
    pinned_.push_back(v);
    has[std::size_t(component(v))] = 1;
  }
}

// Seams that end at a vertex about which charts do not turn are none.
void ChartSeams::PruneSeams() {
  std::vector<int> seams(std::size_t(topology_.vertices()), 0);
  std::vector<char> anchored(seams.size(), 0);
  for (const int v : anchors_) anchored[std::size_t(v)] = 1;
  for (int h = 0; h < topology_.half_edges(); ++h) {
    seams[std::size_t(topology_.Origin(h))] += IsSeam(h);
  }
  for (int start = 0; start < topology_.vertices(); ++start) {
    for (int v = start; seams[std::size_t(v)] == 1 && !anchored[std::size_t(v)];) {
      int h = topology_.Outgoing(v);
      while (!IsSeam(h)) h = topology_.Turned(h);
      line_[std::size_t(h)] = line_[std::size_t(topology_.Twin(h))] = -1;
      --seams[std::size_t(v)];
      v = topology_.Origin(TriangleTopology::Next(h));
      --seams[std::size_t(v)];
    }
  }
}

void ChartSeams::NumberLines() {
  std::vector<char> ends(std::size_t(topology_.vertices()), 0);
  std::vector<int> seams(ends.size(), 0);
  for (int h = 0; h < topology_.half_edges(); ++h) {
    seams[std::size_t(topology_.Origin(h))] += IsSeam(h);
  }
  for (std::size_t v = 0; v < ends.size(); ++v) ends[v] = seams[v] > 0 && seams[v] != 2;
  for (const int v : anchors_) ends[std::size_t(v)] = 1;
  std::vector<int> begins;
  for (int h = 0; h < topology_.half_edges(); ++h) {
    if (!IsSeam(h)) continue;
    line_[std::size_t(h)] = topology_.half_edges();  // not followed yet
    if (ends[std::size_t(topology_.Origin(h))]) begins.push_back(h);
  }
  for (const int h : begins) FollowLine(h, ends);
  // What is left goes round without an end.
  for (int h = 0; h < topology_.half_edges(); ++h) {
    if (line_[std::size_t(h)] < topology_.half_edges()) continue;
    ends[std::size_t(topology_.Origin(h))] = 1;
    FollowLine(h, ends);
  }
}

void ChartSeams::FollowLine(int first, std::vector<char>& ends) {
  if (line_[std::size_t(first)] < topology_.half_edges()) return;
  for (int h = first;;) {
    line_[std::size_t(h)] = line_[std::size_t(topology_.Twin(h))] = lines_;
    forward_[std::size_t(topology_.Twin(h))] = 0;
    if (ends[std::size_t(topology_.Origin(TriangleTopology::Next(h)))]) break;
    // Clockwise about the end, on the same side, to the next seam.
    h = TriangleTopology::Next(h);
    while (!IsSeam(h)) h = TriangleTopology::Next(topology_.Twin(h));
  }
  ++lines_;
}

}  // namespace batten::internal
