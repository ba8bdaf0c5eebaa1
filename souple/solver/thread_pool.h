#pragma once

#include "souple/solver/threads.h"
#include "souple/solver/work_partition.h"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

namespace souple {

/// Threads that spin on one word for their next job: a fork and join of two threads costs a few hundred
/// nanoseconds, where waking a sleeping thread costs fifty microseconds. Between steps they sleep.
///
/// That word, the signal, holds the number of the job (upper 48 bits) and what is asked (lower 16): so many
/// parts to work on, or to sleep, or to end. Part 0 is the caller's and part t worker t's, so that a thread
/// meets the same particles color after color; but a worker that does not run just now, because it still
/// wakes up or the system gave its processor to others, would make all wait: whoever works on a part claims
/// it first, and the caller takes those that nobody has claimed when its own is done. Which thread works on a
/// part changes no result. (Without this, a job took 90 microseconds on a busy machine; parts handed out one
/// by one from a counter would move particles from cache to cache.)
///
/// All parts of a job are claimed before the next is sent, and signals only grow: a worker that comes late
/// finds its claim refused and never looks at a job that is being written.
class ThreadPool final : public Threads {
 public:
  explicit ThreadPool(int count);
  ~ThreadPool() override;
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int count() const override { return count_; }
  void for_each(std::size_t n, std::size_t grain, RangeFunction f) override;
  void wake() override { awake_ = true; }
  void rest() override;

 private:
  /// What the caller tells the workers, on one cache line (two, where the processor fetches pairs).
  struct alignas(128) Job {
    std::atomic<std::uint64_t> signal{0};
    const RangeFunction* function = nullptr;
    WorkPartition partition{0, 1, 1};
  };
  struct alignas(128) Worker {
    std::atomic<std::uint64_t> claimed{0};  ///< the signal of the last job whose part was taken
    std::atomic<std::uint64_t> done{0};     ///< and of the last whose part is finished
    std::thread thread;
  };

  /// Whether the part of a job is the one's who asks: true once for each signal.
  static bool claim(Worker& worker, std::uint64_t signal);
  void start();
  void send(std::uint64_t command);
  void work(std::size_t t) noexcept;
  std::uint64_t next_signal(std::uint64_t seen, int spin_limit);

  int count_;
  int spin_limit_;
  bool started_ = false;
  bool awake_ = false;     // between wake() and rest()
  bool sleeping_ = false;  // the workers, or on their way to it
  Job job_;
  std::vector<Worker> workers_;  // all but the caller
  std::mutex mutex_;             // guards the change from sleep to a job
  std::condition_variable wake_condition_;
};

/// Those that the scheduler lets this process use, at least 1.
int usable_processors();

}  // namespace souple
