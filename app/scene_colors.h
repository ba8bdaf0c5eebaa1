#pragma once

#include "render/subject.h"
#include "souple/scene/scene.h"

namespace souple::app {

/// Applies the colors of the scene's entries to the bodies and colliders of `subject` with equal names. Omits
/// hidden colliders.
void add_colors(const SceneDescription& scene, render::Subject& subject);

}  // namespace souple::app
