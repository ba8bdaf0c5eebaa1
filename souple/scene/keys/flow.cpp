#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

template <class T>
void add_times(Table<T>& keys) {
  keys.template key<&T::start>("start", number<double>(from_zero(1e6)), "when it begins [s]")
      .template key<&T::end>("end", maybe(number<double>(from_zero(1e6))),
                             "when it ends [s]; if not given, never")
      .check([](const T& value, const JsonPath& path) {
        if (value.end && *value.end < value.start) path.key("end").fail("is before \"start\"");
      });
}

}  // namespace

CodecPtr<EmitterDescription> emitter_codec() {
  using E = EmitterDescription;
  auto keys =
      table<E>("emitter",
               "A round nozzle from which a fluid comes, layer after layer, a spacing apart. It holds "
               "back what finds other fluid in its way, and what is more than `max_particles`.");
  keys->required<&E::position>("position", vector3<float>(meters), "of its middle [m]")
      .key<&E::direction>("direction", vector3<float>(meters), "where the fluid goes; any length but zero")
      .key<&E::radius>("radius", number<float>(from_zero(far_away)),
                       "[m]; below the spacing: a thread of one particle after another")
      .key<&E::speed>("speed", number<float>(positive(1e4)), "[m/s]")
      .key<&E::keyframes>("keyframes", keyframes_codec(),
                          "poses that move and turn it; the fluid takes over its velocity")
      .key<&E::loop>("loop", boolean(), "starts the keyframes over after the last")
      .needs("loop", "keyframes")
      .check([](const E& emitter, const JsonPath& path) {
        check_times(emitter.keyframes, path);
        if (!(length_squared(Vec3d(emitter.direction)) > 1e-12))
          path.key("direction").fail("must not be zero");
      });
  add_times(*keys);
  return keys;
}

CodecPtr<DrainDescription> drain_codec() {
  using D = DrainDescription;
  auto keys = table<D>("drain", "A region in which fluids cease to exist.");
  keys->required<&D::shape>("shape", shape_codec(), "the region; a plane takes what is below it")
      .key<&D::transform>("transform", pose_codec(), "where it stands")
      .key<&D::rate>("rate", maybe(number<float>(positive(1e9))),
                     "at most so much a second [m^3/s]; if not given, all that comes");
  add_times(*keys);
  return keys;
}

}  // namespace souple::scene_format
