#include "souple/collision/surface_contacts.h"

#include "souple/collision/continuous.h"
#include "souple/collision/kernels/find_kernels.h"
#include "souple/collision/nearest.h"
#include "souple/error.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace souple {
namespace {

using kernels::Classification;

constexpr std::size_t contact_grain = 256;
constexpr std::uint16_t no_color = std::numeric_limits<std::uint16_t>::max();
constexpr std::uint32_t no_vertex = std::numeric_limits<std::uint32_t>::max();
// Nearer than this no side is left to keep: what began so is not held back, or two sheets that lie in one
// plane would never come apart. [m]
constexpr float touching = 1e-8f;

const kernels::ElementPairKernels& packed() {
  return kernels::find_element_pair_kernels(instruction_set());
}

/// The four particles of a pair relative to the first: when the substep began, and where they go.
struct Motion {
  Vec3f x[4], p[4];
};

Motion motion_of(const NearPair& pair, const ParticleView& particles) {
  const auto& i = pair.particle;
  Motion motion;
  const Vec3f moved = particles.moved(i[0]);
  for (std::size_t k = 1; k < 4; ++k) {
    motion.p[k] = particles.difference(i[k], i[0]);
    motion.x[k] = motion.p[k] - (particles.moved(i[k]) - moved);
  }
  return motion;
}

/// The part of x -> p that brings nothing into touch.
float safe_time(const Motion& motion, bool edges) {
  Moving4 moving;
  for (std::size_t k = 0; k < 4; ++k) moving.x[k] = Vec3d(motion.x[k]), moving.p[k] = Vec3d(motion.p[k]);
  const double time = edges ? edge_edge_time(moving, 0) : vertex_triangle_time(moving, 0);
  return static_cast<float>(time);
}

/// Whether there is a line between the two where that part of their way has led them, and one of them can
/// move along it.
bool has_normal(const NearPair& pair, const Motion& motion, float part, bool edges,
                const ParticleView& particles) {
  Vec3f at[4];
  for (std::size_t k = 1; k < 4; ++k) at[k] = motion.x[k] + (motion.p[k] - motion.x[k]) * part;
  float c[4] = {1, 0, 0, 0};
  if (edges) {
    float s = 0, t = 0;
    nearest_on_edges(at[0], at[1], at[2], at[3], s, t);
    c[0] = 1 - s, c[1] = s, c[2] = t - 1, c[3] = -t;
  } else {
    float weight[3];
    nearest_on_triangle(at[0], at[1], at[2], at[3], weight);
    for (std::size_t k = 0; k < 3; ++k) c[k + 1] = -weight[k];
  }
  float inverse_mass = 0;
  for (std::size_t k = 0; k < 4; ++k) inverse_mass += particles.inverse_mass(pair.particle[k]) * c[k] * c[k];
  return inverse_mass > 0 && length(at[1] * c[1] + at[2] * c[2] + at[3] * c[3]) > 0;
}

// Whether a way from q to k begins towards the origin: by more than rounding can tell, or what is just above
// a side would be over neither triangle.
bool is_over(const Vec3f& q, const Vec3f& k) {
  constexpr float sine = 1e-4f;
  const float along = -dot(q, k - q);
  return along > 0 && along * along > sine * sine * length_squared(q) * length_squared(k - q);
}

}  // namespace

void SurfaceContacts::set_surfaces(std::vector<ContactSurface> surfaces) {
  forget_contacts();
  pairs_.set_surfaces(std::move(surfaces));
  if (!pairs_.any()) return;
  find_sides();
  // Colors and what the solver leaves undone come and go.
  used_.reserve(3 * pairs_.particle_count());
  begin_.reserve(512), next_place_.reserve(512);
  cut_pair_.reserve(256), cut_part_.reserve(256), cuts_.reserve(256);
  cut_particles_.reserve(2048);
  rescues_.resize(256);
}

// --- what is there more than once

