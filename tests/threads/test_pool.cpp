#include "souple/error.h"
#include "souple/threads/threads.h"
#include "souple/threads/work_partition.h"
#include "tests/expect_error.h"
#include "tests/threads/idle.h"
#include "tests/threads/in_child.h"

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <new>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#if defined(__linux__)
#include <sys/resource.h>
#endif

namespace souple::test_threads_pool {

constexpr Threading kinds[] = {Threading::automatic, Threading::serial, Threading::pool, Threading::tbb};
constexpr std::size_t whole = std::numeric_limits<std::size_t>::max();

// Number of visits of each of n indices. Each index has a plain counter: two threads on one index would race.
std::vector<int> visits(Threads& threads, std::size_t n, std::size_t grain) {
  std::vector<int> count(n);
  threads.for_each(n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++count[i];
  });
  return count;
}

TEST(WorkPartition, PartsAreWholePacksAndNoSmallerThanTheGrain) {
  for (const std::size_t n : {0u, 1u, 15u, 16u, 17u, 100u, 1000u, 4097u})
    for (const std::size_t grain : {0u, 1u, 7u, 16u, 20u, 64u, 5000u})
      for (const int count : {1, 2, 3, 8, 1000}) {
        const WorkPartition partition(n, grain, count);
        ASSERT_GE(partition.parts(), 1u);
        ASSERT_LE(partition.parts(), static_cast<std::size_t>(count));
        EXPECT_EQ(partition.begin(0), 0u);
        EXPECT_EQ(partition.begin(partition.parts()), n);
        for (std::size_t t = 0; t < partition.parts(); ++t) {
          const std::size_t size = partition.begin(t + 1) - partition.begin(t);
          EXPECT_TRUE(size >= grain || partition.parts() == 1) << n << " in parts of at least " << grain;
          EXPECT_TRUE(partition.begin(t) % 16 == 0 || grain < 16) << n << " in parts of at least " << grain;
          EXPECT_TRUE(size > 0 || n == 0);
        }
      }
}

TEST(WorkPartition, UsesTheThreadsThereAre) {
  EXPECT_EQ(WorkPartition(100000, 256, 8).parts(), 8u);
  EXPECT_EQ(WorkPartition(8, 1, 3).parts(), 3u);
  EXPECT_EQ(WorkPartition(whole, 1, 3).begin(3), whole);
  EXPECT_EQ(WorkPartition(5, whole, 3).parts(), 1u);
}

TEST(Threads, MeetEveryIndexOnce) {
  for (const Threading kind : kinds)
    for (const int count : {1, 2, 3, 8}) {
      const auto threads = make_threads(kind, count);
      EXPECT_EQ(threads->count(), kind == Threading::serial ? 1 : count);
      for (int awake = 0; awake < 2; ++awake) {
        if (awake == 1) threads->wake();
        for (const std::size_t n : {0u, 1u, 2u, 16u, 31u, 32u, 33u, 1000u, 4097u})
          for (const std::size_t grain :
               {std::size_t{0}, std::size_t{1}, std::size_t{16}, std::size_t{100}, whole})
            EXPECT_EQ(visits(*threads, n, grain), std::vector<int>(n, 1)) << n << ", grain " << grain;
      }
      threads->rest();
      EXPECT_EQ(visits(*threads, 1000, 1), std::vector<int>(1000, 1)) << "after rest";
    }
}

// A for_each reads the results of the previous for_each, whatever threads both ran on. Short jobs follow each
// other closely, with varying numbers of parts. The thread sanitizer checks for races.
TEST(Threads, SeeWhatTheLastJobWrote) {
  for (const Threading kind : kinds) {
    const auto threads = make_threads(kind, 4);
    const ActiveScope awake(*threads);
    std::vector<int> from(256), to(256);
    std::iota(from.begin(), from.end(), 0);
    for (int round = 0; round < 2000; ++round) {
      const std::size_t grain = std::size_t{16} << (round % 4);
      threads->for_each(from.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) to[i] = from[(i + 100) % from.size()] + 1;
      });
      std::swap(from, to);
    }
    EXPECT_EQ(std::accumulate(from.begin(), from.end(), 0), 256 * 2000 + 255 * 256 / 2);
  }
}

