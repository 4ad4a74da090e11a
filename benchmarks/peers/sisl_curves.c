/* SPDX-License-Identifier: MIT */
/* A cubic by SISL's s1961 (chord lengths, data reduction to a tolerance) along points in a row, for
   fitpack_curves.py: prints its number of control points and the seconds it took, and writes many
   points of it. SHARE is that of the tolerance spent on the polyline it starts from, 0 to 1. Links
   SISL (AGPL) and nothing of batten; built on request only.
   Usage: sisl_curves POINTS.xyz TOLERANCE SHARE LINE.xyz */
#include <sisl.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { kDimension = 3, kOrder = 4, kChords = 20000, kIterations = 10 };

static double Now(void) {
  struct timespec t;
  timespec_get(&t, TIME_UTC);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double* ReadNumbers(const char* path, size_t* count) {
  FILE* in = fopen(path, "r");
  if (!in) return NULL;
  size_t room = 1024;
  double* numbers = malloc(room * sizeof *numbers);
  for (*count = 0; numbers && fscanf(in, "%lf", &numbers[*count]) == 1;) {
    if (++*count < room) continue;
    room *= 2;
    double* more = realloc(numbers, room * sizeof *numbers);
    if (!more) free(numbers);
    numbers = more;
  }
  fclose(in);
  return numbers;
}

static int WriteLine(SISLCurve* curve, const char* path) {
  FILE* out = fopen(path, "w");
  if (!out) return 0;
  const double lower = curve->et[kOrder - 1], upper = curve->et[curve->in];
  int left = 0, status = 0;
  for (int k = 0; k <= kChords && status >= 0; ++k) {
    double point[kDimension];
    s1221(curve, 0, lower + (upper - lower) * k / kChords, &left, point, &status);
    fprintf(out, "%.17g %.17g %.17g\n", point[0], point[1], point[2]);
  }
  return fclose(out) == 0 && status >= 0;
}

int main(int argc, char** argv) {
  if (argc != 5) {
    fprintf(stderr, "usage: sisl_curves POINTS.xyz TOLERANCE SHARE LINE.xyz\n");
    return 2;
  }
  size_t numbers = 0;
  double* points = ReadNumbers(argv[1], &numbers);
  const int count = (int)(numbers / kDimension);
  if (!points || count < 2 || numbers % kDimension != 0) {
    fprintf(stderr, "sisl_curves: can't use %s\n", argv[1]);
    return 1;
  }
  const double tolerance = atof(argv[2]), share = atof(argv[3]);
  double tolerances[kDimension] = {tolerance, tolerance, tolerance}, errors[kDimension];
  SISLCurve* curve = NULL;
  int status = 0;
  const double begin = Now();
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
  const double seconds = Now() - begin;
  free(points);
  if (status < 0 || !curve || !WriteLine(curve, argv[4])) {
    fprintf(stderr, "sisl_curves: s1961 ended with %d\n", status);
    return 1;
  }
  printf("%d %.4f\n", curve->in, seconds);
  freeCurve(curve);
  return 0;
}
