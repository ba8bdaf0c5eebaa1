#include "souple/error.h"
#include "souple/simd/instruction_set.h"
#include "souple/version.h"
#include "web/src/calls.h"
#include "web/src/held_world.h"

#include <cstdint>
#include <filesystem>
#include <malloc.h>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

// The functions behind World in souple.js, which checks what users pass.

namespace souple::web {

namespace {

std::vector<std::string> lines(std::string_view text) {
  std::vector<std::string> result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    result.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

std::vector<std::uint32_t> copied(const std::uint32_t* values, int count) {
  return {values, values + count};
}

}  // namespace

SOUPLE_CALL const char* souple_error() {
  std::string& text = last_error();
  if (text.empty()) return nullptr;
  const char* kept = keep(text);
  text.clear();
  return kept;
}

SOUPLE_CALL const char* souple_version() {
  return keep(fmt::format("Souple {}, {}", version, simd_name()));
}

/// Bytes that are in use, of those that the module has.
SOUPLE_CALL double souple_memory_used() {
  return static_cast<double>(mallinfo().uordblks);
}

SOUPLE_CALL HeldWorld* souple_open_file(const char* file, const char* overrides) {
  return guarded([&] {
    const std::filesystem::path path(file);
    return new HeldWorld(load_scene(path, lines(overrides)), path.stem().string());
  });
}
SOUPLE_CALL HeldWorld* souple_open_text(const char* text, const char* folder, const char* name,
                                        const char* overrides) {
  return guarded([&] { return new HeldWorld(parse_scene(text, folder, name, lines(overrides)), name); });
}
SOUPLE_CALL void souple_close(HeldWorld* world) {
  delete world;
}

SOUPLE_CALL void souple_step(HeldWorld* world, double dt) {
  guarded([&] { world->step(dt); });
}
SOUPLE_CALL void souple_reset(HeldWorld* world) {
  guarded([&] { world->reset(); });
}
SOUPLE_CALL double souple_time(HeldWorld* world) {
  return world->world().time();
}
SOUPLE_CALL double souple_frame_rate(HeldWorld* world) {
  return world->simulation().frame_rate();
}
SOUPLE_CALL const char* souple_hash(HeldWorld* world) {
  return guarded([&] { return keep(fmt::format("{:016x}", world->world().hash())); });
}
SOUPLE_CALL const char* souple_objects(HeldWorld* world) {
  return guarded([&] { return keep(world->objects_text()); });
}
SOUPLE_CALL const char* souple_report(HeldWorld* world) {
  return guarded([&] { return keep(world->report_text()); });
}
SOUPLE_CALL const char* souple_scene(HeldWorld* world) {
  return guarded([&] { return keep(world->simulation().scene_text()); });
}
SOUPLE_CALL const char* souple_tunables(HeldWorld* world, int object) {
  return guarded([&] { return keep(world->tunables_text(static_cast<std::size_t>(object))); });
}
SOUPLE_CALL const char* souple_add(HeldWorld* world, const char* object) {
  return guarded([&] { return keep(world->add(object)); });
}
SOUPLE_CALL void souple_set(HeldWorld* world, const char* setting) {
  guarded([&] { world->set(setting); });
}

// --- arrays, in the module's memory; 0 where there is none
SOUPLE_CALL const Vec3f* souple_positions(HeldWorld* world, std::uint32_t object) {
  return guarded([&] { return world->world().positions({object}).data(); });
}
SOUPLE_CALL const Vec3f* souple_velocities(HeldWorld* world, std::uint32_t object) {
  return guarded([&] { return world->world().velocities({object}).data(); });
}
SOUPLE_CALL const Vec3f* souple_normals(HeldWorld* world, std::uint32_t object) {
  return guarded([&] { return world->world().normals({object}).data(); });
}
SOUPLE_CALL const Triangle* souple_triangles(HeldWorld* world, std::uint32_t object) {
  return guarded([&] { return world->world().triangles({object}).data(); });
}
SOUPLE_CALL int souple_vertex_count(HeldWorld* world, std::uint32_t object) {
  return guarded([&] { return static_cast<int>(world->world().positions({object}).size()); });
}

// --- pins and the hand
SOUPLE_CALL void souple_pin(HeldWorld* world, std::uint32_t object, const std::uint32_t* which, int count) {
  guarded([&] { world->world().pin({object}, vertices(copied(which, count))); });
}
SOUPLE_CALL void souple_unpin(HeldWorld* world, std::uint32_t object, const std::uint32_t* which, int count) {
  guarded([&] { world->world().unpin({object}, vertices(copied(which, count))); });
}
SOUPLE_CALL void souple_move_pins(HeldWorld* world, std::uint32_t object, const std::uint32_t* which,
                                  int count, const Vec3f* positions) {
  const auto n = static_cast<std::size_t>(count);
  guarded([&] { world->world().move_pins({object}, std::span(which, n), std::span(positions, n)); });
}
SOUPLE_CALL int souple_grab(HeldWorld* world, const Vec3f* ray, float reach) {
  return guarded([&] { return world->grab({ray[0], ray[1]}, reach, ray[2]) ? 1 : 0; });
}
SOUPLE_CALL void souple_drag(HeldWorld* world, const Vec3f* ray) {
  guarded([&] { world->drag({ray[0], ray[1]}); });
}
SOUPLE_CALL void souple_release(HeldWorld* world) {
  world->release();
}

}  // namespace souple::web
