// SPDX-License-Identifier: MIT
#include "io/report/report_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "batten/geometry/closure.h"
#include "batten/geometry/curvature.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/surface_evaluator.h"
#include "batten/geometry/trim_loops.h"
#include "batten/geometry/trim_region.h"
#include "io/exchange/polyline.h"

namespace batten::internal {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

// Parameters of one direction, evenly in every span, ends included.
std::vector<double> EvenIn(const std::vector<double>& breaks, int pieces) {
  std::vector<double> result{breaks.front()};
  for (std::size_t k = 1; k < breaks.size(); ++k) {
    for (int piece = 1; piece <= pieces; ++piece) {
      const double share = double(piece) / pieces;
      result.push_back(breaks[k - 1] + share * (breaks[k] - breaks[k - 1]));
    }
  }
  return result;
}

// A surface on a coarse lattice: what share of it counts, how large it is, how long its spans are.
class Lattice {
 public:
  explicit Lattice(const NurbsSurface& surface)
      : breaks_u_(KnotBreaks(surface.basis_u())), breaks_v_(KnotBreaks(surface.basis_v())) {
    constexpr int kLeast = 24;
    const auto pieces = [](const std::vector<double>& breaks) {
      return 1 + kLeast / static_cast<int>(breaks.size());
    };
    pieces_u_ = pieces(breaks_u_);
    pieces_v_ = pieces(breaks_v_);
    us_ = EvenIn(breaks_u_, pieces_u_);
    vs_ = EvenIn(breaks_v_, pieces_v_);
    SurfaceEvaluator(surface).Grid(us_, vs_, grid_);
    const TrimRegion region(surface);
    constexpr double kHalf = 0.5;
    counts_.assign(us_.size() * vs_.size(), false);
    for (std::size_t i = 0; i + 1 < us_.size(); ++i) {
      for (std::size_t j = 0; j + 1 < vs_.size(); ++j) {
        if (!region.Contains(kHalf * (us_[i] + us_[i + 1]), kHalf * (vs_[j] + vs_[j + 1]))) {
          continue;
        }
        counts_[i * vs_.size() + j] = true;
        const Eigen::Vector3d d = At(i + 1, j + 1) - At(i, j), e = At(i, j + 1) - At(i + 1, j);
        area_ += kHalf * d.cross(e).norm();
      }
    }
  }

  double area() const { return area_; }

  // Pairs of spans there are then.
  double Cells(double side) const {
    const std::size_t u = breaks_u_.size() - 1 + Cuts(Direction::kU, side).size();
    const std::size_t v = breaks_v_.size() - 1 + Cuts(Direction::kV, side).size();
    return static_cast<double>(u) * static_cast<double>(v);
  }
  double spans() const {
    return static_cast<double>((breaks_u_.size() - 1) * (breaks_v_.size() - 1));
  }

  // Knots that make every span at most `side` long where the surface counts.
  std::vector<double> Cuts(Direction direction, double side) const {
    const bool along_u = direction == Direction::kU;
    const std::vector<double>& breaks = along_u ? breaks_u_ : breaks_v_;
    const int pieces = along_u ? pieces_u_ : pieces_v_;
    const std::size_t lines = (along_u ? vs_.size() : us_.size()) - 1;
    std::vector<double> cuts;
    for (std::size_t k = 1; k < breaks.size(); ++k) {
      double longest = 0;
      for (std::size_t line = 0; line < lines; ++line) {
        double length = 0;
        for (std::size_t s = (k - 1) * pieces; s < k * pieces; ++s) {
          const std::size_t i = along_u ? s : line, j = along_u ? line : s;
          if (!counts_[i * vs_.size() + j]) continue;
          length += (along_u ? At(i + 1, j) - At(i, j) : At(i, j + 1) - At(i, j)).norm();
        }
        longest = std::max(longest, length);
      }
      constexpr double kMost = 1000;
      const int parts = static_cast<int>(std::clamp(std::ceil(longest / side), 1.0, kMost));
      const double from = breaks[k - 1], to = breaks[k];
      for (int part = 1; part < parts; ++part) {
        const double cut = from + (to - from) * (double(part) / parts);
        if (from < cut && cut < to && (cuts.empty() || cuts.back() < cut)) cuts.push_back(cut);
      }
    }
    return cuts;
  }

