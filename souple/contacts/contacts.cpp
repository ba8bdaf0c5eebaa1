#include "souple/contacts/contacts.h"

#include "souple/contacts/collider_contacts.h"
#include "souple/contacts/collider_element_contacts.h"
#include "souple/contacts/particle_contacts.h"
#include "souple/contacts/surfaces/surface_contacts.h"
#include "souple/contacts/vertex_balls.h"
#include "souple/intersections/intersection_resolver.h"
#include "souple/state/saved_bytes.h"

#include <exception>

namespace souple {

// The order of solution. Colliders come last: nothing pushes a particle back into one.
Contacts::Contacts() : intersection_resolver_(std::make_unique<IntersectionResolver>()) {
  kinds_.push_back(std::make_unique<SurfaceContacts>(intersection_resolver_.get()));
  kinds_.push_back(std::make_unique<ParticleContacts>());
  kinds_.push_back(std::make_unique<VertexBalls>());
  kinds_.push_back(std::make_unique<ColliderElementContacts>());
  kinds_.push_back(std::make_unique<ColliderContacts>());
}

Contacts::~Contacts() = default;

void Contacts::build(const ContactGeometry& geometry) {
  *intersection_resolver_ = IntersectionResolver(geometry.surfaces, geometry.joined);
  for (const auto& kind : kinds_) kind->build(geometry);
}

void Contacts::set_end(std::size_t object, std::uint32_t end) {
  for (const auto& kind : kinds_) kind->set_end(object, end);
}

// A user's callback may throw in one kind: the others find their contacts all the same.
template <class Function>
void Contacts::guarded_for_each(const Function& f) {
  std::exception_ptr first;
  for (const auto& kind : kinds_) {
    try {
      f(*kind);
    } catch (...) {
      if (!first) first = std::current_exception();
    }
  }
  if (first) std::rethrow_exception(first);
}

void Contacts::begin_step(const ContactInput& input, bool search_intersections, Threads& threads) {
  intersection_resolver_->begin_step(input.particles, input.step, search_intersections, threads);
  guarded_for_each([&](ContactProjector& kind) { kind.begin_step(input, threads); });
}

void Contacts::refresh(const ParticleView& particles, const Substep& substep, double time, Threads& threads) {
  intersection_resolver_->separate(particles, substep);
  guarded_for_each([&](ContactProjector& kind) { kind.refresh(particles, substep, time, threads); });
}

std::size_t Contacts::after_solve(const ParticleView& particles, const Substep& substep, Threads& threads) {
  std::size_t clamped = 0;
  for (const auto& kind : kinds_) clamped += kind->after_solve(particles, substep, threads);
  return clamped;
}

// Only contacts of surfaces have any.
std::span<const BodyPush> Contacts::body_pushes() const {
  return kinds_.front()->body_pushes();
}

std::span<const Pinch> Contacts::pinches() const {
  return kinds_.front()->pinches();
}

void Contacts::update_masses(const ParticleView& particles) {
  for (const auto& kind : kinds_) kind->update_masses(particles);
}

void Contacts::choose_body_contacts(const ParticleView& particles, const ParticleFunction& f) {
  for (const auto& kind : kinds_) kind->choose_body_contacts(particles, f);
}

void Contacts::project_body_contacts(const ParticleView& particles) {
  for (const auto& kind : kinds_) kind->project_body_contacts(particles);
}

void Contacts::visit_body_impulses(const ImpulseFunction& f) const {
  for (const auto& kind : kinds_) kind->visit_body_impulses(f);
}

void Contacts::append_impacts(const Substep& substep, std::vector<Impact>& out) const {
  for (const auto& kind : kinds_) kind->append_impacts(substep, out);
}

void Contacts::apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                 const Substep& substep, Threads& threads) {
  for (const auto& kind : kinds_) kind->apply_restitution(particles, velocity, substep, threads);
}

void Contacts::visit_impulses(const ParticleView& particles, const ImpulseFunction& f) const {
  for (const auto& kind : kinds_) kind->visit_impulses(particles, f);
}

ContactReport Contacts::report() const {
  ContactReport sum;
  for (const auto& kind : kinds_) {
    const ContactReport report = kind->report();
    sum.count += report.count;
    sum.deepest = max(sum.deepest, report.deepest);
  }
  return sum;
}

ShortenedMotion Contacts::shortened() const {
  ShortenedMotion fastest;
  for (const auto& kind : kinds_)
    if (kind->shortened().speed > fastest.speed) fastest = kind->shortened();
  return fastest;
}

void Contacts::events(const ParticleView& particles, std::vector<ContactPush>& out) const {
  for (const bool colliders : {true, false})
    for (const auto& kind : kinds_)
      if (kind->is_collider_contact() == colliders) kind->events(particles, out);
}

void Contacts::visit_separated(const ParticleFunction& f) const {
  intersection_resolver_->visit_separated(f);
}

std::span<const IntersectingPair> Contacts::intersecting_pairs() const {
  return intersection_resolver_->pairs();
}

std::size_t Contacts::layer_violations() const {
  return intersection_resolver_->layer_violations().size();
}

void ContactProjector::check_saved(SavedBytes in, std::size_t) const {
  in.require_end();
}
void ContactProjector::load(SavedBytes) {}

void Contacts::save(SavedBytesWriter& out) const {
  for (std::size_t k = 0; k < kinds_.size(); ++k) out.section(k, [&] { kinds_[k]->save(out); });
}

void Contacts::check_saved(SavedBytes in, std::size_t particles) const {
  for (std::size_t k = 0; k < kinds_.size(); ++k)
    kinds_[k]->check_saved(in.section(k, kinds_[k]->kind()), particles);
  in.require_end();
}

void Contacts::load(SavedBytes in) {
  for (std::size_t k = 0; k < kinds_.size(); ++k) kinds_[k]->load(in.section(k, kinds_[k]->kind()));
}

void Contacts::erase_particles(std::uint32_t begin, std::uint32_t end) {
  for (const auto& kind : kinds_) kind->erase_particles(begin, end);
}

std::size_t Contacts::bytes() const {
  std::size_t sum = intersection_resolver_->bytes();
  for (const auto& kind : kinds_) sum += kind->bytes();
  return sum;
}

}  // namespace souple