void SurfaceContacts::find_sides() {
  const std::size_t n = pairs_.particle_count();
  owner_of_vertex_.assign(n, {no_vertex, no_vertex, no_vertex});
  struct OfVertex {
    std::uint32_t vertex;
    Side side;
  };
  std::vector<OfVertex> found;
  for (std::size_t a = 0; a < pairs_.surface_count(); ++a) {
    const ContactSurface& surface = pairs_.surface(a);
    for (std::array<std::uint32_t, 3> t : surface.triangles) {
      for (std::uint32_t& i : t) i += surface.begin;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t i = t[k], j = t[(k + 1) % 3], third = t[(k + 2) % 3];
        if (owner_of_vertex_[i][0] == no_vertex) owner_of_vertex_[i] = t;
        found.push_back({i, {j, third}});
        found.push_back({j, {i, third}});
      }
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const OfVertex& a, const OfVertex& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.side.other < b.side.other;
  });
  sides_.clear();
  side_begin_.assign(n + 1, 0);
  for (const OfVertex& one : found) {
    sides_.push_back(one.side);
    ++side_begin_[one.vertex + 1];
  }
  for (std::size_t i = 0; i < n; ++i) side_begin_[i + 1] += side_begin_[i];
}

// Whether the triangle of a pair is the one that stands for the side or the corner where its nearest point
// lies: bit k of on_border says that corner k has no weight.
bool SurfaceContacts::is_owner(const NearPair& pair, unsigned on_border,
                               const ParticleView& particles) const {
  if (on_border == 0) return true;
  if (std::has_single_bit(on_border))
    return is_owner_of_side(pair, static_cast<std::size_t>(std::countr_zero(on_border)), particles);
  const auto k = static_cast<std::size_t>(std::countr_zero(~on_border & 7u)) % 3;
  return is_owner_of_corner(pair, k, particles);
}

// The side across from a corner. Of all triangles that have it none may reach below the vertex x: with q the
// nearest point of the side and k the corner across, (x - q) . (k - q) <= 0.
bool SurfaceContacts::is_owner_of_side(const NearPair& pair, std::size_t corner,
                                       const ParticleView& particles) const {
  const std::uint32_t x = pair.particle[0], k = pair.particle[1 + corner];
  const std::uint32_t i = pair.particle[1 + (corner + 1) % 3], j = pair.particle[1 + (corner + 2) % 3];
  const Vec3f to_i = particles.difference(i, x), to_j = particles.difference(j, x);
  const float s = nearest_on_edge(Vec3f{}, to_i, to_j);
  const Vec3f to_q = to_i * (1 - s) + to_j * s;
  bool first = true;
  for (std::uint32_t n = side_begin_[i]; n < side_begin_[i + 1]; ++n) {
    if (sides_[n].other != j) continue;
    const std::uint32_t third = sides_[n].third;
    if (first && third != k) return false;
    first = false;
    if (third != k && third != x && is_over(to_q, particles.difference(third, x))) return false;
  }
  return true;
}

// The same of all sides that meet in a corner.
bool SurfaceContacts::is_owner_of_corner(const NearPair& pair, std::size_t corner,
                                         const ParticleView& particles) const {
  const auto& i = pair.particle;
  const std::uint32_t x = i[0], q = i[1 + corner];
  for (const std::uint32_t k : owner_of_vertex_[q])
    if (k != i[1] && k != i[2] && k != i[3]) return false;
  const Vec3f to_q = particles.difference(q, x);
  for (std::uint32_t n = side_begin_[q]; n < side_begin_[q + 1]; ++n) {
    const std::uint32_t other = sides_[n].other;
    if (other != x && is_over(to_q, particles.difference(other, x))) return false;
  }
  return true;
}

// --- what touches

void SurfaceContacts::begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                                 std::span<const float> radius, std::span<float> contact_margin,
                                 const ContactMaterialTable& matrix, const ContactStep& step,
                                 Threads& threads) {
  forget_contacts();
  pairs_.clear();
  if (!pairs_.any()) return;
  if (matrix.rows() < pairs_.surface_count() || matrix.columns() < pairs_.surface_count())
    throw Error("SurfaceContacts: the surface matrix is smaller than surfaces x surfaces; build it anew");
  matrix_ = &matrix;
  step_ = step;
  contact_margin_ = contact_margin;
  pairs_.begin_step(particles, velocity, radius, contact_margin, step, threads);
  renew_colors();
}

void SurfaceContacts::forget_contacts() {
  contacts_.resize(0);
  begin_.assign(1, 0);
}

// Pairs from there on are new; 0: all.
void SurfaceContacts::renew_colors_from(std::size_t renewed_from) {
  if (renewed_from == 0) return renew_colors();
  const std::size_t known = color_.size();
  resize_with_spare(color_, pairs_.size());
  std::fill(color_.begin() + static_cast<std::ptrdiff_t>(known), color_.end(), no_color);
}

void SurfaceContacts::renew_colors() {
  resize_with_spare(color_, pairs_.size());
  std::fill(color_.begin(), color_.end(), no_color);
  used_.assign(pairs_.particle_count(), 0);
}

