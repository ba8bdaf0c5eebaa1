#pragma once

// As much of Radium Engine 1.5 as plugins/radium and its tests use: no Qt, no OpenGL, no files. Names and behavior are
// Radium's, whose documentation stands for both. Every header of Radium that they include leads here (stub.cmake).

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

using uint = unsigned int;
using Scalar = float;

namespace Ra::Core {

using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
using Vector4 = Eigen::Matrix<Scalar, 4, 1>;
using Matrix4 = Eigen::Matrix<Scalar, 4, 4>;
using Vector3ui = Eigen::Matrix<uint, 3, 1>;
using Vector4ui = Eigen::Matrix<uint, 4, 1>;
using VectorNui = Eigen::Matrix<uint, Eigen::Dynamic, 1>;
using AngleAxis = Eigen::AngleAxis<Scalar>;
using Transform = Eigen::Transform<Scalar, 3, Eigen::Affine>;
using Ray = Eigen::ParametrizedLine<Scalar, 3>;
using Aabb = Eigen::AlignedBox<Scalar, 3>;

template <typename V>
using VectorArray = std::vector<V, Eigen::aligned_allocator<V>>;
using Vector3Array = VectorArray<Vector3>;

class FunctionTask {
 public:
  FunctionTask(std::function<void()> f, const std::string& /*name*/) : m_f(std::move(f)) {}
  void process() { m_f(); }

 private:
  std::function<void()> m_f;
};

class TaskQueue {
 public:
  explicit TaskQueue(uint /*numThreads*/) {}
  void registerTask(std::unique_ptr<FunctionTask> task) { m_tasks.push_back(std::move(task)); }
  void runTasksInThisThread() {
    for (const auto& task : m_tasks) task->process();
    m_tasks.clear();
  }

 private:
  std::vector<std::unique_ptr<FunctionTask>> m_tasks;
};

namespace Asset {
class MaterialData;
}

namespace Utils {

class Index {
 public:
  Index(int value = -1) : m_idx(value) {}
  bool isInvalid() const { return m_idx < 0; }
  int getValue() const { return m_idx; }
  operator int() const { return m_idx; }

 private:
  int m_idx;
};

class Color : public Vector4 {
 public:
  Color(float r, float g, float b, float alpha = 1) : Vector4(r, g, b, alpha) {}
};

template <typename T>
class Attrib {
 public:
  const VectorArray<T>& data() const { return m_data; }
  void setData(const VectorArray<T>& data) { m_data = data; }

 private:
  VectorArray<T> m_data;
};

template <typename T>
struct AttribHandle {
  std::string name;
};

}  // namespace Utils

namespace Geometry {

enum MeshAttrib : uint { VERTEX_COLOR };

inline std::string getAttribName(MeshAttrib /*index*/) {
  return "in_color";
}

class AttribArrayGeometry {
 public:
  virtual ~AttribArrayGeometry() = default;

  const Vector3Array& vertices() const { return m_vertices; }
  const Vector3Array& normals() const { return m_normals; }
  void setVertices(const Vector3Array& vertices) { m_vertices = vertices; }
  void setNormals(const Vector3Array& normals) { m_normals = normals; }

  template <typename T>
  Utils::AttribHandle<T> addAttrib(const std::string& name, const VectorArray<T>& data) {
    static_assert(std::is_same_v<T, Vector4>, "attributes are colors");
    m_attribs[name].setData(data);
    return {name};
  }
  template <typename T>
  Utils::AttribHandle<T> getAttribHandle(const std::string& name) const {
    return {name};
  }
  template <typename T>
  const Utils::Attrib<T>& getAttrib(const Utils::AttribHandle<T>& handle) const {
    return m_attribs.at(handle.name);
  }
  bool hasAttrib(const std::string& name) const { return m_attribs.count(name) > 0; }

 private:
  Vector3Array m_vertices;
  Vector3Array m_normals;
  std::map<std::string, Utils::Attrib<Vector4>> m_attribs;
};

class PointCloud : public AttribArrayGeometry {};

template <typename T>
class IndexedGeometry : public AttribArrayGeometry {
 public:
  const VectorArray<T>& getIndices() const { return m_indices; }
  void setIndices(VectorArray<T>&& indices) { m_indices = std::move(indices); }

 private:
  VectorArray<T> m_indices;
};

using TriangleMesh = IndexedGeometry<Vector3ui>;
using QuadMesh = IndexedGeometry<Vector4ui>;
using PolyMesh = IndexedGeometry<VectorNui>;

}  // namespace Geometry
}  // namespace Ra::Core

