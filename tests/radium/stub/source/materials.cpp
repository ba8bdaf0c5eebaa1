#include <Core/Asset/BlinnPhongMaterialData.hpp>
#include <Core/Utils/Log.hpp>
#include <Engine/Data/BlinnPhongMaterial.hpp>
#include <Engine/Data/MaterialConverters.hpp>
#include <map>
#include <memory>

namespace Ra {
namespace Engine {
namespace Data {

Material* BlinnPhongMaterialConverter::operator()(const Core::Asset::MaterialData* toconvert) {
  const auto& data = static_cast<const Core::Asset::BlinnPhongMaterialData&>(*toconvert);
  auto material = std::make_unique<BlinnPhongMaterial>(data.getName());
  if (data.hasDiffuse()) material->m_kd = data.m_diffuse;
  if (data.hasSpecular()) material->m_ks = data.m_specular;
  if (data.hasShininess()) material->m_ns = data.m_shininess;
  if (data.hasOpacity()) material->m_alpha = data.m_opacity;
  return material.release();
}

namespace EngineMaterialConverters {

namespace {

std::map<std::string, ConverterFunction>& converters() {
  static std::map<std::string, ConverterFunction> all;
  return all;
}

}  // namespace

bool registerMaterialConverter(const std::string& name, ConverterFunction converter) {
  return converters().emplace(name, std::move(converter)).second;
}

bool removeMaterialConverter(const std::string& name) {
  return converters().erase(name) == 1;
}

std::pair<bool, ConverterFunction> getMaterialConverter(const std::string& name) {
  const auto found = converters().find(name);
  if (found != converters().end()) return {true, found->second};
  return {false, [name](AssetMaterialPtr) -> RadiumMaterialPtr {
            LOG(Core::Utils::logERROR) << "no converter for a material of type " << name;
            return nullptr;
          }};
}

}  // namespace EngineMaterialConverters
}  // namespace Data
}  // namespace Engine
}  // namespace Ra
