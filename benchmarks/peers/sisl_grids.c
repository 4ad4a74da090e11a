/* SPDX-License-Identifier: MIT */
/* Franke's function on a regular N × N grid through SISL: s1537 interpolates it or, with a
   tolerance, s1966 approximates it. Prints median seconds, control points and errors as
   grid_fitting.cc does, measured on a finer grid: the rms of z against the function at the
   surface's own (x, y), and the largest difference from the interpolant at the same parameters.
   Links SISL (AGPL) and nothing of batten; built on request only. Usage: sisl_grids N [TOLERANCE]
 */
#include <sisl.h>

#include "comparator.h"

enum { kDimension = 3, kOrder = 4, kFiner = 4, kMostPlaces = 2000, kIterations = 10 };
/* s1966's best way on smooth data: cubic Hermite pieces, no part of the tolerance for lines. */
enum { kShareOfLines = 0, kHermitePieces = 3 };

static void PointAt(SISLSurf* surface, double u, double v, double* point) {
  double parameters[2] = {u, v}, normal[kDimension];
  static int left1 = 0, left2 = 0;
  int status = 0;
  s1421(surface, 0, parameters, &left1, &left2, point, normal, &status);
}

static SISLSurf* Interpolate(double* points, double* parameters, int n) {
  SISLSurf* surface = NULL;
  int status = 0;
  s1537(points,
        n,
        n,
        kDimension,
        parameters,
        parameters,
        0,
        0,
        0,
        0,
        kOrder,
        kOrder,
        1,
        1,
        &surface,
        &status);
  return status < 0 ? NULL : surface;
}

/* rms of z to the function, and the largest difference from another surface. */
static void Measure(SISLSurf* surface, SISLSurf* other, int n, double* rms, double* most) {
  const int fine = kFiner * (n - 1) < kMostPlaces ? kFiner * (n - 1) : kMostPlaces;
  double squares = 0;
  *most = 0;
  for (int i = 0; i <= fine; ++i) {
    for (int j = 0; j <= fine; ++j) {
      double p[kDimension], q[kDimension];
      PointAt(surface, (double)i / fine, (double)j / fine, p);
      PointAt(other, (double)i / fine, (double)j / fine, q);
      const double off = p[2] - Franke(p[0], p[1]);
      squares += off * off;
      const double apart = sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
                                (p[2] - q[2]) * (p[2] - q[2]));
      if (apart > *most) *most = apart;
    }
  }
  *rms = sqrt(squares / ((fine + 1.0) * (fine + 1.0)));
}

/* Cubic within a tolerance; null where that fails. */
static SISLSurf* Approximate(
    double* points, double* parameters, int n, double tolerance, double* errors) {
  double tolerances[kDimension] = {tolerance, tolerance, tolerance}, edges[4 * kDimension];
  for (int e = 0; e < 4 * kDimension; ++e) edges[e] = tolerance;
  int fixed[4] = {0, 0, 0, 0}, status = 0;
  SISLSurf* surface = NULL;
  s1966(points,
        n,
        n,
        kDimension,
        3,
        parameters,
        parameters,
        tolerances,
        fixed,
        1,
        1,
        edges,
        kShareOfLines,
        kHermitePieces,
        kIterations,
        kOrder,
        kOrder,
        &surface,
        errors,
        &status);
  return status < 0 ? NULL : surface;
}

int main(int argc, char** argv) {
  const int n = argc > 1 ? atoi(argv[1]) : 0;
  const double tolerance = argc == 3 ? atof(argv[2]) : 0;
  if (n < kOrder || argc > 3) {
    fprintf(stderr, "usage: sisl_grids N [TOLERANCE]\n");
    return 2;
  }
  double* points = malloc(sizeof *points * kDimension * (size_t)n * (size_t)n);
  double* parameters = malloc(sizeof *parameters * (size_t)n);
  double* errors = malloc(sizeof *errors * kDimension * (size_t)n * (size_t)n);
  if (!points || !parameters || !errors) return 1;
  for (int j = 0; j < n; ++j) parameters[j] = (double)j / (n - 1);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      double* p = points + kDimension * ((size_t)j * (size_t)n + (size_t)i);
      p[0] = parameters[i];
      p[1] = parameters[j];
      p[2] = Franke(p[0], p[1]);
    }
  }
  SISLSurf* surface = NULL;
  Runs runs = {.count = 0};
  while (MayRun(&runs)) {
    if (surface) freeSurf(surface);
    const Seconds begin = Now();
    surface = tolerance > 0 ? Approximate(points, parameters, n, tolerance, errors)
                            : Interpolate(points, parameters, n);
    AddRun(&runs, Since(begin));
    if (!surface) {
      fprintf(stderr, "sisl_grids: SISL failed\n");
      return 1;
    }
  }
  SISLSurf* through = Interpolate(points, parameters, n);
  if (!through) return 1;
  double rms, most;
  Measure(surface, through, n, &rms, &most);
  PrintSeconds(&runs);
  printf(" numbers=%d rms=%.4e", surface->in1 * surface->in2, rms);
  if (tolerance > 0) printf(" max=%.4e", most);
  printf("\n");
  freeSurf(through);
  freeSurf(surface);
  free(points);
  free(parameters);
  free(errors);
  return 0;
}