namespace Ra::Engine {

struct FrameInfo {
  Scalar m_animationTime = 0;
  Scalar m_dt = 0;
};

namespace Data {

class Displayable {
 public:
  virtual ~Displayable() = default;
};

class AttribArrayDisplayable : public Displayable {
 public:
  virtual const Core::Geometry::AttribArrayGeometry& getAttribArrayGeometry() const = 0;
  virtual Core::Geometry::AttribArrayGeometry& getAttribArrayGeometry() = 0;
};

template <typename T>
class CoreGeometryDisplayable : public AttribArrayDisplayable {
 public:
  explicit CoreGeometryDisplayable(T&& mesh) : m_mesh(std::move(mesh)) {}
  const Core::Geometry::AttribArrayGeometry& getAttribArrayGeometry() const override { return m_mesh; }
  Core::Geometry::AttribArrayGeometry& getAttribArrayGeometry() override { return m_mesh; }
  const T& getCoreGeometry() const { return m_mesh; }

 private:
  T m_mesh;
};

using PointCloud = CoreGeometryDisplayable<Core::Geometry::PointCloud>;
using Mesh = CoreGeometryDisplayable<Core::Geometry::TriangleMesh>;
using QuadMesh = CoreGeometryDisplayable<Core::Geometry::QuadMesh>;
using PolyMesh = CoreGeometryDisplayable<Core::Geometry::PolyMesh>;

class Material {
 public:
  virtual ~Material() = default;
};

class BlinnPhongMaterial final : public Material {
 public:
  Core::Utils::Color m_kd{0.7f, 0.7f, 0.7f};
  Core::Utils::Color m_ks{0.3f, 0.3f, 0.3f};
  bool m_perVertexColor = false;
};

}  // namespace Data

namespace Rendering {
class RenderObject;
}

namespace Scene {

class Entity;
class System;

/// A part of an entity, which owns it from its construction on.
class Component {
 public:
  Component(const std::string& name, Entity* entity);
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;
  virtual ~Component();

  virtual void initialize() = 0;
  const std::string& getName() const { return m_name; }
  Entity* getEntity() const { return m_entity; }
  void setSystem(System* system) { m_system = system; }
  const std::vector<Core::Utils::Index>& getRenderObjects() { return m_renderObjects; }
  void removeRenderObject(const Core::Utils::Index& index);

 protected:
  void addRenderObject(Rendering::RenderObject* object);

 private:
  std::string m_name;
  Entity* m_entity;
  System* m_system = nullptr;
  std::vector<Core::Utils::Index> m_renderObjects;
};

class System {
  friend class Component;

 public:
  virtual ~System() = default;
  virtual void generateTasks(Core::TaskQueue* taskQueue, const FrameInfo& frameInfo) = 0;
  void addComponent(Entity* entity, Component* component) { registerComponent(entity, component); }
  std::vector<Component*> getEntityComponents(const Entity* entity) {
    std::vector<Component*> found;
    for (Component* component : m_components)
      if (component->getEntity() == entity) found.push_back(component);
    return found;
  }

 protected:
  virtual void registerComponent(const Entity* /*entity*/, Component* component) {
    m_components.push_back(component);
    component->setSystem(this);
  }
  virtual void unregisterComponent(const Entity* /*entity*/, Component* component) {
    m_components.erase(std::find(m_components.begin(), m_components.end(), component));
  }

 private:
  std::vector<Component*> m_components;
};

class GeometrySystem : public System {
 public:
  void generateTasks(Core::TaskQueue* /*taskQueue*/, const FrameInfo& /*frameInfo*/) override {}
};

/// Components under one transform. A new transform is seen after the end of the frame.
class Entity {
 public:
  explicit Entity(std::string name) : m_name(std::move(name)) {}

  const std::string& getName() const { return m_name; }
  const Core::Transform& getTransform() const { return m_transform; }
  void setTransform(const Core::Transform& transform) { m_doubleBufferedTransform = transform; }
  void swapTransformBuffers() { m_transform = m_doubleBufferedTransform; }

  void addComponent(Component* component) { m_components.emplace_back(component); }
  void removeComponent(const std::string& name) { m_components.erase(find(name)); }
  void remove_components() { m_components.clear(); }
  Component* getComponent(const std::string& name) {
    const auto found = find(name);
    return found == m_components.end() ? nullptr : found->get();
  }
  const std::vector<std::unique_ptr<Component>>& getComponents() const { return m_components; }

 private:
  std::vector<std::unique_ptr<Component>>::iterator find(const std::string& name) {
    return std::find_if(m_components.begin(), m_components.end(),
                        [&](const auto& component) { return component->getName() == name; });
  }

