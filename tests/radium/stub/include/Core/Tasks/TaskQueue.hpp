#pragma once

#include <Core/RaCore.hpp>
#include <Core/Tasks/Task.hpp>
#include <Core/Utils/Index.hpp>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace Ra {
namespace Core {

/// Tasks with an order among some of them. Here all run in the thread of the caller, in the order in which
/// one thread of Radium would take them: as registered, and the ones that wait when the last one they wait
/// for is done.
class TaskQueue {
 public:
  using TaskId = Utils::Index;

  explicit TaskQueue(uint numThreads) : m_numThreads(numThreads) {}
  TaskQueue(const TaskQueue&) = delete;
  TaskQueue& operator=(const TaskQueue&) = delete;

  TaskId registerTask(std::unique_ptr<Task> task);
  /// The task does nothing from now on; the others keep their numbers. One that is not there is ignored.
  void removeTask(TaskId taskId);
  /// The first of that name, invalid if there is none.
  TaskId getTaskId(const std::string& taskName) const;

  void addDependency(TaskId predecessor, TaskId successor);
  /// False if there is no task of that name.
  bool addDependency(const std::string& predecessor, TaskId successor);
  bool addDependency(TaskId predecessor, const std::string& successor);
  /// The same, but the name is looked for when the tasks start.
  void addPendingDependency(const std::string& predecessor, TaskId successor);
  void addPendingDependency(TaskId predecessor, const std::string& successor);

  /// All tasks are done when this returns. With no threads it does nothing but complain, as Radium's.
  /// An exception that leaves a task ends the program: in Radium it leaves a thread.
  void startTasks() noexcept;
  void waitForTasks() {}
  /// Runs all and forgets them. An exception that leaves a task comes out of here, with the tasks still
  /// there.
  void runTasksInThisThread();
  void flushTaskQueue();

 private:
  void resolveDependencies();
  void runTasks();

  uint m_numThreads;
  std::vector<std::unique_ptr<Task>> m_tasks;
  std::vector<std::vector<TaskId>> m_dependencies;
  std::vector<uint> m_remainingDependencies;
  std::vector<std::pair<TaskId, std::string>> m_pendingSuccessors;
  std::vector<std::pair<std::string, TaskId>> m_pendingPredecessors;
};

}  // namespace Core
}  // namespace Ra
