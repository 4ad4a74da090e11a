// SPDX-License-Identifier: MIT
#include "io/cloud/vertex_rows.h"

#include <algorithm>
#include <utility>

namespace batten::internal {

void FeedRows(std::vector<VertexRows> groups, CloudFilter& filter) {
  struct Place {
    std::size_t group, column;
  };
  std::vector<Place> all;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (std::size_t c = 0; c < groups[g].width(); ++c) all.push_back({g, c});
  }
  const std::vector<int>& fields = filter.columns().fields;
  const std::int64_t size = groups.front().size();
  filter.Expect(size);
  RowBatch batch(fields.size());
  for (std::int64_t first = 0; first < size; first += RowBatch::kRows) {
    batch.rows = static_cast<int>(std::min<std::int64_t>(RowBatch::kRows, size - first));
    for (std::size_t c = 0; c < fields.size(); ++c) {
      const Place place = all[static_cast<std::size_t>(fields[c])];
      const VertexRows& rows = groups[place.group];
      const double* from = rows.Row(first) + place.column;  // a batch is inside one piece
      double* to = batch.column(c);
      for (int r = 0; r < batch.rows; ++r) to[r] = from[static_cast<std::size_t>(r) * rows.width()];
    }
    for (int r = 0; r < batch.rows; ++r) batch.places[r] = first + r + 1;
    filter.Take(batch);
    for (VertexRows& rows : groups) rows.FreeBefore(first + RowBatch::kRows);
  }
}

}  // namespace batten::internal
