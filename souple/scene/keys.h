#pragma once

#include "souple/scene/table.h"

namespace souple {

struct SceneDescription;

namespace scene_format {

/// All keys of a scene: the single definition of names, units, ranges, defaults and texts.
CodecPtr<SceneDescription> scene_codec();

}  // namespace scene_format

}  // namespace souple
