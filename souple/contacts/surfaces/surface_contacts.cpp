#include "souple/contacts/surfaces/surface_contacts.h"

#include "souple/assert.h"
#include "souple/contacts/contact_law.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/contacts/surfaces/contact_colors.h"
#include "souple/contacts/surfaces/motion_filter.h"
#include "souple/contacts/surfaces/round_contacts.h"
#include "souple/contacts/surfaces/surface_narrow_phase.h"
#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {
namespace {

constexpr std::size_t contact_grain = 256;

const kernels::ElementPairKernels& simd_kernels() {
  return kernels::find_element_pair_kernels(instruction_set());
}

}  // namespace

SurfaceContacts::SurfaceContacts(const IntersectionResolver* intersection_resolver)
    : intersection_resolver_(intersection_resolver),
      narrow_phase_(std::make_unique<SurfaceNarrowPhase>()),
      colors_(std::make_unique<ContactColors>()),
      filter_(std::make_unique<MotionFilter>()),
      round_(std::make_unique<RoundContacts>()) {}
SurfaceContacts::~SurfaceContacts() = default;

void SurfaceContacts::build(const ContactGeometry& geometry) {
  clear_contacts();
  pairs_ = ElementPairs(geometry.surfaces, geometry.joined, intersection_resolver_);
  if (!pairs_.surfaces().any()) return;
  has_margin_.assign(pairs_.surfaces().size(), 1);
  narrow_phase_->build(pairs_.surfaces());
  colors_->set_count(pairs_.surfaces().particle_count());
  filter_->set_count();
  round_->build(pairs_.surfaces());
}

void SurfaceContacts::begin_step(const ContactInput& input, Threads& threads) {
  clear_contacts();
  held_ = {};
  pairs_.clear();
  if (!pairs_.surfaces().any()) return;
  narrow_phase_->begin_step(pairs_.surfaces(), input.tables.against_objects, input.step);
  contact_margin_ = input.contact_margin, radius_ = input.radius;
  round_->raise_margins(pairs_.surfaces(), contact_margin_);
  balls_roll_ = !input.step.turn.empty();
  still_.assign(pairs_.surfaces().size(), 0);
  for (std::size_t a = 0; a < std::min(still_.size(), input.tables.objects.size()); ++a)
    still_[a] = input.tables.objects[a].still ? 1 : 0;
  for (std::size_t a = 0; a < still_.size(); ++a)
    if (still_[a] == 0) has_margin_[a] = 1;
  pairs_.begin_step(input.particles, input.velocity, input.radius, input.contact_margin, still_, input.step,
                    threads);
  colors_->extend(0, pairs_);
}

void SurfaceContacts::clear_contacts() {
  contacts_.resize(0), round_->clear();
  of_bodies_.clear();
  colors_->clear_contacts();
  filter_->clear_pushes();
}

void SurfaceContacts::refresh(const ParticleView& particles, const Substep& substep, double,
                              Threads& threads) {
  clear_contacts();
  if (!pairs_.surfaces().any()) return;
  narrow_phase_->begin_substep(substep.h);
  pairs_.begin_substep(substep.h, still_have_margins());
  if (const auto former = pairs_.drop_replaced(threads); !former.empty()) colors_->keep(former);
  color_new(pairs_.update(particles, substep.h, threads));
  pairs_.measure(particles, threads);
  narrow_phase_->find_contacts(pairs_, particles, contact_pairs_, threads);
  if (!narrow_phase_->is_discrete())
    round_->find(pairs_, *narrow_phase_, particles, radius_, contact_margin_, intersection_resolver_,
                 contact_pairs_);
  colors_->sort(contact_pairs_, pairs_, particles);
  describe_contacts(particles, threads);
  for (std::size_t c = 0; narrow_phase_->is_discrete() && c < contacts_.size(); ++c)
    narrow_phase_->describe_crossing(pairs_, colors_->pair()[c], c, particles, columns_);
}

