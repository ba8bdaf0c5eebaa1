#include "souple/collision/surface_contacts.h"

#include "souple/collision/continuous.h"
#include "souple/collision/friction.h"
#include "souple/collision/nearest.h"
#include "souple/collision/untangling.h"
#include "souple/error.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace souple {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
constexpr float infinity = std::numeric_limits<float>::infinity();
// Candidates are looked at in chunks of one size, and what chunks found is put together in order: the same
// for any number of threads.
constexpr std::size_t chunk_size = 1024;
constexpr std::size_t particle_grain = 2048;
// Features that were nearer than their thickness at rest may stay a little nearer than that.
constexpr float rest_part = 0.9f;
constexpr float least_thickness = 1e-5f;  // m
// A particle is boxed for the way that its velocity takes it and a little more: it may be pushed.
constexpr float surprise = 0.1f;
// Nearer than this no side is left to keep: what began so is not held back, or two sheets that lie in one
// plane would never come apart. [m]
constexpr float touching = 1e-8f;
// What is far from everything may be pulled along within a step by this part of its size.
constexpr float unwatched = 0.125f;
// Contacts are made somewhat before features are near enough to push: the solver moves them too.
constexpr float early = 0.1f;

std::size_t chunks_of(std::size_t n) {
  return (n + chunk_size - 1) / chunk_size;
}

/// Room for twice as much as is needed: contacts come and go, and a warm step allocates nothing.
template <class T>
void make_room(std::vector<T>& vector, std::size_t size) {
  if (vector.capacity() < size) vector.reserve(2 * size);
}

Bounds around(const Vec3f& a, const Vec3f& b, float reach) {
  return {{min(a.x, b.x) - reach, min(a.y, b.y) - reach, min(a.z, b.z) - reach},
          {max(a.x, b.x) + reach, max(a.y, b.y) + reach, max(a.z, b.z) + reach}};
}

bool is_inside(const Vec3f& x, const Bounds& box, float reach) {
  return x.x - reach >= box.lo.x && x.x + reach <= box.hi.x && x.y - reach >= box.lo.y &&
         x.y + reach <= box.hi.y && x.z - reach >= box.lo.z && x.z + reach <= box.hi.z;
}

/// The four particles of a pair relative to the first: when the substep began, and where they go.
struct Motion {
  Vec3f x[4], p[4];
};

Motion motion_of(const std::uint32_t (&particle)[4], const ParticleView& particles) {
  Motion motion;
  const Vec3f moved = particles.moved(particle[0]);
  for (std::size_t k = 1; k < 4; ++k) {
    motion.p[k] = particles.difference(particle[k], particle[0]);
    motion.x[k] = motion.p[k] - (particles.moved(particle[k]) - moved);
  }
  return motion;
}

/// How far any point of one feature may have moved relative to any point of the other. [m]
float relative_way(const std::uint32_t (&particle)[4], bool edges, const ParticleView& particles) {
  const Vec3f a = particles.moved(particle[0]), b = particles.moved(particle[1]),
              c = particles.moved(particle[2]), d = particles.moved(particle[3]);
  const float ac = length_squared(a - c), ad = length_squared(a - d);
  if (!edges) return sqrt(max(length_squared(a - b), max(ac, ad)));
  return sqrt(max(max(ac, ad), max(length_squared(b - c), length_squared(b - d))));
}

/// Weights of the two nearest points: their difference is sum_k c_k x_k.
void nearest_points(const Vec3f (&x)[4], bool edges, float (&c)[4]) {
  if (edges) {
    float s = 0, t = 0;
    nearest_on_edges(x[0], x[1], x[2], x[3], s, t);
    c[0] = 1 - s, c[1] = s, c[2] = t - 1, c[3] = -t;
  } else {
    float weight[3];
    nearest_on_triangle(x[0], x[1], x[2], x[3], weight);
    c[0] = 1;
    for (std::size_t k = 0; k < 3; ++k) c[k + 1] = -weight[k];
  }
}

Vec3f weighted(const Vec3f (&x)[4], const float (&c)[4]) {
  return x[0] * c[0] + x[1] * c[1] + x[2] * c[2] + x[3] * c[3];
}

