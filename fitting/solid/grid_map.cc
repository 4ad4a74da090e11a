// SPDX-License-Identifier: MIT
#include "fitting/solid/grid_map.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "batten/fitting/refused_data.h"
#include "fitting/neighbours/signed_sets.h"
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

// An edge: its end less its origin.
Form EdgeForm(const std::vector<Form>& corners, int h) {
  Form row = corners[std::size_t(TriangleTopology::Next(h))];
  for (const auto& [k, factor] : corners[std::size_t(h)]) row.emplace_back(k, -factor);
  return row;
}

// Adds what a row asks for to right sides of free places and of integers, which follow these.
void PullTo(const Form& row, Complex by, Eigen::VectorXcd& free, Eigen::VectorXcd& integers) {
  const auto n = static_cast<int>(free.size());
  for (const auto& [j, one] : row) (j < n ? free[j] : integers[j - n]) += std::conj(one) * by;
}

// Edges along creases, which are to run along lines of the grid, as long as they like: by turns
// least squares with given lengths and lengths from these; what is left across is asked for
// against. [alternating directions: Boyd et al. 2011, §5]
class CreaseLines {
 public:
  CreaseLines() = default;
  // Creases by half-edge, forms of corners and wanted edges.
  CreaseLines(std::vector<char> creases,
              const std::vector<Form>& corners,
              const std::vector<Complex>& wanted)
      : creases_(std::move(creases)), number_(creases_.size(), -1) {
    for (int h = 0; h < int(creases_.size()); ++h) {
      if (!creases_[std::size_t(h)]) continue;
      const Complex edge = wanted[std::size_t(h)];
      const Complex axis =
          AsComplex(PowerOfI(int(std::lround(std::arg(edge) / (std::numbers::pi / 2)))));
      number_[std::size_t(h)] = int(edges_.size());
      edges_.push_back({EdgeForm(corners, h), axis, axis * std::real(std::conj(axis) * edge), 0});
    }
  }

  bool none() const { return edges_.empty(); }
  double WeightOf(int h) const { return creases_[std::size_t(h)] ? kAlong : 0; }

  void Pull(Eigen::VectorXcd& free, Eigen::VectorXcd& integers) const {
    for (const Edge& edge : edges_) {
      PullTo(edge.row, kAlong * (edge.along - edge.against), free, integers);
    }
  }

  void Follow(const Eigen::VectorXcd& free, const Eigen::VectorXcd& integers) {
    const auto n = static_cast<int>(free.size());
    for (Edge& edge : edges_) {
      Complex place = edge.against;
      for (const auto& [k, factor] : edge.row)
        place += factor * (k < n ? free[k] : integers[k - n]);
      edge.along = edge.axis * std::real(std::conj(edge.axis) * place);
      edge.against = place - edge.along;
    }
  }

  // The integers' real and imaginary parts, one after the other, make each crease between held
  // vertices begin and end on one line of the grid.
  std::vector<GaussianRow> Conditions(const TriangleTopology& topology,
                                      const std::vector<int>& held,
                                      int free,
                                      int integers) const {
    std::vector<char> seen(creases_.size(), 0), stops(std::size_t(topology.vertices()), 0);
    for (const int v : held) stops[std::size_t(v)] = 1;
    std::vector<GaussianRow> rows;
    for (int first = 0; first < topology.half_edges(); ++first) {
      if (!creases_[std::size_t(first)] || seen[std::size_t(first)]) continue;
      if (!stops[std::size_t(topology.Origin(first))]) continue;
      std::map<int, Complex> across;  // of which the imaginary part is to vanish
      for (int h = first;;) {
        seen[std::size_t(h)] = seen[std::size_t(topology.Twin(h))] = 1;
        const Edge& edge = edges_[std::size_t(number_[std::size_t(h)])];
        for (const auto& [k, factor] : edge.row) across[k] += std::conj(edge.axis) * factor;
        if (stops[std::size_t(topology.Origin(TriangleTopology::Next(h)))]) break;
        // The other crease of the vertex.
        h = topology.Turned(topology.Twin(h));
        while (!creases_[std::size_t(h)]) h = topology.Turned(h);
      }
      GaussianRow row = RowOf(across, free, integers);
      if (!row.empty()) rows.push_back(std::move(row));
    }
    return rows;
  }

 private:
  struct Edge {
    Form row;
    Complex axis, along, against;  // a unit of the grid, the length, what is asked for across
  };

  // None where the crease does not keep to its direction, and places of free vertices are left.
  static GaussianRow RowOf(const std::map<int, Complex>& across, int free, int integers) {
    GaussianRow row;
    for (const auto& [k, factor] : across) {
      const Gaussian whole(std::llround(factor.real()), std::llround(factor.imag()));
      if (whole == Gaussian(0)) continue;
      if (k < free) return {};
      if (whole.imag() != 0) row[k - free] = whole.imag();
      if (whole.real() != 0) row[k - free + integers] = whole.real();
    }
    return row;
  }

  static constexpr double kAlong = 3;  // weight of lengths given; other edges' are about one
  std::vector<char> creases_;
  std::vector<int> number_;  // in edges_, by half-edge
  std::vector<Edge> edges_;
};

