#pragma once

// The headers that a simulating program needs.

#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/fill.h"
#include "souple/io/recorder.h"
#include "souple/world/world.h"
