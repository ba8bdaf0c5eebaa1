#include "souple/collision/contact_material.h"

#include "souple/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

namespace souple {
namespace {

void check(std::string_view where, const char* what, float value, float max_value, const char* expected) {
  if (std::isfinite(value) && value >= 0 && value <= max_value) return;
  throw Error(fmt::format("{}: {} is {:g}; expected {}", where, what, value, expected));
}

std::pair<std::string, std::string> key_of(std::string_view a, std::string_view b) {
  if (b < a) std::swap(a, b);
  return {std::string(a), std::string(b)};
}

constexpr float any = std::numeric_limits<float>::max();

}  // namespace

void validate(const ContactMaterial& material, std::string_view where) {
  check(where, "friction", material.friction, any, "a finite number of at least 0");
  check(where, "kinetic_friction", material.kinetic_friction.value_or(material.friction), material.friction,
        "a number from 0 to friction");
  check(where, "restitution", material.restitution, 1, "a number from 0 to 1");
}

void validate(const ContactMaterialPair& pair, std::string_view where) {
  check(where, "static friction", pair.static_friction, any, "a finite number of at least 0");
  check(where, "kinetic friction", pair.kinetic_friction, pair.static_friction,
        "a number from 0 to the static friction");
  check(where, "restitution", pair.restitution, 1, "a number from 0 to 1");
}

ContactMaterialPair combine(const ContactMaterial& a, const ContactMaterial& b) {
  // Root of each factor: the product cannot overflow. Equal frictions are returned unchanged.
  const auto mean = [](float x, float y) { return x == y ? x : std::sqrt(x) * std::sqrt(y); };
  const float static_friction = mean(a.friction, b.friction);
  const float kinetic_friction =
      mean(a.kinetic_friction.value_or(a.friction), b.kinetic_friction.value_or(b.friction));
  return {static_friction, std::min(kinetic_friction, static_friction),
          std::max(a.restitution, b.restitution)};
}

void PairOverrides::set(std::string_view a, std::string_view b, const ContactMaterialPair& pair) {
  validate(pair, "material pair '" + std::string(a) + "', '" + std::string(b) + "'");
  overrides_[key_of(a, b)] = pair;
}

const ContactMaterialPair* PairOverrides::find(std::string_view a, std::string_view b) const {
  const auto found = overrides_.find(key_of(a, b));
  return found == overrides_.end() ? nullptr : &found->second;
}

ContactMaterialPair PairOverrides::resolve(const NamedContactMaterial& a,
                                           const NamedContactMaterial& b) const {
  const ContactMaterialPair* exception = find(a.name, b.name);
  return exception ? *exception : combine(a.material, b.material);
}

void PairOverrides::set_collide(std::string_view a, std::string_view b, bool collide) {
  if (collide) {
    non_colliding_.erase(key_of(a, b));
  } else {
    non_colliding_.insert(key_of(a, b));
  }
}

bool PairOverrides::collide(const NamedContactMaterial& a, const NamedContactMaterial& b) const {
  if (a.name != b.name && !may_collide(a.filter, b.filter)) return false;
  return non_colliding_.empty() || non_colliding_.count(key_of(a.name, b.name)) == 0;
}

ContactMaterialTable::ContactMaterialTable(std::span<const NamedContactMaterial> rows,
                                           std::span<const NamedContactMaterial> columns,
                                           const PairOverrides& table)
    : columns_(columns.size()) {
  pairs_.reserve(rows.size() * columns.size());
  collide_.reserve(pairs_.capacity());
  for (const NamedContactMaterial& row : rows)
    for (const NamedContactMaterial& column : columns) {
      pairs_.push_back(table.resolve(row, column));
      pairs_.back().radius = std::min(row.radius, column.radius);
      collide_.push_back(table.collide(row, column) ? 1 : 0);
    }
}

}  // namespace souple