float distance(const Vec3f (&x)[4], bool edges) {
  float c[4];
  nearest_points(x, edges, c);
  return length(weighted(x, c));
}

/// The part of x -> p that brings nothing into touch.
float safe_time(const Motion& motion, bool edges) {
  Moving4 moving;
  for (std::size_t k = 0; k < 4; ++k) moving.x[k] = Vec3d(motion.x[k]), moving.p[k] = Vec3d(motion.p[k]);
  const double time = edges ? edge_edge_time(moving, 0) : vertex_triangle_time(moving, 0);
  return static_cast<float>(time);
}

}  // namespace

// --- what may touch

bool SurfaceContacts::meet(std::size_t a, std::size_t b) const {
  const ContactSurface &one = surfaces_[a], &other = surfaces_[b];
  if (a == b) return one.meets_itself;
  if (one.loose_particles && other.loose_particles) return false;  // see ParticleContacts
  return (one.groups & other.meets) != 0 && (other.groups & one.meets) != 0;
}

void SurfaceContacts::set_surfaces(std::vector<ContactSurface> surfaces) {
  *this = SurfaceContacts(std::move(excluded_));
  surfaces_ = std::move(surfaces);
  const std::size_t n = surfaces_.size();
  own_matrix_ = crossing_matrix_ = ObjectMatrix(n);
  for (std::uint32_t a = 0; a < n; ++a) {
    own_matrix_.set(a, a, surfaces_[a].meets_itself);
    any_pair_ = any_pair_ || surfaces_[a].meets_itself;
    for (std::uint32_t b = 0; b < a; ++b) {
      crossing_matrix_.set(a, b, meet(a, b));
      any_pair_ = any_pair_ || meet(a, b);
    }
  }
  if (!any_pair_) return;
  crosses_.assign(n, 0);
  std::uint32_t end = 0;
  for (const ContactSurface& surface : surfaces_) end = std::max(end, surface.end);
  surface_of_.assign(end, none);
  for (std::uint32_t a = 0; a < n; ++a) {
    const ContactSurface& surface = surfaces_[a];
    std::fill(surface_of_.begin() + surface.begin, surface_of_.begin() + surface.end, a);
    if (!surface.meets_itself) continue;
    own_.add_triangles(surface.triangles, surface.begin, a);
    own_.add_edges(surface.edges, surface.begin, a);
  }
  for (std::vector<Vec4f>* each : {&velocity_now_, &before_}) each->reserve(end);
  used_.reserve(end), part_.reserve(end);
  cuts_.reserve(256), rescues_.reserve(256);
}

void SurfaceContacts::exclude(std::vector<std::array<std::uint32_t, 2>> pairs) {
  const std::size_t n = pairs.size();
  for (std::size_t k = 0; k < n; ++k) pairs.push_back({pairs[k][1], pairs[k][0]});
  std::sort(pairs.begin(), pairs.end());
  excluded_ = std::move(pairs);
}

bool SurfaceContacts::is_excluded(const NearPair& pair, bool edges) const {
  if (excluded_.empty()) return false;
  const std::size_t first = edges ? 2 : 1;
  for (std::size_t a = 0; a < first; ++a)
    for (std::size_t b = first; b < 4; ++b)
      if (std::binary_search(excluded_.begin(), excluded_.end(),
                             std::array<std::uint32_t, 2>{pair.particle[a], pair.particle[b]}))
        return true;
  return false;
}

// --- near pairs

void SurfaceContacts::make_chunks(std::size_t count) {
  if (chunks_.size() >= count) return;
  const std::size_t before = chunks_.size();
  chunks_.resize(count + count / 2 + 16);
  for (std::size_t c = before; c < chunks_.size(); ++c) {
    chunks_[c].candidates.reserve(chunk_size);
    chunks_[c].contacts.reserve(chunk_size / 8);
    chunks_[c].cuts.reserve(16);
  }
}

// Mean velocities of what can move: a heap that falls as one needs no room for it.
void SurfaceContacts::find_frames(const ParticleView& particles, std::span<const Vec4f> velocity) {
  frame_.assign(surfaces_.size(), {});
  for (std::size_t a = 0; a < surfaces_.size(); ++a) {
    Vec3d sum;
    double count = 0;
    for (std::uint32_t i = surfaces_[a].begin; i < surfaces_[a].end; ++i) {
      if (particles.inverse_mass(i) == 0) continue;
      sum += Vec3d(velocity[i].xyz());
      ++count;
    }
    const Vec3f mean(count > 0 ? sum / count : sum);
    if (is_finite(mean)) frame_[a] = mean;
  }
}