TEST(Threads, SmallWorkStaysOnTheCallersThread) {
  for (const Threading kind : kinds) {
    const auto threads = make_threads(kind, 4);
    const auto caller = std::this_thread::get_id();
    std::atomic<int> elsewhere{0};
    for (const std::size_t n : {1u, 50u, 100u, 199u})
      threads->for_each(n, 100, [&](std::size_t, std::size_t) {
        if (std::this_thread::get_id() != caller) ++elsewhere;
      });
    EXPECT_EQ(elsewhere, 0);
  }
}

TEST(Threads, WorkAtTheSameTime) {
  const auto threads = make_threads(Threading::pool, 3);
  std::atomic<int> inside{0};
  // Each part waits for both other parts: for_each returns only if all three run concurrently.
  threads->for_each(3, 1, [&](std::size_t, std::size_t) {
    ++inside;
    while (inside < 3) std::this_thread::yield();
  });
  EXPECT_EQ(inside, 3);
}

/// Jobs of a host: each on a thread of its own.
class ThreadPerJob final : public JobSystem {
 public:
  int workers() const override { return 4; }
  void run(std::size_t count, RangeFunction job) override {
    std::vector<std::thread> threads;
    threads.reserve(count);
    for (std::size_t i = 0; i < count; ++i) threads.emplace_back([&job, i] { job(i, i + 1); });
    for (std::thread& thread : threads) thread.join();
  }
};

/// The loop throws what the part with index `bad` throws, after all parts that began, and works afterwards.
void expect_carried(Threads& threads, std::size_t bad) {
  std::atomic<int> inside{0};
  std::string caught;
  try {
    threads.for_each(400, 1, [&](std::size_t begin, std::size_t end) {
      ++inside;
      if (begin <= bad && bad < end) {
        --inside;
        throw Error("bad " + std::to_string(bad));
      }
      std::this_thread::yield();
      --inside;
    });
  } catch (const Error& error) {
    caught = error.what();
  }
  EXPECT_EQ(inside, 0) << "a part still runs";
  EXPECT_EQ(caught, "bad " + std::to_string(bad));
  EXPECT_EQ(visits(threads, 400, 1), std::vector<int>(400, 1)) << "after an exception";
}

void expect_all_carried(Threads& threads) {
  for (int round = 0; round < 50; ++round)
    for (const std::size_t bad : {0u, 150u, 250u, 399u}) expect_carried(threads, bad);
  EXPECT_THROW(threads.for_each(400, 1, [](std::size_t, std::size_t) { throw std::bad_alloc(); }),
               std::bad_alloc)
      << "every part throws";
  EXPECT_EQ(visits(threads, 400, 1), std::vector<int>(400, 1));
}

TEST(Threads, CarryAnExceptionOfAPartToTheCallerOfTheLoop) {
  for (const Threading kind : kinds)
    for (const int count : {1, 2, 4}) {
      const auto threads = make_threads(kind, count);
      expect_all_carried(*threads);
      const ActiveScope awake(*threads);
      expect_all_carried(*threads);
    }
  ThreadPerJob jobs;
  expect_all_carried(*make_threads(jobs));
}

TEST(Threads, EndWhileTheySleepWhileTheySpinAndBeforeTheyStart) {
  for (const Threading kind : kinds)
    for (int i = 0; i < 20; ++i) {
      make_threads(kind, 4);
      const auto asleep = make_threads(kind, 4);
      visits(*asleep, 100, 1);
      const auto spinning = make_threads(kind, 4);
      spinning->wake();
      visits(*spinning, 100, 1);
    }
}

#if defined(__linux__)

