// SPDX-License-Identifier: MIT
#include "io/opencascade/space_curve.h"

#include <Approx_CurveOnSurface.hxx>
#include <Bnd_Box.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Standard_Failure.hxx>
#include <algorithm>
#include <cmath>

namespace batten::internal {
namespace {

double SizeOf(const Geom_BSplineSurface& surface) {
  Bnd_Box box;
  for (int i = 1; i <= surface.NbUPoles(); ++i) {
    for (int j = 1; j <= surface.NbVPoles(); ++j) box.Add(surface.Pole(i, j));
  }
  return std::sqrt(box.SquareExtent());
}

}  // namespace

Handle(Geom_BSplineCurve) CurveInSpace(const Handle(Geom_BSplineSurface) & surface,
                                       const Handle(Geom2d_BSplineCurve) & parameters) {
  constexpr int kMostPieces = 2000, kDegree = 9;
  constexpr double kShare = 1e-9;
  const Handle(Geom2dAdaptor_Curve) curve = new Geom2dAdaptor_Curve(parameters);
  const Handle(GeomAdaptor_Surface) onto = new GeomAdaptor_Surface(surface);
  Approx_CurveOnSurface approximation(curve,
                                      onto,
                                      parameters->FirstParameter(),
                                      parameters->LastParameter(),
                                      kShare * SizeOf(*surface));
  approximation.Perform(kMostPieces, kDegree, GeomAbs_C1, true);
  if (!approximation.HasResult()) throw Standard_Failure("no curve in space follows a trim loop");
  return approximation.Curve3d();
}

double Deviation(const Geom_Curve& in_space,
                 const Geom2d_BSplineCurve& parameters,
                 const Geom_Surface& surface) {
  constexpr int kPlaces = 23;
  double worst = 0;
  for (int k = 1; k < parameters.NbKnots(); ++k) {
    const double low = parameters.Knot(k), high = parameters.Knot(k + 1);
    for (int i = 0; i <= kPlaces; ++i) {
      const double t = low + (high - low) * i / kPlaces;
      const gp_Pnt2d uv = parameters.Value(t);
      worst = std::max(worst, in_space.Value(t).Distance(surface.Value(uv.X(), uv.Y())));
    }
  }
  return worst;
}

}  // namespace batten::internal
