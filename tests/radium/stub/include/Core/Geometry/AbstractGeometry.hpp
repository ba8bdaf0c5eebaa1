#pragma once

#include <Core/Types.hpp>
#include <Core/Utils/Observable.hpp>

namespace Ra {
namespace Core {
namespace Geometry {

/// Something with a bounding box, which is kept until it is said to be stale.
struct AbstractGeometry {
  AbstractGeometry() = default;
  // As in Radium, a copy takes those who observe the box along: they hear of the copy too.
  AbstractGeometry(const AbstractGeometry& other) : m_isAabbValid(other.m_isAabbValid), m_aabb(other.m_aabb) {
    other.m_aabbObservable.copyObserversTo(m_aabbObservable);
  }
  AbstractGeometry& operator=(const AbstractGeometry&) = delete;
  virtual ~AbstractGeometry() = default;

  virtual void clear() = 0;
  virtual Aabb computeAabb() const = 0;

  Utils::ObservableVoid& getAabbObservable() { return m_aabbObservable; }

 protected:
  bool isAabbValid() const { return m_isAabbValid; }
  Aabb getAabb() const { return m_aabb; }
  void setAabb(const Aabb& aabb) const {
    m_aabb = aabb;
    m_isAabbValid = true;
  }
  void invalidateAabb() const {
    m_isAabbValid = false;
    m_aabbObservable.notify();
  }

 private:
  mutable bool m_isAabbValid = false;
  mutable Aabb m_aabb;
  Utils::ObservableVoid m_aabbObservable;
};

}  // namespace Geometry
}  // namespace Core
}  // namespace Ra