bool SurfaceContacts::still_have_margins() const {
  for (std::size_t a = 0; a < still_.size(); ++a)
    if (still_[a] != 0 && has_margin_[a] != 0) return true;
  return false;
}

void SurfaceContacts::color_new(std::size_t first_new) {
  colors_->extend(first_new, pairs_);
  colors_->forget(pairs_.take_searched_anew());
}

void SurfaceContacts::describe_contacts(const ParticleView& particles, Threads& threads) {
  contacts_.resize(contact_pairs_.size());
  columns_ = contacts_.columns();
  const std::span<const std::size_t> kind_begin = colors_->begin();
  threads.for_each(contact_pairs_.size(), contact_grain, [&](std::size_t begin, std::size_t end) {
    auto kind = static_cast<std::size_t>(std::upper_bound(kind_begin.begin(), kind_begin.end(), begin) -
                                         kind_begin.begin()) -
                1;
    for (; begin < end; ++kind) {
      const std::size_t last = std::min(end, kind_begin[kind + 1]);
      narrow_phase_->describe(pairs_, kind % 2 == 1, begin, last, particles, colors_->pair(), colors_->toi(),
                              columns_);
      begin = std::max(begin, last);
    }
  });
}

std::size_t SurfaceContacts::round_size() const {
  return round_->contacts().size();
}

// Round contacts come last, one after the other: those of a body act on the same particles.
int SurfaceContacts::color_count() const {
  return colors_->count() + static_cast<int>(round_size());
}

std::size_t SurfaceContacts::color_size(int color) const {
  if (color >= colors_->count()) return 1;
  const auto c = static_cast<std::size_t>(color);
  return colors_->begin()[2 * c + 2] - colors_->begin()[2 * c];
}

void SurfaceContacts::project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
                              const Substep&) {
  if (color >= colors_->count())
    return round_->project(static_cast<std::size_t>(color - colors_->count()), particles);
  const std::size_t first = colors_->begin()[2 * static_cast<std::size_t>(color)];
  simd_kernels().project(pairs_.particle_records(particles), columns_, first + begin, first + end);
}

std::uint32_t SurfaceContacts::particle_of(int color, std::size_t index,
                                           const ParticleView& particles) const {
  if (color >= colors_->count())
    return particles.first_movable(
        round_->contacts()[static_cast<std::size_t>(color - colors_->count())].anchor.particle);
  const std::size_t c = colors_->begin()[2 * static_cast<std::size_t>(color)] + index;
  return particles.first_movable(anchor_of(columns_, c).particle);
}

// A contact's correction beyond the approach becomes the margin of its particles, if it exceeds the
// speculative margin: at most max_part of the thickness. Older margins decay.
void SurfaceContacts::update_contact_margins() {
  constexpr float max_part = 0.5f, decay = 0.9f, negligible = 1e-6f;  // negligible: m
  const auto widen = [this](float normal_sum, float approach, float thickness, const auto& particles) {
    const float beyond = normal_sum - max(0.0f, approach);
    if (!(beyond > speculative_part * thickness)) return;
    SOUPLE_ASSERT(thickness >= 0, "no thickness is negative");
    for (const std::uint32_t i : particles) {
      contact_margin_[i] = max(contact_margin_[i], min(beyond, max_part * thickness));
      has_margin_[pairs_.surfaces().of(i)] = 1;
    }
  };
  for (std::size_t a = 0; a < has_margin_.size(); ++a) {
    if (std::exchange(has_margin_[a], still_[a] == 0 ? 1 : 0) == 0) continue;
    const ContactSurface& surface = pairs_.surfaces()[a];
    for (std::uint32_t i = surface.begin; i < max(surface.end, surface.reserved_end); ++i) {
      const float decayed = decay * contact_margin_[i];
      contact_margin_[i] = contact_margin_[i] > negligible ? decayed : 0;
      if (contact_margin_[i] > 0) has_margin_[a] = 1;
    }
  }
  for (std::size_t c = 0; c < contacts_.size(); ++c)
    widen(columns_.normal_sum[c], columns_.approach[c], columns_.thickness[c],
          anchor_of(columns_, c).particle);
  for (const RoundContacts::Contact& contact : round_->contacts())
    widen(contact.sums.normal_sum, contact.approach, contact.thickness, contact.anchor.particle);
  round_->raise_margins(pairs_.surfaces(), contact_margin_);
}

