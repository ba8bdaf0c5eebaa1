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

/// An object of the world and the mesh of Radium that shows it.
struct Body {
  std::string name;
  host::Drawable drawable;
  RenderMesh mesh;
  bool from_scene = false;
  std::array<float, 16> transform{};             ///< the mesh's, as the world last heard of it
  std::vector<float> first_positions{};          ///< how the mesh lay when it became an object
  std::vector<float> first_normals{};            ///< the same
  Ra::Engine::Scene::Component* mark = nullptr;  ///< in Radium's tree; nullptr once it was deleted there

  host::Handle object() const { return drawable.object(); }
};

}  // namespace souple::radium
