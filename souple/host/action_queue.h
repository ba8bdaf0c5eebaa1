#pragma once

#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace souple::host {

/// Actions requested while a frame is computed. One thread posts them, another applies them at the start of the next
/// frame, in the order of posting. Any thread may call any function at any time.
template <class Target>
class ActionQueue {
 public:
  using Action = std::function<void(Target&)>;

  /// `name` begins the error message of a failed action.
  void post(std::string name, Action action) {
    const std::lock_guard<std::mutex> lock(mutex_);
    actions_.emplace_back(std::move(name), std::move(action));
  }

  /// Runs the posted actions. Actions that these post wait for the next call. Returns a sentence for each
  /// action that threw; the others still run.
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
        failures.push_back(name + ": failed with an unknown exception");
      }
    }
    return failures;
  }

 private:
  std::mutex mutex_;
  std::vector<std::pair<std::string, Action>> actions_;
};

}  // namespace souple::host
