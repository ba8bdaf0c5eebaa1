#pragma once

#include "souple/scene/scene.h"
#include "souple/scene/table.h"

namespace souple::scene_format {

/// All keys of a scene: the single definition of names, units, ranges, defaults and texts.
CodecPtr<SceneDescription> scene_codec();

}  // namespace souple::scene_format
