// SPDX-License-Identifier: MIT
#include "geometry_laws.h"

#include <cmath>

#include "batten/io/geometry_json.h"
#include "batten/io/read_error.h"
#include "fuzz_targets.h"

namespace batten::internal {
namespace {

// Shares of a domain: both ends, and places within.
constexpr double kPlaces[] = {0, 0.25, 0.61803398874989485, 1};

double Place(const SplineBasis& basis, double share) {
  return std::lerp(basis.lower(), basis.upper(), share);
}

template <int Dim>
bool FiniteAt(const NurbsCurve<Dim>& curve) {
  for (const double share : kPlaces) {
    if (!curve.At(Place(curve.basis(), share)).allFinite()) return false;
  }
  return true;
}

bool FiniteAt(const NurbsSurface& surface) {
  for (const double s : kPlaces) {
    for (const double t : kPlaces) {
      const double u = Place(surface.basis_u(), s), v = Place(surface.basis_v(), t);
      if (!surface.At(u, v).allFinite()) return false;
    }
  }
  for (const NurbsCurve<2>& loop : surface.trims()) {
    if (!FiniteAt(loop)) return false;
  }
  return true;
}

}  // namespace

void RequireGeometryLaws(const std::vector<Geometry>& geometry) {
  RequireLaw(!geometry.empty(), "a file that is read holds geometry");
  for (const Geometry& one : geometry) {
    RequireLaw(std::visit([](const auto& shape) { return FiniteAt(shape); }, one),
               "points of the geometry are finite");
  }
  const std::string text = ToGeometryJson(geometry);
  std::string again;
  try {
    again = ToGeometryJson(ParseGeometryJson(text, "written.json"));
  } catch (const ReadError& error) {
    throw BrokenLaw(std::string("what was read and written can't be read: ") + error.what());
  }
  RequireLaw(text == again, "what was read and written reads back the same");
}

}  // namespace batten::internal