void SurfaceContacts::find_boxes(const ParticleView& particles, std::span<const Vec4f> velocity, float dt,
                                 Threads& threads) {
  boxes_.resize(surface_of_.size());
  own_boxes_.resize(surface_of_.size());
  travel_.resize(surface_of_.size());
  const float fall = step_.gravity * dt * dt;
  threads.for_each(surface_of_.size(), particle_grain, [&](std::size_t i, std::size_t end) {
    for (; i < end; ++i) {
      if (surface_of_[i] == none) continue;
      const Vec3f x = particles.relative(i, {}), v = velocity[i].xyz();
      const Vec3f own = v - frame_[surface_of_[i]];
      const float room = fall + surprise * dt * length(own) + 0.25f * max(radius_[i], 0.0f);
      const float reach = max(radius_[i], least_thickness) * (1 + early) + room;
      boxes_[i] = around(x, x + v * dt, reach + surprise * dt * length(v));
      own_boxes_[i] = around(x, x + own * dt, reach);
      travel_[i] = length(own) * dt + 1.8f * room;
    }
  });
}

// Surfaces whose boxes meet, of those that may: their elements are compared.
void SurfaceContacts::find_crossing() {
  const std::size_t n = surfaces_.size();
  surface_bounds_.assign(n, {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}});
  for (std::size_t a = 0; a < n; ++a) {
    Bounds& bounds = surface_bounds_[a];
    for (std::uint32_t i = surfaces_[a].begin; i < surfaces_[a].end; ++i) bounds = united(bounds, boxes_[i]);
    const Vec3f size = bounds.hi - bounds.lo;
    bounds = around(bounds.lo, bounds.hi, unwatched * max(size.x, max(size.y, size.z)));
  }
  crosses_now_.assign(n, 0);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (crossing_matrix_.at(a, b) && overlap(surface_bounds_[a], surface_bounds_[b]))
        crosses_now_[a] = crosses_now_[b] = 1;
  if (crosses_now_ == crosses_) return;
  crosses_ = crosses_now_;
  crossing_.clear();
  for (std::uint32_t a = 0; a < n; ++a) {
    if (crosses_[a] == 0) continue;
    const ContactSurface& surface = surfaces_[a];
    crossing_.add_triangles(surface.triangles, surface.begin, a);
    crossing_.add_edges(surface.edges, surface.begin, a);
    if (surface.loose_particles) crossing_.add_particles(surface.begin, surface.end, a);
  }
}

void SurfaceContacts::find_pairs(const ParticleView& particles, std::span<const Vec4f> velocity, float dt,
                                 Threads& threads) {
  find_frames(particles, velocity);
  find_boxes(particles, velocity, dt, threads);
  find_crossing();
  own_finder_.find(own_, own_boxes_, own_matrix_, particles.position, own_pairs_, threads);
  crossing_finder_.find(crossing_, boxes_, crossing_matrix_, particles.position, crossing_pairs_, threads);
  candidates_.clear();
  add_candidates(own_pairs_.vertex_triangle, false, particles, threads);
  add_candidates(crossing_pairs_.vertex_triangle, false, particles, threads);
  first_edges_ = candidates_.size();
  add_candidates(own_pairs_.edge_edge, true, particles, threads);
  add_candidates(crossing_pairs_.edge_edge, true, particles, threads);
  elapsed_ = 0;
  covered_ = dt;
}

