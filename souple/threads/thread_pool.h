#pragma once

#include "souple/threads/threads.h"
#include "souple/threads/work_partition.h"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace souple {

/// Threads that spin on one word for their next job. Fork and join of two threads costs a few hundred
/// nanoseconds; waking a sleeping thread costs fifty microseconds. Between steps the threads sleep. So they do within
/// a step where the next job is long in coming: a processor that only waits is one that others lack.
///
/// That word, the signal, holds the number of the job (upper 48 bits) and a command (lower 16). The command is the
/// number of parts to work on, or sleep, or end. Part 0 belongs to the caller and part t to worker t, so that a thread
/// gets the same particles color after color. A worker may not be running: it is still waking up, or the system gave
/// its processor to another process. To avoid waiting for it, a thread claims a part before working on it, and the
/// caller, after its own part, takes all unclaimed ones. The assignment of parts to threads changes no result. (Without
/// claims, a job took 90 microseconds on a busy machine. Taking parts one by one from a counter would move particles
/// from cache to cache.)
///
/// A child made by fork between steps has no workers; the pool then starts new ones.
///
/// All parts of a job are claimed before the next job is sent, and signals only grow. So the claim of a late
/// worker fails, and it never reads a job that is being written.
class ThreadPool final : public Threads {
 public:
  explicit ThreadPool(int count);
  ~ThreadPool() override;
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int count() const override { return count_; }
  void for_each(std::size_t n, std::size_t grain, RangeFunction f) override;
  void wake() override;
  void rest() override;
  /// How often it has woken workers that rested since `rest`. Those that fell asleep within a step do not count.
  std::uint64_t wake_count() const { return wake_count_; }

 private:
  /// Message from the caller to the workers, on one cache line (two, where the processor fetches pairs).
  struct alignas(128) Job {
    std::atomic<std::uint64_t> signal{0};
    const RangeFunction* function = nullptr;
    WorkPartition partition{0, 1, 1};
  };
  struct alignas(128) Worker {
    std::atomic<std::uint64_t> claimed{0};  ///< signal of the last job whose part was claimed
    std::atomic<std::uint64_t> done{0};     ///< signal of the last job whose part is finished
    std::atomic<bool> parked{false};        ///< sleeps, or is about to, until the next signal
    std::exception_ptr error;               ///< exception of that part; null: none
    std::thread thread;
  };

  /// Claims the worker's part of the job with this signal. Returns true only once per signal.
  static bool claim(Worker& worker, std::uint64_t signal);
  void start();
  void forget_if_forked();
  void send(std::uint64_t command);
  void work(std::size_t t) noexcept;
  std::uint64_t next_signal(std::size_t t, std::uint64_t seen);
  void park(Worker& worker, std::uint64_t seen);

  int count_;
  int spin_limit_;
  long process_ = 0;  // that started the workers
  bool started_ = false;
  int awake_ = 0;          // calls of wake() without their rest()
  bool sleeping_ = false;  // the workers sleep or are about to
  std::uint64_t wake_count_ = 0;
  Job job_;
  std::vector<Worker> workers_;  // all threads but the caller
  std::mutex mutex_;             // guards the transition from sleep to a job
  std::condition_variable wake_condition_;
};

/// Number of processors that the scheduler lets this process use, at least 1.
int usable_processors();

}  // namespace souple
