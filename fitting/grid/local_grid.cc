// SPDX-License-Identifier: MIT
// InterpolateGridLocally.
#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "batten/fitting/interpolate_grid.h"

namespace batten {
namespace {

// A linear combination of three successive lines, or of two where there are no more.
struct Mix {
  Eigen::Index first = 0;
  double factors[3] = {0, 0, 0};
};

// Bessel's derivative at parameter k as a mix: that of the parabola through k and its neighbours,
// at an end through the three points there; of two points the slope between them.
Mix BesselAt(const Eigen::VectorXd& t, Eigen::Index k) {
  const Eigen::Index n = t.size();
  if (n == 2) return {0, {-1 / (t[1] - t[0]), 1 / (t[1] - t[0]), 0}};
  const Eigen::Index first = std::clamp<Eigen::Index>(k - 1, 0, n - 3);
  Mix mix{first, {}};
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const double at = t[first + a], bt = t[first + b], ct = t[first + c];
    mix.factors[a] = ((t[k] - bt) + (t[k] - ct)) / ((at - bt) * (at - ct));
  }
  return mix;
}

// Every control point over double knots: a line's own place plus a third of a step along its
// derivative, to either side; at the ends also the place itself.
std::vector<Mix> HermiteMixes(const Eigen::VectorXd& t) {
  const Eigen::Index n = t.size();
  std::vector<Mix> mixes;
  for (Eigen::Index k = 0; k < n; ++k) {
    const Mix slope = BesselAt(t, k);
    const auto beside = [&](double step) {
      Mix mix = slope;
      for (double& factor : mix.factors) factor *= step / 3;
      mix.factors[k - mix.first] += 1;
      mixes.push_back(mix);
    };
    beside(k > 0 ? t[k - 1] - t[k] : 0);
    beside(k + 1 < n ? t[k + 1] - t[k] : 0);
  }
  return mixes;
}

SplineBasis DoubleKnots(const Eigen::VectorXd& t) {
  std::vector<double> knots(2, t[0]);
  for (const double x : t) knots.insert(knots.end(), 2, x);
  knots.insert(knots.end(), 2, t[t.size() - 1]);
  return SplineBasis(3, std::move(knots));
}

}  // namespace

InterpolatedGrid InterpolateGridLocally(const PointNet& net,
                                        const GridInterpolationOptions& options,
                                        ThreadPool& pool) {
  RequireComplete(net, "InterpolateGridLocally");
  if (options.closed.u || options.closed.v) {
    throw std::invalid_argument(
        "local interpolation of a grid does not close: interpolate globally");
  }
  const GridParameters t =
      ParametersFor(net, options.parameterization, options.parameters, options.closed);
  const std::vector<Mix> along_u = HermiteMixes(t.u), along_v = HermiteMixes(t.v);
  const Eigen::Index rows = net.rows, columns = net.columns, wide = 2 * columns;
  const Eigen::Vector3d middle = MiddleOf(net);
  Eigen::Matrix3Xd half = Eigen::Matrix3Xd::Zero(3, rows * wide);
  Eigen::Matrix3Xd control(3, 2 * rows * wide);
  const auto mixed = [&](const Mix& mix, Eigen::Index last, auto&& at) -> Eigen::Vector3d {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Eigen::Index a = 0; a < 3 && mix.first + a <= last; ++a) {
      sum += mix.factors[a] * at(mix.first + a);
    }
    return sum;
  };
  constexpr std::ptrdiff_t kBlock = 16;
  pool.For(rows, kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      for (Eigen::Index b = 0; b < wide; ++b) {
        half.col(i * wide + b) =
            mixed(along_v[static_cast<size_t>(b)], columns - 1, [&](Eigen::Index j) {
              return net.points.col(i * columns + j) - middle;
            });
      }
    }
  });
  pool.For(2 * rows, kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t a = begin; a < end; ++a) {
      for (Eigen::Index b = 0; b < wide; ++b) {
        control.col(a * wide + b) =
            middle + mixed(along_u[static_cast<size_t>(a)], rows - 1, [&](Eigen::Index i) {
              return half.col(i * wide + b);
            });
      }
    }
  });
  Collapse(PolesOf(net, options.closed),
           static_cast<int>(2 * rows),
           static_cast<int>(2 * columns),
           control);
  return {NurbsSurface(DoubleKnots(t.u), DoubleKnots(t.v), std::move(control)), t};
}

}  // namespace batten