  Core::Transform m_transform = Core::Transform::Identity();
  Core::Transform m_doubleBufferedTransform = Core::Transform::Identity();
  std::vector<std::unique_ptr<Component>> m_components;
  std::string m_name;
};

class EntityManager {
 public:
  ~EntityManager() { deleteEntities(); }

  /// A name that is taken gets _1, _2, ...
  Entity* createEntity(const std::string& name) {
    std::string free_name = name;
    for (int i = 1; entityExists(free_name); ++i) free_name = name + "_" + std::to_string(i);
    return m_entities.emplace_back(std::make_unique<Entity>(free_name)).get();
  }
  bool entityExists(const std::string& name) const { return getEntity(name) != nullptr; }
  Entity* getEntity(const std::string& name) const {
    for (Entity* entity : getEntities())
      if (entity->getName() == name) return entity;
    return nullptr;
  }
  std::vector<Entity*> getEntities() const {
    std::vector<Entity*> all;
    for (const auto& entity : m_entities) all.push_back(entity.get());
    return all;
  }
  // The entity exists while its components are removed.
  void removeEntity(Entity* entity) {
    entity->remove_components();
    m_entities.erase(std::find_if(m_entities.begin(), m_entities.end(),
                                  [entity](const auto& owned) { return owned.get() == entity; }));
  }
  void deleteEntities() {
    while (!m_entities.empty()) removeEntity(m_entities.front().get());
  }
  void swapBuffers() {
    for (const auto& entity : m_entities) entity->swapTransformBuffers();
  }

 private:
  std::vector<std::unique_ptr<Entity>> m_entities;
};

}  // namespace Scene

namespace Rendering {

enum class RenderObjectType { UI = 0, Debug, Geometry };

class RenderObject final {
 public:
  RenderObject(Scene::Component* component, std::shared_ptr<Data::AttribArrayDisplayable> mesh,
               std::shared_ptr<Data::Material> material)
      : m_component(component), m_mesh(std::move(mesh)), m_material(std::move(material)) {}

  Scene::Component* getComponent() { return m_component; }
  RenderObjectType getType() const { return RenderObjectType::Geometry; }
  std::shared_ptr<Data::Displayable> getMesh() { return m_mesh; }
  std::shared_ptr<Data::Material> getMaterial() { return m_material; }

  /// The entity's transform times the local one.
  Core::Transform getTransform() const { return m_component->getEntity()->getTransform() * m_localTransform; }
  void setLocalTransform(const Core::Transform& transform) { m_localTransform = transform; }
  void setLocalTransform(const Core::Matrix4& transform) { m_localTransform = Core::Transform(transform); }

  /// In the world.
  Core::Aabb computeAabb() {
    Core::Aabb box;
    for (const Core::Vector3& vertex : m_mesh->getAttribArrayGeometry().vertices())
      box.extend(getTransform() * vertex);
    return box;
  }

 private:
  Core::Transform m_localTransform = Core::Transform::Identity();
  Scene::Component* m_component;
  std::shared_ptr<Data::AttribArrayDisplayable> m_mesh;
  std::shared_ptr<Data::Material> m_material;
};

class RenderObjectManager final {
 public:
  /// A new object gets the lowest index that is free.
  Core::Utils::Index addRenderObject(RenderObject* object) {
    int free = 0;
    while (exists(free)) ++free;
    m_renderObjects.emplace(free, object);
    return free;
  }
  void removeRenderObject(const Core::Utils::Index& index) { m_renderObjects.erase(index); }
  std::shared_ptr<RenderObject> getRenderObject(const Core::Utils::Index& index) {
    return m_renderObjects.at(index);
  }
  bool exists(const Core::Utils::Index& index) const { return m_renderObjects.count(index) > 0; }

