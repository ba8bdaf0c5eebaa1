#include "souple/threads/tbb_threads.h"

#include "souple/threads/process.h"
#include "souple/threads/work_partition.h"

#include <memory>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

namespace souple {
namespace {

/// Uses the same partition as all Threads, one task per part; oneTBB chooses the thread of each task.
class TbbThreads final : public Threads {
 public:
  explicit TbbThreads(int count)
      : count_(count), process_(process_number()), arena_(std::make_unique<oneapi::tbb::task_arena>(count)) {}
  // In a child made by fork the end of an arena may wait for a lock that a thread of the parent held.
  ~TbbThreads() override {
    if (process_ != process_number()) static_cast<void>(arena_.release());
  }
  TbbThreads(const TbbThreads&) = delete;
  TbbThreads& operator=(const TbbThreads&) = delete;

  int count() const override { return count_; }
  void for_each(std::size_t n, std::size_t grain, RangeFunction f) override {
    if (n == 0) return;
    const WorkPartition partition(n, grain, count_);
    // In a child made by fork oneTBB may wait for threads that only the parent has.
    if (partition.parts() < 2 || process_ != process_number()) return f(0, n);
    arena_->execute([&] {
      oneapi::tbb::parallel_for(
          std::size_t{0}, partition.parts(),
          [&](std::size_t t) { f(partition.begin(t), partition.begin(t + 1)); },
          oneapi::tbb::static_partitioner{});
    });
  }

 private:
  int count_;
  long process_;  // in which oneTBB has its threads
  std::unique_ptr<oneapi::tbb::task_arena> arena_;
};

}  // namespace

std::unique_ptr<Threads> make_tbb_threads(int count) {
  return std::make_unique<TbbThreads>(count);
}

}  // namespace souple
