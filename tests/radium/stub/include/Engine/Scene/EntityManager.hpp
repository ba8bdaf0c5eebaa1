#pragma once

#include <Core/Utils/IndexMap.hpp>
#include <Engine/RaEngine.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace Ra {
namespace Engine {
namespace Scene {

class Entity;

/// The entities; number 0 is the system's own.
class EntityManager {
 public:
  EntityManager();
  EntityManager(const EntityManager&) = delete;
  EntityManager& operator=(const EntityManager&) = delete;
  virtual ~EntityManager();

  /// A name that is taken gets _1, _2, ...; an empty one becomes Entity_ and the number.
  Entity* createEntity(const std::string& name = "");
  bool entityExists(const std::string& name) const { return m_entitiesName.count(name) > 0; }

  /// Throws std::out_of_range if there is no such entity; Radium's behavior is undefined.
  void removeEntity(Core::Utils::Index idx);
  void removeEntity(Entity* entity);
  /// All but the system's own.
  void deleteEntities();

  /// nullptr if there is none.
  Entity* getEntity(Core::Utils::Index idx) const;
  Entity* getEntity(const std::string& name) const;
  std::vector<Entity*> getEntities() const;

  void swapBuffers();

 private:
  Core::Utils::IndexMap<std::unique_ptr<Entity>> m_entities;
  std::map<std::string, Core::Utils::Index> m_entitiesName;
};

}  // namespace Scene
}  // namespace Engine
}  // namespace Ra
