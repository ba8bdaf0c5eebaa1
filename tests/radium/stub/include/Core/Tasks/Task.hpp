#pragma once

#include <Core/RaCore.hpp>
#include <functional>
#include <string>
#include <utility>

namespace Ra {
namespace Core {

class Task {
 public:
  virtual ~Task() = default;

  virtual std::string getName() const = 0;
  virtual void process() = 0;
};

class FunctionTask : public Task {
 public:
  FunctionTask(std::function<void()> f, std::string name) : m_f(std::move(f)), m_name(std::move(name)) {}

  std::string getName() const override { return m_name; }
  void process() override { m_f(); }

 protected:
  std::function<void()> m_f;
  std::string m_name;
};

}  // namespace Core
}  // namespace Ra
