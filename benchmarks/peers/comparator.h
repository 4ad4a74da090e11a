/* SPDX-License-Identifier: MIT */
/* What comparator programs share: clouds from files, clocks, medians, and Franke's function. Plain
   C that names nothing of batten. */
#pragma once

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { kMostRuns = 5, kTruthSide = 201 };

/* Seconds that have gone on the wall and on the processor. */
typedef struct {
  double wall, cpu;
} Seconds;

static inline double ReadClock(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static inline Seconds Now(void) {
  Seconds now;
  now.wall = ReadClock(CLOCK_MONOTONIC);
  now.cpu = ReadClock(CLOCK_PROCESS_CPUTIME_ID);
  return now;
}

static inline Seconds Since(Seconds begin) {
  Seconds now = Now();
  now.wall -= begin.wall;
  now.cpu -= begin.cpu;
  return now;
}

static inline int CompareNumbers(const void* a, const void* b) {
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

static inline double MedianOf(double* numbers, int count) {
  qsort(numbers, (size_t)count, sizeof *numbers, CompareNumbers);
  return count % 2 ? numbers[count / 2] : (numbers[count / 2 - 1] + numbers[count / 2]) / 2;
}

/* Runs of one job: at most five, no more once a second of processor time has gone. */
typedef struct {
  double wall[kMostRuns], cpu[kMostRuns], spent;
  int count;
} Runs;

static inline int MayRun(const Runs* runs) {
  return runs->count == 0 || (runs->count < kMostRuns && runs->spent < 1);
}

static inline void AddRun(Runs* runs, Seconds took) {
  runs->wall[runs->count] = took.wall;
  runs->cpu[runs->count++] = took.cpu;
  runs->spent += took.cpu;
}

static inline void PrintSeconds(Runs* runs) {
  printf("wall=%.6g cpu=%.6g", MedianOf(runs->wall, runs->count), MedianOf(runs->cpu, runs->count));
}

/* All doubles of a file, in the machine's byte order; null where it can't be read. */
static inline double* ReadDoubles(const char* path, size_t* count) {
  double* numbers = NULL;
  FILE* in = fopen(path, "rb");
  if (!in) return NULL;
  if (fseek(in, 0, SEEK_END) == 0) {
    const long bytes = ftell(in);
    *count = bytes > 0 ? (size_t)bytes / sizeof *numbers : 0;
    rewind(in);
    if (*count > 0) numbers = (double*)malloc(*count * sizeof *numbers);
    if (numbers && fread(numbers, sizeof *numbers, *count, in) != *count) {
      free(numbers);
      numbers = NULL;
    }
  }
  fclose(in);
  return numbers;
}

/* Franke's test function on the unit square. [Franke 1979] */
static inline double Franke(double x, double y) {
  const double a = 9 * x, b = 9 * y;
  return 0.75 * exp(-((a - 2) * (a - 2) + (b - 2) * (b - 2)) / 4) +
         0.75 * exp(-((a + 1) * (a + 1)) / 49 - (b + 1) / 10) +
         0.5 * exp(-((a - 7) * (a - 7) + (b - 3) * (b - 3)) / 4) -
         0.2 * exp(-((a - 4) * (a - 4)) - (b - 7) * (b - 7));
}
