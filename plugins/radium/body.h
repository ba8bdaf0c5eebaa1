#pragma once

#include "plugins/radium/render_mesh.h"

#include <array>
#include <souple/host/drawable.h>
#include <string>
#include <vector>

namespace Ra::Engine::Scene {
class Component;
}

namespace souple::radium {

/// An object of the world and its mesh in Radium.
struct Body {
  std::string name;
  host::Drawable drawable;
  RenderMesh mesh;
  bool from_scene = false;
  std::array<float, 16> transform{};     ///< the mesh's transform when the world last read it
  std::vector<float> first_positions{};  ///< positions of the mesh when it became an object
  std::vector<float> first_normals{};    ///< normals of the mesh when it became an object
  Ra::Engine::Scene::Component* mark =
      nullptr;  ///< component in Radium's tree; nullptr after its deletion there

  host::Handle object() const { return drawable.object(); }
};

}  // namespace souple::radium
