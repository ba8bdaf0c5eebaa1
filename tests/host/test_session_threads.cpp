#include "souple/geometry/builders.h"
#include "tests/host/player.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace souple::host::test_host_session_threads {

TEST(Session, AnotherThreadPostsAndLooksWhileFramesAreMade) {
  const Corners sheet(grid(5, 5, 1.0));
  Player host;
  const Handle cloth = host.session.add_cloth(sheet.soup());
  std::atomic<bool> done = false;
  std::int64_t refused = 0;
  const auto count_refused = [&] {  // beside warnings of steps
    const std::vector<std::string> messages = host.session.take_messages();
    refused += std::count_if(messages.begin(), messages.end(),
                             [](const std::string& message) { return message.rfind("pin: ", 0) == 0; });
  };
  std::uint64_t steps = 0;
  std::thread user([&] {
    for (int i = 0; i < 300; ++i) {
      host.session.post("pin", [cloth, i](Session& s) { s.set_pinned(cloth, 0, i % 2 == 0); });
      host.session.post("pin", [](Session& s) { s.set_pinned(77, 0, true); });
      count_refused();
      const std::uint64_t now = host.session.statistics().steps;
      EXPECT_GE(now, steps);
      steps = now;
      std::this_thread::yield();
    }
    done = true;
  });
  while (!done) {
    host.play(1);
    std::this_thread::yield();
  }
  user.join();
  host.play(1);
  count_refused();
  EXPECT_GT(refused, 0);
  EXPECT_LE(refused, 300);
  EXPECT_EQ(host.session.statistics().steps, host.session.steps());
}

}  // namespace souple::host::test_host_session_threads
