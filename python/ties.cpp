#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/objects/tie_options.h"

namespace souple::python {

void bind_ties(py::module_& m) {
  Struct<SurfacePoint>(m, "SurfacePoint")
      .fields<&SurfacePoint::object, &SurfacePoint::vertices, &SurfacePoint::weights>();
  Struct<TieSlide>(m, "TieSlide").fields<&TieSlide::along, &TieSlide::friction>();
  Struct<TieOptions>(m, "TieOptions")
      .fields<&TieOptions::name, &TieOptions::point, &TieOptions::point_b, &TieOptions::rest_length,
              &TieOptions::compliance, &TieOptions::breaking_force, &TieOptions::breaking_strain,
              &TieOptions::slide>();
  Result<TieReport>(m, "TieReport")
      .fields<&TieReport::name, &TieReport::point_a, &TieReport::point_b, &TieReport::force,
              &TieReport::rest_length, &TieReport::segment, &TieReport::along, &TieReport::broken>();
}

}  // namespace souple::python
