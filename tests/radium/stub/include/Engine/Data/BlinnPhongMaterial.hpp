#pragma once

#include <Core/Utils/Color.hpp>
#include <Engine/Data/Material.hpp>
#include <Engine/RaEngine.hpp>
#include <string>

namespace Ra {
namespace Core {
namespace Asset {
class MaterialData;
}
}  // namespace Core
namespace Engine {
namespace Data {

class BlinnPhongMaterial final : public Material {
 public:
  explicit BlinnPhongMaterial(const std::string& instanceName) : Material(instanceName, "BlinnPhong") {}

  void updateGL() override { m_isDirty = false; }
  bool isTransparent() const override { return m_alpha < 1 || m_kd[3] < 1 || Material::isTransparent(); }
  void setColoredByVertexAttrib(bool state) override {
    if (state != m_perVertexColor) needUpdate();
    m_perVertexColor = state;
  }
  bool isColoredByVertexAttrib() const override { return m_perVertexColor; }

  Core::Utils::Color m_kd{0.7, 0.7, 0.7, 1.0};
  Core::Utils::Color m_ks{0.3, 0.3, 0.3, 1.0};
  Scalar m_ns = 64;
  Scalar m_alpha = 1;
  bool m_perVertexColor = false;
  bool m_renderAsSplat = false;
};

/// Makes a material of a BlinnPhongMaterialData; the caller owns it.
class BlinnPhongMaterialConverter final {
 public:
  Material* operator()(const Core::Asset::MaterialData* toconvert);
};

}  // namespace Data
}  // namespace Engine
}  // namespace Ra
