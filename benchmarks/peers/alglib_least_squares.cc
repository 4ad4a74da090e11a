// SPDX-License-Identifier: MIT
// Least squares by ALGLIB's bicubic BlockLLS solver, no smoothing, heights z over given (x, y) in
// the unit square, NET × NET nodes: prints median seconds, and the vertical rms and largest error
// against Franke's function on a grid of 201 × 201 places. Links ALGLIB (GPL) and nothing of
// batten; built on request only. Usage: alglib_least_squares CLOUD.f64 NET
#include <libalglib/interpolation.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "comparator.h"

namespace {

alglib::spline2dinterpolant Fit(const alglib::real_2d_array& points, int net) {
  alglib::spline2dbuilder builder;
  alglib::spline2dbuildercreate(1, builder);
  alglib::spline2dbuildersetpoints(builder, points, points.rows());
  alglib::spline2dbuildersetarea(builder, 0, 1, 0, 1);
  alglib::spline2dbuildersetgrid(builder, net, net);
  alglib::spline2dbuildersetalgoblocklls(builder, 0);
  alglib::spline2dinterpolant spline;
  alglib::spline2dfitreport report;
  alglib::spline2dfit(builder, spline, report);
  return spline;
}

void PrintErrors(const alglib::spline2dinterpolant& spline) {
  constexpr int kSide = kTruthSide;
  double squares = 0, most = 0;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const double x = i / (kSide - 1.0), y = j / (kSide - 1.0);
      const double off = alglib::spline2dcalc(spline, x, y) - Franke(x, y);
      squares += off * off;
      most = std::max(most, std::abs(off));
    }
  }
  std::printf(" rms=%.4e max=%.4e", std::sqrt(squares / (kSide * kSide)), most);
}

}  // namespace

int main(int argc, char** argv) {
  size_t count = 0;
  double* numbers = argc == 3 ? ReadDoubles(argv[1], &count) : nullptr;
  const int net = argc == 3 ? std::atoi(argv[2]) : 0;
  if (!numbers || count < 3 || net < 4) {
    std::fprintf(stderr, "usage: alglib_least_squares CLOUD.f64 NET, where NET is 4 or more\n");
    return 2;
  }
  try {
    alglib::real_2d_array points;
    points.setcontent(static_cast<alglib::ae_int_t>(count / 3), 3, numbers);
    std::free(numbers);
    alglib::spline2dinterpolant spline;
    Runs runs{};
    while (MayRun(&runs)) {
      const Seconds begin = Now();
      spline = Fit(points, net);
      AddRun(&runs, Since(begin));
    }
    PrintSeconds(&runs);
    std::printf(" numbers=%d", net * net);
    PrintErrors(spline);
    std::printf("\n");
  } catch (const alglib::ap_error& error) {
    std::fprintf(stderr, "alglib_least_squares: %s\n", error.msg.c_str());
    return 1;
  }
}
