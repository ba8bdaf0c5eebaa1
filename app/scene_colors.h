#pragma once

#include "render/subject.h"
#include "souple/scene/scene.h"

namespace souple::app {

/// Gives the bodies and colliders of `subject` the colors that the scene's entries of the same name ask for.
/// Colliders that are not to be shown are left out.
void add_colors(const SceneDescription& scene, render::Subject& subject);

}  // namespace souple::app
