#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/host/action_queue.h"
#include "tests/host/player.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace souple::host::test_host_threads {

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

using Numbers = std::vector<int>;

TEST(ActionQueue, AppliesInTheOrderOfPostingAndOnce) {
  ActionQueue<Numbers> queue;
  Numbers numbers;
  for (int i = 0; i < 5; ++i) queue.post("add", [i](Numbers& n) { n.push_back(i); });
  EXPECT_TRUE(numbers.empty());
  EXPECT_TRUE(queue.apply(numbers).empty());
  EXPECT_EQ(numbers, (Numbers{0, 1, 2, 3, 4}));
  EXPECT_TRUE(queue.apply(numbers).empty());
  EXPECT_EQ(numbers.size(), 5u);
}

TEST(ActionQueue, WhatFailsIsToldAndTheRestIsDone) {
  ActionQueue<Numbers> queue;
  Numbers numbers;
  queue.post("pin", [](Numbers&) { throw Error("object 3 is gone"); });
  queue.post("add", [](Numbers& n) { n.push_back(1); });
  queue.post("odd", [](Numbers&) { throw 5; });
  queue.post("empty", {});
  const std::vector<std::string> failures = queue.apply(numbers);
  ASSERT_EQ(failures.size(), 2u);
  EXPECT_EQ(failures[0], "pin: object 3 is gone");
  EXPECT_NE(failures[1].find("odd"), std::string::npos);
  EXPECT_EQ(numbers, (Numbers{1}));
}

TEST(ActionQueue, AnActionMayPostTheNext) {
  ActionQueue<Numbers> queue;
  Numbers numbers;
  queue.post("first", [&queue](Numbers& n) {
    n.push_back(1);
    queue.post("second", [](Numbers& m) { m.push_back(2); });
  });
  queue.apply(numbers);
  EXPECT_EQ(numbers, (Numbers{1}));
  queue.apply(numbers);
  EXPECT_EQ(numbers, (Numbers{1, 2}));
}

/// One thread posts while another applies: nothing is lost, nothing comes twice or in another order.
TEST(ActionQueue, ThreadsDoNotMeet) {
  constexpr int count = 20000;
  ActionQueue<Numbers> queue;
  Numbers numbers;
  std::atomic<bool> done = false;
  std::thread user([&] {
    for (int i = 0; i < count; ++i) queue.post("add", [i](Numbers& n) { n.push_back(i); });
    done = true;
  });
  while (!done) queue.apply(numbers);
  user.join();
  queue.apply(numbers);
  ASSERT_EQ(numbers.size(), std::size_t(count));
  for (int i = 0; i < count; ++i) ASSERT_EQ(numbers[static_cast<std::size_t>(i)], i);
}

}  // namespace souple::host::test_host_threads