// Thickness of a pair: what both are thick, but not more than they were apart at rest.
float SurfaceContacts::thickness_of(const NearPair& pair, bool edges) const {
  const auto& i = pair.particle;
  const std::uint32_t a = surface_of_[i[0]], b = surface_of_[i[3]];
  const float first = edges ? max(radius_[i[0]], radius_[i[1]]) : radius_[i[0]];
  const float second =
      edges ? max(radius_[i[2]], radius_[i[3]]) : max(radius_[i[1]], max(radius_[i[2]], radius_[i[3]]));
  const float thickness = max(first + second, least_thickness);
  if (a != b || surfaces_[a].rest.empty()) return thickness;
  const std::span<const Vec3d> rest = surfaces_[a].rest;
  const std::uint32_t begin = surfaces_[a].begin;
  Vec3f x[4];
  for (std::size_t k = 1; k < 4; ++k) x[k] = Vec3f(rest[i[k] - begin] - rest[i[0] - begin]);
  // Far enough at rest by its corners alone.
  const float size = edges ? length(x[1]) + length(x[2] - x[3]) : length(x[1] - x[2]) + length(x[1] - x[3]);
  if (length(x[2]) - size > thickness) return thickness;
  return min(thickness, rest_part * distance(x, edges));
}

// What cannot come near enough within the time is left out.
void SurfaceContacts::add_candidates(std::span<const NearPair> pairs, bool edges,
                                     const ParticleView& particles, Threads& threads) {
  const std::size_t chunks = chunks_of(pairs.size());
  make_chunks(chunks);
  threads.for_each(chunks, 1, [&](std::size_t c, std::size_t last) {
    for (; c < last; ++c) {
      std::vector<Candidate>& found = chunks_[c].candidates;
      found.clear();
      for (std::size_t k = c * chunk_size; k < std::min(pairs.size(), (c + 1) * chunk_size); ++k) {
        const auto& i = pairs[k].particle;
        if (is_excluded(pairs[k], edges)) continue;
        if (untangling_ != nullptr && untangling_->exempts(pairs[k], edges)) continue;
        Vec3f x[4];
        for (std::size_t j = 1; j < 4; ++j) x[j] = particles.difference(i[j], i[0]);
        const float apart = distance(x, edges);
        const float thickness = thickness_of(pairs[k], edges);
        const bool same = surface_of_[i[0]] == surface_of_[i[3]];
        const float way = edges ? max(travel_[i[0]], travel_[i[1]]) + max(travel_[i[2]], travel_[i[3]])
                                : travel_[i[0]] + max(travel_[i[1]], max(travel_[i[2]], travel_[i[3]]));
        const Vec3f drift = frame_[surface_of_[i[0]]] - frame_[surface_of_[i[3]]];
        const float between = same ? 0 : length(drift) * step_.dt * (1 + surprise);
        if (!(apart > (1 + early) * thickness + way + between))
          found.push_back({{i[0], i[1], i[2], i[3]}, thickness, apart});
      }
    }
  });
  std::size_t sum = candidates_.size();
  for (std::size_t c = 0; c < chunks; ++c) sum += chunks_[c].candidates.size();
  make_room(candidates_, sum);
  for (std::size_t c = 0; c < chunks; ++c)
    candidates_.insert(candidates_.end(), chunks_[c].candidates.begin(), chunks_[c].candidates.end());
}

void SurfaceContacts::begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                                 std::span<const float> radius, const SurfaceMatrix& matrix,
                                 const ContactStep& step, Threads& threads) {
  forget_contacts();
  candidates_.clear();
  if (!any_pair_) return;
  if (matrix.rows() < surfaces_.size() || matrix.columns() < surfaces_.size())
    throw Error("SurfaceContacts: the surface matrix is smaller than surfaces x surfaces; build it anew");
  radius_ = radius;
  matrix_ = &matrix;
  step_ = step;
  find_pairs(particles, velocity, step.dt, threads);
}

// Surfaces that are far from all others are not watched within a step; their bounds are larger for it.
bool SurfaceContacts::is_active(std::size_t surface) const {
  return surfaces_[surface].meets_itself || crosses_[surface] != 0;
}

// Whether some particle is no longer where pairs were looked for.
bool SurfaceContacts::left_boxes(const ParticleView& particles, Threads& threads) {
  const std::size_t n = surface_of_.size(), chunks = chunks_of(n);
  chunk_flags_.resize(chunks);
  threads.for_each(chunks, 2, [&](std::size_t c, std::size_t last) {
    for (; c < last; ++c) {
      bool inside = true;
      for (std::size_t i = c * chunk_size; i < std::min(n, (c + 1) * chunk_size); ++i) {
        if (surface_of_[i] == none || !is_active(surface_of_[i])) continue;
        const Vec3f x = particles.relative(i, {});
        const float reach = max(radius_[i], least_thickness) * (1 + early);
        inside = inside && is_inside(x, boxes_[i], reach) &&
                 is_inside(x - frame_[surface_of_[i]] * elapsed_, own_boxes_[i], reach);
      }
      chunk_flags_[c] = inside ? 0 : 1;
    }
  });
  return std::find(chunk_flags_.begin(), chunk_flags_.end(), 1) != chunk_flags_.end();
}

