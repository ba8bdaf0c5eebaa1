#include "souple/threads/threads.h"

#include <atomic>
#include <cmath>
#include <cstdint>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

// Cost of passing work to other threads and of waiting for them, as between two colors of a cloth. Real time;
// with more threads than processors it measures the scheduler.

namespace souple {
namespace {

constexpr const char* names[] = {"automatic", "serial", "pool", "tbb"};

/// An empty task of one item per thread, on any thread: the caller processes items that no worker has
/// started.
void fork_and_join(benchmark::State& state) {
  const auto kind = static_cast<Threading>(state.range(0));
  const int count = static_cast<int>(state.range(1));
  const auto threads = make_threads(kind, count);
  const ActiveScope awake(*threads);
  for (auto _ : state)
    threads->for_each(static_cast<std::size_t>(count), 1,
                      [](std::size_t begin, std::size_t) { benchmark::DoNotOptimize(begin); });
  state.SetLabel(names[state.range(0)]);
}

/// Two items that wait for each other, so that both threads take part: the full round trip.
void rendezvous(benchmark::State& state) {
  const auto threads = make_threads(static_cast<Threading>(state.range(0)), 2);
  const ActiveScope awake(*threads);
  std::atomic<std::int64_t> arrived{0};
  std::int64_t all = 0;
  for (auto _ : state) {
    all += 2;
    threads->for_each(2, 1, [&](std::size_t, std::size_t) {
      arrived.fetch_add(1);
      for (int spins = 0; arrived.load() < all; ++spins)
        if (spins > 10000) std::this_thread::yield();
    });
  }
  state.SetLabel(names[state.range(0)]);
}

/// A color that takes about 10 microseconds on one thread: square roots in registers.
void short_color(benchmark::State& state) {
  const auto threads = make_threads(static_cast<Threading>(state.range(0)), static_cast<int>(state.range(1)));
  std::vector<float> values(8192, 2.0f);
  const ActiveScope awake(*threads);
  for (auto _ : state) {
    threads->for_each(values.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) values[i] = std::sqrt(values[i]) + 1;
    });
    benchmark::ClobberMemory();
  }
  state.SetLabel(names[state.range(0)]);
}

/// Cost of the first task of a step: the workers sleep until it starts.
void wake_workers(benchmark::State& state) {
  const int count = static_cast<int>(state.range(1));
  const auto threads = make_threads(static_cast<Threading>(state.range(0)), count);
  for (auto _ : state)
    threads->for_each(static_cast<std::size_t>(count), 1,
                      [](std::size_t begin, std::size_t) { benchmark::DoNotOptimize(begin); });
  state.SetLabel(names[state.range(0)]);
}

void kinds_and_counts(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"kind", "threads"})->UseRealTime();
  benchmark->Args({static_cast<int>(Threading::serial), 1});
  for (const Threading kind : {Threading::pool, Threading::tbb})
    for (const int count : {2, 4, 8}) benchmark->Args({static_cast<int>(kind), count});
}
BENCHMARK(fork_and_join)->Apply(kinds_and_counts);
BENCHMARK(rendezvous)
    ->ArgName("kind")
    ->Arg(static_cast<int>(Threading::pool))
    ->Arg(static_cast<int>(Threading::tbb))
    ->UseRealTime();
BENCHMARK(short_color)->Apply(kinds_and_counts);
BENCHMARK(wake_workers)->Apply(kinds_and_counts);

}  // namespace
}  // namespace souple
