#pragma once

#include <Core/Utils/Index.hpp>

namespace Ra {
namespace Core {
namespace Utils {

class IndexedObject {
 public:
  explicit IndexedObject(Index idx = Index::Invalid()) : m_idx(idx) {}
  IndexedObject(const IndexedObject&) = default;
  virtual ~IndexedObject() = default;

  void setIndex(const Index& idx) { m_idx = idx; }
  const Index& getIndex() const { return m_idx; }

 protected:
  Index m_idx;
};

}  // namespace Utils
}  // namespace Core
}  // namespace Ra