// Pairs for the rest of the step, from where the substep began, by the ways that it takes.
void SurfaceContacts::find_again(const ParticleView& particles, float h, Threads& threads) {
  velocity_now_.resize(surface_of_.size());
  for (std::size_t i = 0; i < velocity_now_.size(); ++i) velocity_now_[i].set_xyz(particles.moved(i) / h);
  before_.assign(particles.start.begin(), particles.start.end());
  ParticleView before = particles;
  before.moving = before_;
  if (particles.form == Form::plain) before.position = before_;
  find_pairs(before, velocity_now_, max(covered_ - elapsed_ + h, h), threads);
  elapsed_ = h;
}

// --- contacts of a substep

void SurfaceContacts::forget_contacts() {
  contacts_.clear();
  colour_begin_.assign(1, 0);
}

void SurfaceContacts::refresh(const ParticleView& particles, const Substep& substep, Threads& threads) {
  forget_contacts();
  if (!any_pair_) return;
  last_h_ = substep.h;
  elapsed_ += substep.h;
  if (left_boxes(particles, threads)) find_again(particles, substep.h, threads);
  const std::size_t chunks = chunks_of(candidates_.size());
  make_chunks(chunks);
  threads.for_each(chunks, 1, [&](std::size_t c, std::size_t last) {
    for (; c < last; ++c) {
      std::vector<Contact>& found = chunks_[c].contacts;
      found.clear();
      Contact contact;
      for (std::size_t k = c * chunk_size; k < std::min(candidates_.size(), (c + 1) * chunk_size); ++k)
        if (contact_of(candidates_[k], k >= first_edges_, particles, substep.h, contact))
          found.push_back(contact);
    }
  });
  std::size_t sum = 0;
  for (std::size_t c = 0; c < chunks; ++c) sum += chunks_[c].contacts.size();
  make_room(found_, sum);
  make_room(contacts_, sum);
  make_room(colour_of_, sum);
  make_room(waiting_, sum);
  found_.clear();
  for (std::size_t c = 0; c < chunks; ++c)
    found_.insert(found_.end(), chunks_[c].contacts.begin(), chunks_[c].contacts.end());
  colour_found(particles);
}

bool SurfaceContacts::contact_of(Candidate& candidate, bool edges, const ParticleView& particles, float h,
                                 Contact& contact) const {
  const auto& i = candidate.particle;
  const float way = relative_way(i, edges, particles);
  const float near = (1 + early) * candidate.thickness;
  if (candidate.known - way > near) return false;
  const Motion motion = motion_of(i, particles);
  candidate.known = distance(motion.x, edges);
  if (candidate.known - way > near) return false;

  contact = {};
  std::copy(std::begin(i), std::end(i), std::begin(contact.particle));
  float part = 1;
  if (way > 0.5f * candidate.known) part = safe_time(motion, edges);
  Vec3f at[4];
  for (std::size_t k = 1; k < 4; ++k)
    at[k] = part < 1 ? motion.x[k] + (motion.p[k] - motion.x[k]) * part : motion.p[k];
  nearest_points(at, edges, contact.c);
  if (edges && part >= 1 && is_end(contact)) return false;
  const Vec3f apart = weighted(at, contact.c);
  const float size = length(apart);
  if (!(size > 0)) return false;
  if (part >= 1 && size > near) return false;
  contact.normal = apart / size;
  contact.thickness = candidate.thickness;
  for (std::size_t k = 0; k < 4; ++k)
    contact.inverse_mass += particles.inverse_mass(i[k]) * contact.c[k] * contact.c[k];
  if (!(contact.inverse_mass > 0)) return false;
  const float overlap = candidate.known - candidate.thickness;
  if (overlap < 0) contact.allowed = min(0.0f, overlap + step_.depenetration_speed * h);
  contact.surface = matrix_->at(surface_of_[i[0]], surface_of_[i[3]]);
  for (std::size_t k = 0; k < 4; ++k) contact.predicted += particles.moved(i[k]) * contact.c[k];
  return true;
}

