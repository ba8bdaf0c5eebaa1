#include "souple/queries/crossings.h"

#include "souple/intersections/intersection_finder.h"
#include "souple/objects/object.h"
#include "souple/queries/caches.h"
#include "souple/queries/query_view.h"

#include <limits>
#include <memory>
#include <mutex>
#include <vector>

namespace souple {

std::size_t count_crossings(const QueryView& view, const Object& object) {
  const std::uint32_t n = object.particle_count();
  if (object.surface.empty()) return 0;
  std::vector<Vec4f> position(n), unmoved(n);
  const Vec3d origin = view.particles.exact_position(object.begin);
  for (std::uint32_t i = 0; i < n; ++i)
    position[i].set_xyz(Vec3f(view.particles.exact_position(object.begin + i) - origin));
  const ParticleView particles{position, unmoved, unmoved};
  const ContactSurface surface{
      .end = n, .triangles = object.surface, .self_collision = true, .rest = object.rest};
  const std::lock_guard<std::mutex> lock(view.caches.lock);  // queries share the threads
  std::unique_ptr<Threads> own;
  if (view.threads == nullptr) own = make_threads(Threading::serial, 1);
  IntersectionFinder finder({&surface, 1});
  finder.find(particles, own ? *own : *view.threads);
  std::size_t count = 0;
  std::uint32_t last = std::numeric_limits<std::uint32_t>::max();
  for (const EdgeIntersection& found : finder.intersections()) {
    if (found.edge != last) ++count;
    last = found.edge;
  }
  return count;
}

}  // namespace souple
