#pragma once

#include "souple/scene/scene.h"
#include "souple/scene/table.h"

namespace souple::scene_format {

/// The keys of a scene: the one place where names, units, ranges, defaults and meanings stand.
CodecPtr<SceneDescription> scene_codec();

}  // namespace souple::scene_format