// of_chunk(index, what it found).
template <class Function>
void SurfaceContacts::find(std::vector<Touch>& found, Threads& threads, const Function& of_chunk) {
  const std::size_t count = pairs_.chunk_count();
  if (found_.size() < count) {
    const std::size_t before = found_.size();
    found_.resize(count + count / 2 + 16);
    for (std::size_t c = before; c < found_.size(); ++c) found_[c].touches.reserve(ElementPairs::chunk_size);
  }
  threads.for_each(count, 4, [&](std::size_t c, std::size_t last) {
    for (; c < last; ++c) {
      found_[c].touches.clear();
      of_chunk(c, found_[c].touches);
    }
  });
  std::size_t sum = 0;
  for (std::size_t c = 0; c < count; ++c) {
    found_[c].place = sum;
    sum += found_[c].touches.size();
  }
  resize_with_spare(found, sum, ContactArrays::spare);
  for (std::size_t c = 0; c < count; ++c)
    std::copy(found_[c].touches.begin(), found_[c].touches.end(),
              found.begin() + static_cast<std::ptrdiff_t>(found_[c].place));
}

void SurfaceContacts::refresh(const ParticleView& particles, const Substep& substep, Threads& threads) {
  forget_contacts();
  if (!pairs_.any()) return;
  limits_ = {1 / substep.h, 2 * step_.gravity * substep.h, step_.depenetration_speed * substep.h};
  pairs_.begin_substep(substep.h);
  renew_colors_from(pairs_.update(particles, substep.h, threads));
  pairs_.measure(particles, threads);
  find(touches_, threads,
       [&](std::size_t chunk, std::vector<Touch>& found) { find_touching(chunk, particles, found); });
  sort_touches(particles);
  describe_touches(particles, threads);
}

void SurfaceContacts::find_touching(std::size_t chunk, const ParticleView& particles,
                                    std::vector<Touch>& found) {
  std::uint32_t near[ElementPairs::chunk_size];
  float classification[ElementPairs::chunk_size];
  const kernels::ParticleRecords records = pairs_.particle_records(particles);
  const std::size_t count =
      pairs_.find_near(chunk, {1, 1 + speculative_part, pairs_.contact_margin(chunk)}, records, near);
  if (count == 0) return;
  packed().classify[pairs_.chunk(chunk).edges ? 1 : 0](records, pairs_.columns(), speculative_part, near, 0,
                                                       count, classification);
  for (std::size_t k = 0; k < count; ++k) {
    float part = 1;
    if (!pairs_.is_replaced(near[k]) &&
        is_contact(near[k], static_cast<unsigned>(classification[k]), particles, part))
      found.push_back({near[k], part});
  }
}

bool SurfaceContacts::is_contact(std::uint32_t pair, unsigned classification, const ParticleView& particles,
                                 float& part) const {
  const bool edges = pairs_.are_edges(pair);
  const NearPair& particle = pairs_.pair(pair);
  if ((classification & Classification::fast) != 0) {
    const Motion motion = motion_of(particle, particles);
    part = safe_time(motion, edges);
    if (part < 1) return has_normal(particle, motion, part, edges, particles);
  }
  if ((classification & Classification::touches) == 0) return false;
  const unsigned on_border = classification / Classification::on_border;
  if (!edges) return is_owner(particle, on_border, particles);
  const auto is_rope = [&](std::uint32_t i) {
    return pairs_.surface(pairs_.surface_of(i)).triangles.empty();
  };
  return on_border == 0 || is_rope(particle.particle[0]) || is_rope(particle.particle[2]);
}

// --- colors

// The lowest color that none of its particles has yet. A particle that cannot move takes none.
std::uint16_t SurfaceContacts::color_of(const NearPair& pair, const ParticleView& particles) {
  const std::size_t n = pairs_.particle_count();
  for (std::size_t round = 0;; ++round) {
    if (used_.size() == round * n) used_.resize(used_.size() + n, 0);
    std::uint64_t* const used = used_.data() + round * n;
    std::uint64_t taken = 0;
    for (const std::uint32_t i : pair.particle)
      if (particles.inverse_mass(i) > 0) taken |= used[i];
    if (taken == ~std::uint64_t{0}) continue;
    const int bit = std::countr_one(taken);
    for (const std::uint32_t i : pair.particle) used[i] |= std::uint64_t{1} << bit;
    return static_cast<std::uint16_t>(64 * round + static_cast<std::size_t>(bit));
  }
}

