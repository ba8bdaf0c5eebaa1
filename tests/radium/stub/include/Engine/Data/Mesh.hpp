#pragma once

#include <Core/Containers/AlignedStdVector.hpp>
#include <Core/Geometry/StandardAttribNames.hpp>
#include <Core/Geometry/TriangleMesh.hpp>
#include <Core/Utils/Attribs.hpp>
#include <Engine/Data/DisplayableObject.hpp>
#include <Engine/RaEngine.hpp>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace Ra {
namespace Engine {
namespace Data {

/// Keeps which attributes the graphics card has not seen yet. Nothing is drawn here: updateGL only takes
/// note.
class AttribArrayDisplayable : public Displayable {
 public:
  enum MeshRenderMode : uint {
    RM_POINTS = 0,
    RM_LINES = 1,
    RM_TRIANGLES = 4,
    RM_TRIANGLE_STRIP = 5,
    RM_TRIANGLE_FAN = 6
  };

  explicit AttribArrayDisplayable(const std::string& name, MeshRenderMode renderMode = RM_TRIANGLES);

  void setRenderMode(MeshRenderMode mode);
  MeshRenderMode getRenderMode() const { return m_renderMode; }

  void setDirty(const Core::Geometry::MeshAttrib& type) { setDirty(Core::Geometry::getAttribName(type)); }
  void setDirty(const std::string& name);

  virtual const Core::Geometry::AttribArrayGeometry& getAttribArrayGeometry() const = 0;
  virtual Core::Geometry::AttribArrayGeometry& getAttribArrayGeometry() = 0;

 protected:
  /// Takes all attributes as new, and hears of their changes from now on.
  void observe(Core::Utils::AttribManager& attribs);
  void setClean();

  MeshRenderMode m_renderMode;
  std::vector<bool> m_dataDirty;
  std::map<std::string, uint> m_handleToBuffer;
  bool m_isDirty = false;

 private:
  void observe(Core::Utils::AttribBase& attrib);
};

class VaoIndices {
 public:
  void setIndicesDirty() { m_indicesDirty = true; }

 protected:
  bool m_indicesDirty = true;
};

template <typename T>
class CoreGeometryDisplayable : public AttribArrayDisplayable {
 public:
  using base = AttribArrayDisplayable;
  using CoreGeometry = T;

  explicit CoreGeometryDisplayable(const std::string& name, MeshRenderMode renderMode = RM_TRIANGLES)
      : base(name, renderMode) {
    observe(m_mesh.vertexAttribs());
  }

  const Core::Geometry::AbstractGeometry& getAbstractGeometry() const override { return m_mesh; }
  Core::Geometry::AbstractGeometry& getAbstractGeometry() override { return m_mesh; }
  const Core::Geometry::AttribArrayGeometry& getAttribArrayGeometry() const override { return m_mesh; }
  Core::Geometry::AttribArrayGeometry& getAttribArrayGeometry() override { return m_mesh; }
  const CoreGeometry& getCoreGeometry() const { return m_mesh; }
  CoreGeometry& getCoreGeometry() { return m_mesh; }

  template <typename A>
  Core::Utils::AttribHandle<A> addAttrib(const std::string& name, const Core::VectorArray<A>& data) {
    return m_mesh.addAttrib(name, data);
  }

  std::size_t getNumVertices() const override { return m_mesh.vertices().size(); }
  virtual void loadGeometry(CoreGeometry&& mesh) { loadGeometry_common(std::move(mesh)); }

  // Also stale faces wait until some attribute is stale, as in Radium.
  void updateGL() override {
    if (!m_isDirty) return;
    updateGL_specific_impl();
    setClean();
  }
  void render(const ShaderProgram* /*prog*/) override {}

 protected:
  virtual void updateGL_specific_impl() {}
  void loadGeometry_common(CoreGeometry&& mesh) {
    m_mesh = std::move(mesh);
    observe(m_mesh.vertexAttribs());
  }

  CoreGeometry m_mesh;
};

class PointCloud : public CoreGeometryDisplayable<Core::Geometry::PointCloud> {
  using base = CoreGeometryDisplayable<Core::Geometry::PointCloud>;

 public:
  explicit PointCloud(const std::string& name, MeshRenderMode renderMode = RM_POINTS)
      : base(name, renderMode) {}
  PointCloud(const std::string& name, Core::Geometry::PointCloud&& geom,
             MeshRenderMode renderMode = RM_POINTS)
      : base(name, renderMode) {
    loadGeometry_common(std::move(geom));
  }
};

template <typename T>
class IndexedGeometry : public CoreGeometryDisplayable<T>, public VaoIndices {
 public:
  using base = CoreGeometryDisplayable<T>;
  using base::CoreGeometryDisplayable;
  IndexedGeometry(const std::string& name, T&& geom,
                  typename base::MeshRenderMode renderMode = base::MeshRenderMode::RM_TRIANGLES)
      : base(name, renderMode) {
    load(std::move(geom));
  }

  void loadGeometry(T&& mesh) override { load(std::move(mesh)); }

 protected:
  void updateGL_specific_impl() override { this->m_indicesDirty = false; }

 private:
  void load(T&& mesh) {
    setIndicesDirty();
    base::loadGeometry_common(std::move(mesh));
    base::m_mesh.attach([this]() { setIndicesDirty(); });
  }
};

class Mesh : public IndexedGeometry<Core::Geometry::TriangleMesh> {
 public:
  using IndexedGeometry<Core::Geometry::TriangleMesh>::IndexedGeometry;
  std::size_t getNumFaces() const override;
};

/// The triangles that stand for one face, in the order in which Radium draws (and picks) them.
void triangulate_face(const Core::Vector4ui& face, Core::AlignedStdVector<Core::Vector3ui>& triangles);
void triangulate_face(const Core::VectorNui& face, Core::AlignedStdVector<Core::Vector3ui>& triangles);

/// A mesh of quads or polygons: drawn as triangles that only it knows.
template <typename T>
class GeneralMesh : public IndexedGeometry<T> {
 public:
  using IndexedGeometry<T>::IndexedGeometry;
  std::size_t getNumFaces() const override { return this->getCoreGeometry().getIndices().size(); }

 protected:
  void updateGL_specific_impl() override {
    if (this->m_indicesDirty) triangulate();
    this->m_indicesDirty = false;
  }

 private:
  void triangulate() {
    m_triangleIndices.clear();
    for (const auto& face : this->m_mesh.getIndices()) triangulate_face(face, m_triangleIndices);
  }

  Core::AlignedStdVector<Core::Vector3ui> m_triangleIndices;
};

using PolyMesh = GeneralMesh<Core::Geometry::PolyMesh>;
using QuadMesh = GeneralMesh<Core::Geometry::QuadMesh>;

namespace RenderMeshType {

template <typename CoreMesh>
struct getType {};
template <>
struct getType<Core::Geometry::TriangleMesh> {
  using Type = Mesh;
};
template <>
struct getType<Core::Geometry::QuadMesh> {
  using Type = QuadMesh;
};
template <>
struct getType<Core::Geometry::PolyMesh> {
  using Type = PolyMesh;
};

}  // namespace RenderMeshType

}  // namespace Data
}  // namespace Engine
}  // namespace Ra