 private:
  std::map<int, std::shared_ptr<RenderObject>> m_renderObjects;
};

}  // namespace Rendering

namespace Scene {

/// Shows one geometry as one render object of a gray material.
template <typename CoreMesh>
class MeshComponent : public Component {
 public:
  MeshComponent(const std::string& name, Entity* entity, CoreMesh&& mesh,
                Core::Asset::MaterialData* /*mat*/ = nullptr)
      : Component(name, entity) {
    auto material = std::make_shared<Data::BlinnPhongMaterial>();
    material->m_perVertexColor = mesh.hasAttrib(Core::Geometry::getAttribName(Core::Geometry::VERTEX_COLOR));
    auto shown = std::make_shared<Data::CoreGeometryDisplayable<CoreMesh>>(std::move(mesh));
    addRenderObject(new Rendering::RenderObject(this, std::move(shown), std::move(material)));
  }
  void initialize() override {}
};

using TriangleMeshComponent = MeshComponent<Core::Geometry::TriangleMesh>;
using QuadMeshComponent = MeshComponent<Core::Geometry::QuadMesh>;
using PolyMeshComponent = MeshComponent<Core::Geometry::PolyMesh>;

class PointCloudComponent : public MeshComponent<Core::Geometry::PointCloud> {
 public:
  using MeshComponent<Core::Geometry::PointCloud>::MeshComponent;
  void setSplatSize(float /*size*/) {}
};

}  // namespace Scene

class RadiumEngine {
 public:
  static RadiumEngine* createInstance() {
    s_instance = std::make_unique<RadiumEngine>();
    return s_instance.get();
  }
  static RadiumEngine* getInstance() { return s_instance.get(); }
  static void destroyInstance() { s_instance.reset(); }

  void initialize() {
    m_entityManager = std::make_unique<Scene::EntityManager>();
    m_renderObjectManager = std::make_unique<Rendering::RenderObjectManager>();
  }
  void cleanup() {
    m_entityManager.reset();
    m_renderObjectManager.reset();
    m_systems.clear();
  }

  /// Advances time in the first frame too, and by both `dt` and the constant step, as Radium's clock does.
  void getTasks(Core::TaskQueue* tasks, Scalar dt) {
    if (m_playing || m_singleStep) advance(dt + m_step);
    m_singleStep = false;
    for (const auto& [name, system] : m_systems) system->generateTasks(tasks, {m_time, m_step});
  }
  void endFrameSync() { m_entityManager->swapBuffers(); }

  bool registerSystem(const std::string& name, Scene::System* system, int /*priority*/ = 1) {
    return m_systems.emplace(name, system).second;
  }
  Scene::System* getSystem(const std::string& name) const {
    const auto found = m_systems.find(name);
    return found == m_systems.end() ? nullptr : found->second.get();
  }
  Scene::EntityManager* getEntityManager() const { return m_entityManager.get(); }
  Rendering::RenderObjectManager* getRenderObjectManager() const { return m_renderObjectManager.get(); }

  void setConstantTimeStep(Scalar dt, bool /*forceConstantTime*/) { m_step = dt; }
  void play(bool isPlaying) { m_playing = isPlaying; }
  void step() { m_singleStep = true; }
  void resetTime() {
    m_playing = m_singleStep = false;
    m_time = m_start;
  }
  Scalar getTime() const { return m_time; }
  void setStartTime(Scalar t) { m_start = t > 0 ? t : 0; }
  Scalar getStartTime() const { return m_start; }
  void setEndTime(Scalar t) { m_end = t; }
  Scalar getEndTime() const { return m_end; }

 private:
  // A window that is empty, or ends before 0, has no end.
  void advance(Scalar dt) {
    m_time += dt;
    if (m_end < 0 || m_start >= m_end) return;
    m_time = m_time < m_start ? m_start
             : m_time > m_end ? m_start + std::fmod(m_time - m_start, m_end - m_start)
                              : m_time;
  }

  static inline std::unique_ptr<RadiumEngine> s_instance;
  std::map<std::string, std::unique_ptr<Scene::System>> m_systems;
  std::unique_ptr<Rendering::RenderObjectManager> m_renderObjectManager;
  std::unique_ptr<Scene::EntityManager> m_entityManager;
  Scalar m_step = 1.0f / 60, m_start = 0, m_end = 1, m_time = 0;
  bool m_playing = false;
  bool m_singleStep = true;
};

inline Scene::Component::Component(const std::string& name, Entity* entity) : m_name(name), m_entity(entity) {
  entity->addComponent(this);
}

inline Scene::Component::~Component() {
  while (!m_renderObjects.empty()) removeRenderObject(m_renderObjects.back());
  if (m_system != nullptr) m_system->unregisterComponent(m_entity, this);
}

inline void Scene::Component::addRenderObject(Rendering::RenderObject* object) {
  m_renderObjects.push_back(RadiumEngine::getInstance()->getRenderObjectManager()->addRenderObject(object));
}

inline void Scene::Component::removeRenderObject(const Core::Utils::Index& index) {
  const auto found = std::find(m_renderObjects.begin(), m_renderObjects.end(), index);
  if (found == m_renderObjects.end()) return;
  RadiumEngine::getInstance()->getRenderObjectManager()->removeRenderObject(index);
  m_renderObjects.erase(found);
}

}  // namespace Ra::Engine
