#pragma once

#include <Core/Utils/Index.hpp>
#include <Engine/RaEngine.hpp>
#include <string>
#include <vector>

namespace Ra {
namespace Engine {

class RadiumEngine;

namespace Scene {

class Component;
class Entity;

/// An entity; or a component, with its entity; or a render object, with both.
struct ItemEntry {
  ItemEntry() = default;
  explicit ItemEntry(Entity* ent, Component* comp = nullptr,
                     Core::Utils::Index ro = Core::Utils::Index::Invalid())
      : m_entity(ent), m_component(comp), m_roIndex(ro) {}

  bool operator==(const ItemEntry& rhs) const {
    return m_entity == rhs.m_entity && m_component == rhs.m_component && m_roIndex == rhs.m_roIndex;
  }

  bool isValid() const;
  bool isSelectable() const;
  bool isEntityNode() const { return m_entity && !m_component; }
  bool isComponentNode() const { return m_entity && m_component && m_roIndex.isInvalid(); }
  bool isRoNode() const { return m_entity && m_component && m_roIndex.isValid(); }

  Entity* m_entity = nullptr;
  Component* m_component = nullptr;
  Core::Utils::Index m_roIndex;
};

std::string getEntryName(const Engine::RadiumEngine* engine, const ItemEntry& ent);
std::vector<Core::Utils::Index> getItemROs(const Engine::RadiumEngine* engine, const ItemEntry& ent);

}  // namespace Scene
}  // namespace Engine
}  // namespace Ra