std::size_t SurfaceContacts::after_solve(const ParticleView& particles, const Substep& substep,
                                         Threads& threads) {
  if (!pairs_.surfaces().any()) return 0;
  if (narrow_phase_->is_discrete()) {
    color_new(pairs_.update(particles, substep.h, threads));
    pairs_.measure(particles, threads);
    pairs_.end_substep();
    return 0;
  }
  const auto [clamped, first_new, held] = filter_->apply(pairs_, *narrow_phase_, particles, substep, threads);
  if (held.speed > held_.speed) held_ = held;
  color_new(first_new);
  pairs_.end_substep();
  update_contact_margins();
  return clamped;
}

std::span<const BodyPush> SurfaceContacts::body_pushes() const {
  return filter_->body_pushes();
}

std::span<const Pinch> SurfaceContacts::pinches() const {
  return filter_->pinches();
}

void SurfaceContacts::update_masses(const ParticleView& particles) {
  for (RoundContacts::Contact& contact : round_->contacts()) {
    const float inverse_mass = contact.anchor.inverse_mass(particles);
    const float ratio = inverse_mass / contact.inverse_mass;
    contact.inverse_mass = inverse_mass;
    contact.sums = {contact.sums.normal_sum * ratio, contact.sums.tangent_sum * ratio};
  }
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    if (!is_of_body(c) || !(columns_.inverse_mass[c] > 0)) continue;
    const float ratio = anchor_of(columns_, c).inverse_mass(particles) / columns_.inverse_mass[c];
    columns_.inverse_mass[c] *= ratio;
    // Sums are impulses times the inverse mass.
    columns_.normal_sum[c] *= ratio;
    for (float* const sum : columns_.tangent_sum) sum[c] *= ratio;
    if (!balls_roll_) continue;
    columns_.share[c] /= ratio;
    for (float* const sum : columns_.moment_sum) sum[c] *= ratio;
  }
}

bool SurfaceContacts::is_rigid(std::uint32_t particle) const {
  return pairs_.surfaces()[pairs_.surfaces().of(particle)].rigid;
}

bool SurfaceContacts::is_of_body(std::size_t contact) const {
  return is_rigid(columns_.particle[0][contact]) || is_rigid(columns_.particle[3][contact]);
}

float SurfaceContacts::gap(std::size_t contact, const ParticleView& particles) const {
  Vec3f apart;
  for (std::size_t k = 1; k < 4; ++k)
    apart += particles.difference(columns_.particle[k][contact], columns_.particle[0][contact]) *
             columns_.c[k][contact];
  const Vec3f n{columns_.normal[0][contact], columns_.normal[1][contact], columns_.normal[2][contact]};
  return dot(n, apart) - columns_.thickness[contact];
}

