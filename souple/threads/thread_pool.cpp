#include "souple/threads/thread_pool.h"

#include "souple/assert.h"
#include "souple/threads/error_of.h"
#include "souple/threads/process.h"

#include <algorithm>
#include <memory>
#include <new>
#include <system_error>
#include <utility>

#if defined(__unix__) || defined(__APPLE__)
#include <csignal>
#endif
#if defined(__linux__)
#include <sched.h>
#endif

namespace souple {
namespace {

constexpr int job_bits = 16;
constexpr std::uint64_t command_mask = (std::uint64_t{1} << job_bits) - 1;
// Otherwise: number of parts, 2 or more.
constexpr std::uint64_t command_sleep = 0, command_end = command_mask;

/// Spins before a waiting thread yields its processor: some tens of microseconds.
constexpr int spin_limit_uncontended = 2000;
/// With more threads than processors: the awaited thread may need this processor.
constexpr int spin_limit_oversubscribed = 20;

/// Yields before a worker that waits for a job sleeps: some hundred microseconds on an idle machine.
constexpr int yield_limit = 200;

/// Hints to the processor that this thread only waits.
void pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Waits until `ready()`.
template <class Ready>
void spin_until(int spin_limit, const Ready& ready) {
  for (int spins = 0; !ready(); ++spins) {
    if (spins < spin_limit) {
      pause();
    } else {
      std::this_thread::yield();
    }
  }
}

/// While it exists, this thread receives no external signal. Threads that this thread starts inherit the mask
/// and never receive one: handlers of users run on threads of users.
class SignalsBlocked {
 public:
#if defined(__unix__) || defined(__APPLE__)
  SignalsBlocked() {
    sigset_t outside;
    sigfillset(&outside);
    for (const int own : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGPROF})
      sigdelset(&outside, own);
    pthread_sigmask(SIG_SETMASK, &outside, &before_);
  }
  ~SignalsBlocked() {
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

 private:
  sigset_t before_{};
#endif
};

}  // namespace

int usable_processors() {
#if defined(__linux__)
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0) return CPU_COUNT(&set);
#endif
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

ThreadPool::ThreadPool(int count)
    : count_(std::max(count, 1)),
      spin_limit_(count_ <= usable_processors() ? spin_limit_uncontended : spin_limit_oversubscribed),
      workers_(static_cast<std::size_t>(count_ - 1)) {}

ThreadPool::~ThreadPool() {
  forget_if_forked();
  if (started_) send(command_end);
  for (Worker& worker : workers_)
    if (worker.thread.joinable()) worker.thread.join();
}

// If the system refuses a thread, the pool continues with the threads it has.
void ThreadPool::start() {
  process_ = process_number();
  started_ = true;
  sleeping_ = true;
  const SignalsBlocked blocked;
  for (std::size_t t = 1; t <= workers_.size(); ++t) {
    try {
      workers_[t - 1].thread = std::thread([this, t] { work(t); });
    } catch (const std::system_error&) {
      count_ = static_cast<int>(t);
      return;
    } catch (const std::bad_alloc&) {
      count_ = static_cast<int>(t);
      return;
    }
  }
}

// A worker of the parent may have held the mutex, and waits in the condition forever. So neither they nor the handles
// of the threads may be destroyed.
void ThreadPool::forget_if_forked() {
  if (!started_ || process_ == process_number()) return;
  for (Worker& worker : workers_) {
    std::construct_at(&worker.thread);
    worker.parked = false;
  }
  std::construct_at(&mutex_);
  std::construct_at(&wake_condition_);
  started_ = false;
}

void ThreadPool::wake() {
  forget_if_forked();
  ++awake_;
}

void ThreadPool::send(std::uint64_t command) {
  SOUPLE_ASSERT(command <= command_mask, "a command fits into its bits");
  const std::uint64_t number = (job_.signal.load(std::memory_order_relaxed) >> job_bits) + 1;
  const std::uint64_t signal = number << job_bits | command;
  bool wakes = sleeping_;
  if (!sleeping_) {
    // Either a worker that parks sees this signal, or it is seen to be parked.
    job_.signal.store(signal, std::memory_order_seq_cst);
    for (const Worker& worker : workers_) wakes = wakes || worker.parked.load(std::memory_order_seq_cst);
    if (wakes) {
      const std::lock_guard lock(mutex_);  // a worker that is about to park then waits
    }
  } else {
    // Under the lock, so that no worker falls asleep between its check and the notification.
    const std::lock_guard lock(mutex_);
    job_.signal.store(signal, std::memory_order_seq_cst);
  }
  if (wakes) wake_condition_.notify_all();
  if (sleeping_) ++wake_count_;
  sleeping_ = command == command_sleep;
}

bool ThreadPool::claim(Worker& worker, std::uint64_t signal) {
  std::uint64_t last = worker.claimed.load(std::memory_order_relaxed);
  return last < signal && worker.claimed.compare_exchange_strong(last, signal, std::memory_order_relaxed);
}

void ThreadPool::for_each(std::size_t n, std::size_t grain, RangeFunction f) {
  if (n == 0) return;
  if (awake_ == 0) forget_if_forked();
  if (count_ > 1 && !started_ && WorkPartition(n, grain, count_).parts() > 1) start();
  const WorkPartition partition(n, grain, count_);
  if (partition.parts() < 2) return f(0, n);
  SOUPLE_ASSERT(partition.parts() <= static_cast<std::size_t>(count_), "a part per thread");
  SOUPLE_ASSERT(partition.begin(partition.parts()) == n, "parts cover the range");
  job_.function = &f;
  job_.partition = partition;
  send(partition.parts());
  const std::uint64_t signal = job_.signal.load(std::memory_order_relaxed);
  std::exception_ptr error = error_of(f, 0, partition.begin(1));
  for (std::size_t t = 1; t < partition.parts(); ++t) {
    if (!claim(workers_[t - 1], signal)) continue;
    workers_[t - 1].error = error_of(f, partition.begin(t), partition.begin(t + 1));
    workers_[t - 1].done.store(signal, std::memory_order_relaxed);
  }
  for (std::size_t t = 1; t < partition.parts(); ++t)
    spin_until(spin_limit_, [&] { return workers_[t - 1].done.load(std::memory_order_acquire) == signal; });
  for (std::size_t t = 1; t < partition.parts(); ++t)
    if (std::exception_ptr of_part = std::exchange(workers_[t - 1].error, {}); of_part && !error)
      error = std::move(of_part);
  if (awake_ == 0) send(command_sleep);
  if (error) std::rethrow_exception(std::move(error));
}

void ThreadPool::rest() {
  SOUPLE_ASSERT(awake_ > 0, "each rest follows a wake");
  if (--awake_ == 0 && started_ && !sleeping_) send(command_sleep);
}

void ThreadPool::park(Worker& worker, std::uint64_t seen) {
  std::unique_lock lock(mutex_);
  worker.parked.store(true, std::memory_order_seq_cst);
  wake_condition_.wait(lock, [&] { return job_.signal.load(std::memory_order_seq_cst) != seen; });
  worker.parked.store(false, std::memory_order_relaxed);
}

// Returns the next signal after `seen`: spins for it, then yields, then sleeps; at once if `seen` commands sleep.
std::uint64_t ThreadPool::next_signal(std::size_t t, std::uint64_t seen) {
  const auto changed = [&] { return job_.signal.load(std::memory_order_acquire) != seen; };
  const bool sleeps = (seen & command_mask) == command_sleep;
  const int limit = sleeps ? 0 : spin_limit_ + yield_limit;
  for (int k = 0; k < limit && !changed(); ++k) {
    if (k < spin_limit_)
      pause();
    else
      std::this_thread::yield();
  }
  if (!changed()) park(workers_[t - 1], seen);
  return job_.signal.load(std::memory_order_acquire);
}

void ThreadPool::work(std::size_t t) noexcept {
  std::uint64_t signal = 0;
  for (;;) {
    signal = next_signal(t, signal);
    const std::uint64_t command = signal & command_mask;
    if (command == command_end) return;
    if (command == command_sleep || t >= command || !claim(workers_[t - 1], signal)) continue;
    workers_[t - 1].error = error_of(*job_.function, job_.partition.begin(t), job_.partition.begin(t + 1));
    workers_[t - 1].done.store(signal, std::memory_order_release);
  }
}

}  // namespace souple
