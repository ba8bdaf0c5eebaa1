#pragma once

#include "plugins/radium/render_mesh.h"

#include <souple/host/drawable.h>

namespace Ra::Engine {
class RadiumEngine;
}

namespace souple::radium {

/// Creates an entity for an object of a scene, with a mesh, or with splats for grains and ropes.
RenderMesh show_object(Ra::Engine::RadiumEngine& engine, const host::ObjectInfo& info,
                       const host::Drawable& drawable);
/// Creates an entity for a collider of a scene; its local transform is the collider's pose.
RenderMesh show_collider(Ra::Engine::RadiumEngine& engine, const host::ColliderShape& shape);

}  // namespace souple::radium
