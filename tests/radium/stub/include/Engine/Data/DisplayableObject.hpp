#pragma once

#include <Core/Geometry/TriangleMesh.hpp>
#include <Engine/RaEngine.hpp>
#include <cstddef>
#include <string>
#include <utility>

namespace Ra {
namespace Engine {
namespace Data {

class ShaderProgram;

class Displayable {
 public:
  enum PickingRenderMode { PKM_POINTS = 0, PKM_LINES = 1, PKM_LINE_ADJ = 2, PKM_TRI = 3, NO_PICKING };

  explicit Displayable(std::string name) : m_name(std::move(name)) {}
  Displayable(const Displayable&) = delete;
  void operator=(const Displayable&) = delete;
  virtual ~Displayable() = default;

  PickingRenderMode pickingRenderMode() const { return m_pickingRenderMode; }
  const std::string& getName() const { return m_name; }

  virtual const Core::Geometry::AbstractGeometry& getAbstractGeometry() const = 0;
  virtual Core::Geometry::AbstractGeometry& getAbstractGeometry() = 0;
  virtual void updateGL() = 0;
  virtual void render(const ShaderProgram* prog) = 0;
  virtual std::size_t getNumFaces() const { return 0; }
  virtual std::size_t getNumVertices() const { return 0; }

 protected:
  PickingRenderMode m_pickingRenderMode = NO_PICKING;

 private:
  std::string m_name;
};

}  // namespace Data
}  // namespace Engine
}  // namespace Ra
