#pragma once

#include "souple/contacts/collider_contacts.h"
#include "souple/contacts/particle_contacts.h"
#include "souple/solver/solver.h"
#include "souple/state/particles.h"

#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace souple::test {

/// Radius of an object whose old overlaps are removed at 3 m/s [m]: a fall by it takes it to that speed.
constexpr float radius_at_3_mps = 9.0f / (2 * 9.81f);

/// A simulation loop with contacts only.
struct MiniWorld {
  void add(const Vec3d& x, float radius_, float mass = 1, const Vec3f& v = {}) {
    const Vec3f rounded(x);
    position.push_back({rounded.x, rounded.y, rounded.z, mass > 0 ? 1 / mass : 0.0f});
    const Vec3f rest(x - Vec3d(rounded));  // of rounding the position
    offset.push_back({rest.x, rest.y, rest.z, 0});
    velocity.push_back({v.x, v.y, v.z, 0});
    radius.push_back(radius_);
    element_radius.push_back(0);
  }
  /// Makes an object of the particles added since the last one.
  ContactObject& end_object(const ContactMaterial& material, const std::string& name = "object") {
    ContactObject object;
    object.begin = objects.empty() ? 0 : objects.back().end;
    object.end = static_cast<std::uint32_t>(position.size());
    objects.push_back(object);
    materials.push_back({name, material});
    return objects.back();
  }
  void add_collider(Shape shape, const ContactMaterial& material, ColliderMotion motion = {}) {
    colliders.push_back({"collider", shape, motion, material, true});
  }

  /// Finds the contact candidates of a step.
  void begin_step(double dt) {
    std::vector<NamedContactMaterial> named, obstacles;
    for (std::size_t k = 0; k < objects.size(); ++k)
      named.push_back({names(k), materials[k].second, {}, radius_at_3_mps});
    for (const Collider& collider : colliders) obstacles.push_back({collider.name, collider.material});
    tables = {objects, colliders, {}, {named, obstacles, table}, {named, named, table}};
    start = offset;
    begin_step(ContactStep{time, float(dt), length(gravity)});
  }
  /// With `tables` as they are.
  void begin_step(const ContactStep& step) {
    const ContactInput input{view(), velocity, radius, element_radius, {}, tables, step};
    on_colliders.begin_step(input, *threads);
    on_particles.begin_step(input, *threads);
  }

  void step(double dt, int substeps, int iterations = 1) {
    begin_step(dt);
    for (int s = 0; s < substeps; ++s)
      substep({.h = float(dt / substeps), .iterations = iterations, .mode = Mode::small_steps, .number = s});
  }

  void substep(const Substep& substep) {
    const float h = substep.h;
    start = offset;
    for (std::size_t i = 0; i < position.size(); ++i) {
      if (position[i].w == 0) continue;
      velocity[i].set_xyz(velocity[i].xyz() + gravity * h);
      offset[i].set_xyz(offset[i].xyz() + velocity[i].xyz() * h);
    }
    on_colliders.refresh(view(), substep, time, *threads);
    on_particles.refresh(view(), substep, time, *threads);
    Substep swept = substep;
    for (swept.sweep = substep.first_sweep(); swept.sweep < substep.first_sweep() + substep.iterations;
         ++swept.sweep)
      for (Projector* const contacts :
           {static_cast<Projector*>(&on_particles), static_cast<Projector*>(&on_colliders)})
        sweep(*contacts, view(), swept, *threads);
    for (std::size_t i = 0; i < position.size(); ++i) {
      if (position[i].w == 0) continue;
      velocity[i].set_xyz((offset[i].xyz() - start[i].xyz()) * (1 / h));
      const Vec3f before = position[i].xyz();
      position[i].set_xyz(before + offset[i].xyz());
      offset[i].set_xyz(offset[i].xyz() - (position[i].xyz() - before));
    }
    on_colliders.apply_restitution(view(), velocity, substep, *threads);
    on_particles.apply_restitution(view(), velocity, substep, *threads);
    time += double(h);
  }

  ParticleView view() { return {position, offset, start}; }
  Vec3d at(std::size_t i) const { return exact_sum(position[i], offset[i]); }
  std::string_view names(std::size_t k) const { return materials[k].first; }

  /// FNV-1a 64 over positions, then velocities.
  std::uint64_t hash() const {
    std::uint64_t value = 14695981039346656037u;
    for (const auto* array : {&position, &offset, &velocity}) {
      for (const Vec4f& v : *array) {
        unsigned char bytes[12];
        std::memcpy(bytes, &v, sizeof bytes);
        for (const unsigned char byte : bytes) value = (value ^ byte) * 1099511628211u;
      }
    }
    return value;
  }

  Vec3f gravity{0, -9.81f, 0};
  double time = 0;
  std::vector<Vec4f> position, offset, start, velocity;
  std::vector<float> radius, element_radius;
  std::vector<ContactObject> objects;
  std::vector<std::pair<std::string, ContactMaterial>> materials;
  std::vector<Collider> colliders;
  PairOverrides table;
  ContactTables tables;
  ColliderContacts on_colliders;
  ParticleContacts on_particles;
  std::shared_ptr<Threads> threads = make_threads(Threading::serial, 1);
};

}  // namespace souple::test
