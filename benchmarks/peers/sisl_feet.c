/* SPDX-License-Identifier: MIT */
/* Nearest points of a surface to the points of a cloud by SISL: `global` searches the whole surface
   (s1958), `near` from a start (s1775). Prints seconds and the rms distance over the first COUNT
   points. Links SISL (AGPL) and nothing of batten; built on request only. SHEET.f64 holds bicubic
   control points: their numbers in u and v, the two knot vectors, then points, v fastest;
   STARTS.f64 parameters u and v. Usage: sisl_feet global CLOUD.f64 SHEET.f64 COUNT sisl_feet near
   CLOUD.f64 SHEET.f64 COUNT STARTS.f64 */
#include <sisl.h>
#include <string.h>

#include "comparator.h"

enum { kDimension = 3, kOrder = 4 };

/* SISL's first parameter runs fastest, so v is the first here. */
static SISLSurf* ReadSheet(const char* path) {
  size_t count = 0;
  double* numbers = ReadDoubles(path, &count);
  if (!numbers || count < 2) return NULL;
  const int nu = (int)numbers[0], nv = (int)numbers[1];
  const size_t knots = (size_t)(nu + nv + 2 * kOrder), net = (size_t)kDimension * (size_t)(nu * nv);
  SISLSurf* surface = NULL;
  if (count == 2 + knots + net) {
    double* u = numbers + 2;
    double* v = u + nu + kOrder;
    surface = newSurf(nv, nu, kOrder, kOrder, v, u, u + knots, 1, kDimension, 1);
  }
  free(numbers);
  return surface;
}

static double Distance(const double* a, const double* b) {
  return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
              (a[2] - b[2]) * (a[2] - b[2]));
}

static double Global(SISLSurf* surface, double* point) {
  double parameters[2], distance = NAN;
  int status = 0;
  s1958(surface, point, kDimension, 1e-12, 1e-9, parameters, &distance, &status);
  return status < 0 ? NAN : distance;
}

static double Near(SISLSurf* surface, double* point, const double* start) {
  double first[2] = {0, 0}, second[2] = {1, 1}, at[2] = {start[1], start[0]}, found[2];
  double foot[kDimension], normal[kDimension];
  int status = 0, left1 = 0, left2 = 0;
  first[0] = surface->et1[kOrder - 1];
  first[1] = surface->et2[kOrder - 1];
  second[0] = surface->et1[surface->in1];
  second[1] = surface->et2[surface->in2];
  s1775(surface, point, kDimension, 1e-9, first, second, at, found, &status);
  if (status < 0) return NAN;
  s1421(surface, 0, found, &left1, &left2, foot, normal, &status);
  return status < 0 ? NAN : Distance(foot, point);
}

int main(int argc, char** argv) {
  const int near = argc == 6 && strcmp(argv[1], "near") == 0;
  if (!near && !(argc == 5 && strcmp(argv[1], "global") == 0)) {
    fprintf(stderr, "usage: sisl_feet global|near CLOUD.f64 SHEET.f64 COUNT [STARTS.f64]\n");
    return 2;
  }
  size_t numbers = 0, pairs = 0;
  double* points = ReadDoubles(argv[2], &numbers);
  SISLSurf* surface = ReadSheet(argv[3]);
  const size_t count = strtoul(argv[4], NULL, 10);
  double* starts = near ? ReadDoubles(argv[5], &pairs) : NULL;
  if (!points || !surface || count == 0 || count > numbers / kDimension ||
      (near && (!starts || count > pairs / 2))) {
    fprintf(stderr, "sisl_feet: can't use these files\n");
    return 1;
  }
  double squares = 0;
  const Seconds begin = Now();
  for (size_t k = 0; k < count; ++k) {
    double* point = points + kDimension * k;
    const double distance = near ? Near(surface, point, starts + 2 * k) : Global(surface, point);
    squares += distance * distance;
  }
  const Seconds took = Since(begin);
  printf("wall=%.6g cpu=%.6g rms=%.4e\n", took.wall, took.cpu, sqrt(squares / (double)count));
  freeSurf(surface);
  free(points);
  free(starts);
  return 0;
}