// An edge whose nearest point is its end: a vertex against a triangle is the same contact, unless it is of a
// rope.
bool SurfaceContacts::is_end(const Contact& contact) const {
  const auto is_rope = [&](std::uint32_t i) { return surfaces_[surface_of_[i]].triangles.empty(); };
  const bool first = contact.c[0] == 0 || contact.c[1] == 0, second = contact.c[2] == 0 || contact.c[3] == 0;
  return (first || second) && !is_rope(contact.particle[0]) && !is_rope(contact.particle[2]);
}

// The lowest colour that none of its particles has yet, in order. A particle that cannot move takes none.
void SurfaceContacts::colour_found(const ParticleView& particles) {
  constexpr std::uint32_t per_round = 64;
  colour_of_.resize(found_.size());
  waiting_.clear();
  for (std::uint32_t c = 0; c < found_.size(); ++c) waiting_.push_back(c);
  make_room(colour_begin_, 256);
  make_room(next_place_, colour_begin_.capacity());
  colour_begin_.assign(1, 0);
  for (std::uint32_t first = 0; !waiting_.empty(); first += per_round) {
    used_.assign(surface_of_.size(), 0);
    std::size_t still = 0;
    for (const std::uint32_t c : waiting_) {
      std::uint64_t taken = 0;
      for (const std::uint32_t i : found_[c].particle)
        if (particles.inverse_mass(i) > 0) taken |= used_[i];
      if (taken == ~std::uint64_t{0}) {
        waiting_[still++] = c;
        continue;
      }
      const auto bit = static_cast<std::uint32_t>(std::countr_one(taken));
      for (const std::uint32_t i : found_[c].particle) used_[i] |= std::uint64_t{1} << bit;
      colour_of_[c] = first + bit;
      if (colour_begin_.size() < first + bit + 2) colour_begin_.resize(first + bit + 2, 0);
      ++colour_begin_[first + bit + 1];
    }
    waiting_.resize(still);
  }
  for (std::size_t colour = 1; colour < colour_begin_.size(); ++colour)
    colour_begin_[colour] += colour_begin_[colour - 1];
  next_place_ = colour_begin_;
  contacts_.resize(found_.size());
  for (std::size_t c = 0; c < found_.size(); ++c) contacts_[next_place_[colour_of_[c]]++] = found_[c];
}

void SurfaceContacts::project(int colour, std::size_t begin, std::size_t end, const ParticleView& particles,
                              const Substep&) {
  const std::size_t first = colour_begin_[static_cast<std::size_t>(colour)];
  for (std::size_t c = first + begin; c < first + end; ++c) project_one(contacts_[c], particles);
}

// As for two particles (particle_contacts.cpp), on the difference of two points:
//   dx_k = w_k c_k / (sum_j w_j c_j^2) dx
void SurfaceContacts::project_one(Contact& contact, const ParticleView& particles) const {
  const auto& i = contact.particle;
  Vec3f apart, moved;
  const Vec3f moved_first = particles.moved(i[0]);
  for (std::size_t k = 1; k < 4; ++k) {
    apart += particles.difference(i[k], i[0]) * contact.c[k];
    moved += (particles.moved(i[k]) - moved_first) * contact.c[k];
  }
  const Vec3f n = contact.normal;
  const float C = dot(n, apart) - contact.thickness;
  const float dn = max(contact.allowed - C, -contact.pushed);
  if (!(dn > 0) && !(contact.pushed > 0)) return;
  contact.pushed += dn;
  Vec3f rubbed;
  if (contact.pushed > 0) {
    const Vec3f wanted = contact.rubbed - (moved - n * dot(n, moved));
    rubbed = within_friction(wanted, contact.surface, contact.pushed);
  } else {
    contact.pushed = 0;
  }
  const Vec3f dx = (n * dn + (rubbed - contact.rubbed)) / contact.inverse_mass;
  contact.rubbed = rubbed;
  for (std::size_t k = 0; k < 4; ++k) {
    const float w = particles.inverse_mass(i[k]);
    if (w > 0) particles.correct(i[k], dx * (w * contact.c[k]));
  }
}

