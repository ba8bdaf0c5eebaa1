#pragma once

#include "plugins/radium/render_mesh.h"

#include <souple/host/drawable.h>

namespace Ra::Engine {
class RadiumEngine;
}

namespace souple::radium {

/// Shows an object of a scene: an entity of its name with a mesh, or with splats for grains and ropes.
RenderMesh show_object(Ra::Engine::RadiumEngine& engine, const host::ObjectInfo& info,
                       const host::Drawable& drawable);
/// Shows a collider of a scene; its local transform is where it is.
RenderMesh show_collider(Ra::Engine::RadiumEngine& engine, const host::ColliderShape& shape);

}  // namespace souple::radium
