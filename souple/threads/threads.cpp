#include "souple/threads/threads.h"

#include "souple/error.h"
#include "souple/threads/error_of.h"
#include "souple/threads/thread_pool.h"
#include "souple/threads/work_partition.h"
#ifdef SOUPLE_WITH_TBB
#include "souple/threads/tbb_threads.h"
#endif

#include <charconv>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace souple {
namespace {

class SerialThreads final : public Threads {
 public:
  int count() const override { return 1; }
  void for_each(std::size_t n, std::size_t, RangeFunction f) override {
    if (n > 0) f(0, n);
  }
};

/// One job per part of the same partition as all Threads.
class JobThreads final : public Threads {
 public:
  explicit JobThreads(JobSystem& jobs) : jobs_(jobs), count_(jobs.workers()) {}

  int count() const override { return count_; }
  void for_each(std::size_t n, std::size_t grain, RangeFunction f) override {
    if (n == 0) return;
    const WorkPartition partition(n, grain, count_);
    if (partition.parts() < 2) return f(0, n);
    std::mutex mutex;
    std::exception_ptr error;
    const auto job = [&](std::size_t part, std::size_t) {
      std::exception_ptr of_part = error_of(f, partition.begin(part), partition.begin(part + 1));
      if (!of_part) return;
      const std::lock_guard lock(mutex);
      if (!error) error = std::move(of_part);
    };
    jobs_.run(partition.parts(), job);
    if (error) std::rethrow_exception(std::move(error));
  }

 private:
  JobSystem& jobs_;
  int count_;
};

std::unique_ptr<Threads> make_tbb_or_pool(int count) {
#ifdef SOUPLE_WITH_TBB
  return make_tbb_threads(count);
#else
  return std::make_unique<ThreadPool>(count);
#endif
}

}  // namespace

bool has_tbb() {
#ifdef SOUPLE_WITH_TBB
  return true;
#else
  return false;
#endif
}

int thread_count(int count) {
  if (count != 0) return count;
  const char* variable = std::getenv("SOUPLE_THREADS");
  if (!variable || *variable == '\0') return usable_processors();
  const std::string_view text(variable);
  int wanted = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), wanted);
  if (error != std::errc{} || end != text.data() + text.size() || wanted < 1 || wanted > 1024)
    throw Error("the environment variable SOUPLE_THREADS is '" + std::string(text) +
                "', expected a whole number from 1 to 1024: set it to one, or unset it");
  return wanted;
}

std::unique_ptr<Threads> make_threads(Threading kind, int count) {
  count = thread_count(count);
  if (kind == Threading::serial || count == 1) return std::make_unique<SerialThreads>();
  return kind == Threading::tbb ? make_tbb_or_pool(count) : std::make_unique<ThreadPool>(count);
}

std::unique_ptr<Threads> make_threads(JobSystem& jobs) {
  return std::make_unique<JobThreads>(jobs);
}

}  // namespace souple
