#include "souple/state/particles.h"

#include "souple/assert.h"
#include "souple/math/index_range.h"

namespace souple {
namespace {

template <class Function>
void for_each_array(Particles& p, const Function& f) {
  f(p.position), f(p.offset), f(p.start), f(p.velocity), f(p.mass), f(p.radius), f(p.element_radius),
      f(p.contact_margin);
  if (p.has_spin()) f(p.spin), f(p.turn);
}

}  // namespace

void Particles::resize(std::size_t count) {
  for_each_array(*this, [count](auto& array) { array.resize(count); });
}

void Particles::shrink_to_fit() {
  for_each_array(*this, [](auto& array) { array.shrink_to_fit(); });
}

void Particles::copy(std::size_t from, std::size_t to) {
  SOUPLE_ASSERT(from < size() && to < size(), "two particles");
  for_each_array(*this, [from, to](auto& array) { array[to] = array[from]; });
}

void Particles::erase(std::span<const IndexRange> ranges) {
  for_each_array(*this, [ranges](auto& array) {
    if (!array.empty()) erase_ranges(array, ranges);
  });
}

}  // namespace souple
