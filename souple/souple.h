#pragma once

// The headers that a simulating program needs. User constraints need solver/set_projector.h or
// solver/custom_constraint.h, scene files scene/scene.h, mesh files mesh_files/mesh_file.h.

#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/fill.h"
#include "souple/io/recorder.h"
#include "souple/objects/joint_options.h"
#include "souple/objects/kind_traits.h"
#include "souple/objects/tie_options.h"
#include "souple/rigid/joints/joint.h"
#include "souple/world/debug_draw.h"
#include "souple/world/memory.h"
#include "souple/world/profile.h"
#include "souple/world/world.h"
