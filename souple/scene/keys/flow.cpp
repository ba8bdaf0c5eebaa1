#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

template <class T>
void add_times(Table<T>& keys) {
  keys.template key<&T::start>("start", number<double>(from_zero(1e6)), "start time [s]")
      .template key<&T::end>("end", maybe(number<double>(from_zero(1e6))),
                             "end time [s]; if not given, never")
      .check([](const T& value, const JsonPath& path) {
        if (value.end && *value.end < value.start) path.key("end").fail("must not be before \"start\"");
      });
}

}  // namespace

CodecPtr<EmitterDescription> emitter_codec() {
  using E = EmitterDescription;
  auto keys = table<E>("emitter",
                       "A round nozzle that emits fluid in layers, one spacing apart. It withholds particles "
                       "that would overlap other fluid or exceed `max_particles`.");
  keys->required<&E::position>("position", vector3<float>(meters), "center of the nozzle [m]")
      .key<&E::direction>("direction", vector3<float>(meters), "direction of the flow; any nonzero length")
      .key<&E::radius>("radius", number<float>(from_zero(far_away)),
                       "radius of the nozzle [m]; below the spacing: a single row of particles")
      .key<&E::speed>("speed", number<float>(positive(1e4)), "speed of the fluid [m/s]")
      .check([](const E& emitter, const JsonPath& path) {
        if (!(length_squared(Vec3d(emitter.direction)) > 1e-12))
          path.key("direction").fail("must not be zero");
      });
  add_keyframe_keys(*keys, "poses that move and rotate the nozzle; the fluid inherits its velocity");
  add_times(*keys);
  return keys;
}

CodecPtr<DrainDescription> drain_codec() {
  using D = DrainDescription;
  auto keys = table<D>("drain", "A region that removes fluid.");
  keys->required<&D::shape>("shape", shape_codec(), "the region; a plane removes all fluid below it")
      .key<&D::transform>("transform", pose_codec(), "position and rotation")
      .key<&D::rate>("rate", maybe(number<float>(positive(1e9))),
                     "maximum rate [m^3/s]; if not given, all fluid in the region");
  add_times(*keys);
  return keys;
}

}  // namespace souple::scene_format
