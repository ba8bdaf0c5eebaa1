#include "tests/radium/radium.h"

#include <Core/Tasks/TaskQueue.hpp>
#include <Engine/Rendering/RenderObject.hpp>
#include <Engine/Rendering/RenderObjectManager.hpp>
#include <Engine/Scene/GeometryComponent.hpp>
#include <Engine/Scene/GeometrySystem.hpp>
#include <utility>

namespace souple::radium {

namespace {

using Ra::Core::Vector3Array;
using Ra::Core::Vector3ui;
using Ra::Core::Geometry::PolyMesh;
using Ra::Core::Geometry::QuadMesh;
using Ra::Core::Geometry::TriangleMesh;
using Ra::Engine::RadiumEngine;

template <class Mesh>
Mesh points(const std::vector<Vector3>& vertices) {
  Mesh mesh;
  mesh.setVertices(Vector3Array(vertices.begin(), vertices.end()));
  mesh.setNormals(Vector3Array(vertices.size(), Vector3(0, 1, 0)));
  return mesh;
}

template <class Mesh, class Face>
Mesh faces(const std::vector<Vector3>& vertices, const std::vector<Face>& indices) {
  Mesh mesh = points<Mesh>(vertices);
  mesh.setIndices(Ra::Core::VectorArray<Face>(indices.begin(), indices.end()));
  return mesh;
}

template <class Component, class Mesh>
Index show_mesh(RadiumEngine& engine, Entity& entity, Mesh mesh) {
  auto* component = new Component(entity.getName() + " mesh", &entity, std::move(mesh), nullptr);
  engine.getSystem("GeometrySystem")->addComponent(&entity, component);
  component->initialize();
  return component->getRenderObjects().front();
}

void add_triangle(Triangles& mesh, const Vector3& a, const Vector3& b, const Vector3& c) {
  const auto first = static_cast<unsigned>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
  mesh.indices.emplace_back(first, first + 1, first + 2);
}

void add_square(Triangles& mesh, const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

}  // namespace

Triangles sheet(int cells, float size) {
  Triangles mesh;
  const auto at = [&](int i, int k) {
    const float cell = size / static_cast<float>(cells);
    return Vector3(static_cast<float>(i) * cell - size / 2, 0, static_cast<float>(k) * cell - size / 2);
  };
  for (int k = 0; k < cells; ++k)
    for (int i = 0; i < cells; ++i) add_square(mesh, at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k));
  return mesh;
}

Triangles box(const Vector3& half) {
  Triangles mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const auto corner = [&](float u, float v) {
        Vector3 x;
        x[axis] = side;
        x[(axis + 1) % 3] = side * u;
        x[(axis + 2) % 3] = v;
        return Vector3(x.cwiseProduct(half));
      };
      add_square(mesh, corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1));
    }
  }
  return mesh;
}

Radium::Radium() : engine(RadiumEngine::createInstance()) {
  engine->initialize();
  engine->registerSystem("GeometrySystem", new Ra::Engine::Scene::GeometrySystem, 1000);
  system = PhysicsSystem::add_to(*engine);
}

Radium::~Radium() {
  close();
}

void Radium::close() {
  if (engine == nullptr) return;
  engine->cleanup();
  RadiumEngine::destroyInstance();
  engine = nullptr;
  system = nullptr;
}

Entity& Radium::entity(const std::string& name, const Transform& transform) {
  Entity* entity = engine->getEntityManager()->createEntity(name);
  entity->setTransform(transform);
  engine->endFrameSync();  // transforms are seen after a frame
  return *entity;
}

Index Radium::show(const std::string& name, const Triangles& mesh, const Transform& transform) {
  return show_mesh<Ra::Engine::Scene::TriangleMeshComponent>(
      *engine, entity(name, transform), faces<TriangleMesh, Vector3ui>(mesh.vertices, mesh.indices));
}

Index Radium::show_quads(const std::string& name, const std::vector<Vector3>& vertices,
                         const std::vector<Ra::Core::Vector4ui>& quads) {
  return show_mesh<Ra::Engine::Scene::QuadMeshComponent>(
      *engine, entity(name), faces<QuadMesh, Ra::Core::Vector4ui>(vertices, quads));
}

Index Radium::show_polygons(const std::string& name, const std::vector<Vector3>& vertices,
                            const std::vector<std::vector<unsigned>>& polygons) {
  using Corners = Ra::Core::VectorNui;
  std::vector<Corners> indices;
  for (const std::vector<unsigned>& polygon : polygons)
    indices.emplace_back(
        Eigen::Map<const Corners>(polygon.data(), static_cast<Eigen::Index>(polygon.size())));
  return show_mesh<Ra::Engine::Scene::PolyMeshComponent>(*engine, entity(name),
                                                         faces<PolyMesh, Corners>(vertices, indices));
}

Index Radium::show_points(const std::string& name, const std::vector<Vector3>& vertices) {
  return show_mesh<Ra::Engine::Scene::PointCloudComponent>(*engine, entity(name),
                                                           points<Ra::Core::Geometry::PointCloud>(vertices));
}

Index Radium::shown(const std::string& name) const {
  const Entity* entity = engine->getEntityManager()->getEntity(name);
  return entity->getComponents().front()->getRenderObjects().front();
}

void Radium::frames(int count) {
  for (int i = 0; i < count; ++i) {
    Ra::Core::TaskQueue tasks(1);
    engine->getTasks(&tasks, frame_time);
    ASSERT_NO_THROW(tasks.runTasksInThisThread());
    engine->endFrameSync();
  }
}

std::string Radium::words() const {
  std::string all;
  for (const std::string& message : system->take_messages()) all += (all.empty() ? "" : "; ") + message;
  return all;
}

Vector3 Radium::world_vertex(const Index& index, std::size_t vertex) const {
  const std::vector<float> x = mesh(index).positions();
  const auto object = engine->getRenderObjectManager()->getRenderObject(index);
  return object->getTransform() * Vector3(x[3 * vertex], x[3 * vertex + 1], x[3 * vertex + 2]);
}

Ra::Core::Aabb Radium::bounding_box(const Index& index) const {
  return engine->getRenderObjectManager()->getRenderObject(index)->computeAabb();
}

Ra::Engine::Scene::Component& Radium::component(const Index& index) const {
  return *engine->getRenderObjectManager()->getRenderObject(index)->getComponent();
}

}  // namespace souple::radium
