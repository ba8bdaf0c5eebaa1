#pragma once

#include "souple/collision/segment_triangle/watertight.h"
#include "souple/studies/segment_triangle/inclusion.h"
#include "souple/studies/segment_triangle/moeller_trumbore.h"
#include "souple/studies/segment_triangle/plane_projection.h"
#include "souple/studies/segment_triangle/signed_volumes.h"
