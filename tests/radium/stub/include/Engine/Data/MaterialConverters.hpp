#pragma once

#include <Engine/RaEngine.hpp>
#include <functional>
#include <string>
#include <utility>

namespace Ra {
namespace Core {
namespace Asset {
class MaterialData;
}
}  // namespace Core
namespace Engine {
namespace Data {

class Material;

namespace EngineMaterialConverters {

using AssetMaterialPtr = const Core::Asset::MaterialData*;
using RadiumMaterialPtr = Material*;
using ConverterFunction = std::function<RadiumMaterialPtr(AssetMaterialPtr)>;

/// False if the name is taken: the first one stays.
bool registerMaterialConverter(const std::string& name, ConverterFunction converter);
bool removeMaterialConverter(const std::string& name);
/// If there is none: false, and one that complains and makes nothing.
std::pair<bool, ConverterFunction> getMaterialConverter(const std::string& name);

}  // namespace EngineMaterialConverters
}  // namespace Data
}  // namespace Engine
}  // namespace Ra