 private:
  Eigen::Vector3d At(std::size_t i, std::size_t j) const {
    return grid_.points.col(static_cast<Eigen::Index>(i * vs_.size() + j));
  }

  std::vector<double> breaks_u_, breaks_v_, us_, vs_;
  int pieces_u_, pieces_v_;
  SurfaceGrid grid_;
  std::vector<bool> counts_;  // whether the middle of the cell after (i, j) is inside the trims
  double area_ = 0;
};

double CellsOf(const std::vector<Lattice>& lattices, double side) {
  double cells = 0;
  for (const Lattice& lattice : lattices) cells += lattice.Cells(side);
  return cells;
}

// The same surfaces with more knots, whose crossings are vertices of their meshes: all cells
// together are about as many as asked for, and of the same size.
std::vector<NurbsSurface> WithCells(const std::vector<NurbsSurface>& surfaces, double cells) {
  std::vector<Lattice> lattices;
  double area = 0, spans = 0;
  for (const NurbsSurface& surface : surfaces) {
    lattices.emplace_back(surface);
    area += lattices.back().area();
    spans += lattices.back().spans();
  }
  double side = std::sqrt(area / cells);
  if (!(side > 0)) return surfaces;
  // A span that is long somewhere is cut all along.
  constexpr double kEnough = 2, kLarger = 1.25;
  for (; CellsOf(lattices, side) > std::max(spans, kEnough * cells); side *= kLarger) {
  }
  std::vector<NurbsSurface> result;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const NurbsSurface finer =
        RefineKnots(surfaces[k], Direction::kU, lattices[k].Cuts(Direction::kU, side));
    result.push_back(RefineKnots(finer, Direction::kV, lattices[k].Cuts(Direction::kV, side)));
  }
  return result;
}

// A lattice of about so many triangles, those outside the trims left out: for surfaces of more
// cells than there may be triangles.
TriangleMesh CoarseMesh(const NurbsSurface& surface, Eigen::Index most) {
  const int side = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(most) / 2)));
  const auto even = [&](const SplineBasis& basis) {
    return EvenIn({basis.lower(), basis.upper()}, side);
  };
  const std::vector<double> us = even(surface.basis_u()), vs = even(surface.basis_v());
  SurfaceGrid grid;
  SurfaceEvaluator(surface).Grid(us, vs, grid);
  const TrimRegion region(surface);
  TriangleMesh mesh;
  mesh.vertices = std::move(grid.points);
  mesh.normals = std::move(grid.normals);
  mesh.parameters.resize(2, mesh.vertices.cols());
  mesh.triangles.resize(3, Eigen::Index{2} * side * side);
  constexpr double kHalf = 0.5;
  Eigen::Index count = 0;
  for (int i = 0; i <= side; ++i) {
    for (int j = 0; j <= side; ++j) {
      const int a = i * (side + 1) + j, b = a + side + 1;
      mesh.parameters.col(a) << us[i], vs[j];
      if (i == side || j == side) continue;
      if (!region.Contains(kHalf * (us[i] + us[i + 1]), kHalf * (vs[j] + vs[j + 1]))) continue;
      mesh.triangles.col(count++) << a, b, b + 1;
      mesh.triangles.col(count++) << a, b + 1, a + 1;
    }
  }
  mesh.triangles.conservativeResize(3, count);
  return mesh;
}

// All surfaces' meshes; none where they need more triangles than there may be.
std::vector<TriangleMesh> MeshesWithin(const std::vector<NurbsSurface>& surfaces,
                                       TessellateOptions options,
                                       const Progress& progress) {
  std::vector<TriangleMesh> meshes;
  const auto total = static_cast<double>(surfaces.size());
  options.progress = [&](double share) {
    Report(progress, "draw", (static_cast<double>(meshes.size()) + share) / total);
  };
  for (const NurbsSurface& surface : surfaces) {
    options.progress(0);
    if (options.max_triangles < 1) return {};
    try {
      meshes.push_back(Tessellate(surface, options));
    } catch (const std::invalid_argument&) {  // says that it is too many
      return {};
    }
    options.max_triangles -= meshes.back().triangles.cols();
  }
  return meshes;
}

