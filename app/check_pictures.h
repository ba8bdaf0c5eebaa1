#pragma once

#include "souple/scene/scene.h"

namespace souple::app {

/// Reads the pictures and the panorama that the scene names. Throws Error that names the scene and the key of one that
/// cannot be used. A program without the renderer checks nothing.
void check_pictures(const SceneDescription& scene);

}  // namespace souple::app