// --- nothing passes

// What is left to a pair of its way, 1 when nothing can happen on it.
float SurfaceContacts::safe_part(Candidate& candidate, bool edges, const ParticleView& particles) const {
  const float way = relative_way(candidate.particle, edges, particles);
  if (way < 0.9f * candidate.known) return 1;
  const Motion motion = motion_of(candidate.particle, particles);
  candidate.known = distance(motion.x, edges);
  if (way < 0.9f * candidate.known || candidate.known < touching) return 1;
  return safe_time(motion, edges);
}

// Pairs that would touch on their ways, in order.
void SurfaceContacts::find_cuts(const ParticleView& particles, Threads& threads) {
  const std::size_t chunks = chunks_of(candidates_.size());
  make_chunks(chunks);
  threads.for_each(chunks, 1, [&](std::size_t c, std::size_t last) {
    for (; c < last; ++c) {
      std::vector<Cut>& cuts = chunks_[c].cuts;
      cuts.clear();
      for (std::size_t k = c * chunk_size; k < std::min(candidates_.size(), (c + 1) * chunk_size); ++k) {
        const float part = safe_part(candidates_[k], k >= first_edges_, particles);
        if (part < 1) cuts.push_back({static_cast<std::uint32_t>(k), part});
      }
    }
  });
  cuts_.clear();
  for (std::size_t c = 0; c < chunks; ++c)
    cuts_.insert(cuts_.end(), chunks_[c].cuts.begin(), chunks_[c].cuts.end());
}

// What the solver left undone: contacts of the pairs that would still touch, one after the other. They keep
// momentum.
void SurfaceContacts::push_cuts(const ParticleView& particles, float h) {
  Contact contact;
  for (const Cut& cut : cuts_)
    if (contact_of(candidates_[cut.candidate], cut.candidate >= first_edges_, particles, h, contact))
      rescues_.push_back(contact);
  constexpr int sweeps = 4;
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (Contact& rescue : rescues_) project_one(rescue, particles);
}

// Particles of a pair that would touch keep the part of their way that is safe.
void SurfaceContacts::shorten_ways(const ParticleView& particles) {
  part_.assign(surface_of_.size(), 1);
  for (const Cut& cut : cuts_)
    for (const std::uint32_t i : candidates_[cut.candidate].particle) part_[i] = min(part_[i], cut.part);
  for (std::size_t i = 0; i < part_.size(); ++i)
    if (part_[i] < 1 && particles.inverse_mass(i) > 0)
      particles.moving[i].set_xyz(particles.start[i].xyz() + particles.moved(i) * part_[i]);
}

// First pushes, which keep momentum; what they do not settle is stopped.
std::size_t SurfaceContacts::keep_apart(const ParticleView& particles, const Substep& substep,
                                        Threads& threads) {
  if (!any_pair_) return 0;
  constexpr int pushes = 20, passes = 30;
  rescues_.clear();
  std::size_t count = 0;
  for (int pass = 0; pass < passes; ++pass) {
    if (left_boxes(particles, threads)) find_again(particles, substep.h, threads);
    find_cuts(particles, threads);
    if (cuts_.empty()) break;
    if (pass < pushes) {
      push_cuts(particles, substep.h);
    } else {
      count += cuts_.size();
      shorten_ways(particles);
    }
  }
  const std::size_t chunks = chunks_of(candidates_.size());
  threads.for_each(chunks, 1, [&](std::size_t c, std::size_t last) {
    for (; c < last; ++c)
      for (std::size_t k = c * chunk_size; k < std::min(candidates_.size(), (c + 1) * chunk_size); ++k)
        candidates_[k].known -= relative_way(candidates_[k].particle, k >= first_edges_, particles);
  });
  return count;
}

// --- velocities

void SurfaceContacts::apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                        const Substep& substep, Threads& threads) {
  for (std::size_t colour = 0; colour + 1 < colour_begin_.size(); ++colour) {
    const std::size_t first = colour_begin_[colour];
    threads.for_each(colour_begin_[colour + 1] - first, grain(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = first + begin; c < first + end; ++c)
        restore_speed(contacts_[c], particles, velocity, substep.h);
    });
  }
}

