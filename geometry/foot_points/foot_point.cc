// SPDX-License-Identifier: MIT
#include "batten/geometry/foot_point.h"

#include <cmath>
#include <stdexcept>

#include "geometry/foot_points/distance_certificate.h"
#include "geometry/foot_points/foot_search.h"
#include "geometry/foot_points/trimmed_foot_search.h"

namespace batten {
using namespace internal;
namespace {

void CheckQuery(const char* function, const Eigen::Vector3d& q) {
  if (q.allFinite()) return;
  throw std::invalid_argument(std::string(function) + ": a coordinate of the point is not finite");
}

FootWorkspace& ThreadWorkspace() {
  thread_local FootWorkspace workspace;
  return workspace;
}

// Point, distance and bound at the local parameters that the rounded parameters stand for.
template <typename Foot>
void Place(const FootTable& table,
           const Eigen::Vector3d& q,
           const FoundFoot& found,
           double x,
           double y,
           Foot& foot) {
  const FootPiece piece{table.local(found.piece),
                        table.degree_u(),
                        table.degree_v(),
                        table.rational,
                        table.monomial()};
  Eigen::Vector3d position;
  EvaluatePosition(piece, x, y, position.data());
  const Eigen::Vector3d& centre = table.centres[found.piece];
  foot.point = centre + position;
  foot.distance = (foot.point - q).norm();
  foot.lower_bound = std::min(found.lower_bound, foot.distance);
  foot.certified = IsCertified(table, found);
}

}  // namespace

struct SurfaceFootPoints::Search {
  explicit Search(NurbsSurface s) : surface(std::move(s)), search(FootTable(surface)) {
    if (surface.trimmed()) trimmed = std::make_unique<const TrimmedFootSearch>(surface, search);
  }

  FoundFoot Nearest(const Eigen::Vector3d& q) const {
    FootWorkspace& workspace = ThreadWorkspace();
    const FoundFoot found = search.Nearest(q, workspace);
    if (trimmed == nullptr || trimmed->Counts(found)) return found;
    return trimmed->Nearest(q, found, workspace);
  }

  SurfaceFoot Answer(const Eigen::Vector3d& q, const FoundFoot& found) const {
    const FootTable& table = search.table();
    const int cell_u = found.piece / table.v.cells(), cell_v = found.piece % table.v.cells();
    SurfaceFoot foot;
    foot.u = table.u.At(cell_u, found.x);
    foot.v = table.v.At(cell_v, found.y);
    Place(table, q, found, table.u.Local(cell_u, foot.u), table.v.Local(cell_v, foot.v), foot);
    return foot;
  }

  NurbsSurface surface;
  FootSearch search;
  std::unique_ptr<const TrimmedFootSearch> trimmed;  // none: no trims
};

SurfaceFootPoints::SurfaceFootPoints(NurbsSurface surface)
    : search_(std::make_unique<Search>(std::move(surface))) {}
SurfaceFootPoints::~SurfaceFootPoints() = default;
SurfaceFootPoints::SurfaceFootPoints(SurfaceFootPoints&&) noexcept = default;
SurfaceFootPoints& SurfaceFootPoints::operator=(SurfaceFootPoints&&) noexcept = default;

const NurbsSurface& SurfaceFootPoints::surface() const { return search_->surface; }

SurfaceFoot SurfaceFootPoints::Nearest(const Eigen::Vector3d& q) const {
  CheckQuery("SurfaceFootPoints::Nearest", q);
  return search_->Answer(q, search_->Nearest(q));
}

SurfaceFoot SurfaceFootPoints::NearestFrom(const Eigen::Vector3d& q, double u, double v) const {
  CheckQuery("SurfaceFootPoints::NearestFrom", q);
  const FootTable& table = search_->search.table();
  u = search_->surface.basis_u().Clamp(u);
  v = search_->surface.basis_v().Clamp(v);
  const int i = table.u.Find(u), j = table.v.Find(v);
  FootWorkspace& workspace = ThreadWorkspace();
  const FoundFoot found = search_->search.NearestFrom(
      q, i * table.v.cells() + j, table.u.Local(i, u), table.v.Local(j, v), workspace);
  const bool counts = search_->trimmed == nullptr || search_->trimmed->Counts(found);
  return search_->Answer(q, counts ? found : search_->trimmed->Nearest(q, found, workspace));
}

bool SurfaceFootPoints::SurelyNearest(const Eigen::Vector3d& q, double u, double v) const {
  CheckQuery("SurfaceFootPoints::SurelyNearest", q);
  const FootTable& table = search_->search.table();
  u = search_->surface.basis_u().Clamp(u);
  v = search_->surface.basis_v().Clamp(v);
  const int i = table.u.Find(u), j = table.v.Find(v);
  const FoundFoot found =
      search_->search.Look(q, i * table.v.cells() + j, table.u.Local(i, u), table.v.Local(j, v));
  return found.lower_bound > 0 && (search_->trimmed == nullptr || search_->trimmed->Counts(found));
}

SurfaceFoot SurfaceFootPoints::Near(const Eigen::Vector3d& q, double u, double v) const {
  CheckQuery("SurfaceFootPoints::Near", q);
  const FootTable& table = search_->search.table();
  u = search_->surface.basis_u().Clamp(u);
  v = search_->surface.basis_v().Clamp(v);
  const int i = table.u.Find(u), j = table.v.Find(v);
  const FoundFoot found =
      search_->search.Descend(q, i * table.v.cells() + j, table.u.Local(i, u), table.v.Local(j, v));
  const bool counts = search_->trimmed == nullptr || search_->trimmed->Counts(found);
  return search_->Answer(q, counts ? found : search_->Nearest(q));
}

namespace {

constexpr std::ptrdiff_t kBlock = 256;  // queries a thread takes at once

}  // namespace

std::vector<SurfaceFoot> SurfaceFootPoints::Nearest(const Eigen::Matrix3Xd& points,
                                                    ThreadPool& pool) const {
  std::vector<SurfaceFoot> feet(points.cols());
  pool.For(points.cols(), kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) feet[k] = Nearest(points.col(k));
  });
  return feet;
}

