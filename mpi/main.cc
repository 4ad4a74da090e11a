// SPDX-License-Identifier: MIT
// batten-mpi fit surface …: `batten fit surface --memory` and `--tiles` on the processes of an MPI
// job.
#define OMPI_SKIP_MPICXX 1
#include <mpi.h>

#include <fmt/format.h>

#include <cstdio>
#include <cstring>
#include <memory>

#include "cli/arguments/point_sharing.h"
#include "cli/commands/program.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/terminal.h"
#include "mpi/mpi_source.h"

namespace batten::internal {
namespace {

constexpr const char* kUsage =
    "usage: mpirun -n N batten-mpi fit surface CLOUD... -o OUT --memory SIZE|--tiles NxM ..., "
    "flags "
    "as in batten fit surface\n"
    "Processes share the files, or the points of one; sums alone go over the wire, and the first "
    "writes.\n";

bool IsStreamedFit(int argc, char** argv) {
  bool passes = false;
  for (int k = 1; k < argc; ++k)
    passes |= std::strncmp(argv[k], "--memory", 8) == 0 || std::strncmp(argv[k], "--tiles", 7) == 0;
  return argc > 2 && std::strcmp(argv[1], "fit") == 0 && std::strcmp(argv[2], "surface") == 0 &&
         passes;
}

int Run(int argc, char** argv) {
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (!IsStreamedFit(argc, argv)) {
    if (rank == 0) std::fputs(kUsage, stderr);
    return kBadUsage;
  }
  ShareAmong({rank, size, [](PointSource& own) { return std::make_unique<MpiSource>(own); }});
  const int code = RunProgram(argc, argv);
  bool quiet = false;
  for (int k = 1; k < argc; ++k) quiet |= std::strcmp(argv[k], "--quiet") == 0;
  if (rank == 0 && !quiet && size > 1)
    PrintNote(fmt::format("{} processes; each handed over {} bytes", size, MpiSource::bytes()));
  return code;
}

}  // namespace
}  // namespace batten::internal

int main(int argc, char** argv) {
  using namespace batten::internal;
  MPI_Init(&argc, &argv);
  const int code = Run(argc, argv);
  // The others may wait for this one in a sum: the job ends with it.
  if (code != kDone && code != kToleranceMissed && code != kBadUsage)
    MPI_Abort(MPI_COMM_WORLD, code);
  MPI_Finalize();
  return code;
}
