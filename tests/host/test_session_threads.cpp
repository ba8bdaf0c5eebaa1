#include "souple/geometry/builders.h"
#include "tests/host/player.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

namespace souple::host {
namespace {

TEST(Session, AnotherThreadPostsAndLooksWhileFramesAreMade) {
  const Corners sheet(grid(5, 5, 1.0));
  Player host;
  const Handle cloth = host.session.add_cloth(sheet.soup());
  std::atomic<bool> done = false;
  std::size_t refused = 0;
  std::uint64_t steps = 0;
  std::thread user([&] {
    for (int i = 0; i < 300; ++i) {
      host.session.post("pin", [cloth, i](Session& s) { s.set_pinned(cloth, 0, i % 2 == 0); });
      host.session.post("pin", [](Session& s) { s.set_pinned(77, 0, true); });
      refused += host.session.take_messages().size();
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
  refused += host.session.take_messages().size();
  EXPECT_GT(refused, 0u);
  EXPECT_LE(refused, 300u);
  EXPECT_EQ(host.session.statistics().steps, host.session.steps());
}

}  // namespace
}  // namespace souple::host
