#include "plugins/radium/headless/checks.h"

#include "plugins/radium/headless/sight.h"

#include <cstring>

namespace souple::radium {

namespace {

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

std::string name_of(const Ra::Core::Vector2& pixel) {
  return "pixel " + std::to_string(static_cast<int>(pixel.x())) + ", " +
         std::to_string(static_cast<int>(pixel.y()));
}

std::string name_of(const PickedVertex& vertex) {
  return "render object " + std::to_string(vertex.render_object.getValue()) + ", triangle " +
         std::to_string(vertex.triangle) + ", corner " + std::to_string(vertex.corner);
}

}  // namespace

void check_buttons(Show& show, Checks& checks) {
  const std::uint64_t start = show.system.session().hash();
  const auto steps_are = [&](const char* after, std::uint64_t expected) {
    checks.equal(std::string("steps after ") + after, show.steps(), expected);
  };
  show.run(3);
  steps_are("3 frames without a request", 0);
  show.system.step();
  show.run(3);
  steps_are("step and 3 frames", 1);
  show.system.play();
  show.run(7);
  steps_are("play and 7 frames", 8);
  show.system.pause();
  show.run(3);
  steps_are("pause and 3 frames", 8);
  show.system.reset();
  show.run(2);
  steps_are("reset and 2 frames", 0);
  checks.is_true("after the reset all is where it was at first", show.system.session().hash() == start);
}

void check_pictures(Show& show, Checks& checks) {
  constexpr int played = 10;
  show.system.reset();
  show.run(1);
  std::vector<unsigned char> last = show.window.draw().pixels;
  show.run(1);
  checks.is_true("the picture stays the same while paused", show.window.draw().pixels == last);
  show.system.play();
  int changed = 0;
  for (int frame = 0; frame < played; ++frame) {
    show.run(1);
    std::vector<unsigned char> now = show.window.draw().pixels;
    changed += now == last ? 0 : 1;
    last = std::move(now);
  }
  checks.equal("pictures that differ from the one before, of 10 played frames", changed, played);
}

void check_against_pure_run(Show& show, Checks& checks) {
  const PureRun pure = run_scene(show.file, show.frames, double{Window::frame_time});
  show.system.reset();
  show.system.play();
  show.run(show.frames);
  show.system.pause();
  host::Session& session = show.system.session();
  checks.equal("steps", show.steps(), static_cast<std::uint64_t>(show.frames));
  checks.equal("hash of positions and velocities, and of a run without Radium", session.hash(), pure.hash);
  std::size_t equal = 0;
  for (const host::ObjectInfo& info : session.objects()) {
    std::vector<float> positions(3 * info.vertex_count);
    session.write(info.handle, {positions.data()}, info.vertex_count);
    equal += same_bits(positions, pure.positions.at(info.name)) ? 1 : 0;
  }
  checks.equal("objects whose positions are bit for bit those of that run", equal, pure.positions.size());
}

void check_picking(Show& show, Checks& checks) {
  const Sight sight(show.window, show.system);
  int tried = 0;
  for (const VisibleVertex& visible : sight.visible_vertices(5)) {
    ++tried;
    const PickedVertex picked = show.window.pick(visible.pixel);
    checks.equal("picked at " + name_of(visible.pixel), name_of(picked), name_of(visible.vertex));
    const Ra::Core::Ray ray = show.window.ray_through(visible.pixel);
    // A pinned vertex cannot be grabbed.
    if (!show.system.grab(picked, ray, show.window.facing())) continue;
    const Vec3f held = show.system.session().grabbed_point();
    const float way = (Ra::Core::Vector3(held.x, held.y, held.z) - visible.point).norm();
    checks.is_true("the grab took hold of it", way <= visible.thickness);
    show.system.release();
  }
  checks.is_true("there was something to pick", tried > 0);
}

}  // namespace souple::radium
