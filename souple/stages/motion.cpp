#include "souple/stages/motion.h"

#include "souple/assert.h"
#include "souple/math/limits.h"
#include "souple/objects/object.h"
#include "souple/simd/instruction_set.h"
#include "souple/solver/kernels/find_kernels.h"
#include "souple/solver/kernels/motion.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace souple {
namespace {

// Minimum number of particles per thread.
constexpr std::size_t motion_grain = 2048;

bool is_non_finite(const Vec3f& v) {
  return !std::isfinite(v.x + v.y + v.z);
}

/// The lowest particle that any thread noted.
class LowestParticle {
 public:
  void note(std::size_t i) {
    std::size_t current = lowest_;
    while (i < current && !lowest_.compare_exchange_weak(current, i)) {
    }
  }
  std::optional<std::size_t> found() const {
    return lowest_ == none ? std::nullopt : std::optional<std::size_t>(lowest_);
  }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::atomic<std::size_t> lowest_{none};
};

/// Calls f(begin, end) for the ranges of [first, last) that belong to objects that are awake and not still.
template <class Function>
void for_each_awake(const StageView& stage, std::size_t first, std::size_t last, const Function& f) {
  if (first == last) return;
  const auto& objects = stage.objects.objects;
  std::size_t begin = first;
  for (std::size_t o = stage.objects.object_of[first]; o < objects.size() && objects[o]->begin < last; ++o) {
    if (objects[o]->sleep.island == 0 && !objects[o]->sleep.still) continue;
    if (objects[o]->begin > begin) f(begin, objects[o]->begin);
    begin = objects[o]->reserved_end();
  }
  if (begin < last) f(begin, last);
}

/// Calls f on all threads, for all awake particles.
template <class Function>
void for_each_awake(const StageView& stage, const Function& f) {
  stage.threads.for_each(stage.objects.particles.size(), motion_grain,
                         [&](std::size_t begin, std::size_t end) { for_each_awake(stage, begin, end, f); });
}

/// Calls f(in_air, begin, end) for the ranges of [first, last) whose objects all feel the air, or all do not.
template <class Function>
void for_each_air(const StageView& stage, std::size_t first, std::size_t last, const Function& f) {
  const auto& objects = stage.objects.objects;
  for (std::size_t begin = first, o = stage.objects.object_of[first]; begin < last;) {
    const bool in_air = feels_air(*objects[o], stage.settings.wind);
    std::size_t end = begin;
    while (end < last && feels_air(*objects[o], stage.settings.wind) == in_air)
      end = std::min<std::size_t>(last, objects[o++]->reserved_end());
    f(in_air, begin, end);
    begin = end;
  }
}

void predict_one(const ExternalForces& forces, std::size_t i, float h, Integrate integrate,
                 std::vector<Vec4f>& p, LowestParticle& first_non_finite) {
  Particles& particles = forces.stage.objects.particles;
  if (particles.position[i].w == 0) {
    particles.start[i] = p[i];
    return;
  }
  const double time = forces.stage.time;
  const Vec3f v = particles.velocity[i].xyz();
  const Vec3f x = particles.position[i].xyz();
  Predicted predicted;
  if (integrate == nullptr) {
    predicted.velocity = v + acceleration(forces, i, x, v, time) * h;
    predicted.move = predicted.velocity * h;
  } else {
    predicted = integrate(forces, i, x, v, h, time);
  }
  if (is_non_finite(predicted.velocity)) first_non_finite.note(i);
  particles.velocity[i].set_xyz(predicted.velocity);
  particles.start[i] = p[i];  // acceleration read the air's force there
  p[i].set_xyz(p[i].xyz() + predicted.move);
}

void finish_one(const StageView& stage, std::size_t i, float h, const std::vector<Vec4f>& p,
                const MotionScratch& scratch, LowestParticle& first_non_finite) {
  Particles& particles = stage.objects.particles;
  // v = v* + (p - p*) / h: a particle without corrections keeps its velocity bitwise. The semi-implicit p* is
  // recomputed from v* with the rounding of the prediction. A pinned particle has no v*: v = (p - x) / h.
  const bool semi_implicit = scratch.integrate == nullptr;
  const Vec3f start = particles.start[i].xyz();
  const Vec3f v_star = particles.velocity[i].xyz();
  const bool pinned = particles.position[i].w == 0;
  const Vec3f base = pinned ? Vec3f{} : v_star;
  const Vec3f since = pinned ? start : semi_implicit ? start + v_star * h : scratch.predicted[i].xyz();
  const Vec3f v = base + (p[i].xyz() - since) / h;
  particles.velocity[i].set_xyz(v);
  if (is_non_finite(v)) first_non_finite.note(i);
  // x += q; the part beyond the precision of x stays in the offset.
  const Vec3f q = particles.offset[i].xyz();
  const Vec3f x = particles.position[i].xyz();
  const Vec3f moved = x + q;
  particles.position[i].set_xyz(moved);
  particles.offset[i].set_xyz(q - (moved - x));
  if (is_non_finite(moved)) first_non_finite.note(i);
}

// SIMD kernels of predict_one and finish_one, or null if none applies.
const kernels::MotionKernels* packed(const MotionScratch& scratch) {
  return scratch.integrate == nullptr ? find_motion_kernels(instruction_set()) : nullptr;
}

kernels::MotionArrays arrays_of(const ObjectsView& objects) {
  Particles& particles = objects.particles;
  if (particles.size() == 0) return {};
  return {&particles.position.data()->x, &objects.particles.offset.data()->x, &particles.start.data()->x,
          &particles.velocity.data()->x};
}

// The SIMD kernels report only that a value may be non-finite.
void find_non_finite(const Particles& particles, std::size_t begin, std::size_t end,
                     LowestParticle& first_non_finite) {
  for (std::size_t i = begin; i < end; ++i)
    if (is_non_finite(particles.velocity[i].xyz()) || is_non_finite(particles.position[i].xyz()))
      return first_non_finite.note(i);
}

bool has_no_mass(std::span<const Vec4f> displacements) {
  return std::all_of(displacements.begin(), displacements.end(), [](const Vec4f& d) { return d.w == 0; });
}

}  // namespace

