// SPDX-License-Identifier: MIT
// Standard deviations of a fitted shape, and covariances of what is read off it.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/fit_report.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/surface_options.h"

namespace batten {

// A linear functional of the shape's displacement ν along its normal: Σ factor · ν(u, v).
struct DisplacementTerm {
  double u, v, factor;  // v is not looked at on curves
};
using ShapeFunctional = std::vector<DisplacementTerm>;

// A place of a shape: v is 0 on curves.
struct PlaceUncertainty {
  double deviation = 0;  // standard deviation along the normal, the data's units
  double bias = 0;       // by which fairness moved the shape along the normal, to first order
  double support = 0;    // share of the data in what is known there, 0 … 1; the rest is fairness
};

// Below this support fairness, not the points, decides where the shape is. Smoothing splines in the
// midst of data have 3/4, fits without smoothing 1, voids next to 0.
inline constexpr double kLeastSupport = 0.5;

// The shape found by least squares moves with the noise of its points: to first order by
// ν = b(u,v)ᵀ M⁻¹ Σ w b_k ε_k along its normal, with M = A + λP, A = Σ w b_k b_kᵀ the normal matrix
// of distances along the normal (foot points are free to slide) and λP the fairness. So
// Var ν = σ² bᵀ M⁻¹ A M⁻¹ b, with σ² = Σ w r² / (m − 2 tr H + tr H²) and H the matrix from points
// to their feet [Hastie & Tibshirani 1990, §3.5]; the part of fairness, −λ M⁻¹ P c, is a bias and
// is given apart. Under a loss ρ: ψ = ρ' in place of r, all over the mean of ψ' [Huber 1981, §7.6].
// Weights and knots that were free are further columns of A, as are conditions: edges, poles and
// points that were held have no variance, a mirrored surface moves with its image. Noise that
// neighbours share makes sums of residuals over blocks (parts of knot cells) larger than σ² allows;
// the ratio, where it is significant, multiplies all variances. What the fit chose by the data (the
// number of control points, outliers) counts as given. Where noise is wider than a knot cell, or
// the shape has detail the spline does not follow, errors are larger than said here.
// Matrices are sparse; entries of inverses come by the recursion of [Takahashi, Fagan & Chen 1973].
class Uncertainty {
 public:
  // Of a fit to this cloud. Throws std::invalid_argument, with a sentence for the user, where the
  // fit has none (FitEstimator::refused) or the points leave no freedom to estimate noise by.
  // O(m (p+1)² (q+1)²) for m points, and a sparse factorization.
  Uncertainty(const SurfaceFit& fit, const PointCloud& cloud, int threads = 0);
  Uncertainty(const CurveFit<2>& fit, const PointCloud& cloud, int threads = 0);
  Uncertainty(const CurveFit<3>& fit, const PointCloud& cloud, int threads = 0);
  ~Uncertainty();
  Uncertainty(Uncertainty&&) noexcept;
  Uncertainty& operator=(Uncertainty&&) noexcept;

  double noise() const;      // σ of a point of weight one, along the normal
  double inflation() const;  // ≥ 1: factor on variances for noise that neighbours share
  double freedom() const;    // degrees of freedom left to estimate σ by

  // At parameters of the domain (2 × k; of curves the first row). Curves in space have the same
  // deviation in every direction across. O((p+1)² (q+1)²) a place.
  std::vector<PlaceUncertainty> At(const Eigen::Matrix2Xd& parameters) const;
  PlaceUncertainty At(double u, double v = 0) const;

  // The covariance of functionals (k × k), inflation included. A solve with the factor for each.
  Eigen::MatrixXd Covariance(const std::vector<ShapeFunctional>& functionals) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// How much a number that is read off a surface changes with ν, to first order. Derivatives of ν are
// differences inside a knot cell. Each throws std::invalid_argument where the surface has no normal
// at the place.
//  · the position along a direction (of length one);
ShapeFunctional PositionAlong(const NurbsSurface& surface,
                              double u,
                              double v,
                              const Eigen::Vector3d& direction);
//  · the distance between two different places;
ShapeFunctional DistanceBetween(const NurbsSurface& surface,
                                const Eigen::Vector2d& first,
                                const Eigen::Vector2d& second);
//  · the component of the unit normal along a direction, in radians for one in the tangent plane;
ShapeFunctional NormalAlong(const NurbsSurface& surface,
                            double u,
                            double v,
                            const Eigen::Vector3d& direction);
//  · the normal curvature, or its radius, along a·S_u + b·S_v, (a, b) = `along`.
ShapeFunctional NormalCurvature(const NurbsSurface& surface,
                                double u,
                                double v,
                                const Eigen::Vector2d& along);
ShapeFunctional CurvatureRadius(const NurbsSurface& surface,
                                double u,
                                double v,
                                const Eigen::Vector2d& along);
// Of a plane curve: its signed curvature, ν to the left.
ShapeFunctional Curvature(const NurbsCurve<2>& curve, double u);

// Deviations over a shape on a grid of parameters, u outside, v inside (one on curves); NaN, and no
// area, outside the trims.
struct UncertaintyMap {
  std::vector<double> u, v;
  std::vector<PlaceUncertainty> places;
  Eigen::VectorXd areas;  // of the cells around the places; lengths of curves

  // What the report says.
  UncertaintySummary Summary(const Uncertainty& of) const;
};
UncertaintyMap MapUncertainty(const Uncertainty& of, const NurbsSurface& surface);
template <int Dim>
UncertaintyMap MapUncertainty(const Uncertainty& of, const NurbsCurve<Dim>& curve);

extern template UncertaintyMap MapUncertainty(const Uncertainty&, const NurbsCurve<2>&);
extern template UncertaintyMap MapUncertainty(const Uncertainty&, const NurbsCurve<3>&);

}  // namespace batten
