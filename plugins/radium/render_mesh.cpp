#include "plugins/radium/render_mesh.h"

#include <Core/Geometry/TriangleMesh.hpp>
#include <Engine/Data/Mesh.hpp>
#include <Engine/RadiumEngine.hpp>
#include <Engine/Rendering/RenderObject.hpp>
#include <Engine/Rendering/RenderObjectManager.hpp>
#include <Engine/Scene/Component.hpp>
#include <Engine/Scene/Entity.hpp>
#include <cstring>
#include <utility>

namespace souple::radium {

namespace {

using Ra::Core::Vector3;
using Ra::Core::Vector3Array;
using Ra::Engine::Data::AttribArrayDisplayable;
using Ra::Engine::Rendering::RenderObject;
using Ra::Engine::Rendering::RenderObjectType;

static_assert(sizeof(Scalar) == sizeof(float), "Souple asks for a Radium whose Scalar is float");
static_assert(sizeof(Vector3) == 3 * sizeof(float), "vertices are x, y, z without a gap");

AttribArrayDisplayable* displayed(const std::shared_ptr<RenderObject>& object) {
  return object ? dynamic_cast<AttribArrayDisplayable*>(object->getMesh().get()) : nullptr;
}

std::vector<float> numbers(const Vector3Array& array) {
  std::vector<float> values(3 * array.size());
  if (!values.empty()) std::memcpy(values.data(), array.data()->data(), values.size() * sizeof(float));
  return values;
}

template <class Corners>
void cut_polygon(const Corners& corners, std::vector<std::uint32_t>& triangles) {
  // Alternately from both ends, like Radium's drawing of a PolyMesh.
  auto corner = [&](int i) { return static_cast<std::uint32_t>(corners[i]); };
  int first = 0, last = static_cast<int>(corners.size()) - 1;
  while (first + 1 < last) {
    if ((last - first) % 2 != 0) {
      triangles.insert(triangles.end(), {corner(first), corner(first + 1), corner(last)});
      ++first;
    } else {
      triangles.insert(triangles.end(), {corner(last), corner(first), corner(last - 1)});
      --last;
    }
  }
}

}  // namespace

Vector3Array vectors(const std::vector<float>& values) {
  Vector3Array result(values.size() / 3);
  if (!values.empty()) std::memcpy(result.data()->data(), values.data(), values.size() * sizeof(float));
  return result;
}

RenderMesh::RenderMesh(Ra::Engine::RadiumEngine& engine, const Ra::Core::Utils::Index& render_object)
    : engine_(&engine), index_(render_object) {
  auto* objects = engine.getRenderObjectManager();
  if (objects == nullptr || index_.isInvalid() || !objects->exists(index_)) return;
  const std::shared_ptr<RenderObject> object = objects->getRenderObject(index_);
  const AttribArrayDisplayable* mesh = displayed(object);
  if (mesh == nullptr || object->getType() != RenderObjectType::Geometry) return;
  object_ = object;
  vertex_count_ = mesh->getAttribArrayGeometry().vertices().size();
}

bool RenderMesh::alive() const {
  const std::shared_ptr<RenderObject> object = object_.lock();
  if (!object) return false;
  // A renderer may keep a deleted object for one more frame: only Radium's own list is reliable.
  auto* objects = engine_->getRenderObjectManager();
  if (objects == nullptr || !objects->exists(index_) || objects->getRenderObject(index_) != object)
    return false;
  const AttribArrayDisplayable* mesh = displayed(object);
  return mesh != nullptr && mesh->getAttribArrayGeometry().vertices().size() == vertex_count_;
}

std::string RenderMesh::name() const {
  return object_.lock()->getComponent()->getName();
}

Ra::Engine::Scene::Entity& RenderMesh::entity() const {
  return *object_.lock()->getComponent()->getEntity();
}

Ra::Core::Geometry::AttribArrayGeometry& RenderMesh::geometry() const {
  return displayed(object_.lock())->getAttribArrayGeometry();
}

std::vector<float> RenderMesh::positions() const {
  return numbers(geometry().vertices());
}

std::vector<float> RenderMesh::normals() const {
  return numbers(geometry().normals());
}

std::vector<std::uint32_t> RenderMesh::triangles() const {
  std::vector<std::uint32_t> result;
  AttribArrayDisplayable* mesh = displayed(object_.lock());
  if (auto* of_triangles = dynamic_cast<Ra::Engine::Data::Mesh*>(mesh)) {
    for (const auto& t : of_triangles->getCoreGeometry().getIndices())
      result.insert(result.end(), {t[0], t[1], t[2]});
  } else if (auto* of_quads = dynamic_cast<Ra::Engine::Data::QuadMesh*>(mesh)) {
    for (const auto& q : of_quads->getCoreGeometry().getIndices())
      result.insert(result.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
  } else if (auto* of_polygons = dynamic_cast<Ra::Engine::Data::PolyMesh*>(mesh)) {
    for (const auto& polygon : of_polygons->getCoreGeometry().getIndices()) {
      if (polygon.size() == 3)
        result.insert(result.end(), {polygon[0], polygon[1], polygon[2]});
      else
        cut_polygon(polygon, result);
    }
  }
  return result;
}

std::size_t RenderMesh::triangle_count() const {
  return triangles().size() / 3;
}

std::array<float, 16> RenderMesh::transform() const {
  const Ra::Core::Matrix4 matrix = object_.lock()->getTransform().matrix();
  std::array<float, 16> result{};
  std::memcpy(result.data(), matrix.data(), sizeof result);
  return result;
}

void RenderMesh::set_vertices(const std::vector<float>& positions, const std::vector<float>& normals) {
  // Not verticesWithLock and verticesUnlock: they do not update the bounding box, at which Radium clips.
  geometry().setVertices(vectors(positions));
  if (!normals.empty()) geometry().setNormals(vectors(normals));
}

void RenderMesh::set_local_transform(const std::array<float, 16>& transform) {
  Ra::Core::Matrix4 matrix;
  std::memcpy(matrix.data(), transform.data(), sizeof transform);
  object_.lock()->setLocalTransform(matrix);
}

}  // namespace souple::radium