// By color, and within a color in order of pairs, which has vertices and triangles first.
void SurfaceContacts::sort_touches(const ParticleView& particles) {
  next_place_.assign(next_place_.capacity() > 0 ? 2 : 256, 0);
  for (const Touch& touch : touches_) {
    std::uint16_t& color = color_[touch.pair];
    if (color == no_color) color = color_of(pairs_.pair(touch.pair), particles);
    const std::size_t kind = 2 * std::size_t{color} + (pairs_.are_edges(touch.pair) ? 1 : 0);
    if (next_place_.size() <= kind) next_place_.resize(2 * std::size_t{color} + 2, 0);
    ++next_place_[kind];
  }
  begin_.clear();
  std::size_t sum = 0;
  for (std::size_t kind = 0; kind < next_place_.size(); kind += 2) {
    const std::size_t vertices = next_place_[kind], edges = next_place_[kind + 1];
    next_place_[kind] = sum, next_place_[kind + 1] = sum + vertices;
    if (vertices + edges == 0) continue;
    begin_.push_back(sum), begin_.push_back(sum + vertices);
    sum += vertices + edges;
  }
  begin_.push_back(sum);
  resize_with_spare(pair_, sum, ContactArrays::spare);
  resize_with_spare(part_, sum, ContactArrays::spare);
  for (const Touch& touch : touches_) {
    const std::size_t place =
        next_place_[2 * std::size_t{color_[touch.pair]} + (pairs_.are_edges(touch.pair) ? 1 : 0)]++;
    pair_[place] = touch.pair;
    part_[place] = touch.part;
  }
}

// --- contacts

void SurfaceContacts::describe(bool edges, std::size_t begin, std::size_t end, const ParticleView& particles,
                               const std::vector<std::uint32_t>& pairs, const std::vector<float>& parts,
                               const kernels::ContactColumns& out) {
  if (begin >= end) return;
  packed().describe[edges ? 1 : 0](pairs_.particle_records(particles), pairs_.columns(), limits_,
                                   pairs.data(), parts.data(), begin, end, out);
  for (std::size_t c = begin; c < end; ++c) {
    const NearPair& pair = pairs_.pair(pairs[c]);
    const ContactMaterialPair& surface =
        matrix_->at(pairs_.surface_of(pair.particle[0]), pairs_.surface_of(pair.particle[3]));
    out.static_friction[c] = surface.static_friction;
    out.kinetic_friction[c] = surface.kinetic_friction;
    out.restitution[c] = surface.restitution;
  }
}

void SurfaceContacts::describe_touches(const ParticleView& particles, Threads& threads) {
  contacts_.resize(touches_.size());
  columns_ = contacts_.columns();
  threads.for_each(touches_.size(), contact_grain, [&](std::size_t begin, std::size_t end) {
    auto kind =
        static_cast<std::size_t>(std::upper_bound(begin_.begin(), begin_.end(), begin) - begin_.begin()) - 1;
    for (; begin < end; ++kind) {
      const std::size_t last = std::min(end, begin_[kind + 1]);
      describe(kind % 2 == 1, begin, last, particles, pair_, part_, columns_);
      begin = std::max(begin, last);
    }
  });
}

void SurfaceContacts::project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
                              const Substep&) {
  const std::size_t first = begin_[2 * static_cast<std::size_t>(color)];
  packed().project(pairs_.particle_records(particles), columns_, first + begin, first + end);
}

// --- nothing passes

void SurfaceContacts::find_passing(std::size_t chunk, const ParticleView& particles, bool all,
                                   std::vector<Cut>& found) {
  constexpr float nearly = 0.9f;  // of what is between them
  if (!all && !pairs_.any_moved_by(nearly, pairs_.chunk(chunk))) return;
  std::uint32_t near[ElementPairs::chunk_size];
  const std::size_t count = pairs_.find_near(chunk, {nearly, 0, 0}, pairs_.particle_records(particles), near);
  for (std::size_t k = 0; k < count; ++k) {
    if (!all && !pairs_.was_moved(near[k])) continue;
    if (pairs_.distance_bound(near[k]) < touching || pairs_.is_replaced(near[k])) continue;
    const float part = safe_time(motion_of(pairs_.pair(near[k]), particles), pairs_.chunk(chunk).edges);
    if (part < 1) found.push_back({near[k], part});
  }
}

