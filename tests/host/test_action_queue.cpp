#include "souple/error.h"
#include "souple/host/action_queue.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

namespace souple::host::test_host_action_queue {

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

}  // namespace souple::host::test_host_action_queue
