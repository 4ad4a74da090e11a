// SPDX-License-Identifier: MIT
#include "io/cloud/cloud_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "batten/io/read_error.h"

namespace batten::internal {
namespace {

std::uint8_t ColourByte(double value) {
  if (!(value > 0)) return 0;  // NaN too
  return static_cast<std::uint8_t>(std::min(255.0, std::round(value)));
}

// The bits 0xRRGGBB of a packed colour, from the integer or from the float32 with these bits.
std::uint32_t PackedBits(double packed, bool in_float) {
  if (in_float) return std::bit_cast<std::uint32_t>(static_cast<float>(packed));
  return packed >= 0 && packed <= 4294967295.0 ? static_cast<std::uint32_t>(packed) : 0;
}

// 0, 1, … of a whole batch.
const std::array<int, RowBatch::kRows>& AllRows() {
  static const auto rows = [] {
    std::array<int, RowBatch::kRows> all;
    std::iota(all.begin(), all.end(), 0);
    return all;
  }();
  return rows;
}

constexpr Eigen::Index kChunkPoints = Eigen::Index{1} << 16;

// The column vector or matrix with another number of points; keeps the first.
template <class Matrix>
void ResizePoints(Matrix& matrix, Eigen::Index points) {
  if constexpr (Matrix::RowsAtCompileTime == Eigen::Dynamic) {
    matrix.conservativeResize(points);
  } else {
    matrix.conservativeResize(Eigen::NoChange, points);
  }
}

// What `member` names of all parts as one matrix. Frees the pieces on the way; a single piece is
// passed on without a copy.
template <class Matrix>
Matrix JoinMember(std::vector<FileCloud>& parts, Eigen::Index total, Matrix CloudChunk::*member) {
  Matrix all;
  if (parts.size() == 1 && parts[0].chunks.size() == 1) {
    all = std::move(parts[0].chunks[0].*member);
    ResizePoints(all, total);
    return all;
  }
  ResizePoints(all, total);
  const Eigen::Index rows = total > 0 ? all.size() / total : 0;
  Eigen::Index done = 0;
  for (FileCloud& part : parts) {
    for (CloudChunk& chunk : part.chunks) {
      Matrix& piece = chunk.*member;
      std::copy_n(piece.data(), chunk.size * rows, all.data() + done * rows);
      done += chunk.size;
      piece = Matrix();
    }
  }
  return all;
}

// Copies columns of the batch at the rows `kept` into the columns of a matrix from `at` on; a
// missing column (−1) gives zeros.
template <class Matrix, std::size_t kColumns>
void CopyRows(const RowBatch& batch,
              const std::array<int, kColumns>& columns,
              std::span<const int> kept,
              Eigen::Index at,
              Matrix& target) {
  static const std::vector<double> kZeros(RowBatch::kRows, 0.0);
  const double* sources[kColumns];
  for (std::size_t d = 0; d < kColumns; ++d) {
    sources[d] = columns[d] >= 0 ? batch.column(columns[d]) : kZeros.data();
  }
  double* to = target.data() + at * static_cast<Eigen::Index>(kColumns);
  if (kept.empty()) return;
  if (kept.back() - kept.front() + 1 == static_cast<int>(kept.size())) {  // all of them in between
    for (std::size_t d = 0; d < kColumns; ++d) sources[d] += kept.front();
    for (std::size_t r = 0; r < kept.size(); ++r) {
      for (std::size_t d = 0; d < kColumns; ++d) *to++ = sources[d][r];
    }
    return;
  }
  for (const int row : kept) {
    for (std::size_t d = 0; d < kColumns; ++d) *to++ = sources[d][row];
  }
}

// Sets normals to zero that are not usable. Not in the batch, whose columns other roles may share.
void ClearUnusual(Eigen::Matrix3Xd& normals, Eigen::Index first, Eigen::Index count) {
  const auto is_unusual = [](double value) { return !(std::abs(value) <= kLargestCoordinate); };
  const double* values = normals.data() + 3 * first;
  int unusual = 0;
  for (Eigen::Index k = 0; k < 3 * count; ++k) unusual |= is_unusual(values[k]);
  if (unusual == 0) return;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (std::any_of(values + 3 * k, values + 3 * k + 3, is_unusual)) {
      normals.col(first + k).setZero();
    }
  }
}

bool AllHave(const std::vector<FileCloud>& parts, bool FileCloud::*what) {
  return std::all_of(parts.begin(), parts.end(), [&](const FileCloud& part) { return part.*what; });
}

}  // namespace

