// SPDX-License-Identifier: MIT
#include "fitting/streaming/point_passes.h"

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

namespace batten::internal {
namespace {

constexpr std::size_t kPiecesAhead = 2;  // of 65536 points: they stay in the caches

// Pieces on their way from the thread that reads to the one that takes.
class PieceQueue {
 public:
  struct Closed {};  // thrown to the reader when nobody takes any more

  void Put(const Eigen::Matrix3Xd& piece) {
    Eigen::Matrix3Xd copy;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return closed_ || pieces_.size() < kPiecesAhead; });
      if (closed_) throw Closed();
      if (!spare_.empty()) {
        copy = std::move(spare_.back());
        spare_.pop_back();
      }
    }
    copy = piece;
    const std::scoped_lock lock(mutex_);
    pieces_.push_back(std::move(copy));
    changed_.notify_all();
  }

  // The next piece in place of one that is done with; false at the end.
  bool Get(Eigen::Matrix3Xd& piece) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ended_ || !pieces_.empty(); });
    if (pieces_.empty()) return false;
    if (piece.size() > 0) spare_.push_back(std::move(piece));
    piece = std::move(pieces_.front());
    pieces_.pop_front();
    changed_.notify_all();
    return true;
  }

  void End() { Set(ended_); }
  void Close() { Set(closed_); }

 private:
  void Set(bool& flag) {
    const std::scoped_lock lock(mutex_);
    flag = true;
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Eigen::Matrix3Xd> pieces_;
  std::vector<Eigen::Matrix3Xd> spare_;  // memory of pieces that are done with
  bool ended_ = false, closed_ = false;
};

// Closes the queue and waits for the thread that fills it.
class Reader {
 public:
  Reader(PointSource& source, PieceQueue& queue) : queue_(queue) {
    thread_ = std::thread([&source, this] {
      try {
        source.Pass([this](const Eigen::Matrix3Xd& points) { queue_.Put(points); });
      } catch (const PieceQueue::Closed&) {
      } catch (const std::exception&) {
        failure_ = std::current_exception();
      }
      queue_.End();
    });
  }
  ~Reader() {
    queue_.Close();
    if (thread_.joinable()) thread_.join();
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  // After the queue's end.
  void Finish() {
    thread_.join();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  PieceQueue& queue_;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace

void PointPasses::Over(const TakePoints& take) {
  if (!ahead_) return source_.Pass(take);
  PieceQueue queue;
  Reader reader(source_, queue);
  Eigen::Matrix3Xd piece;
  while (queue.Get(piece)) take(piece);
  reader.Finish();
}

bool PointPasses::Restore(const std::vector<std::span<double>>& numbers) {
  std::optional<std::vector<double>> kept = store_->Kept(done_);
  std::array<double, 2> found = {kept ? 1.0 : 0.0, kept ? static_cast<double>(kept->size()) : 0.0};
  source_.Sum(found);
  if (found[0] == 0) return false;
  std::size_t size = 0;
  for (const std::span<double> part : numbers) size += part.size();
  if (found[1] != static_cast<double>(size))
    throw std::runtime_error("pass " + std::to_string(done_) + " kept " +
                             std::to_string(static_cast<long long>(found[1])) +
                             " numbers where it has " + std::to_string(size));
  std::size_t at = 0;
  for (const std::span<double> part : numbers) {
    if (kept) {
      std::copy_n(kept->data() + at, part.size(), part.data());
    } else {
      std::fill(part.begin(), part.end(), 0.0);
    }
    source_.Sum(part);
    at += part.size();
  }
  return true;
}

void PointPasses::Next(const std::vector<std::span<double>>& numbers,
                       const std::function<void()>& run) {
  ++done_;
  if (store_ == nullptr) return run();
  if (Restore(numbers)) return;
  run();
  std::vector<double> all;
  for (const std::span<double> part : numbers) all.insert(all.end(), part.begin(), part.end());
  store_->Keep(done_, all);
}

}  // namespace batten::internal