std::vector<TriangleMesh> Meshes(const std::vector<NurbsSurface>& surfaces,
                                 const SurfaceDrawing& drawing) {
  constexpr double kCells = 1.0 / 9, kCoarser = 4;
  constexpr int kRounds = 6;
  const std::vector<NurbsSurface> finer =
      WithCells(surfaces, kCells * static_cast<double>(drawing.max_triangles));
  TessellateOptions options;
  options.max_triangles = drawing.max_triangles;
  options.chord_tolerance = drawing.chord_tolerance;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<TriangleMesh> meshes =
        MeshesWithin(round < kRounds / 2 ? finer : surfaces, options, drawing.progress);
    if (!meshes.empty()) return meshes;
    options.chord_tolerance *= kCoarser;
  }
  std::vector<TriangleMesh> meshes;
  for (const NurbsSurface& surface : surfaces) {
    meshes.push_back(
        CoarseMesh(surface, drawing.max_triangles / static_cast<Eigen::Index>(surfaces.size())));
  }
  return meshes;
}

void AddCurvature(const SurfaceEvaluator& at, ReportSurface& drawn, ThreadPool& pool) {
  const Eigen::Matrix2Xd& parameters = drawn.mesh.parameters;
  drawn.gaussian.setConstant(parameters.cols(), kNoValue);
  drawn.mean = drawn.gaussian;
  constexpr std::ptrdiff_t kBlock = 1024;
  pool.For(parameters.cols(), kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const double u = parameters(0, k), v = parameters(1, k);
      auto curvature = CurvatureOf(at.JetAt(u, v));
      if (!curvature) curvature = CurvatureAt(at.surface(), u, v);
      if (!curvature || !std::isfinite(curvature->gaussian) || !std::isfinite(curvature->mean)) {
        continue;
      }
      drawn.gaussian[k] = curvature->gaussian;
      drawn.mean[k] = curvature->mean;
    }
  });
}

// Lines on the surface, within the chord tolerance.
class Lines {
 public:
  Lines(const SurfaceEvaluator& at, double chord_tolerance)
      : at_(at), tolerance_(chord_tolerance) {}

  Eigen::Matrix3Xd Loop(const NurbsCurve<2>& loop) const {
    constexpr double kFine = 1e-3;  // of the domain
    const SplineBasis &bu = at_.surface().basis_u(), &bv = at_.surface().basis_v();
    const double domain = std::min(bu.upper() - bu.lower(), bv.upper() - bv.lower());
    const Polygon polygon = LoopPolyline(loop, kFine * domain);
    std::vector<double> breaks(polygon.parameters.begin(), polygon.parameters.end());
    if (breaks.back() < loop.basis().upper()) breaks.push_back(loop.basis().upper());
    return Along([&](double t) { return loop.At(t); }, breaks, 2);
  }