CloudFilter::CloudFilter(std::string file,
                         const std::vector<CloudField>& fields,
                         CloudColumns columns,
                         const CloudReadOptions& options,
                         RowPlace place)
    : file_(std::move(file)),
      columns_(std::move(columns)),
      box_(options.box),
      take_(options.take),
      place_(place),
      keep_(RowBatch::kRows) {
  for (const CloudField& field : fields) part_.fields.push_back(field.name);
  part_.dimension = columns_.dimension();
  part_.degrees = columns_.degrees;
  part_.has_normals = columns_.normal[0] >= 0;
  part_.has_parameters = columns_.parameter[0] >= 0;
  part_.has_weights = columns_.weight >= 0;
  part_.has_colours = columns_.colour[0] >= 0 || columns_.packed_colour >= 0;
  if (take_) {
    if (part_.has_weights)
      throw ReadError(file_, "has weights, which points that are passed on piece by piece leave");
    if (part_.dimension == 2)
      throw ReadError(file_, "holds points in the plane (two columns), not x y z");
    const bool named = options.projection == CloudProjection::kByNames && columns_.degrees;
    if (named || options.projection == CloudProjection::kLocal)
      throw ReadError(
          file_,
          "holds degrees, which become metres only in points that are read whole; leave "
          "out --memory and --tiles, or project the file before");
    part_.has_normals = part_.has_parameters = part_.has_colours = false;
  }
  finite_.insert(finite_.end(), columns_.point.begin(), columns_.point.end());
  finite_.insert(finite_.end(), columns_.parameter.begin(), columns_.parameter.end());
  finite_.push_back(columns_.weight);
  std::erase(finite_, -1);
}

void CloudFilter::Refuse(std::int64_t place, const std::string& reason) const {
  switch (place_) {
    case RowPlace::kLine:
      throw ReadError::AtLine(file_, place, reason);
    case RowPlace::kByte:
      throw ReadError::AtByte(file_, place, reason);
    case RowPlace::kVertex:
      throw ReadError(file_, fmt::format("vertex {}: {}", place, reason));
  }
  throw ReadError(file_, reason);
}

// How many rows are dropped by now.
Eigen::Index CloudFilter::DropCount(const RowBatch& batch) const {
  return std::count(keep_.begin(), keep_.begin() + batch.rows, 0);
}

void CloudFilter::Take(RowBatch& batch) {
  if (TakesAll(batch)) {
    part_.rows += batch.rows;
    part_.matched += batch.rows;
    Append(batch, {AllRows().data(), static_cast<std::size_t>(batch.rows)});
    batch.rows = 0;
    return;
  }
  std::fill_n(keep_.begin(), batch.rows, 1);
  part_.rows += batch.rows;
  DropUnmatched(batch);
  const Eigen::Index unmatched = DropCount(batch);
  const std::vector<char> matched(keep_.begin(), keep_.begin() + batch.rows);
  DropNonFinite(batch);
  RequirePositiveWeights(batch);
  const Eigen::Index finite_dropped = DropCount(batch);
  if (finite_dropped > unmatched && !take_) NoteMissing(matched);
  DropOutside(batch);
  const Eigen::Index all_dropped = DropCount(batch);
  part_.matched += batch.rows - unmatched;
  part_.non_finite += finite_dropped - unmatched;
  part_.filtered += unmatched + all_dropped - finite_dropped;
  std::array<int, RowBatch::kRows> rows;
  int count = 0;
  for (int r = 0; r < batch.rows; ++r) {
    rows[count] = r;
    count += keep_[r];
  }
  Append(batch, {rows.data(), static_cast<std::size_t>(count)});
  batch.rows = 0;
}

