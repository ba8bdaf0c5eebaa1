#include <Core/Geometry/TriangleMesh.hpp>
#include <utility>

namespace Ra {
namespace Core {
namespace Geometry {

const std::string& getAttribName(MeshAttrib index) {
  static const std::string names[] = {"in_position", "in_normal", "in_tangent", "in_bitangent",
                                      "in_texcoord", "in_color",  "in_weight",  "in_weight_idx"};
  return names[index];
}

AttribArrayGeometry::AttribArrayGeometry(const AttribArrayGeometry& other)
    : AbstractGeometry(other),
      m_verticesHandle(other.m_verticesHandle),
      m_normalsHandle(other.m_normalsHandle) {
  m_vertexAttribs.copyAllAttributes(other.m_vertexAttribs);
}

// Those who observe the box stay with the object, not with what it holds.
AttribArrayGeometry::AttribArrayGeometry(AttribArrayGeometry&& other) noexcept
    : AbstractGeometry(),
      m_vertexAttribs(std::move(other.m_vertexAttribs)),
      m_verticesHandle(std::move(other.m_verticesHandle)),
      m_normalsHandle(std::move(other.m_normalsHandle)) {}

AttribArrayGeometry& AttribArrayGeometry::operator=(const AttribArrayGeometry& other) {
  if (this == &other) return *this;
  m_vertexAttribs.clear();
  m_vertexAttribs.copyAllAttributes(other.m_vertexAttribs);
  m_verticesHandle = other.m_verticesHandle;
  m_normalsHandle = other.m_normalsHandle;
  invalidateAabb();
  return *this;
}

AttribArrayGeometry& AttribArrayGeometry::operator=(AttribArrayGeometry&& other) noexcept {
  if (this == &other) return *this;
  m_vertexAttribs = std::move(other.m_vertexAttribs);
  m_verticesHandle = std::move(other.m_verticesHandle);
  m_normalsHandle = std::move(other.m_normalsHandle);
  invalidateAabb();
  return *this;
}

void AttribArrayGeometry::clear() {
  m_vertexAttribs.clear();
  addDefaultAttribs();
}

void AttribArrayGeometry::addDefaultAttribs() {
  m_verticesHandle = m_vertexAttribs.addAttrib<Point>(getAttribName(VERTEX_POSITION));
  m_normalsHandle = m_vertexAttribs.addAttrib<Normal>(getAttribName(VERTEX_NORMAL));
  invalidateAabb();
}

Aabb AttribArrayGeometry::computeAabb() const {
  if (!isAabbValid()) {
    Aabb box;
    for (const Point& vertex : vertices()) box.extend(vertex);
    setAabb(box);
  }
  return getAabb();
}

void AttribArrayGeometry::setVertices(const PointAttribHandle::Container& vertices) {
  m_vertexAttribs.setAttrib(m_verticesHandle, vertices);
  invalidateAabb();
}

void AttribArrayGeometry::setNormals(const NormalAttribHandle::Container& normals) {
  m_vertexAttribs.setAttrib(m_normalsHandle, normals);
}

void AttribArrayGeometry::colorize(const Utils::Color& color) {
  const auto handle = addAttrib<Vector4>(getAttribName(VERTEX_COLOR));
  getAttrib(handle).setData(Vector4Array(vertices().size(), color));
}

}  // namespace Geometry
}  // namespace Core
}  // namespace Ra
