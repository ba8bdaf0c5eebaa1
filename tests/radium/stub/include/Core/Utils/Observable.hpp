#pragma once

#include <Core/RaCore.hpp>
#include <functional>
#include <map>
#include <utility>

namespace Ra {
namespace Core {
namespace Utils {

/// Observers are called in the order they came. The first has the number 1.
template <typename... Args>
class Observable {
 public:
  using Observer = std::function<void(Args...)>;

  Observable() = default;
  Observable(const Observable&) = delete;
  Observable& operator=(const Observable&) = delete;
  virtual ~Observable() = default;

  int attach(Observer observer) {
    m_observers.emplace(++m_currentId, std::move(observer));
    return m_currentId;
  }

  template <typename T>
  int attachMember(T* object, void (T::*observer)(Args...)) {
    return attach([object, observer](Args... args) { (object->*observer)(args...); });
  }

  void notify(Args... args) const {
    for (const auto& numbered : m_observers) numbered.second(args...);
  }

  void detach(int observerId) { m_observers.erase(observerId); }
  void detachAll() { m_observers.clear(); }

  void copyObserversTo(Observable& other) const {
    for (const auto& numbered : m_observers) other.attach(numbered.second);
  }

 private:
  std::map<int, Observer> m_observers;
  int m_currentId = 0;
};

class ObservableVoid : public Observable<> {};

}  // namespace Utils
}  // namespace Core
}  // namespace Ra
