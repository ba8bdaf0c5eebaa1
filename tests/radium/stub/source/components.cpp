#include <Core/Asset/MaterialData.hpp>
#include <Engine/RadiumEngine.hpp>
#include <Engine/Rendering/RenderObjectManager.hpp>
#include <Engine/Scene/GeometryComponent.hpp>
#include <Engine/Scene/SignalManager.hpp>
#include <Engine/Scene/System.hpp>
#include <algorithm>
#include <cstdlib>

namespace Ra {
namespace Engine {
namespace Scene {

void System::registerComponent(const Entity* entity, Component* component) {
  m_components.emplace_back(entity, component);
  component->setSystem(this);
}

void System::unregisterComponent(const Entity* /*entity*/, Component* component) {
  component->setSystem(nullptr);
  const auto is_it = [component](const auto& entry) { return entry.second == component; };
  const auto found = std::find_if(m_components.begin(), m_components.end(), is_it);
  if (found != m_components.end()) m_components.erase(found);
}

void System::unregisterAllComponents(const Entity* entity) {
  const auto is_of = [entity](const auto& entry) { return entry.first == entity; };
  m_components.erase(std::remove_if(m_components.begin(), m_components.end(), is_of), m_components.end());
}

std::vector<Component*> System::getEntityComponents(const Entity* entity) {
  std::vector<Component*> found;
  for (const auto& entry : m_components) {
    if (entry.first == entity) found.push_back(entry.second);
  }
  return found;
}

Component::Component(const std::string& name, Entity* entity) : m_name(name), m_entity(entity) {
  m_entity->addComponent(this);
}

Component::~Component() {
  for (const auto& index : m_renderObjects) getRoMgr()->removeRenderObject(index);
  // This part of the object is all that is left: what the derived one overrides is not called.
  Entity* entity = Component::getEntity();
  if (m_system) m_system->unregisterComponent(entity, this);
  RadiumEngine::getInstance()->getSignalManager()->fireComponentRemoved(ItemEntry(entity, this));
}

Rendering::RenderObjectManager* Component::getRoMgr() {
  return RadiumEngine::getInstance()->getRenderObjectManager();
}

Core::Utils::Index Component::addRenderObject(Rendering::RenderObject* renderObject) {
  m_renderObjects.push_back(getRoMgr()->addRenderObject(renderObject));
  invalidateAabb();
  return m_renderObjects.back();
}

void Component::removeRenderObject(const Core::Utils::Index& roIdx) {
  const auto found = std::find(m_renderObjects.begin(), m_renderObjects.end(), roIdx);
  if (found != m_renderObjects.end() && getRoMgr()) {
    getRoMgr()->removeRenderObject(*found);
    m_renderObjects.erase(found);
  }
  invalidateAabb();
}

void Component::notifyRenderObjectExpired(const Core::Utils::Index& idx) {
  const auto found = std::find(m_renderObjects.begin(), m_renderObjects.end(), idx);
  if (found != m_renderObjects.end()) m_renderObjects.erase(found);
}

Core::Aabb Component::computeAabb() {
  if (m_isAabbValid) return m_aabb;
  m_aabb.setEmpty();
  for (const auto& index : m_renderObjects) {
    const auto object = getRoMgr()->getRenderObject(index);
    if (object->isVisible()) m_aabb.extend(object->computeAabb());
  }
  m_isAabbValid = true;
  return m_aabb;
}

void Component::invalidateAabb() {
  m_isAabbValid = false;
  m_entity->invalidateAabb();
}

namespace {

std::shared_ptr<Data::Material> material_of(const Core::Asset::MaterialData& data) {
  std::shared_ptr<Data::Material> material(
      Data::EngineMaterialConverters::getMaterialConverter(data.getType()).second(&data));
  // Radium would go on with a null pointer.
  if (!material) std::abort();
  return material;
}

std::shared_ptr<Data::Material> gray_material(const std::string& name,
                                              const Data::AttribArrayDisplayable& mesh) {
  auto material = std::make_shared<Data::BlinnPhongMaterial>(name + "_DefaultBPMaterial");
  material->m_renderAsSplat = mesh.getNumFaces() == 0;
  const std::string& color = Core::Geometry::getAttribName(Core::Geometry::VERTEX_COLOR);
  material->m_perVertexColor = mesh.getAttribArrayGeometry().hasAttrib(color);
  return material;
}

}  // namespace

void GeometryComponent::show(const std::shared_ptr<Data::AttribArrayDisplayable>& mesh,
                             const Core::Asset::MaterialData* material) {
  const std::shared_ptr<Data::Material> shown =
      material ? material_of(*material) : gray_material(m_contentName, *mesh);
  auto* object = Rendering::RenderObject::createRenderObject(m_name + "_" + m_contentName + "_RO", this,
                                                             Rendering::RenderObjectType::Geometry, mesh);
  object->setTransparent(shown->isTransparent());
  object->setMaterial(shown);
  m_roIndex = addRenderObject(object);
}

PointCloudComponent::PointCloudComponent(const std::string& name, Entity* entity,
                                         Core::Geometry::PointCloud&& mesh, Core::Asset::MaterialData* mat)
    : GeometryComponent(name, entity),
      m_displayMesh(std::make_shared<Data::PointCloud>(name, std::move(mesh))) {
  show(m_displayMesh, mat);
}

}  // namespace Scene
}  // namespace Engine
}  // namespace Ra
