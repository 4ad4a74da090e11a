// SPDX-License-Identifier: MIT
#include "mpi/mpi_source.h"

#define OMPI_SKIP_MPICXX 1
#include <mpi.h>

#include <algorithm>
#include <numeric>

namespace batten {
namespace {

constexpr std::size_t kAtOnce = std::size_t{1} << 20;  // numbers in one collective call

std::int64_t handed_over = 0;

int Processes() {
  int size = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

// b = a + b, elementwise, as MPI wants it: a is of lower ranks.
void AddInOrder(void* a, void* b, int* count, MPI_Datatype*) {
  const auto* from = static_cast<const double*>(a);
  auto* to = static_cast<double*>(b);
  for (int k = 0; k < *count; ++k) to[k] = from[k] + to[k];
}

}  // namespace

std::int64_t MpiSource::bytes() { return handed_over; }

bool MpiSource::shared() const { return Processes() > 1; }

void MpiSource::Sum(std::span<double> numbers) {
  if (!shared()) return;
  MPI_Op add{};
  MPI_Op_create(AddInOrder, 0, &add);
  std::vector<double> sums(std::min(kAtOnce, numbers.size()));
  for (std::size_t at = 0; at < numbers.size(); at += kAtOnce) {
    const auto count = static_cast<int>(std::min(kAtOnce, numbers.size() - at));
    MPI_Reduce(numbers.data() + at, sums.data(), count, MPI_DOUBLE, add, 0, MPI_COMM_WORLD);
    MPI_Bcast(sums.data(), count, MPI_DOUBLE, 0, MPI_COMM_WORLD);
    std::copy_n(sums.begin(), count, numbers.begin() + static_cast<std::ptrdiff_t>(at));
    handed_over += static_cast<std::int64_t>(sizeof(double)) * count;
  }
  MPI_Op_free(&add);
}

std::vector<double> MpiSource::Gathered(std::vector<double> numbers) {
  if (!shared()) return numbers;
  const auto own = static_cast<int>(numbers.size());
  std::vector<int> counts(static_cast<std::size_t>(Processes())), places(counts.size());
  MPI_Allgather(&own, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
  std::exclusive_scan(counts.begin(), counts.end(), places.begin(), 0);
  std::vector<double> all(static_cast<std::size_t>(places.back() + counts.back()));
  MPI_Allgatherv(numbers.data(),
                 own,
                 MPI_DOUBLE,
                 all.data(),
                 counts.data(),
                 places.data(),
                 MPI_DOUBLE,
                 MPI_COMM_WORLD);
  handed_over += static_cast<std::int64_t>(sizeof(double) * numbers.size());
  return all;
}

}  // namespace batten
