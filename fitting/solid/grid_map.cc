// SPDX-License-Identifier: MIT
#include "fitting/solid/grid_map.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/fitting/refused_data.h"
#include "fitting/solid/chart_seams.h"
#include "fitting/solid/gaussian_lattice.h"

namespace batten::internal {
namespace {

using SparseComplex = Eigen::SparseMatrix<Complex>;
using Factor = Eigen::SimplicialLDLT<SparseComplex, Eigen::Lower>;
using Form = std::vector<std::pair<int, Complex>>;  // unknowns and their factors

Complex AsComplex(Gaussian z) { return {double(z.real()), double(z.imag())}; }

// The corners of all triangles as linear forms of free vertices, first, and of integers.
class GridUnknowns {
 public:
  GridUnknowns(const TriangleTopology& topology, const ChartSeams& seams)
      : topology_(topology), seams_(seams), number_(std::size_t(topology.vertices()), 0) {
    const std::vector<int>& anchors = seams.anchors();
    for (std::size_t k = 0; k < anchors.size(); ++k) {
      number_[std::size_t(anchors[k])] = -1 - static_cast<int>(k);
    }
    for (int& number : number_) {
      if (number == 0) number = free_++;
    }
    GoRoundVertices();
    for (const int v : seams.pinned()) {
      conditions_.push_back({{seams.lines() - 1 - number_[std::size_t(v)], Gaussian(1)}});
    }
    lattice_ = LatticeOfZeros(conditions_, seams.lines() + static_cast<int>(anchors.size()));
  }

  int free() const { return free_; }
  int integers() const { return static_cast<int>(lattice_.size()); }

  // Of the corner at the origin of a half-edge.
  Form CornerForm(int h) const {
    const Corner& corner = corners_[std::size_t(h)];
    const Gaussian phase = PowerOfI(corner.phase);
    const int number = number_[std::size_t(topology_.Origin(h))];
    Form form;
    GaussianRow row = corner.shift;
    if (number >= 0) {
      form.emplace_back(number, AsComplex(phase));
    } else {
      row[seams_.lines() - 1 - number] += phase;
    }
    if (!row.empty()) AddIntegers(row, form);
    return form;
  }

  Complex ShiftAcross(int h, const Eigen::VectorXcd& integers) const {
    if (!seams_.IsSeam(h)) return 0;
    Form form;
    AddIntegers({{seams_.Line(h), seams_.Factor(h)}}, form);
    Complex shift = 0;
    for (const auto& [k, factor] : form) shift += factor * integers[k - free_];
    return shift;
  }

 private:
  struct Corner {
    int phase = 0;      // quarter turns from the chart of the vertex's first corner
    GaussianRow shift;  // by lines
  };

  void AddIntegers(const GaussianRow& row, Form& form) const {
    for (std::size_t z = 0; z < lattice_.size(); ++z) {
      Gaussian factor = 0;
      for (const auto& [k, part] : row) factor += part * lattice_[z][std::size_t(k)];
      if (factor != Gaussian(0)) form.emplace_back(free_ + static_cast<int>(z), AsComplex(factor));
    }
  }

  // Places across seams, and what has to hold for them to come back to where they began.
  void GoRoundVertices() {
    corners_.resize(std::size_t(topology_.half_edges()));
    for (int v = 0; v < topology_.vertices(); ++v) {
      const int first = topology_.Outgoing(v);
      Corner corner;
      int h = first;
      do {
        corners_[std::size_t(h)] = corner;
        const int crossed = TriangleTopology::Previous(h);
        if (seams_.IsSeam(crossed)) {
          const Gaussian turn = PowerOfI(seams_.Turn(crossed));
          corner.phase = (corner.phase + seams_.Turn(crossed)) & 3;
          for (auto& [line, factor] : corner.shift) factor *= turn;
          corner.shift[seams_.Line(crossed)] += seams_.Factor(crossed);
          std::erase_if(corner.shift, [](const auto& one) { return one.second == Gaussian(0); });
        }
        h = topology_.Turned(h);
      } while (h != first);
      GaussianRow condition = std::move(corner.shift);
      const int number = number_[std::size_t(v)];
      if (number < 0 && corner.phase != 0) {
        condition[seams_.lines() - 1 - number] = PowerOfI(corner.phase) - Gaussian(1);
      }
      if (!condition.empty()) conditions_.push_back(std::move(condition));
    }
  }

