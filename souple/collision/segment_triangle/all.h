#pragma once

#include "souple/collision/segment_triangle/inclusion.h"
#include "souple/collision/segment_triangle/moeller_trumbore.h"
#include "souple/collision/segment_triangle/plane_projection.h"
#include "souple/collision/segment_triangle/signed_volumes.h"
#include "souple/collision/segment_triangle/watertight.h"
