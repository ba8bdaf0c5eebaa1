#pragma once

#include <Core/Geometry/TriangleMesh.hpp>
#include <Engine/Data/BlinnPhongMaterial.hpp>
#include <Engine/Data/MaterialConverters.hpp>
#include <Engine/Data/Mesh.hpp>
#include <Engine/RaEngine.hpp>
#include <Engine/Rendering/RenderObject.hpp>
#include <Engine/Scene/Component.hpp>
#include <Engine/Scene/Entity.hpp>
#include <memory>
#include <string>
#include <utility>

namespace Ra {
namespace Core {
namespace Asset {
class MaterialData;
}
}  // namespace Core
namespace Engine {
namespace Scene {

/// Shows one geometry with one render object, with a material of the data given or a gray one.
class GeometryComponent : public Component {
 public:
  GeometryComponent(const std::string& name, Entity* entity) : Component(name, entity), m_contentName(name) {}

  void initialize() override {}
  void setContentName(const std::string& name) { m_contentName = name; }

 protected:
  void show(const std::shared_ptr<Data::AttribArrayDisplayable>& mesh,
            const Core::Asset::MaterialData* material);

  Core::Utils::Index m_roIndex;
  std::string m_contentName;
};

template <typename CoreMeshType>
class SurfaceMeshComponent : public GeometryComponent {
 public:
  using RenderMeshType = typename Data::RenderMeshType::getType<CoreMeshType>::Type;

  SurfaceMeshComponent(const std::string& name, Entity* entity, CoreMeshType&& mesh,
                       Core::Asset::MaterialData* mat = nullptr)
      : GeometryComponent(name, entity),
        m_displayMesh(std::make_shared<RenderMeshType>(name, std::move(mesh))) {
    show(m_displayMesh, mat);
  }
  SurfaceMeshComponent(const std::string& name, Entity* entity, std::shared_ptr<RenderMeshType> data)
      : GeometryComponent(name, entity), m_displayMesh(std::move(data)) {
    show(m_displayMesh, nullptr);
  }

  const CoreMeshType& getCoreGeometry() const { return std::as_const(*m_displayMesh).getCoreGeometry(); }
  RenderMeshType* getDisplayable() { return m_displayMesh.get(); }

 private:
  std::shared_ptr<RenderMeshType> m_displayMesh;
};

using TriangleMeshComponent = SurfaceMeshComponent<Core::Geometry::TriangleMesh>;
using QuadMeshComponent = SurfaceMeshComponent<Core::Geometry::QuadMesh>;
using PolyMeshComponent = SurfaceMeshComponent<Core::Geometry::PolyMesh>;

class PointCloudComponent : public GeometryComponent {
 public:
  PointCloudComponent(const std::string& name, Entity* entity, Core::Geometry::PointCloud&& mesh,
                      Core::Asset::MaterialData* mat = nullptr);

  const Core::Geometry::PointCloud& getCoreGeometry() const {
    return std::as_const(*m_displayMesh).getCoreGeometry();
  }
  Data::PointCloud* getGeometry() { return m_displayMesh.get(); }

  /// The diameter of a point that is drawn.
  void setSplatSize(float size) { m_splatSize = size; }
  float getSplatSize() const { return m_splatSize; }

 private:
  std::shared_ptr<Data::PointCloud> m_displayMesh;
  float m_splatSize = 0.0025F;
};

}  // namespace Scene
}  // namespace Engine
}  // namespace Ra
