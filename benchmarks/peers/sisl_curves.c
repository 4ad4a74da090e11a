/* SPDX-License-Identifier: MIT */
/* A cubic by SISL's s1961 (chord lengths, data reduction to a tolerance) along points in a row:
   prints median seconds and its number of control points, and writes many points of it. SHARE is
   that of the tolerance spent on the polyline it starts from, 0 to 1. Links SISL (AGPL) and nothing
   of batten; built on request only. Usage: sisl_curves POINTS.f64 TOLERANCE SHARE LINE.f64 */
#include <sisl.h>

#include "comparator.h"

enum { kDimension = 3, kOrder = 4, kChords = 20000, kIterations = 10 };

static int WriteLine(SISLCurve* curve, const char* path) {
  FILE* out = fopen(path, "wb");
  if (!out) return 0;
  const double lower = curve->et[kOrder - 1], upper = curve->et[curve->in];
  int left = 0, status = 0;
  for (int k = 0; k <= kChords && status >= 0; ++k) {
    double point[kDimension];
    s1221(curve, 0, lower + (upper - lower) * k / kChords, &left, point, &status);
    fwrite(point, sizeof *point, kDimension, out);
  }
  return fclose(out) == 0 && status >= 0;
}

int main(int argc, char** argv) {
  if (argc != 5) {
    fprintf(stderr, "usage: sisl_curves POINTS.f64 TOLERANCE SHARE LINE.f64\n");
    return 2;
  }
  size_t numbers = 0;
  double* points = ReadDoubles(argv[1], &numbers);
  const int count = (int)(numbers / kDimension);
  if (!points || count < 2 || numbers % kDimension != 0) {
    fprintf(stderr, "sisl_curves: can't use %s\n", argv[1]);
    return 1;
  }
  const double tolerance = atof(argv[2]), share = atof(argv[3]);
  double tolerances[kDimension] = {tolerance, tolerance, tolerance}, errors[kDimension];
  SISLCurve* curve = NULL;
  int status = 0;
  Runs runs = {.count = 0};
  while (status >= 0 && MayRun(&runs)) {
    if (curve) freeCurve(curve);
    curve = NULL;
    const Seconds begin = Now();
    s1961(points,
          count,
          kDimension,
          1,
          NULL,
          tolerances,
          0,
          0,
          1,
          share,
          kIterations,
          kOrder,
          &curve,
          errors,
          &status);
    AddRun(&runs, Since(begin));
  }
  free(points);
  if (status < 0 || !curve || !WriteLine(curve, argv[4])) {
    fprintf(stderr, "sisl_curves: s1961 ended with %d\n", status);
    return 1;
  }
  PrintSeconds(&runs);
  printf(" numbers=%d\n", curve->in);
  freeCurve(curve);
  return 0;
}
