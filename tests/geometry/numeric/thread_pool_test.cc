// SPDX-License-Identifier: MIT
#include "batten/geometry/thread_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace batten::internal::thread_pool_test {

using Blocks = std::set<std::pair<std::ptrdiff_t, std::ptrdiff_t>>;

Blocks BlocksOf(ThreadPool& pool, std::ptrdiff_t count, std::ptrdiff_t block) {
  std::mutex mutex;
  Blocks blocks;
  pool.For(count, block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const std::lock_guard lock(mutex);
    EXPECT_TRUE(blocks.emplace(begin, end).second) << "block at " << begin << " given twice";
  });
  return blocks;
}

TEST(ThreadPoolTest, CoversEveryIndexExactlyOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    ThreadPool pool(threads);
    for (const std::ptrdiff_t count : {1, 2, 7, 64, 1000}) {
      for (const std::ptrdiff_t block : {1, 3, 64, 5000}) {
        std::vector<std::atomic<int>> visits(count);
        pool.For(count, block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
          for (std::ptrdiff_t k = begin; k < end; ++k) ++visits[k];
        });
        for (std::ptrdiff_t k = 0; k < count; ++k) {
          ASSERT_EQ(visits[k], 1) << threads << " threads, index " << k << " of " << count;
        }
      }
    }
  }
}

TEST(ThreadPoolTest, BlocksDoNotDependOnTheNumberOfThreads) {
  ThreadPool one(1), two(2), five(5);
  for (const auto& [count, block] : {std::pair{100, 7}, std::pair{5, 5}, std::pair{3, 10}}) {
    const Blocks expected = BlocksOf(one, count, block);
    EXPECT_EQ(BlocksOf(two, count, block), expected);
    EXPECT_EQ(BlocksOf(five, count, block), expected);
    for (const auto& [begin, end] : expected) {
      EXPECT_LE(end - begin, block);
      EXPECT_EQ(begin % block, 0);
    }
  }
}

TEST(ThreadPoolTest, ZeroWorkCallsNothing) {
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    EXPECT_TRUE(BlocksOf(pool, 0, 4).empty());
    EXPECT_TRUE(BlocksOf(pool, 0, 0).empty());
  }
}

TEST(ThreadPoolTest, ABlockOfNothingIsTakenAsOne) {
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    EXPECT_EQ(BlocksOf(pool, 3, 0), (Blocks{{0, 1}, {1, 2}, {2, 3}}));
  }
}

TEST(ThreadPoolTest, OneThreadRunsOnTheCallerInOrder) {
  ThreadPool pool(1);
  EXPECT_EQ(pool.threads(), 1);
  const auto caller = std::this_thread::get_id();
  std::vector<std::ptrdiff_t> begins;
  pool.For(10, 3, [&](std::ptrdiff_t begin, std::ptrdiff_t) {
    EXPECT_EQ(std::this_thread::get_id(), caller) << "ran elsewhere";
    begins.push_back(begin);
  });
  EXPECT_EQ(begins, (std::vector<std::ptrdiff_t>{0, 3, 6, 9}));
}

TEST(ThreadPoolTest, HasAsManyThreadsAsAskedFor) {
  EXPECT_EQ(ThreadPool(4).threads(), 4);
  EXPECT_GE(ThreadPool(0).threads(), 1);
  EXPECT_EQ(ThreadPool(-3).threads(), ThreadPool(0).threads());
}

TEST(ThreadPoolTest, AnExceptionReachesTheCallerWithItsMessage) {
  for (const int threads : {1, 2, 4}) {
    ThreadPool pool(threads);
    try {
      pool.For(1000, 1, [](std::ptrdiff_t begin, std::ptrdiff_t) {
        if (begin == 17) throw std::runtime_error("block 17");
      });
      ADD_FAILURE() << "nothing was thrown with " << threads << " threads";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "block 17");
    }
  }
}

TEST(ThreadPoolTest, OneOfManyExceptionsReachesTheCaller) {
  ThreadPool pool(4);
  EXPECT_THROW(pool.For(1000,
                        1,
                        [](std::ptrdiff_t begin, std::ptrdiff_t) {
                          throw std::out_of_range(std::to_string(begin));
                        }),
               std::out_of_range);
}

TEST(ThreadPoolTest, WorksAgainAfterAnException) {
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    for (int round = 0; round < 50; ++round) {
      EXPECT_THROW(
          pool.For(20, 1, [](std::ptrdiff_t, std::ptrdiff_t) { throw std::runtime_error("no"); }),
          std::runtime_error);
      EXPECT_EQ(BlocksOf(pool, 20, 1).size(), 20u);
    }
  }
}

TEST(ThreadPoolTest, IsReusedThousandsOfTimes) {
  ThreadPool pool(3);
  std::atomic<std::ptrdiff_t> sum = 0;
  for (std::ptrdiff_t round = 0; round < 3000; ++round) {
    pool.For(round % 11, 2, [&](std::ptrdiff_t begin, std::ptrdiff_t end) { sum += end - begin; });
  }
  std::ptrdiff_t expected = 0;
  for (std::ptrdiff_t round = 0; round < 3000; ++round) expected += round % 11;
  EXPECT_EQ(sum, expected);
}

TEST(ThreadPoolTest, APoolInsideABodyOfAnotherPoolWorks) {
  ThreadPool outer(3);
  std::vector<std::atomic<int>> visits(6 * 50);
  outer.For(6, 1, [&](std::ptrdiff_t row, std::ptrdiff_t) {
    ThreadPool inner(2);
    inner.For(50, 4, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t k = begin; k < end; ++k) ++visits[50 * row + k];
    });
  });
  for (const auto& visit : visits) ASSERT_EQ(visit, 1);
}

TEST(ThreadPoolTest, InsideItsOwnBodyEveryCallerDoesItsBlocksByItself) {
  ThreadPool pool(3);
  std::vector<std::atomic<int>> visits(6 * 50);
  for (int round = 1; round <= 200; ++round) {
    pool.For(6, 1, [&](std::ptrdiff_t row, std::ptrdiff_t) {
      pool.For(50, 4, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        for (std::ptrdiff_t k = begin; k < end; ++k) ++visits[50 * row + k];
      });
    });
    for (const auto& visit : visits) ASSERT_EQ(visit, round);
  }
  const auto thrower = [&](std::ptrdiff_t, std::ptrdiff_t) {
    pool.For(50, 4, [](std::ptrdiff_t, std::ptrdiff_t) { throw std::runtime_error("inside"); });
  };
  EXPECT_THROW(pool.For(6, 1, thrower), std::runtime_error);
}

TEST(ThreadPoolTest, ReturnsOnlyWhenAllIsWritten) {
  ThreadPool pool(4);
  for (int round = 0; round < 200; ++round) {
    std::vector<int> written(97, 0);  // not atomic: For itself must order the writes
    pool.For(97, 5, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t k = begin; k < end; ++k) written[k] = round + 1;
    });
    for (const int value : written) ASSERT_EQ(value, round + 1);
  }
}

}  // namespace batten::internal::thread_pool_test