// The corners of creases, and a vertex of each connected part that has none.
std::vector<int> AnchorsOf(const SurfaceCreases& creases) {
  std::vector<int> anchors;
  SignedSets parts(std::ssize(creases.corner));
  for (const auto& [a, b] : creases.edges) parts.Join(b, a);
  std::vector<char> has(creases.corner.size(), 0);
  for (int v = 0; v < int(has.size()); ++v) {
    if (!creases.corner[std::size_t(v)]) continue;
    anchors.push_back(v);
    has[std::size_t(parts.Find(v).first)] = 1;
  }
  for (const auto& [a, b] : creases.edges) {
    if (has[std::size_t(parts.Find(a).first)]) continue;
    has[std::size_t(parts.Find(a).first)] = 1;
    anchors.push_back(a);
  }
  return anchors;
}

class GridMapper {
 public:
  GridMapper(const TriangleSurface& surface,
             const TriangleTopology& topology,
             const std::vector<double>& crosses,
             const Eigen::VectorXd& lengths,
             const SurfaceCreases& creases)
      : topology_(topology),
        planar_(PlanarEdges(surface)),
        held_(AnchorsOf(creases)),
        seams_(topology, planar_, crosses, held_),
        unknowns_(topology, seams_),
        stiffness_(std::size_t(topology.triangles()), 1.0) {
    for (int h = 0; h < topology.half_edges(); ++h) {
      forms_.push_back(unknowns_.CornerForm(h));
      const Complex direction = seams_.directions()[std::size_t(h / 3)];
      wanted_.push_back(planar_[std::size_t(h)] * std::conj(direction) / lengths[h / 3]);
    }
    lines_ = CreaseLines(CreasesByHalfEdge(topology, creases), forms_, wanted_);
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
      const Form row = EdgeForm(forms_, h);
      PullTo(row, weight * wanted_[std::size_t(h)], right_, integer_right_);
      const double whole = weight + lines_.WeightOf(h);
      for (const auto& [j, one] : row) {
        for (const auto& [k, other] : row) {
          const Complex entry = whole * std::conj(one) * other;
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
    const int m = unknowns_.integers();
    integers_ = Eigen::VectorXcd::Zero(m);
    if (m == 0) return;
    // Lines that creases hold cross where nothing keeps triangles from turning over before places
    // are integers.
    constexpr int kRounds = 8;
    for (int round = 0; !lines_.none() && round < kRounds; ++round) {
      const GridMap relaxed = MapOf(Relaxed());
      if (relaxed.turned_over == 0) break;
      StiffenAbout(relaxed);
    }
    Relaxed();
    const std::vector<GaussianRow> rows =
        lines_.Conditions(topology_, held_, unknowns_.free(), unknowns_.integers());
    integers_ = RoundedWithin(quadratic_, integers_, rows);
  }

  // The map whose integers may be any numbers, which are left in their place.
  Eigen::VectorXcd Relaxed() {
    Assemble();
    const Eigen::MatrixXcd answers = factor_.solve(Eigen::MatrixXcd(mixed_));
    quadratic_ = integer_part_ - mixed_.adjoint() * answers;
    const Eigen::LDLT<Eigen::MatrixXcd> of_integers(quadratic_);
    Eigen::VectorXcd places =
        OnCreases([&](const Eigen::VectorXcd& free, const Eigen::VectorXcd& integers) {
          integers_ = of_integers.solve(integers - answers.adjoint() * free);
          return factor_.solve(free - mixed_ * integers_).eval();
        });
    if (!integers_.allFinite()) throw RefusedData("the map onto a grid is not determined");
    return places;
  }

  Eigen::VectorXcd Solve() {
    Assemble();
    return OnCreases([&](const Eigen::VectorXcd& free, const Eigen::VectorXcd&) {
      return factor_.solve(free - mixed_ * integers_).eval();
    });
  }

  // The least squares whose edges along creases run along lines of the grid, as long as they like.
  // `solve` answers right sides.
  template <typename Answer>
  Eigen::VectorXcd OnCreases(Answer solve) {
    constexpr int kRounds = 30;
    Eigen::VectorXcd free;
    for (int round = 0; round < kRounds; ++round) {
      Eigen::VectorXcd right = right_, integer_right = integer_right_;
      lines_.Pull(right, integer_right);
      free = solve(right, integer_right);
      if (lines_.none()) break;
      lines_.Follow(free, integers_);
    }
    return free;
  }

  GridMap MapOf(const Eigen::VectorXcd& free) const {
    GridMap map;
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
  std::vector<int> held_;  // vertices
  ChartSeams seams_;
  GridUnknowns unknowns_;
  std::vector<Form> forms_;
  std::vector<Complex> wanted_;
  std::vector<double> stiffness_;
  CreaseLines lines_;
  bool analysed_ = false;
  Factor factor_;
  SparseComplex mixed_;
  Eigen::MatrixXcd integer_part_, quadratic_;  // the latter with free places where they are best
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
                    const Eigen::VectorXd& lengths,
                    const SurfaceCreases& creases) {
  return GridMapper(surface, topology, crosses, lengths, creases).Map();
}

}  // namespace batten::internal
