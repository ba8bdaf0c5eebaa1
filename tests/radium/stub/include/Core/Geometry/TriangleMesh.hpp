#pragma once

#include <Core/Containers/VectorArray.hpp>
#include <Core/Geometry/AbstractGeometry.hpp>
#include <Core/Geometry/StandardAttribNames.hpp>
#include <Core/Types.hpp>
#include <Core/Utils/Attribs.hpp>
#include <Core/Utils/Color.hpp>
#include <Core/Utils/Observable.hpp>
#include <string>

namespace Ra {
namespace Core {
namespace Geometry {

/// Vertices, normals and other attributes. What was moved from has none, not even vertices: asking throws.
class AttribArrayGeometry : public AbstractGeometry {
 public:
  using Point = Vector3;
  using Normal = Vector3;
  using PointAttribHandle = Utils::AttribHandle<Point>;
  using NormalAttribHandle = Utils::AttribHandle<Normal>;
  using FloatAttribHandle = Utils::AttribHandle<Scalar>;
  using Vec2AttribHandle = Utils::AttribHandle<Vector2>;
  using Vec3AttribHandle = Utils::AttribHandle<Vector3>;
  using Vec4AttribHandle = Utils::AttribHandle<Vector4>;

  AttribArrayGeometry() { addDefaultAttribs(); }
  explicit AttribArrayGeometry(const AttribArrayGeometry& other);
  explicit AttribArrayGeometry(AttribArrayGeometry&& other) noexcept;
  AttribArrayGeometry& operator=(const AttribArrayGeometry& other);
  AttribArrayGeometry& operator=(AttribArrayGeometry&& other) noexcept;
  ~AttribArrayGeometry() override = default;

  void clear() override;
  Aabb computeAabb() const override;

  const PointAttribHandle::Container& vertices() const {
    return m_vertexAttribs.getAttrib(m_verticesHandle).data();
  }
  const NormalAttribHandle::Container& normals() const {
    return m_vertexAttribs.getAttrib(m_normalsHandle).data();
  }
  void setVertices(const PointAttribHandle::Container& vertices);
  void setNormals(const NormalAttribHandle::Container& normals);

  // Neither of these makes the bounding box stale: in Radium too, only setVertices does.
  PointAttribHandle::Container& verticesWithLock() {
    return m_vertexAttribs.getAttrib(m_verticesHandle).getDataWithLock();
  }
  void verticesUnlock() { m_vertexAttribs.getAttrib(m_verticesHandle).unlock(); }
  NormalAttribHandle::Container& normalsWithLock() {
    return m_vertexAttribs.getAttrib(m_normalsHandle).getDataWithLock();
  }
  void normalsUnlock() { m_vertexAttribs.getAttrib(m_normalsHandle).unlock(); }

  bool hasAttrib(const std::string& name) const { return m_vertexAttribs.contains(name); }
  Utils::AttribBase* getAttribBase(const std::string& name) { return m_vertexAttribs.getAttribBase(name); }
  const Utils::AttribBase* getAttribBase(const std::string& name) const {
    return m_vertexAttribs.getAttribBase(name);
  }

  template <typename T>
  Utils::AttribHandle<T> getAttribHandle(const std::string& name) const {
    return m_vertexAttribs.findAttrib<T>(name);
  }
  template <typename T>
  bool isValid(const Utils::AttribHandle<T>& handle) const {
    return m_vertexAttribs.isValid(handle);
  }
  template <typename T>
  Utils::Attrib<T>& getAttrib(const Utils::AttribHandle<T>& handle) {
    return m_vertexAttribs.getAttrib(handle);
  }
  template <typename T>
  const Utils::Attrib<T>& getAttrib(const Utils::AttribHandle<T>& handle) const {
    return m_vertexAttribs.getAttrib(handle);
  }
  template <typename T>
  Utils::Attrib<T>& getAttrib(const std::string& name) {
    return m_vertexAttribs.getAttrib<T>(name);
  }
  template <typename T>
  const Utils::Attrib<T>& getAttrib(const std::string& name) const {
    return m_vertexAttribs.getAttrib<T>(name);
  }
  template <typename T>
  Utils::AttribHandle<T> addAttrib(const std::string& name) {
    invalidateAabb();
    return m_vertexAttribs.addAttrib<T>(name);
  }
  template <typename T>
  Utils::AttribHandle<T> addAttrib(const std::string& name, const VectorArray<T>& data) {
    const auto handle = addAttrib<T>(name);
    getAttrib(handle).setData(data);
    return handle;
  }
  template <typename T>
  void removeAttrib(Utils::AttribHandle<T>& handle) {
    m_vertexAttribs.removeAttrib(handle);
    invalidateAabb();
  }

  /// One color for all vertices.
  void colorize(const Utils::Color& color);

  Utils::AttribManager& vertexAttribs() { return m_vertexAttribs; }
  const Utils::AttribManager& vertexAttribs() const { return m_vertexAttribs; }

 private:
  void addDefaultAttribs();

  Utils::AttribManager m_vertexAttribs;
  PointAttribHandle m_verticesHandle;
  NormalAttribHandle m_normalsHandle;
};

class PointCloud : public AttribArrayGeometry {};

}  // namespace Geometry
}  // namespace Core
}  // namespace Ra

#include <Core/Geometry/IndexedGeometry.hpp>
