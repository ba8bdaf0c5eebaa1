#include "plugins/radium/plugin/back_sides.h"

#include <Core/Containers/MakeShared.hpp>
#include <Core/Geometry/TriangleMesh.hpp>
#include <Core/Tasks/Task.hpp>
#include <Core/Tasks/TaskQueue.hpp>
#include <Engine/Data/Mesh.hpp>
#include <Engine/RadiumEngine.hpp>
#include <Engine/Rendering/RenderObject.hpp>
#include <Engine/Rendering/RenderObjectManager.hpp>
#include <Engine/Rendering/RenderTechnique.hpp>
#include <Engine/Scene/Component.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace souple::radium {

namespace {

using Ra::Core::Utils::Index;
using Ra::Engine::Rendering::RenderObject;

constexpr const char* back_sides_name = "Souple back sides";

Ra::Core::Geometry::TriangleMesh turned_over(const RenderMesh& front) {
  Ra::Core::Geometry::TriangleMesh mesh;
  Ra::Core::VectorArray<Ra::Core::Vector3ui> triangles;
  const std::vector<std::uint32_t> corners = front.triangles();
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    triangles.emplace_back(corners[i], corners[i + 2], corners[i + 1]);
  mesh.setVertices(vectors(front.positions()));
  mesh.setIndices(std::move(triangles));
  return mesh;
}

/// Meters per unit of the mesh, averaged over directions.
float scale_of(const RenderMesh& mesh) {
  const std::array<float, 16> transform = mesh.transform();
  const Eigen::Map<const Eigen::Matrix4f> matrix(transform.data());
  return std::cbrt(std::fabs(matrix.topLeftCorner<3, 3>().determinant()));
}

RenderMesh show_back(Ra::Engine::RadiumEngine& engine, const RenderMesh& front) {
  const std::shared_ptr<RenderObject> object =
      engine.getRenderObjectManager()->getRenderObject(front.index());
  auto mesh = Ra::Core::make_shared<Ra::Engine::Data::Mesh>(front.name() + " back", turned_over(front));
  auto* back = RenderObject::createRenderObject(front.name() + " back", object->getComponent(),
                                                Ra::Engine::Rendering::RenderObjectType::Geometry, mesh,
                                                Ra::Engine::Rendering::RenderTechnique{});
  back->setMaterial(object->getMaterial());
  back->setTransparent(object->isTransparent());
  back->setLocalTransform(object->getLocalTransform());
  return {engine, object->getComponent()->addRenderObject(back)};
}

}  // namespace

BackSides* BackSides::add_to(Ra::Engine::RadiumEngine& engine, PhysicsSystem& system) {
  auto sides = std::make_unique<BackSides>(engine, system);
  constexpr int after_the_physics = 0;
  engine.registerSystem(back_sides_name, sides.get(), after_the_physics);
  return sides.release();  // the engine deletes it
}

bool BackSides::match_cloths() {
  remove_stale();
  const std::size_t count = pairs_.size();
  for (const LoadedMesh& mesh : system_.loaded_meshes()) {
    const bool known = std::any_of(pairs_.begin(), pairs_.end(),
                                   [&](const Pair& pair) { return pair.object == mesh.object; });
    if (mesh.object != 0 && !known && system_.session().object(mesh.object).kind == host::Kind::cloth)
      add(mesh);
  }
  return pairs_.size() > count;
}

void BackSides::remove_stale() {
  const auto is_stale = [this](const Pair& pair) {
    return !pair.front.alive() || !pair.back.alive() || !system_.session().contains(pair.object);
  };
  for (const Pair& pair : pairs_) {
    if (!is_stale(pair) || !pair.back.alive()) continue;
    const Index back = pair.back.index();
    engine_.getRenderObjectManager()->getRenderObject(back)->getComponent()->removeRenderObject(back);
  }
  pairs_.erase(std::remove_if(pairs_.begin(), pairs_.end(), is_stale), pairs_.end());
}

void BackSides::add(const LoadedMesh& cloth) {
  const RenderMesh front(engine_, cloth.render_object);
  constexpr float least = 0.002f;  // minimum distance that a depth buffer starting at 1 cm resolves [m]
  const float gap = std::max(least, system_.session().object(cloth.object).radius) / scale_of(front);
  pairs_.push_back({cloth.object, front, show_back(engine_, front), gap});
  follow(pairs_.back());
}

void BackSides::follow(Pair& pair) {
  std::vector<float> positions = pair.front.positions(), normals = pair.front.normals();
  for (std::size_t i = 0; i < normals.size(); ++i) {
    positions[i] -= pair.gap * normals[i];
    normals[i] = -normals[i];
  }
  pair.back.set_vertices(positions, normals);
}

bool BackSides::contains(Index render_object) const {
  return std::any_of(pairs_.begin(), pairs_.end(), [&](const Pair& pair) {
    return pair.back.index().getValue() == render_object.getValue();
  });
}

PickedVertex BackSides::front_of(const PickedVertex& picked) const {
  for (const Pair& pair : pairs_) {
    if (pair.back.index().getValue() != picked.render_object.getValue()) continue;
    constexpr int turned[] = {0, 2, 1};
    const bool is_corner = picked.corner >= 0 && picked.corner < 3;
    return {pair.front.index(), picked.triangle, is_corner ? turned[picked.corner] : picked.corner};
  }
  return picked;
}

void BackSides::generateTasks(Ra::Core::TaskQueue* tasks, const Ra::Engine::FrameInfo& /*frame*/) {
  const auto task = tasks->registerTask(std::make_unique<Ra::Core::FunctionTask>(
      [this] {
        const std::uint64_t version = system_.session().version();
        if (std::exchange(drawn_version_, version) == version) return;
        for (Pair& pair : pairs_)
          if (pair.front.alive() && pair.back.alive()) follow(pair);
      },
      back_sides_name));
  tasks->addPendingDependency(PhysicsSystem::system_name, task);
}

}  // namespace souple::radium
