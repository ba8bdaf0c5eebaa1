#pragma once

#include <Core/Types.hpp>
#include <Core/Utils/IndexedObject.hpp>
#include <Engine/RaEngine.hpp>
#include <Engine/Rendering/RenderObjectTypes.hpp>
#include <Engine/Rendering/RenderTechnique.hpp>
#include <memory>
#include <string>

namespace Ra {
namespace Engine {
namespace Scene {
class Component;
}
namespace Data {
class Displayable;
class Material;
}  // namespace Data
namespace Rendering {

/// What is drawn of a component: a mesh, a material, and where.
class RenderObject final : public Core::Utils::IndexedObject {
 public:
  /// A lifetime in frames, or without end if not positive.
  RenderObject(const std::string& name, Scene::Component* comp, const RenderObjectType& type,
               int lifetime = -1);
  RenderObject(const RenderObject&) = delete;
  RenderObject& operator=(const RenderObject&) = delete;
  ~RenderObject() override;

  static RenderObject* createRenderObject(
      const std::string& name, Scene::Component* comp, const RenderObjectType& type,
      std::shared_ptr<Data::Displayable> mesh,
      const RenderTechnique& techniqueConfig = RenderTechnique::createDefaultRenderTechnique());

  void updateGL();

  const std::string& getName() const { return m_name; }
  const Scene::Component* getComponent() const { return m_component; }
  Scene::Component* getComponent() { return m_component; }
  const RenderObjectType& getType() const { return m_type; }
  void setType(const RenderObjectType& type) { m_type = type; }

  void setVisible(bool visible) { m_visible = visible; }
  void toggleVisible() { m_visible = !m_visible; }
  bool isVisible() const { return m_visible; }
  void setPickable(bool pickable) { m_pickable = pickable; }
  void togglePickable() { m_pickable = !m_pickable; }
  bool isPickable() const { return m_pickable; }
  void setXRay(bool xray) { m_xray = xray; }
  void toggleXRay() { m_xray = !m_xray; }
  bool isXRay() const { return m_xray; }
  void setTransparent(bool transparent) { m_transparent = transparent; }
  void toggleTransparent() { m_transparent = !m_transparent; }
  bool isTransparent() const { return m_transparent; }
  void setColoredByVertexAttrib(bool state);
  bool isColoredByVertexAttrib() const;
  bool isDirty() const { return m_dirty; }

  void setRenderTechnique(std::shared_ptr<RenderTechnique> technique);
  std::shared_ptr<const RenderTechnique> getRenderTechnique() const { return m_renderTechnique; }
  std::shared_ptr<RenderTechnique> getRenderTechnique() { return m_renderTechnique; }
  void setMaterial(std::shared_ptr<Data::Material> material);
  std::shared_ptr<const Data::Material> getMaterial() const { return m_material; }
  std::shared_ptr<Data::Material> getMaterial() { return m_material; }
  void setMesh(std::shared_ptr<Data::Displayable> mesh);
  std::shared_ptr<const Data::Displayable> getMesh() const { return m_mesh; }
  const std::shared_ptr<Data::Displayable>& getMesh() { return m_mesh; }

  /// The entity's transform times the local one.
  Core::Transform getTransform() const;
  Core::Matrix4 getTransformAsMatrix() const { return getTransform().matrix(); }
  void setLocalTransform(const Core::Transform& transform);
  void setLocalTransform(const Core::Matrix4& transform) { setLocalTransform(Core::Transform(transform)); }
  const Core::Transform& getLocalTransform() const { return m_localTransform; }
  const Core::Matrix4& getLocalTransformAsMatrix() const { return m_localTransform.matrix(); }

  /// In the world. As in Radium, it stays what it was when only the entity moves.
  Core::Aabb computeAabb();
  void invalidateAabb();

  void setLifetime(int frames);
  void hasBeenRenderedOnce();
  void hasExpired();

 private:
  Core::Transform m_localTransform = Core::Transform::Identity();
  Scene::Component* m_component;
  std::string m_name;
  RenderObjectType m_type;
  std::shared_ptr<RenderTechnique> m_renderTechnique;
  std::shared_ptr<Data::Displayable> m_mesh;
  std::shared_ptr<Data::Material> m_material;
  int m_lifetime;
  bool m_visible = true;
  bool m_pickable = true;
  bool m_xray = false;
  bool m_transparent = false;
  bool m_dirty = true;
  bool m_hasLifetime;
  bool m_isAabbValid = false;
  Core::Aabb m_aabb;
  int m_aabbObserverIndex = -1;
};

}  // namespace Rendering
}  // namespace Engine
}  // namespace Ra
