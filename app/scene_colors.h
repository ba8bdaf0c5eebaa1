#pragma once

#include "render/subject.h"
#include "souple/scene/scene.h"

namespace souple::app {

/// Gives the bodies and colliders of `subject` the colors and looks of the scene's entries with the same name, and the
/// scene's sky. Removes colliders that the scene hides. Throws Error that names a picture that cannot be read.
void add_colors(const SceneDescription& scene, render::Subject& subject);

}  // namespace souple::app