std::vector<SurfaceFoot> SurfaceFootPoints::Near(const Eigen::Matrix3Xd& points,
                                                 const Eigen::Matrix2Xd& starts,
                                                 ThreadPool& pool) const {
  if (points.cols() != starts.cols()) {
    throw std::invalid_argument("SurfaceFootPoints::Near: " + std::to_string(starts.cols()) +
                                " starts do not fit " + std::to_string(points.cols()) + " points");
  }
  std::vector<SurfaceFoot> feet(points.cols());
  pool.For(points.cols(), kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      feet[k] = Near(points.col(k), starts(0, k), starts(1, k));
    }
  });
  return feet;
}

template <int Dim>
struct CurveFootPoints<Dim>::Search {
  explicit Search(NurbsCurve<Dim> c) : curve(std::move(c)), search(FootTable(curve)) {}

  CurveFoot Answer(const Eigen::Vector3d& q, const FoundFoot& found) const {
    const FootTable& table = search.table();
    CurveFoot foot;
    foot.u = table.u.At(found.piece, found.x);
    Place(table, q, found, table.u.Local(found.piece, foot.u), 0, foot);
    return foot;
  }

  NurbsCurve<Dim> curve;
  FootSearch search;
};

template <int Dim>
CurveFootPoints<Dim>::CurveFootPoints(NurbsCurve<Dim> curve)
    : search_(std::make_unique<Search>(std::move(curve))) {}
template <int Dim>
CurveFootPoints<Dim>::~CurveFootPoints() = default;
template <int Dim>
CurveFootPoints<Dim>::CurveFootPoints(CurveFootPoints&&) noexcept = default;
template <int Dim>
CurveFootPoints<Dim>& CurveFootPoints<Dim>::operator=(CurveFootPoints&&) noexcept = default;

template <int Dim>
const NurbsCurve<Dim>& CurveFootPoints<Dim>::curve() const {
  return search_->curve;
}

template <int Dim>
CurveFoot CurveFootPoints<Dim>::Nearest(const Eigen::Vector3d& q) const {
  CheckQuery("CurveFootPoints::Nearest", q);
  return search_->Answer(q, search_->search.Nearest(q, ThreadWorkspace()));
}

template <int Dim>
CurveFoot CurveFootPoints<Dim>::Near(const Eigen::Vector3d& q, double u) const {
  CheckQuery("CurveFootPoints::Near", q);
  const FootTable& table = search_->search.table();
  u = search_->curve.basis().Clamp(u);
  const int cell = table.u.Find(u);
  return search_->Answer(q, search_->search.Descend(q, cell, table.u.Local(cell, u), 0));
}

template <int Dim>
std::vector<CurveFoot> CurveFootPoints<Dim>::Nearest(const Eigen::Matrix3Xd& points,
                                                     ThreadPool& pool) const {
  std::vector<CurveFoot> feet(points.cols());
  pool.For(points.cols(), kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) feet[k] = Nearest(points.col(k));
  });
  return feet;
}

template class CurveFootPoints<2>;
template class CurveFootPoints<3>;

}  // namespace batten
