#include <Core/Utils/Log.hpp>
#include <Engine/RadiumEngine.hpp>
#include <Engine/Rendering/RenderObject.hpp>
#include <Engine/Rendering/RenderObjectManager.hpp>
#include <Engine/Scene/EntityManager.hpp>
#include <Engine/Scene/SignalManager.hpp>
#include <Engine/Scene/SystemDisplay.hpp>
#include <algorithm>
#include <stdexcept>

namespace Ra {
namespace Engine {
namespace Scene {

namespace {

template <typename Components>
auto find_component(Components& components, const std::string& name) {
  return std::find_if(components.begin(), components.end(),
                      [&name](const auto& component) { return component->getName() == name; });
}

SignalManager& signals() {
  return *RadiumEngine::getInstance()->getSignalManager();
}

}  // namespace

Entity::Entity(const std::string& name)
    : m_transform(Core::Transform::Identity()),
      m_doubleBufferedTransform(Core::Transform::Identity()),
      m_name(name) {}

Entity::~Entity() {
  m_transformationObservers.detachAll();
  m_components.clear();
  signals().fireEntityDestroyed(ItemEntry(this));
}

void Entity::setTransform(const Core::Transform& transform) {
  m_transformChanged = true;
  m_doubleBufferedTransform = transform;
}

const Core::Transform& Entity::getTransform() const {
  const std::lock_guard<std::mutex> lock(m_transformMutex);
  return m_transform;
}

// The bounding boxes stay as they were, as in Radium.
void Entity::swapTransformBuffers() {
  if (!m_transformChanged) return;
  m_transform = m_doubleBufferedTransform;
  m_transformChanged = false;
  m_transformationObservers.notify(this);
}

void Entity::addComponent(Component* component) {
  m_components.emplace_back(component);
  component->setEntity(this);
  signals().fireComponentAdded(ItemEntry(this, component));
  m_isAabbValid = false;
}

void Entity::removeComponent(const std::string& name) {
  const auto found = find_component(m_components, name);
  if (found == m_components.end()) throw std::out_of_range("no component " + name);
  m_components.erase(found);
  m_isAabbValid = false;
}

Component* Entity::getComponent(const std::string& name) {
  const auto found = find_component(m_components, name);
  return found == m_components.end() ? nullptr : found->get();
}

const Component* Entity::getComponent(const std::string& name) const {
  const auto found = find_component(m_components, name);
  return found == m_components.end() ? nullptr : found->get();
}

Core::Aabb Entity::computeAabb() {
  if (m_isAabbValid) return m_aabb;
  m_aabb.setEmpty();
  for (const auto& component : m_components) m_aabb.extend(component->computeAabb());
  m_isAabbValid = true;
  return m_aabb;
}

RA_SINGLETON_IMPLEMENTATION(SystemEntity);

// The entity owns its components.
SystemEntity::SystemEntity() : Entity("System Display Entity") {
  new UiComponent(this);
  new DebugComponent(this);
}

UiComponent* SystemEntity::uiCmp() {
  return static_cast<UiComponent*>(getInstance()->getComponent("UI"));
}

DebugComponent* SystemEntity::dbgCmp() {
  return static_cast<DebugComponent*>(getInstance()->getComponent("Debug"));
}

Rendering::RenderObject* DebugComponent::getRenderObject(Core::Utils::Index idx) {
  return getRoMgr()->getRenderObject(idx).get();
}

EntityManager::EntityManager() {
  Entity* entity = SystemEntity::createInstance();
  entity->setIndex(m_entities.insert(std::unique_ptr<Entity>(entity)));
  m_entitiesName.emplace(entity->getName(), entity->getIndex());
  signals().fireEntityCreated(ItemEntry(entity));
}

// The singleton owns entity 0 too, and is the one to destroy it.
EntityManager::~EntityManager() {
  static_cast<void>(m_entities[0].release());
  SystemEntity::destroyInstance();
}

Entity* EntityManager::createEntity(const std::string& name) {
  const Core::Utils::Index idx = m_entities.insert(std::make_unique<Entity>(name));
  Entity* entity = m_entities[idx].get();
  entity->setIndex(idx);
  std::string free_name = name.empty() ? "Entity_" + std::to_string(idx.getValue()) : name;
  for (int i = 1; !name.empty() && entityExists(free_name); ++i) {
    LOG(Core::Utils::logWARNING) << "an entity " << free_name << " is there already";
    free_name = name + "_" + std::to_string(i);
  }
  entity->rename(free_name);
  m_entitiesName.emplace(free_name, idx);
  signals().fireEntityCreated(ItemEntry(entity));
  return entity;
}

// The name goes last: it exists while the signals of the destruction are given.
void EntityManager::removeEntity(Core::Utils::Index idx) {
  const std::string name = m_entities[idx]->getName();
  m_entities.remove(idx);
  m_entitiesName.erase(name);
}

void EntityManager::removeEntity(Entity* entity) {
  removeEntity(entity->getIndex());
}

void EntityManager::deleteEntities() {
  while (m_entities.size() > 1) removeEntity(m_entities.index(1));
}

Entity* EntityManager::getEntity(Core::Utils::Index idx) const {
  return m_entities.contains(idx) ? m_entities[idx].get() : nullptr;
}

Entity* EntityManager::getEntity(const std::string& name) const {
  const auto found = m_entitiesName.find(name);
  return found == m_entitiesName.end() ? nullptr : m_entities[found->second].get();
}

std::vector<Entity*> EntityManager::getEntities() const {
  std::vector<Entity*> all;
  for (const auto& entity : m_entities) all.push_back(entity.get());
  return all;
}

void EntityManager::swapBuffers() {
  for (const auto& entity : m_entities) entity->swapTransformBuffers();
}

bool ItemEntry::isValid() const {
  const RadiumEngine* engine = RadiumEngine::getInstance();
  const EntityManager* entities = engine->getEntityManager();
  if (!m_entity || !entities || !entities->entityExists(m_entity->getName())) return false;
  return !isRoNode() || engine->getRenderObjectManager()->exists(m_roIndex);
}

bool ItemEntry::isSelectable() const {
  if (m_entity->getIndex() == SystemEntity::getInstance()->getIndex()) return false;
  if (!isRoNode()) return true;
  const auto object = RadiumEngine::getInstance()->getRenderObjectManager()->getRenderObject(m_roIndex);
  return object->getType() == Rendering::RenderObjectType::Geometry;
}

std::string getEntryName(const Engine::RadiumEngine* engine, const ItemEntry& ent) {
  if (!ent.isValid()) return "Invalid Entry";
  if (ent.isRoNode()) return engine->getRenderObjectManager()->getRenderObject(ent.m_roIndex)->getName();
  return ent.isComponentNode() ? ent.m_component->getName() : ent.m_entity->getName();
}

std::vector<Core::Utils::Index> getItemROs(const Engine::RadiumEngine* /*engine*/, const ItemEntry& ent) {
  if (!ent.isValid()) return {};
  if (ent.isRoNode()) return {ent.m_roIndex};
  if (ent.isComponentNode()) return ent.m_component->m_renderObjects;
  std::vector<Core::Utils::Index> all;
  for (const auto& component : ent.m_entity->getComponents()) {
    const auto& some = component->m_renderObjects;
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace Scene
}  // namespace Engine
}  // namespace Ra
