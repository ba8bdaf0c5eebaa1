#pragma once

#include <Core/Containers/VectorArray.hpp>
#include <Core/Geometry/TriangleMesh.hpp>
#include <Core/Types.hpp>
#include <Core/Utils/Observable.hpp>
#include <memory>
#include <stdexcept>
#include <utility>

namespace Ra {
namespace Core {
namespace Geometry {

/// Faces over the vertices. Whoever observes hears when the faces change.
/// What was moved from, or cleared, has no faces to ask for: that throws std::out_of_range.
template <typename T>
class IndexedGeometry : public AttribArrayGeometry, public Utils::ObservableVoid {
 public:
  using IndexType = T;
  using IndexContainerType = VectorArray<T>;

  IndexedGeometry() : m_indices(std::make_unique<IndexContainerType>()) {}
  IndexedGeometry(const IndexedGeometry& other)
      : AttribArrayGeometry(other), ObservableVoid(), m_indices(copy_of(other)) {}
  IndexedGeometry(IndexedGeometry&& other) noexcept
      : AttribArrayGeometry(std::move(other)), ObservableVoid(), m_indices(std::move(other.m_indices)) {}
  IndexedGeometry& operator=(const IndexedGeometry& other) {
    if (this == &other) return *this;
    AttribArrayGeometry::operator=(other);
    m_indices = copy_of(other);
    notify();
    return *this;
  }
  IndexedGeometry& operator=(IndexedGeometry&& other) noexcept {
    AttribArrayGeometry::operator=(std::move(other));
    m_indices = std::move(other.m_indices);
    notify();
    return *this;
  }
  // As in Radium, those who observe the box hear of the end: also of the end of a copy.
  ~IndexedGeometry() override {
    detachAll();
    AttribArrayGeometry::clear();
  }

  void clear() override {
    AttribArrayGeometry::clear();
    m_indices.reset();
    notify();
  }

  const IndexContainerType& getIndices() const { return faces(); }
  IndexContainerType& getIndicesWithLock() { return faces(); }
  void indicesUnlock() { notify(); }
  void setIndices(IndexContainerType&& indices) {
    faces() = std::move(indices);
    notify();
  }
  void setIndices(const IndexContainerType& indices) {
    faces() = indices;
    notify();
  }

 private:
  static std::unique_ptr<IndexContainerType> copy_of(const IndexedGeometry& other) {
    return other.m_indices ? std::make_unique<IndexContainerType>(*other.m_indices) : nullptr;
  }
  IndexContainerType& faces() const {
    if (!m_indices) throw std::out_of_range("no faces: moved from, or cleared");
    return *m_indices;
  }

  std::unique_ptr<IndexContainerType> m_indices;
};

class TriangleMesh : public IndexedGeometry<Vector3ui> {};
class QuadMesh : public IndexedGeometry<Vector4ui> {};
class PolyMesh : public IndexedGeometry<VectorNui> {};

}  // namespace Geometry
}  // namespace Core
}  // namespace Ra
