#pragma once

#include <string>
#include <utility>

namespace Ra {
namespace Core {
namespace Asset {

class AssetData {
 public:
  explicit AssetData(std::string name) : m_name(std::move(name)) {}
  AssetData(const AssetData&) = default;
  virtual ~AssetData() = default;

  virtual const std::string& getName() const { return m_name; }

 protected:
  std::string m_name;
};

}  // namespace Asset
}  // namespace Core
}  // namespace Ra