  // The line on which the parameter of `fixed` is `value`; several where trims cut it.
  void AddLine(Direction fixed,
               double value,
               const TrimRegion* region,
               std::vector<Eigen::Matrix3Xd>& lines) const {
    const bool along_v = fixed == Direction::kU;
    const auto place = [&](double t) {
      return along_v ? Eigen::Vector2d(value, t) : Eigen::Vector2d(t, value);
    };
    const std::vector<double> breaks =
        KnotBreaks(along_v ? at_.surface().basis_v() : at_.surface().basis_u());
    if (!region) {
      lines.push_back(Along(place, breaks, 2));
      return;
    }
    constexpr int kAll = 256;  // a stretch that is shorter may be missed
    const std::vector<double> steps = EvenIn(breaks, 1 + kAll / static_cast<int>(breaks.size()));
    const auto inside = [&](double t) { return region->Contains(place(t)[0], place(t)[1]); };
    std::vector<double> stretch;
    const auto finish = [&] {
      if (stretch.size() > 1) lines.push_back(Along(place, stretch, 1));
      stretch.clear();
    };
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const bool in = inside(steps[k]);
      if (k > 0 && in != !stretch.empty()) {
        stretch.push_back(
            Border(inside, in ? steps[k] : steps[k - 1], in ? steps[k - 1] : steps[k]));
      }
      if (in) {
        stretch.push_back(steps[k]);
      } else {
        finish();
      }
    }
    finish();
  }

 private:
  // Where between them the region ends, from the inside.
  template <class Inside>
  static double Border(const Inside& inside, double in, double out) {
    constexpr int kHalvings = 40;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = in + (out - in) / 2;
      (inside(middle) ? in : out) = middle;
    }
    return in;
  }

  template <class Map>
  Eigen::Matrix3Xd Along(const Map& place, const std::vector<double>& breaks, int pieces) const {
    const std::vector<double> parameters = PolylineParameters(
        [&](double t) {
          const Eigen::Vector2d uv = place(t);
          return at_.At(uv[0], uv[1]);
        },
        breaks,
        tolerance_,
        pieces);
    Eigen::Matrix2Xd places(2, static_cast<Eigen::Index>(parameters.size()));
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      places.col(static_cast<Eigen::Index>(k)) = place(parameters[k]);
    }
    Eigen::Matrix3Xd points;
    at_.Points(places, points);
    return points;
  }

  const SurfaceEvaluator& at_;
  double tolerance_;
};

void AddLines(const SurfaceEvaluator& at, double chord_tolerance, ReportSurface& drawn) {
  const NurbsSurface& surface = at.surface();
  const Lines lines(at, chord_tolerance);
  const TrimRegion region(surface);
  const TrimRegion* const inside = surface.trimmed() ? &region : nullptr;
  for (const NurbsCurve<2>& loop : surface.trims()) drawn.trims.push_back(lines.Loop(loop));
  const CollapsedEdgeSet points = CollapsedEdges(surface);
  for (const Direction fixed : {Direction::kU, Direction::kV}) {
    const bool u = fixed == Direction::kU;
    std::vector<double> breaks = KnotBreaks(u ? surface.basis_u() : surface.basis_v());
    if (!inside && !Closed(surface, fixed)) {
      if (!(u ? points.u_lower : points.v_lower)) {
        lines.AddLine(fixed, breaks.front(), nullptr, drawn.edges);
      }
      if (!(u ? points.u_upper : points.v_upper)) {
        lines.AddLine(fixed, breaks.back(), nullptr, drawn.edges);
      }
    }
    // Of very many lines some say as much.
    constexpr std::size_t kMostLines = 400;
    const std::size_t step = 1 + breaks.size() / kMostLines;
    for (std::size_t k = step; k + 1 < breaks.size(); k += step) {
      lines.AddLine(fixed, breaks[k], inside, drawn.knot_lines);
    }
  }
}

}  // namespace

double AreaOf(const TriangleMesh& mesh) {
  constexpr double kHalf = 0.5;
  double area = 0;
  for (const auto t : mesh.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.vertices.col(t[0]);
    const Eigen::Vector3d b = mesh.vertices.col(t[1]) - a, c = mesh.vertices.col(t[2]) - a;
    area += kHalf * b.cross(c).norm();
  }
  return area;
}

std::vector<ReportSurface> DrawSurfaces(const std::vector<NurbsSurface>& surfaces,
                                        const SurfaceDrawing& drawing,
                                        ThreadPool& pool) {
  std::vector<ReportSurface> result;
  if (surfaces.empty()) return result;
  std::vector<TriangleMesh> meshes = Meshes(surfaces, drawing);
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    Report(drawing.progress, "draw", static_cast<double>(k) / static_cast<double>(surfaces.size()));
    const SurfaceEvaluator at(surfaces[k]);
    ReportSurface& drawn = result.emplace_back();
    drawn.mesh = std::move(meshes[k]);
    AddCurvature(at, drawn, pool);
    AddLines(at, drawing.chord_tolerance, drawn);
    drawn.net_u = surfaces[k].size_u();
    drawn.net_v = surfaces[k].size_v();
    drawn.net = surfaces[k].control_points();
  }
  return result;
}

}  // namespace batten::internal