  const TriangleTopology& topology_;
  const ChartSeams& seams_;
  std::vector<int> number_;  // of free vertices; −1 − k for anchor k
  int free_ = 0;
  std::vector<Corner> corners_;
  std::vector<GaussianRow> conditions_;
  std::vector<std::vector<Gaussian>> lattice_;
};

class GridMapper {
 public:
  GridMapper(const TriangleSurface& surface,
             const TriangleTopology& topology,
             const std::vector<double>& crosses,
             const Eigen::VectorXd& lengths)
      : topology_(topology),
        planar_(PlanarEdges(surface)),
        seams_(topology, planar_, crosses),
        unknowns_(topology, seams_),
        stiffness_(std::size_t(topology.triangles()), 1.0) {
    for (int h = 0; h < topology.half_edges(); ++h) {
      forms_.push_back(unknowns_.CornerForm(h));
      const Complex direction = seams_.directions()[std::size_t(h / 3)];
      wanted_.push_back(planar_[std::size_t(h)] * std::conj(direction) / lengths[h / 3]);
    }
  }

  GridMap Map() {
    SolveForIntegers();
    GridMap best = MapOf(Solve());
    constexpr int kRounds = 6;
    for (int round = 0; round < kRounds && best.turned_over > 0; ++round) {
      GridMap next = MapOf(Solve());
      if (next.turned_over < best.turned_over || round == 0) best = next;
      StiffenAbout(next);
    }
    return best;
  }

 private:
  // min Σ c |p_b − p_a − w|² over the edges of all triangles, c the cotangent of the angle
  // opposite: the sum of squared differences of gradients from those of the cross.
  void Assemble() {
    const int n = unknowns_.free(), m = unknowns_.integers();
    std::vector<Eigen::Triplet<Complex>> free, mixed;
    integer_part_ = Eigen::MatrixXcd::Zero(m, m);
    right_ = Eigen::VectorXcd::Zero(n);
    integer_right_ = Eigen::VectorXcd::Zero(m);
    for (int h = 0; h < topology_.half_edges(); ++h) {
      const Complex to_a = -planar_[std::size_t(TriangleTopology::Next(h))];
      const Complex to_b = planar_[std::size_t(TriangleTopology::Previous(h))];
      // Obtuse angles have negative ones, flat triangles endless ones.
      constexpr double kLeast = 0.05, kMost = 10;
      const double cotangent = std::real(std::conj(to_b) * to_a) / std::abs(AreaOf(to_b, to_a));
      const double weight = (cotangent < kMost ? std::max(kLeast, cotangent) : kMost) *
                            stiffness_[std::size_t(h / 3)];
      Form row = forms_[std::size_t(TriangleTopology::Next(h))];
      for (const auto& [k, factor] : forms_[std::size_t(h)]) row.emplace_back(k, -factor);
      for (const auto& [j, one] : row) {
        const Complex pull = weight * std::conj(one) * wanted_[std::size_t(h)];
        if (j < n) {
          right_[j] += pull;
        } else {
          integer_right_[j - n] += pull;
        }
        for (const auto& [k, other] : row) {
          const Complex entry = weight * std::conj(one) * other;
          if (j >= n && k >= n) {
            integer_part_(j - n, k - n) += entry;
          } else if (j < n && k >= n) {
            mixed.emplace_back(j, k - n, entry);
          } else if (j < n && j >= k) {
            free.emplace_back(j, k, entry);
          }
        }
      }
    }
    mixed_ = SparseComplex(n, m);
    mixed_.setFromTriplets(mixed.begin(), mixed.end());
    SparseComplex matrix(n, n);
    matrix.setFromTriplets(free.begin(), free.end());
    if (!analysed_) factor_.analyzePattern(matrix);
    analysed_ = true;
    factor_.factorize(matrix);
    if (factor_.info() != Eigen::Success) throw RefusedData("the map onto a grid is singular");
  }

