#include <Engine/Data/DisplayableObject.hpp>
#include <Engine/Data/Material.hpp>
#include <Engine/RadiumEngine.hpp>
#include <Engine/Rendering/RenderObject.hpp>
#include <Engine/Rendering/RenderObjectManager.hpp>
#include <Engine/Scene/Component.hpp>
#include <Engine/Scene/Entity.hpp>
#include <Engine/Scene/SignalManager.hpp>
#include <utility>

namespace Ra {
namespace Engine {
namespace Rendering {

RenderObject::RenderObject(const std::string& name, Scene::Component* comp, const RenderObjectType& type,
                           int lifetime)
    : m_component(comp), m_name(name), m_type(type), m_lifetime(lifetime), m_hasLifetime(lifetime > 0) {}

RenderObject::~RenderObject() {
  if (m_mesh) m_mesh->getAbstractGeometry().getAabbObservable().detach(m_aabbObserverIndex);
}

RenderObject* RenderObject::createRenderObject(const std::string& name, Scene::Component* comp,
                                               const RenderObjectType& type,
                                               std::shared_ptr<Data::Displayable> mesh,
                                               const RenderTechnique& techniqueConfig) {
  auto object = std::make_unique<RenderObject>(name, comp, type);
  object->setMesh(std::move(mesh));
  object->setRenderTechnique(std::make_shared<RenderTechnique>(techniqueConfig));
  return object.release();
}

void RenderObject::updateGL() {
  if (m_mesh) m_mesh->updateGL();
  m_dirty = false;
}

void RenderObject::setColoredByVertexAttrib(bool state) {
  if (m_material) m_material->setColoredByVertexAttrib(state);
}

bool RenderObject::isColoredByVertexAttrib() const {
  return m_material && m_material->isColoredByVertexAttrib();
}

void RenderObject::setRenderTechnique(std::shared_ptr<RenderTechnique> technique) {
  m_renderTechnique = std::move(technique);
}

void RenderObject::setMaterial(std::shared_ptr<Data::Material> material) {
  m_material = std::move(material);
}

void RenderObject::setMesh(std::shared_ptr<Data::Displayable> mesh) {
  if (m_mesh) m_mesh->getAbstractGeometry().getAabbObservable().detach(m_aabbObserverIndex);
  m_mesh = std::move(mesh);
  if (!m_mesh) return;
  m_aabbObserverIndex =
      m_mesh->getAbstractGeometry().getAabbObservable().attach([this]() { invalidateAabb(); });
  invalidateAabb();
}

Core::Transform RenderObject::getTransform() const {
  return m_component->getEntity()->getTransform() * m_localTransform;
}

void RenderObject::setLocalTransform(const Core::Transform& transform) {
  m_localTransform = transform;
  invalidateAabb();
}

Core::Aabb RenderObject::computeAabb() {
  if (m_isAabbValid) return m_aabb;
  const Core::Aabb local = m_mesh->getAbstractGeometry().computeAabb();
  m_aabb.setEmpty();
  if (!local.isEmpty()) {
    const Core::Transform to_world = getTransform();
    for (int corner = 0; corner < 8; ++corner) {
      m_aabb.extend(to_world * local.corner(static_cast<Core::Aabb::CornerType>(corner)));
    }
  }
  m_isAabbValid = true;
  return m_aabb;
}

void RenderObject::invalidateAabb() {
  m_isAabbValid = false;
  m_component->invalidateAabb();
}

void RenderObject::setLifetime(int frames) {
  m_lifetime = frames;
  m_hasLifetime = true;
}

void RenderObject::hasBeenRenderedOnce() {
  if (m_hasLifetime && --m_lifetime <= 0) {
    RadiumEngine::getInstance()->getRenderObjectManager()->renderObjectExpired(m_idx);
  }
}

void RenderObject::hasExpired() {
  m_component->notifyRenderObjectExpired(m_idx);
}

RenderObjectManager::RenderObjectManager() = default;
RenderObjectManager::~RenderObjectManager() = default;

Core::Utils::Index RenderObjectManager::addRenderObject(RenderObject* renderObject) {
  const std::lock_guard<std::mutex> lock(m_doubleBufferMutex);
  const Core::Utils::Index index = m_renderObjects.insert(std::shared_ptr<RenderObject>(renderObject));
  renderObject->setIndex(index);
  Scene::Component* component = renderObject->getComponent();
  RadiumEngine::getInstance()->getSignalManager()->fireRenderObjectAdded(
      Scene::ItemEntry(component->getEntity(), component, index));
  return index;
}

void RenderObjectManager::removeRenderObject(const Core::Utils::Index& index) {
  const std::shared_ptr<RenderObject> object = m_renderObjects.at(index);
  Scene::Component* component = object->getComponent();
  RadiumEngine::getInstance()->getSignalManager()->fireRenderObjectRemoved(
      Scene::ItemEntry(component->getEntity(), component, index));
  const std::lock_guard<std::mutex> lock(m_doubleBufferMutex);
  m_renderObjects.remove(index);
}

void RenderObjectManager::renderObjectExpired(const Core::Utils::Index& idx) {
  const std::lock_guard<std::mutex> lock(m_doubleBufferMutex);
  const std::shared_ptr<RenderObject> object = m_renderObjects.at(idx);
  m_renderObjects.remove(idx);
  object->hasExpired();
}

std::shared_ptr<RenderObject> RenderObjectManager::getRenderObject(const Core::Utils::Index& index) {
  return m_renderObjects.at(index);
}

bool RenderObjectManager::exists(const Core::Utils::Index& index) const {
  return index.isValid() && m_renderObjects.contains(index);
}

void RenderObjectManager::getRenderObjectsByType(std::vector<std::shared_ptr<RenderObject>>& objectsOut,
                                                 const RenderObjectType& type) const {
  const std::lock_guard<std::mutex> lock(m_doubleBufferMutex);
  for (const auto& object : m_renderObjects) {
    if (object->getType() == type) objectsOut.push_back(object);
  }
}

std::size_t RenderObjectManager::getNumFaces() const {
  std::size_t sum = 0;
  for (const auto& object : m_renderObjects) {
    const bool counts = object->isVisible() && object->getType() == RenderObjectType::Geometry;
    if (counts) sum += object->getMesh()->getNumFaces();
  }
  return sum;
}

std::size_t RenderObjectManager::getNumVertices() const {
  std::size_t sum = 0;
  for (const auto& object : m_renderObjects) {
    const bool counts = object->isVisible() && object->getType() == RenderObjectType::Geometry;
    if (counts) sum += object->getMesh()->getNumVertices();
  }
  return sum;
}

}  // namespace Rendering
}  // namespace Engine
}  // namespace Ra