// Pairs that would touch on their ways, in order.
void SurfaceContacts::find_cuts(const ParticleView& particles, Threads& threads) {
  pairs_.measure(particles, threads);
  find(cuts_, threads,
       [&](std::size_t chunk, std::vector<Cut>& found) { find_passing(chunk, particles, true, found); });
}

// After a pass, which moves the particles of cuts and of rescues and no others: what it did not move passes
// through nothing, as before.
void SurfaceContacts::find_cuts_again(const ParticleView& particles, const Substep& substep,
                                      Threads& threads) {
  cut_particles_.clear();
  for (const Cut& cut : cuts_)
    for (const std::uint32_t i : pairs_.pair(cut.pair).particle) cut_particles_.push_back(i);
  for (const std::uint32_t* const column : rescues_.columns().particle)
    cut_particles_.insert(cut_particles_.end(), column, column + cut_pair_.size());
  std::sort(cut_particles_.begin(), cut_particles_.end());
  cut_particles_.erase(std::unique(cut_particles_.begin(), cut_particles_.end()), cut_particles_.end());
  const std::size_t renewed_from = pairs_.update(particles, substep.h, cut_particles_, threads);
  renew_colors_from(renewed_from);
  if (renewed_from == 0) return find_cuts(particles, threads);
  pairs_.measure(particles, cut_particles_);
  find(cuts_, threads,
       [&](std::size_t chunk, std::vector<Cut>& found) { find_passing(chunk, particles, false, found); });
}

// What the solver left undone: contacts of the pairs that would still touch, one after the other. They keep
// momentum.
void SurfaceContacts::push_cuts(const ParticleView& particles) {
  const std::size_t begin = cut_pair_.size();
  const auto take = [&](bool edges) {
    for (const Cut& cut : cuts_) {
      const NearPair& pair = pairs_.pair(cut.pair);
      if (pairs_.are_edges(cut.pair) != edges ||
          !has_normal(pair, motion_of(pair, particles), cut.part, edges, particles))
        continue;
      cut_pair_.push_back(cut.pair);
      cut_part_.push_back(cut.part);
    }
  };
  take(false);
  const std::size_t edges = cut_pair_.size();
  take(true);
  rescues_.resize(cut_pair_.size());
  const kernels::ContactColumns columns = rescues_.columns();
  describe(false, begin, edges, particles, cut_pair_, cut_part_, columns);
  describe(true, edges, cut_pair_.size(), particles, cut_pair_, cut_part_, columns);
  const kernels::ElementPairKernels& one_by_one = kernels::find_element_pair_kernels(InstructionSet::scalar);
  constexpr int sweeps = 4;
  for (int sweep = 0; sweep < sweeps; ++sweep)
    one_by_one.project(pairs_.particle_records(particles), columns, 0, cut_pair_.size());
}

// Particles of a pair that would touch keep the part of their way that is safe.
void SurfaceContacts::shorten_ways(const ParticleView& particles) {
  left_of_way_.assign(pairs_.particle_count(), 1);
  for (const Cut& cut : cuts_)
    for (const std::uint32_t i : pairs_.pair(cut.pair).particle)
      left_of_way_[i] = min(left_of_way_[i], cut.part);
  for (std::size_t i = 0; i < left_of_way_.size(); ++i)
    if (left_of_way_[i] < 1 && particles.inverse_mass(i) > 0)
      particles.moving[i].set_xyz(particles.start[i].xyz() + particles.moved(i) * left_of_way_[i]);
}

// What a contact pushed beyond what motion asked for, where that is more than what comes early anyway. At
// most a part of the thickness.
void SurfaceContacts::remember_pushes() {
  constexpr float part_of_thickness = 0.5f, kept = 0.9f, negligible = 1e-6f;  // m
  for (float& contact_margin : contact_margin_)
    contact_margin = contact_margin > negligible ? kept * contact_margin : 0;
  for (std::size_t c = 0; c < size(); ++c) {
    const float beyond = columns_.normal_sum[c] - max(0.0f, columns_.approach[c]);
    if (!(beyond > speculative_part * columns_.thickness[c])) continue;
    const float contact_margin = min(beyond, part_of_thickness * columns_.thickness[c]);
    for (const std::uint32_t* particle : columns_.particle)
      contact_margin_[particle[c]] = max(contact_margin_[particle[c]], contact_margin);
  }
}

