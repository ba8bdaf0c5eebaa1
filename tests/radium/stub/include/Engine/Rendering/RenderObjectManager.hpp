#pragma once

#include <Core/Types.hpp>
#include <Core/Utils/Index.hpp>
#include <Core/Utils/IndexMap.hpp>
#include <Engine/RaEngine.hpp>
#include <Engine/Rendering/RenderObjectTypes.hpp>
#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace Ra {
namespace Engine {
namespace Rendering {

class RenderObject;

class RenderObjectManager final {
 public:
  RenderObjectManager();
  ~RenderObjectManager();

  /// Takes the object. The signal is given with the lock held: getRenderObjectsByType in a callback waits for
  /// ever.
  Core::Utils::Index addRenderObject(RenderObject* renderObject);
  /// Throws std::out_of_range if there is none, as the next one.
  void removeRenderObject(const Core::Utils::Index& index);
  std::shared_ptr<RenderObject> getRenderObject(const Core::Utils::Index& index);
  bool exists(const Core::Utils::Index& index) const;

  std::size_t getRenderObjectsCount() { return m_renderObjects.size(); }
  const Core::Utils::IndexMap<std::shared_ptr<RenderObject>>& getRenderObjects() const {
    return m_renderObjects;
  }
  /// Appends, in the order of the indices.
  void getRenderObjectsByType(std::vector<std::shared_ptr<RenderObject>>& objectsOut,
                              const RenderObjectType& type) const;
  void renderObjectExpired(const Core::Utils::Index& idx);

  /// Of the geometry that is visible.
  std::size_t getNumFaces() const;
  std::size_t getNumVertices() const;

 private:
  Core::Utils::IndexMap<std::shared_ptr<RenderObject>> m_renderObjects;
  mutable std::mutex m_doubleBufferMutex;
};

}  // namespace Rendering
}  // namespace Engine
}  // namespace Ra