#ifndef SOUPLE_SANITIZED  // the thread sanitizer starts no threads in a child
// Workers fall asleep, hold the mutex or have not started when the parent forks.
TEST(Threads, WorkInAChildMadeByFork) {
  for (const Threading kind : kinds)
    for (int round = 0; round < 20; ++round) {
      auto threads = make_threads(kind, 4);
      if (round % 4 > 0) visits(*threads, 1000, 1);
      if (round % 4 > 1) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ASSERT_TRUE(test::succeeds_in_child([&] {
        const std::vector<int> once(1000, 1);
        for (int job = 0; job < 3; ++job)
          if (visits(*threads, 1000, 1) != once) return false;
        {
          const ActiveScope awake(*threads);
          for (int job = 0; job < 3; ++job)
            if (visits(*threads, 1000, 1) != once) return false;
        }
        threads.reset();
        return true;
      })) << "kind "
          << static_cast<int>(kind) << ", round " << round;
      EXPECT_EQ(visits(*threads, 1000, 1), std::vector<int>(1000, 1)) << "in the parent";
    }
}

TEST(Threads, EndInAChildThatDoesNotUseThem) {
  for (const Threading kind : kinds) {
    auto threads = make_threads(kind, 4);
    visits(*threads, 1000, 1);
    EXPECT_TRUE(test::succeeds_in_child([&] {
      threads.reset();
      return true;
    }));
  }
}
#endif

TEST(Threads, SleepBetweenSteps) {
  const auto threads = make_threads(Threading::pool, 3);
  visits(*threads, 100, 1);
  EXPECT_LT(test::idle_seconds(), 0.01) << "after a job outside wake and rest";
  threads->wake();
  visits(*threads, 100, 1);
  double awake = 0;  // a busy machine gives the workers little time
  for (int i = 0; i < 50 && awake < 0.02; ++i) awake += test::idle_seconds();
  EXPECT_GE(awake, 0.02) << "while awake: the test does not detect spinning";
  threads->rest();
  EXPECT_LT(test::idle_seconds(), 0.01) << "after rest";
  threads->wake();
  visits(*threads, 1, 1);
  EXPECT_LT(test::idle_seconds(), 0.01) << "awake, but the job had a single part";
}

#ifndef SOUPLE_SANITIZED  // shadow memory of sanitizers exceeds any limit
// For a child process: limits memory to a few stacks of 8 MB, then requests 64 threads.
[[noreturn]] void work_where_threads_are_refused() {
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = rlim_t{120} << 20;
  if (setrlimit(RLIMIT_AS, &limit) != 0) std::_Exit(3);
  const auto threads = make_threads(Threading::pool, 64);
  const bool right = visits(*threads, 6400, 1) == std::vector<int>(6400, 1) &&
                     visits(*threads, 6400, 1) == std::vector<int>(6400, 1);
  std::_Exit(right && threads->count() < 64 ? 0 : 1);
}

TEST(ThreadsDeathTest, GoOnWithFewerWhereTheSystemRefusesThem) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(work_where_threads_are_refused(), testing::ExitedWithCode(0), "");
}
#endif
#endif  // __linux__

/// Sets SOUPLE_THREADS while it exists.
class ScopedVariable {
 public:
  explicit ScopedVariable(const char* value) { setenv("SOUPLE_THREADS", value, 1); }
  ~ScopedVariable() { unsetenv("SOUPLE_THREADS"); }
};

TEST(ThreadCount, IsWhatWasAskedForOrTheEnvironmentsOrTheProcessors) {
  unsetenv("SOUPLE_THREADS");
  EXPECT_EQ(thread_count(5), 5);
  EXPECT_GE(thread_count(0), 1);
  const int processors = thread_count(0);
  {
    const ScopedVariable variable("3");
    EXPECT_EQ(thread_count(0), 3);
    EXPECT_EQ(thread_count(5), 5);
    EXPECT_EQ(make_threads(Threading::automatic, 0)->count(), 3);
  }
  const ScopedVariable empty("");
  EXPECT_EQ(thread_count(0), processors);
}

TEST(ThreadCount, RefusesAnEnvironmentThatSaysNoNumber) {
  for (const char* bad : {"0", "-2", "1025", "two", "2 ", "1.5", "99999999999999999999"}) {
    const ScopedVariable variable(bad);
    expect_error([] { thread_count(0); }, {"SOUPLE_THREADS", bad, "1 to 1024"});
    EXPECT_EQ(thread_count(2), 2);
  }
}

}  // namespace souple::test_threads_pool
