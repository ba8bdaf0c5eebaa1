#pragma once

#include "render/subject.h"
#include "souple/scene/scene.h"

namespace souple::app {

/// Gives the bodies and colliders of `subject` the colors of the scene's entries with the same name. Removes
/// colliders that the scene hides.
void add_colors(const SceneDescription& scene, render::Subject& subject);

}  // namespace souple::app