void SurfaceContacts::choose_body_contacts(const ParticleView& particles, const ParticleFunction& f) {
  of_bodies_.clear();
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    if (!is_of_body(c)) continue;
    if (!(columns_.normal_sum[c] > 0) && !(gap(c, particles) < columns_.slop[c])) continue;
    bool moves = false;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t i = columns_.particle[k][c];
      if (!is_rigid(i) || !(abs(columns_.c[k][c]) > 0) || !(particles.inverse_mass(i) > 0)) continue;
      f(i), moves = true;
    }
    if (moves) of_bodies_.push_back(static_cast<std::uint32_t>(c));
  }
  // Those of a body act on the same particles, one after the other: together they count as one.
  for (std::size_t c = 0; c < round_size(); ++c) {
    const RoundContacts::Contact& contact = round_->contacts()[c];
    const std::uint32_t i = contact.anchor.particle[0];
    if (!(contact.sums.normal_sum > 0) && !(contact.gap(particles) < contact.slop)) continue;
    if (!(particles.inverse_mass(i) > 0)) continue;
    f(i);
    of_bodies_.push_back(static_cast<std::uint32_t>(contacts_.size() + c));
  }
}

void SurfaceContacts::project_body_contacts(const ParticleView& particles) {
  const kernels::ElementPairKernels& scalar_kernels =
      kernels::find_element_pair_kernels(InstructionSet::scalar);
  for (const std::uint32_t c : of_bodies_) {
    if (c < contacts_.size())
      scalar_kernels.project(pairs_.particle_records(particles), columns_, c, c + std::size_t{1});
    else
      round_->project(c - contacts_.size(), particles);
  }
}

void SurfaceContacts::apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                        const Substep&, Threads& threads) {
  if (velocity.empty()) return;
  for (int color = 0; color < colors_->count(); ++color) {
    const std::size_t first = colors_->begin()[2 * static_cast<std::size_t>(color)];
    threads.for_each(color_size(color), grain(), [&](std::size_t begin, std::size_t end) {
      simd_kernels().apply_restitution(pairs_.particle_records(particles), columns_, narrow_phase_->limits(),
                                       &velocity[0].x, first + begin, first + end);
    });
  }
  round_->apply_restitution(particles, velocity, narrow_phase_->limits());
}

void SurfaceContacts::append_impacts(const Substep&, std::vector<Impact>& out) const {
  const kernels::ContactLimits& limits = narrow_phase_->limits();
  const auto append = [&](float normal_sum, const Impact& impact) {
    if (bounces(normal_sum, impact.restitution, impact.approach, limits.restitution_threshold))
      out.push_back(impact);
  };
  for (std::size_t c = 0; c < contacts_.size(); ++c)
    append(columns_.normal_sum[c], {columns_.particle[0][c],
                                    columns_.particle[3][c],
                                    {columns_.normal[0][c], columns_.normal[1][c], columns_.normal[2][c]},
                                    columns_.approach[c] * limits.inverse_h,
                                    columns_.restitution[c],
                                    {}});
  for (const RoundContacts::Contact& contact : round_->contacts())
    append(contact.sums.normal_sum, {contact.anchor.particle[0],
                                     contact.anchor.particle[4],
                                     contact.normal,
                                     contact.approach * limits.inverse_h,
                                     contact.material.restitution,
                                     {}});
}

ContactReport SurfaceContacts::report() const {
  const ContactReport round = report_of(round_->contacts());
  const ContactReport result = report_of(contacts_.size(), columns_.normal_sum, columns_.depth);
  return {result.count + round.count, max(result.deepest, round.deepest)};
}

