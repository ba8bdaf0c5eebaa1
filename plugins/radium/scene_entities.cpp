#include "plugins/radium/scene_entities.h"

#include <Core/Asset/BlinnPhongMaterialData.hpp>
#include <Core/Geometry/StandardAttribNames.hpp>
#include <Core/Geometry/TriangleMesh.hpp>
#include <Core/Utils/Color.hpp>
#include <Engine/Data/BlinnPhongMaterial.hpp>
#include <Engine/RadiumEngine.hpp>
#include <Engine/Rendering/RenderObject.hpp>
#include <Engine/Rendering/RenderObjectManager.hpp>
#include <Engine/Scene/Entity.hpp>
#include <Engine/Scene/EntityManager.hpp>
#include <Engine/Scene/GeometryComponent.hpp>
#include <Engine/Scene/System.hpp>
#include <cmath>
#include <utility>

namespace souple::radium {

namespace {

using Ra::Core::Vector3ui;
using Ra::Core::Utils::Color;
using Ra::Engine::Scene::PointCloudComponent;
using Ra::Engine::Scene::TriangleMeshComponent;

Ra::Core::Geometry::TriangleMesh triangle_mesh(const std::vector<float>& positions,
                                               const std::vector<float>& normals,
                                               const std::vector<std::uint32_t>& indices) {
  Ra::Core::Geometry::TriangleMesh mesh;
  mesh.setVertices(vectors(positions));
  mesh.setNormals(vectors(normals));
  Ra::Core::VectorArray<Vector3ui> triangles;
  triangles.reserve(indices.size() / 3);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
    triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
  mesh.setIndices(std::move(triangles));
  return mesh;
}

// Scenes define colors in sRGB, Radium's materials in linear light.
float linear(float srgb) {
  return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

RenderMesh finish(Ra::Engine::RadiumEngine& engine, Ra::Engine::Scene::Component* component,
                  const std::array<float, 3>& srgb) {
  engine.getSystem("GeometrySystem")->addComponent(component->getEntity(), component);
  component->initialize();
  const Ra::Core::Utils::Index index = component->getRenderObjects().front();
  auto object = engine.getRenderObjectManager()->getRenderObject(index);
  if (auto* material = dynamic_cast<Ra::Engine::Data::BlinnPhongMaterial*>(object->getMaterial().get())) {
    material->m_kd = Color(linear(srgb[0]), linear(srgb[1]), linear(srgb[2]));
    material->m_ks = Color(0.1f, 0.1f, 0.1f);
  }
  return {engine, index};
}

// In order of host::Kind: cloth, soft bodies, ropes, grains, obstacles, fluids, rigid bodies.
constexpr std::array<float, 3> colors[] = {
    {0.80f, 0.36f, 0.30f}, {0.42f, 0.66f, 0.44f}, {0.76f, 0.62f, 0.40f}, {0.85f, 0.72f, 0.45f},
    {0.62f, 0.64f, 0.68f}, {0.25f, 0.56f, 0.82f}, {0.72f, 0.53f, 0.36f}};

std::array<float, 3> color_of(host::Kind kind) {
  return colors[static_cast<std::size_t>(kind)];
}

// Splats of one color would merge visually: each grain is slightly lighter or darker than its neighbors.
void tint(Ra::Core::Geometry::PointCloud& grains, const std::array<float, 3>& srgb) {
  Ra::Core::VectorArray<Ra::Core::Vector4> tints;
  tints.reserve(grains.vertices().size());
  for (std::uint32_t i = 0; i < grains.vertices().size(); ++i) {
    const std::uint32_t mixed = (i * 2654435761u) >> 24;
    const float light = 0.6f + 0.5f * static_cast<float>(mixed) / 255;
    tints.emplace_back(light * linear(srgb[0]), light * linear(srgb[1]), light * linear(srgb[2]), 1.0f);
  }
  grains.addAttrib<Ra::Core::Vector4>(
      Ra::Core::Geometry::getAttribName(Ra::Core::Geometry::MeshAttrib::VERTEX_COLOR), tints);
}

}  // namespace

RenderMesh show_object(Ra::Engine::RadiumEngine& engine, const host::ObjectInfo& info,
                       const host::Drawable& drawable) {
  auto* entity = engine.getEntityManager()->createEntity(info.name);
  const std::array<float, 3> color = info.has_color ? info.color : color_of(info.kind);
  if (!drawable.balls()) {
    auto mesh = triangle_mesh(drawable.positions(), drawable.normals(), drawable.triangles());
    return finish(engine, new TriangleMeshComponent(info.name + " mesh", entity, std::move(mesh)), color);
  }
  Ra::Core::Geometry::PointCloud points;
  points.setVertices(vectors(drawable.positions()));
  if (info.kind == host::Kind::grains) tint(points, color);
  auto* component = new PointCloudComponent(info.name + " splats", entity, std::move(points));
  // Radium's "diameter" is drawn as a radius.
  component->setSplatSize(drawable.radius());
  return finish(engine, component, color);
}

RenderMesh show_collider(Ra::Engine::RadiumEngine& engine, const host::ColliderShape& shape) {
  auto* entity = engine.getEntityManager()->createEntity(shape.name);
  auto mesh = triangle_mesh(shape.positions, shape.normals, shape.indices);
  return finish(engine, new TriangleMeshComponent(shape.name + " mesh", entity, std::move(mesh)),
                shape.has_color ? shape.color : color_of(host::Kind::obstacle));
}

}  // namespace souple::radium
