#include <Core/Tasks/TaskQueue.hpp>
#include <Core/Utils/Log.hpp>
#include <deque>

namespace Ra {
namespace Core {

namespace {

std::size_t number(TaskQueue::TaskId id) {
  return static_cast<std::size_t>(id.getValue());
}

}  // namespace

TaskQueue::TaskId TaskQueue::registerTask(std::unique_ptr<Task> task) {
  m_tasks.push_back(std::move(task));
  m_dependencies.emplace_back();
  m_remainingDependencies.push_back(0);
  return TaskId(m_tasks.size() - 1);
}

void TaskQueue::removeTask(TaskId taskId) {
  if (taskId.isInvalid() || number(taskId) >= m_tasks.size()) return;
  auto& task = m_tasks[number(taskId)];
  task = std::make_unique<FunctionTask>([] {}, task->getName());
}

TaskQueue::TaskId TaskQueue::getTaskId(const std::string& taskName) const {
  for (std::size_t i = 0; i < m_tasks.size(); ++i) {
    if (m_tasks[i]->getName() == taskName) return TaskId(i);
  }
  return {};
}

void TaskQueue::addDependency(TaskId predecessor, TaskId successor) {
  m_dependencies.at(number(predecessor)).push_back(successor);
  ++m_remainingDependencies.at(number(successor));
}

bool TaskQueue::addDependency(const std::string& predecessor, TaskId successor) {
  const TaskId found = getTaskId(predecessor);
  if (found.isValid()) addDependency(found, successor);
  return found.isValid();
}

bool TaskQueue::addDependency(TaskId predecessor, const std::string& successor) {
  const TaskId found = getTaskId(successor);
  if (found.isValid()) addDependency(predecessor, found);
  return found.isValid();
}

void TaskQueue::addPendingDependency(const std::string& predecessor, TaskId successor) {
  m_pendingPredecessors.emplace_back(predecessor, successor);
}

void TaskQueue::addPendingDependency(TaskId predecessor, const std::string& successor) {
  m_pendingSuccessors.emplace_back(predecessor, successor);
}

void TaskQueue::resolveDependencies() {
  for (const auto& [predecessor, successor] : m_pendingSuccessors) addDependency(predecessor, successor);
  for (const auto& [predecessor, successor] : m_pendingPredecessors) addDependency(predecessor, successor);
  m_pendingSuccessors.clear();
  m_pendingPredecessors.clear();
}

void TaskQueue::runTasks() {
  resolveDependencies();
  std::deque<std::size_t> ready;
  for (std::size_t i = 0; i < m_tasks.size(); ++i) {
    if (m_remainingDependencies[i] == 0) ready.push_back(i);
  }
  while (!ready.empty()) {
    const std::size_t current = ready.front();
    ready.pop_front();
    m_tasks[current]->process();
    for (const TaskId successor : m_dependencies[current]) {
      if (--m_remainingDependencies[number(successor)] == 0) ready.push_back(number(successor));
    }
  }
}

void TaskQueue::startTasks() noexcept {
  if (m_numThreads == 0) {
    LOG(Utils::logERROR) << "a task queue of no threads starts no tasks: use runTasksInThisThread";
    return;
  }
  runTasks();
}

void TaskQueue::runTasksInThisThread() {
  runTasks();
  flushTaskQueue();
}

void TaskQueue::flushTaskQueue() {
  m_tasks.clear();
  m_dependencies.clear();
  m_remainingDependencies.clear();
}

}  // namespace Core
}  // namespace Ra
