// SPDX-License-Identifier: MIT
// Rows of a file in, the points worth keeping out.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/io/cloud_options.h"
#include "io/cloud/cloud_columns.h"
#include "io/cloud/row_batch.h"

namespace batten::internal {

// Coordinates above this are refused: squares of their differences overflow in the single precision
// of neighbour queries.
inline constexpr double kLargestCoordinate = 1e18;

// Points in pieces: a file of unknown length needs no copy to grow, and joining frees piece by
// piece, so that the points are never in memory twice. Attributes are empty or have as many columns
// as the points; the first `size` of them are filled.
struct CloudChunk {
  Eigen::Index size = 0;
  Eigen::Matrix3Xd points, normals;
  Eigen::Matrix2Xd parameters;
  Eigen::VectorXd weights;
  PointCloud::Colours colours;
};

// What one file gave.
struct FileCloud {
  std::vector<std::string> fields;
  int dimension = 3;
  Eigen::Vector3d scale = Eigen::Vector3d::Zero();
  bool has_normals = false, has_parameters = false, has_weights = false, has_colours = false;
  Eigen::Index rows = 0, matched = 0, non_finite = 0, filtered = 0;
  std::vector<Eigen::Index> missing;  // places of those not finite among the rows that match
  std::vector<CloudChunk> chunks;
  std::vector<Eigen::Index> blocks;  // points kept before each block but the first
  std::vector<std::string> remarks;  // sentences on how the file was understood
  bool degrees = false;              // x and y are named longitude and latitude

  Eigen::Index kept() const { return rows - non_finite - filtered; }
};

// Whether places of a batch are lines, bytes, or numbers of vertices from 1.
enum class RowPlace { kLine, kByte, kVertex };

// Judges rows and collects those kept. A row is dropped as filtered when it misses a `where`, as
// not finite when a number with a role is, as filtered when it is outside the box; in this order.
// Normals drop nothing: one that is not finite, or beyond kLargestCoordinate, becomes zero, which
// means none.
class CloudFilter {
 public:
  CloudFilter(std::string file,
              const std::vector<CloudField>& fields,
              CloudColumns columns,
              const CloudReadOptions& options,
              RowPlace place);

  const CloudColumns& columns() const { return columns_; }

  // Makes one piece large enough for all `rows`, which then need no joining. Only for a count that
  // the file has been found large enough for.
  void Expect(std::int64_t rows) { expected_ = take_ ? 0 : rows; }

  // Takes the rows and empties the batch, whose columns are columns().fields. Throws ReadError
  // naming the row where a number is beyond kLargestCoordinate or a weight is not positive.
  void Take(RowBatch& batch);

  // The rows taken from now on are another block.
  void BeginBlock() {
    if (!take_) part_.blocks.push_back(part_.kept());
  }

  void Remark(std::string sentence) { part_.remarks.push_back(std::move(sentence)); }

  Eigen::Index rows() const { return part_.rows; }

  // What was collected; ends the filter's life.
  FileCloud Finish() &&;

 private:
  void NoteMissing(const std::vector<char>& matched);
  void DropUnmatched(const RowBatch& batch);
  void DropNonFinite(const RowBatch& batch);
  void RequirePositiveWeights(const RowBatch& batch) const;
  void DropOutside(const RowBatch& batch);
  bool TakesAll(const RowBatch& batch) const;
  void Append(const RowBatch& batch, std::span<const int> left);
  void JudgeColours(const RowBatch& batch, std::span<const int> kept);
  void WidenColours();
  void CopyColours(const RowBatch& batch, std::span<const int> kept, CloudChunk& chunk) const;
  Eigen::Index DropCount(const RowBatch& batch) const;
  CloudChunk& Room();
  void PassOn(CloudChunk& chunk) const;
  [[noreturn]] void Refuse(std::int64_t place, const std::string& reason) const;

  std::string file_;
  CloudColumns columns_;
  std::optional<Eigen::AlignedBox3d> box_;
  std::function<void(const Eigen::Matrix3Xd&)> take_;
  RowPlace place_;
  Eigen::Index expected_ = 0;
  std::vector<int> finite_;          // columns with a role that must be finite; no normals
  std::vector<unsigned char> keep_;  // one a row of the batch
  bool whole_colours_ = true;        // until now, while there is a colour_limit
  FileCloud part_;
};

// The points of all parts as one cloud; attributes that all parts have are kept.
PointCloud JoinParts(std::vector<FileCloud> parts);

}  // namespace batten::internal
