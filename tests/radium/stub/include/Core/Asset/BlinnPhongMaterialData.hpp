#pragma once

#include <Core/Asset/MaterialData.hpp>
#include <Core/Utils/Color.hpp>
#include <string>

namespace Ra {
namespace Core {
namespace Asset {

class BlinnPhongMaterialData : public MaterialData {
 public:
  explicit BlinnPhongMaterialData(const std::string& name = "") : MaterialData(name, "BlinnPhong") {}

  bool hasDiffuse() const { return m_hasDiffuse; }
  bool hasSpecular() const { return m_hasSpecular; }
  bool hasShininess() const { return m_hasShininess; }
  bool hasOpacity() const { return m_hasOpacity; }

  Utils::Color m_diffuse;
  Utils::Color m_specular;
  Scalar m_shininess = 0;
  Scalar m_opacity = 1;
  bool m_hasDiffuse = false;
  bool m_hasSpecular = false;
  bool m_hasShininess = false;
  bool m_hasOpacity = false;
};

}  // namespace Asset
}  // namespace Core
}  // namespace Ra
