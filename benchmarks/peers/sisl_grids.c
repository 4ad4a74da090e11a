/* SPDX-License-Identifier: MIT */
/* Franke's function on a regular N × N grid through SISL: s1537 interpolates it, s1966 approximates
   it within a tolerance. Prints seconds, control points and errors, measured on a finer grid: the
   rms of z against the function at the surface's own (x, y), and the largest difference from the
   interpolant at the same parameters. For grid_fitting.cc to stand beside. Links SISL (AGPL) and
   nothing of batten; built on request only.
   Usage: sisl_grids N TOLERANCE... */
#include <math.h>
#include <sisl.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { kDimension = 3, kOrder = 4, kRepeats = 5, kFiner = 4, kIterations = 10 };
/* s1966's best way on smooth data: cubic Hermite pieces, no part of the tolerance for lines. */
enum { kShareOfLines = 0, kHermitePieces = 3 };

static double Now(void) {
  struct timespec t;
  timespec_get(&t, TIME_UTC);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double Franke(double x, double y) {
  const double a = 9 * x, b = 9 * y;
  return 0.75 * exp(-((a - 2) * (a - 2) + (b - 2) * (b - 2)) / 4) +
         0.75 * exp(-((a + 1) * (a + 1)) / 49 - (b + 1) / 10) +
         0.5 * exp(-((a - 7) * (a - 7) + (b - 3) * (b - 3)) / 4) -
         0.2 * exp(-((a - 4) * (a - 4)) - (b - 7) * (b - 7));
}

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
  const int fine = kFiner * (n - 1);
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

int main(int argc, char** argv) {
  const int n = argc > 1 ? atoi(argv[1]) : 0;
  if (n < kOrder) {
    fprintf(stderr, "usage: sisl_grids N TOLERANCE...\n");
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
  double best = INFINITY, rms, most;
  SISLSurf* interpolant = NULL;
  for (int k = 0; k < kRepeats; ++k) {
    if (interpolant) freeSurf(interpolant);
    const double begin = Now();
    interpolant = Interpolate(points, parameters, n);
    const double seconds = Now() - begin;
    if (seconds < best) best = seconds;
  }
  if (!interpolant) {
    fprintf(stderr, "sisl_grids: s1537 failed\n");
    return 1;
  }
  Measure(interpolant, interpolant, n, &rms, &most);
  printf("s1537 %d: %.3g s, rms to truth %.3g\n", n, best, rms);
  for (int k = 2; k < argc; ++k) {
    const double tolerance = atof(argv[k]);
    double tolerances[kDimension] = {tolerance, tolerance, tolerance};
    double edges[4 * kDimension];
    for (int e = 0; e < 4 * kDimension; ++e) edges[e] = tolerance;
    int fixed[4] = {0, 0, 0, 0}, status = 0;
    SISLSurf* surface = NULL;
    const double begin = Now();
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
    const double seconds = Now() - begin;
    if (status < 0 || !surface) {
      printf("s1966 %d %g: failed (%d)\n", n, tolerance, status);
      continue;
    }
    Measure(surface, interpolant, n, &rms, &most);
    printf(
        "s1966 %d %g: %.3g s, %d x %d = %d control points, rms to truth %.3g, max to interpolant "
        "%.3g\n",
        n,
        tolerance,
        seconds,
        surface->in1,
        surface->in2,
        surface->in1 * surface->in2,
        rms,
        most);
    freeSurf(surface);
  }
  freeSurf(interpolant);
  free(points);
  free(parameters);
  free(errors);
  return 0;
}
