// SPDX-License-Identifier: MIT
#include "io/opencascade/occt_convert.h"

#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <utility>
#include <vector>

namespace batten::internal {
namespace {

// A knot vector as OpenCASCADE holds it: distinct values with multiplicities.
struct KnotArrays {
  TColStd_Array1OfReal values;
  TColStd_Array1OfInteger multiplicities;

  explicit KnotArrays(const std::vector<double>& knots) : KnotArrays(knots, Distinct(knots)) {}

 private:
  KnotArrays(const std::vector<double>& knots, int distinct)
      : values(1, distinct), multiplicities(1, distinct) {
    multiplicities.Init(0);
    int last = 0;
    for (size_t i = 0; i < knots.size(); ++i) {
      if (i == 0 || knots[i] != knots[i - 1]) values(++last) = knots[i];
      ++multiplicities(last);
    }
  }

  static int Distinct(const std::vector<double>& knots) {
    int count = 1;
    for (size_t i = 1; i < knots.size(); ++i) count += knots[i] != knots[i - 1];
    return count;
  }
};

std::vector<double> Flat(const TColStd_Array1OfReal& values,
                         const TColStd_Array1OfInteger& multiplicities) {
  std::vector<double> knots;
  for (int i = values.Lower(); i <= values.Upper(); ++i) {
    knots.insert(knots.end(), multiplicities(i), values(i));
  }
  return knots;
}

template <int Dim>
Handle(Geom_BSplineCurve) CurveToOcct(const NurbsCurve<Dim>& curve) {
  const int size = curve.basis().size();
  TColgp_Array1OfPnt poles(1, size);
  TColStd_Array1OfReal weights(1, size);
  for (int i = 0; i < size; ++i) {
    const auto point = curve.control_points().col(i);
    double z = 0;
    if constexpr (Dim == 3) z = point[2];
    poles(i + 1) = gp_Pnt(point[0], point[1], z);
    weights(i + 1) = curve.weights()[i];
  }
  const KnotArrays knots(curve.basis().knots());
  return new Geom_BSplineCurve(
      poles, weights, knots.values, knots.multiplicities, curve.basis().degree());
}

}  // namespace

Handle(Geom_BSplineCurve) ToOcct(const NurbsCurve<2>& curve) { return CurveToOcct(curve); }
Handle(Geom_BSplineCurve) ToOcct(const NurbsCurve<3>& curve) { return CurveToOcct(curve); }

Handle(Geom2d_BSplineCurve) ToOcct2d(const NurbsCurve<2>& curve) {
  const int size = curve.basis().size();
  TColgp_Array1OfPnt2d poles(1, size);
  TColStd_Array1OfReal weights(1, size);
  for (int i = 0; i < size; ++i) {
    poles(i + 1) = gp_Pnt2d(curve.control_points()(0, i), curve.control_points()(1, i));
    weights(i + 1) = curve.weights()[i];
  }
  const KnotArrays knots(curve.basis().knots());
  return new Geom2d_BSplineCurve(
      poles, weights, knots.values, knots.multiplicities, curve.basis().degree());
}

Handle(Geom_BSplineSurface) ToOcct(const NurbsSurface& surface) {
  TColgp_Array2OfPnt poles(1, surface.size_u(), 1, surface.size_v());
  TColStd_Array2OfReal weights(1, surface.size_u(), 1, surface.size_v());
  for (int i = 0; i < surface.size_u(); ++i) {
    for (int j = 0; j < surface.size_v(); ++j) {
      const Eigen::Vector3d point = surface.control_point(i, j);
      poles(i + 1, j + 1) = gp_Pnt(point.x(), point.y(), point.z());
      weights(i + 1, j + 1) = surface.weights()[Eigen::Index{i} * surface.size_v() + j];
    }
  }
  const KnotArrays u(surface.basis_u().knots()), v(surface.basis_v().knots());
  return new Geom_BSplineSurface(poles,
                                 weights,
                                 u.values,
                                 v.values,
                                 u.multiplicities,
                                 v.multiplicities,
                                 surface.basis_u().degree(),
                                 surface.basis_v().degree());
}

NurbsCurve<3> FromOcct(const Geom_BSplineCurve& curve) {
  const int size = curve.NbPoles();
  Eigen::Matrix3Xd points(3, size);
  Eigen::VectorXd weights(size);
  for (int i = 0; i < size; ++i) {
    const gp_Pnt& pole = curve.Pole(i + 1);
    points.col(i) << pole.X(), pole.Y(), pole.Z();
    weights[i] = curve.Weight(i + 1);
  }
  return NurbsCurve<3>(SplineBasis(curve.Degree(), Flat(curve.Knots(), curve.Multiplicities())),
                       std::move(points),
                       std::move(weights));
}

NurbsCurve<2> FromOcct(const Geom2d_BSplineCurve& curve) {
  const int size = curve.NbPoles();
  Eigen::Matrix2Xd points(2, size);
  Eigen::VectorXd weights(size);
  for (int i = 0; i < size; ++i) {
    points.col(i) << curve.Pole(i + 1).X(), curve.Pole(i + 1).Y();
    weights[i] = curve.Weight(i + 1);
  }
  return NurbsCurve<2>(SplineBasis(curve.Degree(), Flat(curve.Knots(), curve.Multiplicities())),
                       std::move(points),
                       std::move(weights));
}

NurbsSurface FromOcct(const Geom_BSplineSurface& surface) {
  const int size_u = surface.NbUPoles(), size_v = surface.NbVPoles();
  Eigen::Matrix3Xd points(3, Eigen::Index{size_u} * size_v);
  Eigen::VectorXd weights(points.cols());
  for (int i = 0; i < size_u; ++i) {
    for (int j = 0; j < size_v; ++j) {
      const Eigen::Index k = Eigen::Index{i} * size_v + j;
      const gp_Pnt& pole = surface.Pole(i + 1, j + 1);
      points.col(k) << pole.X(), pole.Y(), pole.Z();
      weights[k] = surface.Weight(i + 1, j + 1);
    }
  }
  return NurbsSurface(
      SplineBasis(surface.UDegree(), Flat(surface.UKnots(), surface.UMultiplicities())),
      SplineBasis(surface.VDegree(), Flat(surface.VKnots(), surface.VMultiplicities())),
      std::move(points),
      std::move(weights));
}

Handle(TCollection_HAsciiString) Text(const std::string& text) {
  return new TCollection_HAsciiString(text.c_str());
}

}  // namespace batten::internal
