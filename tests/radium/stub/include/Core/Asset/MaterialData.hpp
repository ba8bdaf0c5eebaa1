#pragma once

#include <Core/Asset/AssetData.hpp>
#include <string>
#include <utility>

namespace Ra {
namespace Core {
namespace Asset {

/// A material before the engine has it; its type is the name of the converter it needs.
class MaterialData : public AssetData {
 public:
  explicit MaterialData(const std::string& name = "", std::string type = "AbstractMaterial")
      : AssetData(name), m_type(std::move(type)) {}

  void setName(const std::string& name) { m_name = name; }
  std::string getType() const { return m_type; }
  void setType(const std::string& type) { m_type = type; }

 private:
  std::string m_type;
};

}  // namespace Asset
}  // namespace Core
}  // namespace Ra
