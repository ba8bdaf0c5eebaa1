#pragma once

#include <Engine/RaEngine.hpp>
#include <string>
#include <utility>

namespace Ra {
namespace Engine {
namespace Data {

class Material {
 public:
  enum class MaterialAspect { MAT_OPAQUE, MAT_TRANSPARENT, MAT_DENSITY };

  virtual ~Material() = default;

  const std::string& getInstanceName() const { return m_instanceName; }
  const std::string& getMaterialName() const { return m_materialName; }
  void setMaterialAspect(const MaterialAspect& aspect) { m_aspect = aspect; }
  const MaterialAspect& getMaterialAspect() const { return m_aspect; }

  virtual bool isTransparent() const { return m_aspect == MaterialAspect::MAT_TRANSPARENT; }
  virtual void setColoredByVertexAttrib(bool /*state*/) {}
  virtual bool isColoredByVertexAttrib() const { return false; }

  virtual void updateGL() = 0;
  void needUpdate() { m_isDirty = true; }

 protected:
  explicit Material(std::string instanceName, std::string materialName,
                    MaterialAspect aspect = MaterialAspect::MAT_OPAQUE)
      : m_instanceName(std::move(instanceName)), m_aspect(aspect), m_materialName(std::move(materialName)) {}

  std::string m_instanceName;
  MaterialAspect m_aspect;
  bool m_isDirty = true;

 private:
  std::string m_materialName;
};

}  // namespace Data
}  // namespace Engine
}  // namespace Ra