  void SolveForIntegers() {
    Assemble();
    const int m = unknowns_.integers();
    integers_ = Eigen::VectorXcd::Zero(m);
    if (m == 0) return;
    const Eigen::MatrixXcd answers = factor_.solve(Eigen::MatrixXcd(mixed_));
    const Eigen::MatrixXcd quadratic = integer_part_ - mixed_.adjoint() * answers;
    const Eigen::VectorXcd linear = integer_right_ - answers.adjoint() * right_;
    const Eigen::VectorXcd centre = quadratic.ldlt().solve(linear);
    if (!centre.allFinite()) throw RefusedData("the map onto a grid is not determined");
    integers_ = RoundedWithin(quadratic, centre);
  }

  Eigen::VectorXcd Solve() {
    Assemble();
    return factor_.solve(right_ - mixed_ * integers_);
  }

  GridMap MapOf(const Eigen::VectorXcd& free) const {
    GridMap map;
    map.singular = seams_.singular();
    const int n = unknowns_.free();
    for (int h = 0; h < topology_.half_edges(); ++h) {
      Complex place = 0;
      for (const auto& [k, factor] : forms_[std::size_t(h)]) {
        place += factor * (k < n ? free[k] : integers_[k - n]);
      }
      map.corners.push_back(place);
      map.turns.push_back(seams_.Turn(h));
      map.shifts.push_back(unknowns_.ShiftAcross(h, integers_));
    }
    for (int t = 0; t < topology_.triangles(); ++t) map.turned_over += TurnedOver(map, t);
    return map;
  }

  static bool TurnedOver(const GridMap& map, int t) {
    const Complex* p = &map.corners[std::size_t(3 * t)];
    return !(AreaOf(p[1] - p[0], p[2] - p[0]) > 0);
  }

  void StiffenAbout(const GridMap& map) {
    constexpr double kStiffer = 3, kBeside = 1.5;
    for (int t = 0; t < topology_.triangles(); ++t) {
      if (!TurnedOver(map, t)) continue;
      stiffness_[std::size_t(t)] *= kStiffer;
      for (int h = 3 * t; h < 3 * t + 3; ++h) {
        int around = h;
        do {
          stiffness_[std::size_t(around / 3)] *= kBeside;
          around = topology_.Turned(around);
        } while (around != h);
      }
    }
    for (double& stiffness : stiffness_) stiffness = std::min(stiffness, 1e4);
  }

  const TriangleTopology& topology_;
  std::vector<Complex> planar_;
  ChartSeams seams_;
  GridUnknowns unknowns_;
  std::vector<Form> forms_;
  std::vector<Complex> wanted_;
  std::vector<double> stiffness_;
  bool analysed_ = false;
  Factor factor_;
  SparseComplex mixed_;
  Eigen::MatrixXcd integer_part_;
  Eigen::VectorXcd right_, integer_right_, integers_;
};

}  // namespace

Complex GridMap::DirectionAcross(int h, Complex direction) const {
  return AsComplex(PowerOfI(turns[std::size_t(h)])) * direction;
}

Complex GridMap::Across(int h, Complex p) const {
  return DirectionAcross(h, p) + shifts[std::size_t(h)];
}

GridMap MapOntoGrid(const TriangleSurface& surface,
                    const TriangleTopology& topology,
                    const std::vector<double>& crosses,
                    const Eigen::VectorXd& lengths) {
  return GridMapper(surface, topology, crosses, lengths).Map();
}

}  // namespace batten::internal
