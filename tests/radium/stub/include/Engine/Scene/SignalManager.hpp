#pragma once

#include <Core/Utils/Observable.hpp>
#include <Engine/RaEngine.hpp>
#include <Engine/Scene/ItemEntry.hpp>
#include <mutex>

namespace Ra {
namespace Engine {
namespace Scene {

/// Says what comes and goes. All signals share one plain mutex, as in Radium: whoever makes or removes
/// something from within a callback waits for ever.
class SignalManager {
 public:
  using ItemObservable = Core::Utils::Observable<const ItemEntry&>;
  using FrameObservable = Core::Utils::Observable<>;

  void fireEntityCreated(const ItemEntry& entity) const { fire(m_entityCreated, entity); }
  void fireEntityDestroyed(const ItemEntry& entity) const { fire(m_entityDestroyed, entity); }
  void fireComponentAdded(const ItemEntry& component) const { fire(m_componentCreated, component); }
  void fireComponentRemoved(const ItemEntry& component) const { fire(m_componentDestroyed, component); }
  void fireRenderObjectAdded(const ItemEntry& ro) const { fire(m_renderObjectCreated, ro); }
  void fireRenderObjectRemoved(const ItemEntry& ro) const { fire(m_renderObjectDestroyed, ro); }
  void fireFrameEnded() const { fire(m_endFrame); }

  void setOn(bool on) { m_isOn = on; }

  ItemObservable& getEntityCreatedNotifier() { return m_entityCreated; }
  ItemObservable& getEntityDestroyedNotifier() { return m_entityDestroyed; }
  ItemObservable& getComponentCreatedNotifier() { return m_componentCreated; }
  ItemObservable& getComponentDestroyedNotifier() { return m_componentDestroyed; }
  ItemObservable& getRenderObjectCreatedNotifier() { return m_renderObjectCreated; }
  ItemObservable& getRenderObjectDestroyedNotifier() { return m_renderObjectDestroyed; }
  FrameObservable& getEndFrameNotifier() { return m_endFrame; }

 private:
  template <typename Observable, typename... Items>
  void fire(const Observable& observable, const Items&... items) const {
    if (!m_isOn) return;
    const std::lock_guard<std::mutex> lock(m_mutex);
    observable.notify(items...);
  }

  mutable std::mutex m_mutex;
  bool m_isOn = true;
  ItemObservable m_entityCreated;
  ItemObservable m_entityDestroyed;
  ItemObservable m_componentCreated;
  ItemObservable m_componentDestroyed;
  ItemObservable m_renderObjectCreated;
  ItemObservable m_renderObjectDestroyed;
  FrameObservable m_endFrame;
};

}  // namespace Scene
}  // namespace Engine
}  // namespace Ra
