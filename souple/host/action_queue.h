#pragma once

#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace souple::host {

/// What a user asked for while a frame was computed: one thread posts, another applies at the next frame's
/// begin, in the order of posting. All functions may be called by any thread at any time.
template <class Target>
class ActionQueue {
 public:
  using Action = std::function<void(Target&)>;

  /// `name` begins the message when the action fails.
  void post(std::string name, Action action) {
    const std::lock_guard<std::mutex> lock(mutex_);
    actions_.emplace_back(std::move(name), std::move(action));
  }

  /// Runs all that was posted before; what an action posts itself waits for the next time. An action that
  /// throws is reported, one sentence each, and the others run all the same.
  std::vector<std::string> apply(Target& target) {
    std::vector<std::pair<std::string, Action>> actions;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      actions.swap(actions_);
    }
    std::vector<std::string> failures;
    for (const auto& [name, action] : actions) {
      try {
        if (action) action(target);
      } catch (const std::exception& error) {
        failures.push_back(name + ": " + error.what());
      } catch (...) {
        failures.push_back(name + ": failed for a reason that has no words");
      }
    }
    return failures;
  }

 private:
  std::mutex mutex_;
  std::vector<std::pair<std::string, Action>> actions_;
};

}  // namespace souple::host