// Whether a glance shows that every row is kept, as is usual.
bool CloudFilter::TakesAll(const RowBatch& batch) const {
  if (!columns_.where.empty() || box_ || columns_.weight >= 0) return false;
  int unusual = 0;
  for (const int column : finite_) {
    const double* values = batch.column(column);
    for (int r = 0; r < batch.rows; ++r) unusual |= !(std::abs(values[r]) <= kLargestCoordinate);
  }
  return unusual == 0;
}

// Remembers which of the matched rows were dropped since.
void CloudFilter::NoteMissing(const std::vector<char>& matched) {
  Eigen::Index at = part_.matched;
  for (size_t r = 0; r < matched.size(); ++r) {
    if (!matched[r]) continue;
    if (!keep_[r]) part_.missing.push_back(at);
    ++at;
  }
}

void CloudFilter::DropUnmatched(const RowBatch& batch) {
  for (const CloudColumns::Match& match : columns_.where) {
    const double* values = batch.column(match.column);
    for (int r = 0; r < batch.rows; ++r) {
      bool hit = false;
      for (const double value : match.values) hit |= values[r] == value;
      keep_[r] &= hit;
    }
  }
}

void CloudFilter::DropNonFinite(const RowBatch& batch) {
  for (const int column : finite_) {
    const double* values = batch.column(column);
    int unusual = 0;
    for (int r = 0; r < batch.rows; ++r) unusual |= !(std::abs(values[r]) <= kLargestCoordinate);
    if (unusual == 0) continue;
    for (int r = 0; r < batch.rows; ++r) {
      if (!keep_[r] || std::abs(values[r]) <= kLargestCoordinate) continue;
      if (std::isfinite(values[r])) {
        Refuse(batch.places[r],
               fmt::format("the number {} is beyond ±{}", values[r], kLargestCoordinate));
      }
      keep_[r] = 0;
    }
  }
}

void CloudFilter::RequirePositiveWeights(const RowBatch& batch) const {
  if (columns_.weight < 0) return;
  const double* values = batch.column(columns_.weight);
  for (int r = 0; r < batch.rows; ++r) {
    if (keep_[r] && !(values[r] > 0)) {
      Refuse(batch.places[r], fmt::format("the weight {} is not positive", values[r]));
    }
  }
}

void CloudFilter::DropOutside(const RowBatch& batch) {
  if (!box_) return;
  for (int d = 0; d < 3; ++d) {
    const double low = box_->min()[d], high = box_->max()[d];
    if (columns_.point[d] < 0) {
      if (!(low <= 0 && 0 <= high)) std::fill_n(keep_.begin(), batch.rows, 0);
      continue;
    }
    const double* values = batch.column(columns_.point[d]);
    for (int r = 0; r < batch.rows; ++r) keep_[r] &= low <= values[r] && values[r] <= high;
  }
}

void CloudFilter::PassOn(CloudChunk& chunk) const {
  if (chunk.size == chunk.points.cols()) {
    take_(chunk.points);
  } else if (chunk.size > 0) {
    take_(chunk.points.leftCols(chunk.size));
  }
  chunk.size = 0;
}

// A chunk that has room for one more point.
CloudChunk& CloudFilter::Room() {
  if (!part_.chunks.empty() && part_.chunks.back().size < part_.chunks.back().points.cols()) {
    return part_.chunks.back();
  }
  const Eigen::Index capacity = std::max(kChunkPoints, std::exchange(expected_, 0));
  CloudChunk chunk;
  ResizePoints(chunk.points, capacity);
  if (part_.has_normals) ResizePoints(chunk.normals, capacity);
  if (part_.has_parameters) ResizePoints(chunk.parameters, capacity);
  if (part_.has_weights) ResizePoints(chunk.weights, capacity);
  if (part_.has_colours) ResizePoints(chunk.colours, capacity);
  part_.chunks.push_back(std::move(chunk));
  return part_.chunks.back();
}

