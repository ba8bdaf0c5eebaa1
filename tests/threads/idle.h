#pragma once

#include <chrono>
#include <ctime>
#include <thread>

namespace souple::test {

/// Processor time that all threads of this process use while the calling thread sleeps for 0.2 s. [s]
inline double idle_seconds() {
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // workers may still be falling asleep
  const std::clock_t before = std::clock();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  return static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
}

}  // namespace souple::test