std::optional<std::size_t> predict_motion(const StageView& stage,
                                          const CallbackList<VertexForceField>& fields,
                                          const Substep& substep, MotionScratch& scratch) {
  const ObjectsView& objects = stage.objects;
  const ExternalForces forces{stage, fields, wind_at(stage.settings, stage.time)};
  find_air_forces(stage, substep.h, scratch.air_thirds);
  std::vector<Vec4f>& p = objects.particles.offset;
  LowestParticle first_non_finite;
  const auto one_by_one = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      predict_one(forces, i, substep.h, scratch.integrate, p, first_non_finite);
  };
  const kernels::MotionKernels* kernels = packed(scratch);
  if (!fields.empty()) {
    one_by_one(0, objects.particles.size());  // users' functions run on the user's thread
  } else if (!kernels || stage.settings.drag > 0) {
    for_each_awake(stage, one_by_one);
  } else {
    const Vec3f& g = stage.settings.gravity;
    const float gravity[3] = {g.x, g.y, g.z};
    const kernels::MotionArrays arrays = arrays_of(objects);
    for_each_awake(stage, [&](std::size_t first, std::size_t last) {
      for_each_air(stage, first, last, [&](bool in_air, std::size_t begin, std::size_t end) {
        const kernels::Predict predict = in_air ? kernels->predict_in_air : kernels->predict;
        if (!predict(arrays, begin, end, gravity, substep.h))
          find_non_finite(objects.particles, begin, end, first_non_finite);
      });
    });
  }
  return first_non_finite.found();
}

void keep_prediction(const StageView& stage, MotionScratch& scratch) {
  if (scratch.integrate != nullptr) scratch.predicted = stage.objects.particles.offset;
}

std::optional<std::size_t> finish_motion(const StageView& stage, const Substep& substep,
                                         const MotionScratch& scratch) {
  const ObjectsView& objects = stage.objects;
  SOUPLE_ASSERT(has_no_mass(objects.particles.offset), "displacements have no mass in their last lane");
  const std::vector<Vec4f>& p = objects.particles.offset;
  LowestParticle first_non_finite;
  if (const kernels::MotionKernels* kernels = packed(scratch)) {
    const kernels::MotionArrays arrays = arrays_of(objects);
    for_each_awake(stage, [&](std::size_t begin, std::size_t end) {
      if (!kernels->finish(arrays, begin, end, substep.h))
        find_non_finite(objects.particles, begin, end, first_non_finite);
    });
  } else {
    for_each_awake(stage, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) finish_one(stage, i, substep.h, p, scratch, first_non_finite);
    });
  }
  return first_non_finite.found();
}

std::optional<std::size_t> find_non_finite(const StageView& stage) {
  LowestParticle first_non_finite;
  for_each_awake(stage, [&](std::size_t begin, std::size_t end) {
    find_non_finite(stage.objects.particles, begin, end, first_non_finite);
  });
  return first_non_finite.found();
}

std::optional<std::size_t> find_out_of_range(const ObjectsView& objects, Threads& threads) {
  constexpr auto limit = static_cast<float>(range::coordinate);
  const std::vector<Vec4f>& position = objects.particles.position;
  LowestParticle lowest;
  for (const auto& object : objects.objects)
    threads.for_each(object->particle_count(), 4 * motion_grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = object->begin + begin; i < object->begin + end; ++i) {
        const Vec3f x = position[i].xyz();
        if (max(abs(x.x), max(abs(x.y), abs(x.z))) > limit) return lowest.note(i);
      }
    });
  return lowest.found();
}

}  // namespace souple
