#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace souple {

/// A function called on ranges [begin, end): refers to a callable of the caller, owns and allocates nothing.
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

/// The threads a world computes on. One thread of the user's calls it at a time.
class Threads {
 public:
  virtual ~Threads() = default;

  /// Threads that work, the caller's among them. It may fall, once, when the system refuses to start some.
  virtual int count() const = 0;
  /// Cuts [0, n) into at most count() parts of at least `grain`, calls f once for each, then waits for all;
  /// see WorkPartition. `f` must not throw. Allocates nothing once the threads have started.
  virtual void for_each(std::size_t n, std::size_t grain, RangeFunction f) = 0;
  /// Between these two many for_each follow one another closely: workers may spin instead of sleeping. What
  /// is never cut wakes nobody.
  virtual void wake() {}
  virtual void rest() {}
};

/// Awake as long as it lives.
class ActiveScope {
 public:
  explicit ActiveScope(Threads& threads) : threads_(threads) { threads_.wake(); }
  ~ActiveScope() { threads_.rest(); }
  ActiveScope(const ActiveScope&) = delete;
  ActiveScope& operator=(const ActiveScope&) = delete;

 private:
  Threads& threads_;
};

/// Which threads: see docs/performance.md for what each costs.
enum class Threading {
  automatic,  ///< what measures best: the pool, or serial where one thread is asked for
  serial,     ///< the caller's only
  pool,       ///< our own, with a spinning barrier
  tbb         ///< oneTBB's; where the library was built without it, the pool
};

/// Whether the library was built with oneTBB.
bool has_tbb();

/// How many threads `count` means. Itself where it is not 0; otherwise the environment's SOUPLE_THREADS, or
/// one for each processor this process may use. Throws Error when SOUPLE_THREADS is no whole number from 1
/// to 1024.
int thread_count(int count);

/// `count` threads, the caller's among them, by the rules of thread_count. They start when they first have
/// work.
std::unique_ptr<Threads> make_threads(Threading kind, int count);

}  // namespace souple
