#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/objects/tie_options.h"

namespace souple::python {

void bind_ties(py::module_& m) {
  Struct<SurfacePoint>(m, "SurfacePoint")
      .field<&SurfacePoint::object>("object")
      .field<&SurfacePoint::vertices>("vertices")
      .field<&SurfacePoint::weights>("weights");
  Struct<TieSlide>(m, "TieSlide").field<&TieSlide::along>("along").field<&TieSlide::friction>("friction");
  Struct<TieOptions>(m, "TieOptions")
      .field<&TieOptions::name>("name")
      .field<&TieOptions::point>("point")
      .field<&TieOptions::point_b>("point_b")
      .field<&TieOptions::rest_length>("rest_length")
      .field<&TieOptions::compliance>("compliance")
      .field<&TieOptions::breaking_force>("breaking_force")
      .field<&TieOptions::breaking_strain>("breaking_strain")
      .field<&TieOptions::slide>("slide");
  Result<TieReport>(m, "TieReport")
      .field<&TieReport::name>("name")
      .field<&TieReport::point_a>("point_a")
      .field<&TieReport::point_b>("point_b")
      .field<&TieReport::force>("force")
      .field<&TieReport::rest_length>("rest_length")
      .field<&TieReport::segment>("segment")
      .field<&TieReport::along>("along")
      .field<&TieReport::broken>("broken");
}

}  // namespace souple::python