void SurfaceContacts::events(const ParticleView& particles, std::vector<ContactPush>& out) const {
  const std::size_t first = out.size();
  for (std::size_t contact = 0; contact < contacts_.size(); ++contact) {
    if (!(columns_.normal_sum[contact] > 0)) continue;
    const auto i = [&](std::size_t k) { return columns_.particle[k][contact]; };
    const auto c = [&](std::size_t k) { return columns_.c[k][contact]; };
    const Vec3f normal{columns_.normal[0][contact], columns_.normal[1][contact], columns_.normal[2][contact]};
    // The particle with the largest weight on each side.
    const bool edges = c(0) < 1 || c(1) > 0;
    const std::uint32_t one = edges && c(1) > c(0) ? i(1) : i(0);
    std::size_t other = edges ? 2 : 1;
    for (std::size_t k = other; k < 4; ++k)
      if (c(k) < c(other)) other = k;
    const Vec3f point = particles.relative(one, {}) - normal * (0.5f * columns_.thickness[contact]);
    out.push_back({one, i(other), point, normal,
                   normal_impulse(columns_.normal_sum[contact], columns_.restitution_velocity[contact],
                                  narrow_phase_->limits().inverse_h, columns_.inverse_mass[contact])});
  }
  for (const RoundContacts::Contact& contact : round_->contacts()) {
    if (!(contact.sums.normal_sum > 0)) continue;
    const auto& weight = contact.anchor.weight;
    const std::size_t one =
        static_cast<std::size_t>(std::max_element(weight.begin(), weight.begin() + 4) - weight.begin());
    const std::size_t other =
        static_cast<std::size_t>(std::min_element(weight.begin() + 4, weight.end()) - weight.begin());
    Vec3f point;
    for (std::size_t k = 4; k < 7; ++k)
      point -= particles.relative(contact.anchor.particle[k], {}) * weight[k];
    out.push_back({contact.anchor.particle[one], contact.anchor.particle[other],
                   point + contact.normal * (0.5f * contact.thickness), contact.normal,
                   normal_impulse(contact.sums.normal_sum, contact.restitution_velocity,
                                  narrow_phase_->limits().inverse_h, contact.inverse_mass)});
  }
  sort_pushes(out, first);
}

void SurfaceContacts::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  for (int color = 0; color < colors_->count(); ++color)
    for (std::size_t c = colors_->begin()[2 * static_cast<std::size_t>(color)];
         c < colors_->begin()[2 * static_cast<std::size_t>(color) + 2]; ++c) {
      const std::array<std::uint32_t, 4> i{columns_.particle[0][c], columns_.particle[1][c],
                                           columns_.particle[2][c], columns_.particle[3][c]};
      visitor({i, color, 0, max(0.0f, -gap(c, particles))});
    }
  for (const RoundContacts::Contact& contact : round_->contacts())
    visitor({contact.anchor.particle, colors_->count(), 0, max(0.0f, -contact.gap(particles))});
}

float SurfaceContacts::normal_sum(std::size_t c) const {
  return c < contacts_.size() ? columns_.normal_sum[c]
                              : round_->contacts()[c - contacts_.size()].sums.normal_sum;
}

ContactImpulse SurfaceContacts::impulse(std::size_t c) const {
  if (c >= contacts_.size()) {
    const RoundContacts::Contact& contact = round_->contacts()[c - contacts_.size()];
    return contact.anchor.impulse(contact.correction(), contact.inverse_mass);
  }
  const float inverse_mass = columns_.inverse_mass[c];
  ContactImpulse result = anchor_of(columns_, c).impulse(correction_of(columns_, c), inverse_mass);
  if (balls_roll_ && columns_.share[c] > 0) {
    const auto vector = [c](float* const(&of)[3]) { return Vec3f{of[0][c], of[1][c], of[2][c]}; };
    result.moment =
        (cross(vector(columns_.tangent_sum), vector(columns_.normal)) + vector(columns_.moment_sum)) *
        (1 / inverse_mass);
  }
  return result;
}

void SurfaceContacts::visit_impulses(const ParticleView&, const ImpulseFunction& f) const {
  for (std::size_t c = 0; c < size(); ++c)
    if (normal_sum(c) > 0) f(impulse(c));
}

void SurfaceContacts::visit_body_impulses(const ImpulseFunction& f) const {
  for (const std::uint32_t c : of_bodies_)
    if (normal_sum(c) > 0) f(impulse(c));
}

std::size_t SurfaceContacts::bytes() const {
  return bytes_of(contact_pairs_, of_bodies_) + pairs_.bytes() + narrow_phase_->bytes() + colors_->bytes() +
         contacts_.bytes() + filter_->bytes() + round_->bytes();
}

}  // namespace souple