void CloudFilter::Append(const RowBatch& batch, std::span<const int> left) {
  while (!left.empty()) {
    CloudChunk& chunk = Room();
    const auto room = static_cast<std::size_t>(chunk.points.cols() - chunk.size);
    const std::span<const int> kept = left.first(std::min(left.size(), room));
    CopyRows(batch, columns_.point, kept, chunk.size, chunk.points);
    if (part_.has_normals) {
      CopyRows(batch, columns_.normal, kept, chunk.size, chunk.normals);
      ClearUnusual(chunk.normals, chunk.size, static_cast<Eigen::Index>(kept.size()));
    }
    if (part_.has_parameters)
      CopyRows(batch, columns_.parameter, kept, chunk.size, chunk.parameters);
    if (part_.has_weights) {
      CopyRows(batch, std::array{columns_.weight}, kept, chunk.size, chunk.weights);
    }
    if (part_.has_colours) {
      JudgeColours(batch, kept);
      CopyColours(batch, kept, chunk);
    }
    chunk.size += static_cast<Eigen::Index>(kept.size());
    left = left.subspan(kept.size());
    if (take_ && chunk.size == chunk.points.cols()) PassOn(chunk);
  }
}

// Notes what says to which end the colours count.
void CloudFilter::JudgeColours(const RowBatch& batch, std::span<const int> kept) {
  if (std::isinf(columns_.colour_limit)) return;
  double highest = 0;
  for (const int column : columns_.colour) {
    const double* values = batch.column(column);
    for (const int row : kept) {
      highest = std::max(highest, values[row]);
      if (whole_colours_ && std::isfinite(values[row])) {
        whole_colours_ = values[row] == std::floor(values[row]);
      }
    }
  }
  if (highest > columns_.colour_limit) WidenColours();
}

// The colours count to the higher end: what was taken so far is at most the limit, so that its
// bytes still say which numbers the file has, and they are scaled anew.
void CloudFilter::WidenColours() {
  std::array<std::uint8_t, 256> widened;
  for (std::size_t byte = 0; byte < widened.size(); ++byte) {
    const double number = std::round(static_cast<double>(byte) / columns_.colour_scale);
    widened[byte] = ColourByte(number * columns_.wide_colour_scale);
  }
  for (CloudChunk& chunk : part_.chunks) {
    for (auto& byte : chunk.colours.leftCols(chunk.size).reshaped()) byte = widened[byte];
  }
  columns_.colour_scale = columns_.wide_colour_scale;
  columns_.colour_limit = std::numeric_limits<double>::infinity();
}

void CloudFilter::CopyColours(const RowBatch& batch,
                              std::span<const int> kept,
                              CloudChunk& chunk) const {
  Eigen::Index at = chunk.size;
  for (const int row : kept) {
    if (columns_.packed_colour >= 0) {
      const std::uint32_t bits =
          PackedBits(batch.column(columns_.packed_colour)[row], columns_.packed_in_float);
      for (int d = 0; d < 3; ++d) chunk.colours(d, at) = (bits >> (16 - 8 * d)) & 0xff;
    } else {
      for (int d = 0; d < 3; ++d) {
        chunk.colours(d, at) =
            ColourByte(batch.column(columns_.colour[d])[row] * columns_.colour_scale);
      }
    }
    ++at;
  }
}

FileCloud CloudFilter::Finish() && {
  if (columns_.wide_if_whole && whole_colours_ && std::isfinite(columns_.colour_limit)) {
    WidenColours();
  }
  if (take_) {
    for (CloudChunk& chunk : part_.chunks) PassOn(chunk);
    part_.chunks.clear();
  }
  return std::move(part_);
}

PointCloud JoinParts(std::vector<FileCloud> parts) {
  Eigen::Index total = 0;
  int dimension = 2;
  for (const FileCloud& part : parts) {
    total += part.kept();
    dimension = std::max(dimension, part.dimension);
  }
  PointCloud cloud =
      PointCloud::FromWorld(JoinMember(parts, total, &CloudChunk::points), dimension);
  if (AllHave(parts, &FileCloud::has_normals)) {
    cloud.set_normals(JoinMember(parts, total, &CloudChunk::normals));
  }
  if (AllHave(parts, &FileCloud::has_parameters)) {
    cloud.set_parameters(JoinMember(parts, total, &CloudChunk::parameters));
  }
  if (AllHave(parts, &FileCloud::has_weights)) {
    cloud.set_weights(JoinMember(parts, total, &CloudChunk::weights));
  }
  if (AllHave(parts, &FileCloud::has_colours)) {
    cloud.set_colours(JoinMember(parts, total, &CloudChunk::colours));
  }
  return cloud;
}

}  // namespace batten::internal
