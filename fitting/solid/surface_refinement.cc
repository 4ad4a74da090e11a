// SPDX-License-Identifier: MIT
#include "fitting/solid/surface_refinement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/fitting/statistics.h"
#include "fitting/core/rounding.h"
#include "fitting/solid/solid_measurement.h"
#include "geometry/subdivision/catmull_clark.h"

namespace batten::internal {
namespace {

using Marks = std::vector<char>;  // by face or vertex

// How far points are from the surface where it follows them: noise, which sharp bends make seem
// more than it is, or less, but for what is equal.
double ScaleOf(const LimitSurfaceFit& fit, const SurfaceData& data) {
  std::vector<double> distances;
  for (std::size_t k = 0; k < fit.feet.size(); ++k) {
    const auto i = Eigen::Index(k);
    if (data.weights[i] > 0) distances.push_back((fit.feet[k].point - data.points.col(i)).norm());
  }
  const double scale = kMadToSigma * QuantileInPlace(distances, 0.5);
  const double size =
      (data.points.rowwise().maxCoeff() - data.points.rowwise().minCoeff()).maxCoeff();
  return std::max(kRelativelyEqual * size, data.noise > 0 ? std::min(scale, data.noise) : scale);
}

// What the points of a face say of the surface.
struct FaceMisfit {
  int points = 0;
  double squares = 0, most = 0;
};

std::vector<FaceMisfit> MisfitsOf(const CoarseSurface& coarse) {
  std::vector<FaceMisfit> misfits(std::size_t(coarse.stencils.mesh().faces()));
  for (std::size_t k = 0; k < coarse.fit.feet.size(); ++k) {
    const auto i = Eigen::Index(k);
    if (!(coarse.data.weights[i] > 0)) continue;
    FaceMisfit& face = misfits[std::size_t(coarse.fit.feet[k].place.patch >> 2)];
    const double square = (coarse.fit.feet[k].point - coarse.data.points.col(i)).squaredNorm();
    ++face.points;
    face.squares += square;
    face.most = std::max(face.most, square);
  }
  return misfits;
}

// Those and all that share a vertex with them.
Marks WithNeighbours(const QuadTopology& mesh, const Marks& faces) {
  Marks vertices(std::size_t(mesh.vertices()), 0), more = faces;
  for (int f = 0; f < mesh.faces(); ++f) {
    if (!faces[std::size_t(f)]) continue;
    for (int k = 0; k < 4; ++k) vertices[std::size_t(mesh.corners()(k, f))] = 1;
  }
  for (int f = 0; f < mesh.faces(); ++f) {
    for (int k = 0; k < 4; ++k) {
      if (vertices[std::size_t(mesh.corners()(k, f))]) more[std::size_t(f)] = 1;
    }
  }
  return more;
}

// Each of a face's marks for the four that it becomes.
Marks OfFour(const Marks& faces) {
  Marks finer;
  for (const char mark : faces) finer.insert(finer.end(), 4, mark);
  return finer;
}

SurfaceData Some(const SurfaceData& data, const std::vector<Eigen::Index>& which) {
  SurfaceData some;
  some.points = data.points(Eigen::all, which);
  some.normals = data.normals(Eigen::all, which);
  some.oriented = data.oriented;
  some.weights = data.weights(which);
  some.noise = data.noise;
  some.left_out = data.left_out(which);
  return some;
}

// Of patches of the finer mesh: without feet.
Marks Without(const Marks& about, const Marks& no_feet) {
  Marks without = OfFour(OfFour(about));
  for (char& mark : without) mark = !mark;
  for (std::size_t p = 0; p < no_feet.size(); ++p) without[p] |= no_feet[p];
  return without;
}

// With finer control points on some faces and those about them; none where they meet points left
// out no better.
std::optional<RefinedSurface> RefinedOn(const Marks& missed,
                                        const Marks& barred,
                                        const CoarseSurface& coarse,
                                        const SurfaceFitSettings& settings,
                                        ThreadPool& pool) {
  if (std::find(missed.begin(), missed.end(), 1) == missed.end()) return std::nullopt;
  const QuadTopology& mesh = coarse.stencils.mesh();
  const LimitSurfaceFit& fit = coarse.fit;
  Marks moving = WithNeighbours(mesh, missed);
  for (const int cap : coarse.caps) moving[std::size_t(cap)] = 0;
  for (std::size_t f = 0; f < barred.size(); ++f) moving[f] = moving[f] && !barred[f];
  // Control points reach one face farther, feet may slide over another.
  const Marks reached = WithNeighbours(mesh, moving), about = WithNeighbours(mesh, reached);
  const SubdividedMesh& finer = coarse.stencils.finer();
  RefinedSurface refined{LimitStencils(finer.topology, OfFour(about)), {}, {}, 0};
  for (const int cap : coarse.caps) {
    for (int k = 0; k < 4; ++k) refined.caps.push_back(4 * cap + k);
  }
  const Marks no_feet = PatchesOf(refined.caps, refined.stencils.patches());
  SurfaceFitSettings local = settings;
  local.left_out = Without(about, no_feet);
  local.moves.assign(std::size_t(finer.topology.vertices()), 0);
  for (int f = 0; f < finer.topology.faces(); ++f) {
    if (!moving[std::size_t(f >> 2)]) continue;
    for (int k = 0; k < 4; ++k) local.moves[std::size_t(finer.topology.corners()(k, f))] = 1;
  }
  refined.free = std::count(local.moves.begin(), local.moves.end(), 1);
  std::vector<Eigen::Index> which, rank;  // points; places of those left out among all of them
  Eigen::Index left_out = 0;
  for (std::size_t k = 0; k < fit.feet.size(); ++k) {
    const auto i = Eigen::Index(k);
    const bool here = reached[std::size_t(fit.feet[k].place.patch >> 2)];
    if (here) which.push_back(i);
    if (!(coarse.data.weights[i] > 0 && coarse.data.left_out[i])) continue;
    if (here) rank.push_back(left_out);
    ++left_out;
  }
  constexpr std::size_t kFewest = 4;  // fewer points left out say nothing
  if (rank.size() < kFewest) return std::nullopt;
  LimitSurfaceFit start;
  start.control_points = Combined(finer.stencils, fit.control_points);
  start.without = Combined(finer.stencils, fit.without);
  auto found = FitFiner(refined.stencils, start, Some(coarse.data, which), local, pool);
  if (!found) return std::nullopt;
  refined.fit = *std::move(found);
  const Eigen::VectorXd here = std::exchange(refined.fit.held_out, fit.held_out);
  for (std::size_t k = 0; k < rank.size(); ++k)
    refined.fit.held_out[rank[k]] = here[Eigen::Index(k)];
  const LimitSurface surface(refined.stencils, refined.fit.control_points);
  refined.fit.feet = FeetOn({surface, refined.stencils.patches(), no_feet},
                            coarse.data.points,
                            coarse.data.normals,
                            coarse.data.oriented,
                            {},
                            pool);
  return refined;
}

}  // namespace

std::optional<RefinedSurface> RefineSurface(const CoarseSurface& coarse,
                                            const std::vector<char>& barred,
                                            std::optional<double> tolerance,
                                            const SurfaceFitSettings& settings,
                                            ThreadPool& pool) {
  constexpr int kPoints = 4;  // one for each finer face; its neighbours bring others
  // Squares of noise. Chosen among 2, 4, 8 and 16 by points held out of three scans: of twice there
  // are many faces by noise alone, beside which points left out do not show what the others gain;
  // from 8 on faces are lost.
  constexpr double kMissed = 4;
  const double scale = ScaleOf(coarse.fit, coarse.data);
  Marks beyond, missed;
  for (const FaceMisfit& face : MisfitsOf(coarse)) {
    const bool far = !tolerance || face.most > *tolerance * *tolerance;
    beyond.push_back(face.points >= kPoints && far);
    missed.push_back(beyond.back() && face.squares > kMissed * scale * scale * face.points);
  }
  if (tolerance && beyond != missed) {
    if (auto refined = RefinedOn(beyond, barred, coarse, settings, pool)) return refined;
  }
  return RefinedOn(missed, barred, coarse, settings, pool);
}

bool BarAbout(const CoarseSurface& coarse,
              const Eigen::Vector3d& point,
              ThreadPool& pool,
              std::vector<char>& barred) {
  const LimitSurface surface(coarse.stencils, coarse.fit.control_points);
  const QuadTopology& mesh = coarse.stencils.mesh();
  Marks about(std::size_t(mesh.faces()), 0);
  const auto feet = FeetOn(
      {surface, coarse.stencils.patches(), {}}, point, Eigen::Matrix3Xd(3, 0), false, {}, pool);
  about[std::size_t(feet[0].place.patch >> 2)] = 1;
  about = WithNeighbours(mesh, about);
  barred.resize(about.size(), 0);
  const Marks before = barred;
  for (std::size_t f = 0; f < about.size(); ++f) barred[f] |= about[f];
  return barred != before;
}

}  // namespace batten::internal
