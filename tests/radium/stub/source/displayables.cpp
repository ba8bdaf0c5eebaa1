#include <Engine/Data/Mesh.hpp>
#include <algorithm>

namespace Ra {
namespace Engine {
namespace Data {

AttribArrayDisplayable::AttribArrayDisplayable(const std::string& name, MeshRenderMode renderMode)
    : Displayable(name) {
  AttribArrayDisplayable::setRenderMode(renderMode);
}

void AttribArrayDisplayable::setRenderMode(MeshRenderMode mode) {
  m_renderMode = mode;
  m_pickingRenderMode = mode == RM_POINTS ? PKM_POINTS : mode == RM_LINES ? PKM_LINES : PKM_TRI;
}

void AttribArrayDisplayable::setDirty(const std::string& name) {
  const auto buffer = m_handleToBuffer.emplace(name, static_cast<uint>(m_dataDirty.size()));
  if (buffer.second) m_dataDirty.push_back(true);
  m_dataDirty[buffer.first->second] = true;
  m_isDirty = true;
}

void AttribArrayDisplayable::observe(Core::Utils::AttribManager& attribs) {
  m_dataDirty.resize(static_cast<std::size_t>(attribs.getNumAttribs()));
  uint buffer = 0;
  attribs.for_each_attrib([&](Core::Utils::AttribBase* attrib) {
    m_dataDirty[buffer] = true;
    m_handleToBuffer[attrib->getName()] = buffer++;
    observe(*attrib);
  });
  attribs.attach([this, &attribs](const std::string& name) {
    Core::Utils::AttribBase* attrib = attribs.getAttribBase(name);
    if (attrib == nullptr) return;
    if (m_handleToBuffer.emplace(name, static_cast<uint>(m_dataDirty.size())).second)
      m_dataDirty.push_back(true);
    observe(*attrib);
  });
  m_isDirty = true;
}

void AttribArrayDisplayable::observe(Core::Utils::AttribBase& attrib) {
  attrib.attach([this, buffer = m_handleToBuffer[attrib.getName()]]() {
    if (buffer >= m_dataDirty.size()) return;
    m_dataDirty[buffer] = true;
    m_isDirty = true;
  });
}

void AttribArrayDisplayable::setClean() {
  std::fill(m_dataDirty.begin(), m_dataDirty.end(), false);
  m_isDirty = false;
}

std::size_t Mesh::getNumFaces() const {
  const std::size_t indices = getCoreGeometry().getIndices().size();
  if (m_renderMode == RM_TRIANGLES) return indices;
  return m_renderMode == RM_TRIANGLE_STRIP || m_renderMode == RM_TRIANGLE_FAN ? 3 * (indices - 1) + 1 : 0;
}

void triangulate_face(const Core::Vector4ui& face, Core::AlignedStdVector<Core::Vector3ui>& triangles) {
  triangles.emplace_back(face[0], face[1], face[2]);
  triangles.emplace_back(face[0], face[2], face[3]);
}

// A strip that closes from both ends in turn, the last corner against the first ones. A triangle stays as it
// is.
void triangulate_face(const Core::VectorNui& face, Core::AlignedStdVector<Core::Vector3ui>& triangles) {
  if (face.size() == 3) {
    triangles.emplace_back(face[0], face[1], face[2]);
    return;
  }
  Eigen::Index low = 0;
  Eigen::Index high = face.size() - 1;
  for (bool from_below = high % 2 == 1; high - low > 1; from_below = !from_below) {
    if (from_below) {
      triangles.emplace_back(face[low], face[low + 1], face[high]);
      ++low;
    } else {
      triangles.emplace_back(face[high], face[low], face[high - 1]);
      --high;
    }
  }
}

}  // namespace Data
}  // namespace Engine
}  // namespace Ra