// As in particle_contacts.cpp.
void SurfaceContacts::restore_speed(Contact& contact, const ParticleView& particles,
                                    std::span<Vec4f> velocity, float h) const {
  if (!(contact.pushed > 0)) return;
  const auto& i = contact.particle;
  const Vec3f n = contact.normal;
  Vec3f u, apart;
  for (std::size_t k = 0; k < 4; ++k) u += velocity[i[k]].xyz() * contact.c[k];
  for (std::size_t k = 1; k < 4; ++k) apart += particles.difference(i[k], i[0]) * contact.c[k];
  const float u_n = dot(n, u);
  const float approach = -dot(n, contact.predicted) / h;
  const float target = approach > 2 * step_.gravity * h ? contact.surface.restitution * approach : 0.0f;
  contact.bounced = max(target - u_n, -contact.pushed / h);
  const Vec3f held_back = contact.rubbed * (1 / h);
  const Vec3f wanted = held_back - (u - n * u_n);
  const float pressed = contact.pushed / h + max(contact.bounced, 0.0f);
  const Vec3f change = n * contact.bounced + (within_friction(wanted, contact.surface, pressed) - held_back);
  for (std::size_t k = 0; k < 4; ++k) {
    const float w = particles.inverse_mass(i[k]);
    if (w > 0)
      velocity[i[k]].set_xyz(velocity[i[k]].xyz() + change * (w * contact.c[k] / contact.inverse_mass));
  }
  contact.depth = max(0.0f, contact.thickness - dot(n, apart));
}

// --- reports

ContactReport SurfaceContacts::report() const {
  ContactReport report;
  for (const Contact& contact : contacts_) {
    if (!(contact.pushed > 0)) continue;
    ++report.count;
    report.deepest = max(report.deepest, contact.depth);
  }
  return report;
}

void SurfaceContacts::events(const ParticleView& particles, std::vector<ContactPush>& out) const {
  const float inverse_h = last_h_ > 0 ? 1 / last_h_ : 0.0f;
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  for (const Contact& contact : contacts_) {
    if (!(contact.pushed > 0)) continue;
    const auto& i = contact.particle;
    // The corner that carries most of each side.
    const bool edges = contact.c[0] < 1 || contact.c[1] > 0;
    const std::uint32_t one = edges && contact.c[1] > contact.c[0] ? i[1] : i[0];
    std::size_t other = edges ? 2 : 1;
    for (std::size_t k = other; k < 4; ++k)
      if (contact.c[k] < contact.c[other]) other = k;
    const Vec3f point = particles.relative(one, {}) - contact.normal * max(radius_[one], 0.0f);
    out.push_back({one, i[other], point, contact.normal,
                   (contact.pushed * inverse_h + contact.bounced) / contact.inverse_mass});
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
  for (std::size_t colour = 0; colour + 1 < colour_begin_.size(); ++colour)
    for (std::size_t c = colour_begin_[colour]; c < colour_begin_[colour + 1]; ++c) {
      const Contact& contact = contacts_[c];
      Vec3f apart;
      for (std::size_t k = 1; k < 4; ++k)
        apart += particles.difference(contact.particle[k], contact.particle[0]) * contact.c[k];
      const float C = dot(contact.normal, apart) - contact.thickness;
      visitor({contact.particle, static_cast<int>(colour), 0, max(0.0f, -C)});
    }
}

// Surfaces are set anew before the next step.
void SurfaceContacts::erase_particles(std::uint32_t, std::uint32_t) {
  set_surfaces({});
}

std::size_t SurfaceContacts::bytes() const {
  std::size_t sum =
      bytes_of(surfaces_, surface_of_, boxes_, own_boxes_, travel_, candidates_, found_, contacts_, used_,
               part_, own_pairs_.vertex_triangle, own_pairs_.edge_edge, crossing_pairs_.vertex_triangle,
               crossing_pairs_.edge_edge, velocity_now_, before_);
  for (const Chunk& chunk : chunks_) sum += bytes_of(chunk.candidates, chunk.contacts, chunk.cuts);
  return sum + own_.bytes() + crossing_.bytes() + own_finder_.bytes() + crossing_finder_.bytes();
}

}  // namespace souple
