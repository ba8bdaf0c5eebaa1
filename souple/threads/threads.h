#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace souple {

/// A function called on ranges [begin, end). Refers to a callable of the caller; owns and allocates nothing.
class RangeFunction {
 public:
  template <class Function>
  requires(!std::is_same_v<std::remove_cvref_t<Function>, RangeFunction>)
      RangeFunction(const Function& function)  // NOLINT(google-explicit-constructor)
      : function_(&function), call_([](const void* f, std::size_t begin, std::size_t end) {
          (*static_cast<const Function*>(f))(begin, end);
        }) {}

  void operator()(std::size_t begin, std::size_t end) const { call_(function_, begin, end); }

 private:
  const void* function_;
  void (*call_)(const void*, std::size_t, std::size_t);
};

/// The threads on which a world computes. Only one user thread may call it at a time.
class Threads {
 public:
  virtual ~Threads() = default;

  /// Number of working threads, including the caller's. It decreases, at most once, when the system refuses
  /// to start threads.
  virtual int count() const = 0;
  /// Divides [0, n) into at most count() parts of at least `grain`, calls f once per part, and waits for all
  /// parts; see WorkPartition. If f throws, throws that exception after all parts that began have ended; of
  /// several exceptions one. Allocates nothing once the threads have started.
  virtual void for_each(std::size_t n, std::size_t grain, RangeFunction f) = 0;
  /// Calls f(k) for each k in [0, n), in order within a part.
  template <class Function>
  void each(std::size_t n, std::size_t grain, const Function& f) {
    for_each(n, grain, [&f](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) f(k);
    });
  }
  /// `wake` and `rest` enclose many for_each calls in close succession: between these calls, workers may spin
  /// instead of sleeping. A for_each with a single part wakes no worker.
  virtual void wake() {}
  virtual void rest() {}
};

/// Calls `wake` when constructed and `rest` when destroyed: in between, worker threads may spin.
class ActiveScope {
 public:
  explicit ActiveScope(Threads& threads) : threads_(threads) { threads_.wake(); }
  ~ActiveScope() { threads_.rest(); }
  ActiveScope(const ActiveScope&) = delete;
  ActiveScope& operator=(const ActiveScope&) = delete;

 private:
  Threads& threads_;
};

/// Implementation of the threads; docs/performance.md has the cost of each.
enum class Threading {
  automatic,  ///< the fastest by measurement: the pool, or serial for one thread
  serial,     ///< only the caller's thread
  pool,       ///< Souple's own threads, with a spinning barrier
  tbb         ///< oneTBB's threads; the pool if the library was built without oneTBB
};

/// A host's job system in place of Souple's threads: World::set_job_system.
class JobSystem {
 public:
  virtual ~JobSystem() = default;
  /// Number of threads that work at once, with the calling one; constant.
  virtual int workers() const = 0;
  /// Calls job(i, i + 1) for every i in [0, count), in any order on any threads, including the calling one. Returns, or
  /// throws, when all calls have returned. Jobs do not throw, wait for nothing and start no jobs.
  virtual void run(std::size_t count, RangeFunction job) = 0;
};
/// Threads that are jobs of the host.
std::unique_ptr<Threads> make_threads(JobSystem& jobs);

/// Whether the library was built with oneTBB.
bool has_tbb();

/// The number of threads that `count` requests: `count` itself if it is not 0. Otherwise the environment variable
/// SOUPLE_THREADS counts, or one per processor that this process may use. Throws Error when SOUPLE_THREADS is not a
/// whole number from 1 to 1024.
int thread_count(int count);

/// Creates thread_count(count) threads, including the caller's. They start with their first job.
std::unique_ptr<Threads> make_threads(Threading kind, int count);

}  // namespace souple