// First pushes, which keep momentum; what they do not settle is stopped.
std::size_t SurfaceContacts::keep_apart(const ParticleView& particles, const Substep& substep,
                                        Threads& threads) {
  if (!pairs_.any()) return 0;
  constexpr int pushes = 20, passes = 30;
  cut_pair_.clear(), cut_part_.clear();
  std::size_t count = 0;
  renew_colors_from(pairs_.update(particles, substep.h, threads));
  find_cuts(particles, threads);
  for (int pass = 0; pass < passes && !cuts_.empty(); ++pass) {
    if (pass < pushes) {
      push_cuts(particles);
    } else {
      count += cuts_.size();
      shorten_ways(particles);
    }
    find_cuts_again(particles, substep, threads);
  }
  pairs_.end_substep();
  remember_pushes();
  return count;
}

// --- velocities

void SurfaceContacts::apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                        const Substep&, Threads& threads) {
  if (velocity.empty()) return;
  for (int color = 0; color < color_count(); ++color) {
    const std::size_t first = begin_[2 * static_cast<std::size_t>(color)];
    threads.for_each(color_size(color), grain(), [&](std::size_t begin, std::size_t end) {
      packed().apply_restitution(pairs_.particle_records(particles), columns_, limits_, &velocity[0].x,
                                 first + begin, first + end);
    });
  }
}

// --- reports

ContactReport SurfaceContacts::report() const {
  ContactReport report;
  for (std::size_t c = 0; c < size(); ++c) {
    if (!(columns_.normal_sum[c] > 0)) continue;
    ++report.count;
    report.deepest = max(report.deepest, columns_.depth[c]);
  }
  return report;
}

void SurfaceContacts::events(const ParticleView& particles, std::vector<ContactPush>& out) const {
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  for (std::size_t contact = 0; contact < size(); ++contact) {
    if (!(columns_.normal_sum[contact] > 0)) continue;
    const auto i = [&](std::size_t k) { return columns_.particle[k][contact]; };
    const auto c = [&](std::size_t k) { return columns_.c[k][contact]; };
    const Vec3f normal{columns_.normal[0][contact], columns_.normal[1][contact], columns_.normal[2][contact]};
    // The corner that carries most of each side.
    const bool edges = c(0) < 1 || c(1) > 0;
    const std::uint32_t one = edges && c(1) > c(0) ? i(1) : i(0);
    std::size_t other = edges ? 2 : 1;
    for (std::size_t k = other; k < 4; ++k)
      if (c(k) < c(other)) other = k;
    const Vec3f point = particles.relative(one, {}) - normal * (0.5f * columns_.thickness[contact]);
    out.push_back(
        {one, i(other), point, normal,
         (columns_.normal_sum[contact] * limits_.inverse_h + columns_.restitution_velocity[contact]) /
             columns_.inverse_mass[contact]});
  }
  std::stable_sort(out.begin() + first, out.end(), [](const ContactPush& a, const ContactPush& b) {
    return a.particle != b.particle ? a.particle < b.particle : a.other < b.other;
  });
}

Residual SurfaceContacts::residual(const ParticleView& particles) const {
  Residual result;
  visit(particles, [&](const ConstraintState& state) {
    result.largest = max(result.largest, static_cast<double>(state.residual));
    result.sum += static_cast<double>(state.residual);
    ++result.count;
  });
  return result;
}

void SurfaceContacts::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  for (int color = 0; color < color_count(); ++color)
    for (std::size_t c = begin_[2 * static_cast<std::size_t>(color)];
         c < begin_[2 * static_cast<std::size_t>(color) + 2]; ++c) {
      const std::array<std::uint32_t, 4> i{columns_.particle[0][c], columns_.particle[1][c],
                                           columns_.particle[2][c], columns_.particle[3][c]};
      Vec3f apart;
      for (std::size_t k = 1; k < 4; ++k) apart += particles.difference(i[k], i[0]) * columns_.c[k][c];
      const Vec3f n{columns_.normal[0][c], columns_.normal[1][c], columns_.normal[2][c]};
      const float C = dot(n, apart) - columns_.thickness[c];
      visitor({i, color, 0, max(0.0f, -C)});
    }
}

// Surfaces are set anew before the next step.
void SurfaceContacts::erase_particles(std::uint32_t, std::uint32_t) {
  set_surfaces({});
}

std::size_t SurfaceContacts::bytes() const {
  std::size_t sum =
      bytes_of(owner_of_vertex_, side_begin_, sides_, touches_, color_, used_, pair_, part_, left_of_way_);
  for (const Found& found : found_) sum += bytes_of(found.touches);
  return sum + pairs_.bytes() + contacts_.bytes() + rescues_.bytes();
}

}  // namespace souple
