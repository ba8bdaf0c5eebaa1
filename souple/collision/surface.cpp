#include "souple/collision/surface.h"

#include "souple/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

namespace souple {
namespace {

void check(std::string_view where, const char* what, float value, float largest, const char* expected) {
  if (std::isfinite(value) && value >= 0 && value <= largest) return;
  throw Error(fmt::format("{}: {} is {:g}; expected {}", where, what, value, expected));
}

std::pair<std::string, std::string> key_of(std::string_view a, std::string_view b) {
  if (b < a) std::swap(a, b);
  return {std::string(a), std::string(b)};
}

constexpr float any = std::numeric_limits<float>::max();

}  // namespace

void validate(const Surface& surface, std::string_view where) {
  check(where, "friction", surface.friction, any, "a finite number of at least 0");
  check(where, "kinetic_friction", surface.kinetic_friction.value_or(surface.friction), surface.friction,
        "a number from 0 to friction");
  check(where, "restitution", surface.restitution, 1, "a number from 0 to 1");
}

void validate(const SurfacePair& pair, std::string_view where) {
  check(where, "static friction", pair.static_friction, any, "a finite number of at least 0");
  check(where, "kinetic friction", pair.kinetic_friction, pair.static_friction,
        "a number from 0 to the static friction");
  check(where, "restitution", pair.restitution, 1, "a number from 0 to 1");
}

SurfacePair combine(const Surface& a, const Surface& b) {
  // The square root of each factor: no product to overflow, and equal frictions come out as they are.
  const auto mean = [](float x, float y) { return x == y ? x : std::sqrt(x) * std::sqrt(y); };
  const float still = mean(a.friction, b.friction);
  const float sliding =
      mean(a.kinetic_friction.value_or(a.friction), b.kinetic_friction.value_or(b.friction));
  return {still, std::min(sliding, still), std::max(a.restitution, b.restitution)};
}

void PairTable::set(std::string_view a, std::string_view b, const SurfacePair& pair) {
  validate(pair, "surface pair '" + std::string(a) + "', '" + std::string(b) + "'");
  entries_[key_of(a, b)] = pair;
}

const SurfacePair* PairTable::find(std::string_view a, std::string_view b) const {
  const auto found = entries_.find(key_of(a, b));
  return found == entries_.end() ? nullptr : &found->second;
}

SurfacePair PairTable::resolve(const NamedSurface& a, const NamedSurface& b) const {
  const SurfacePair* exception = find(a.name, b.name);
  return exception ? *exception : combine(a.surface, b.surface);
}

void PairTable::set_collide(std::string_view a, std::string_view b, bool collide) {
  if (collide) {
    apart_.erase(key_of(a, b));
  } else {
    apart_.insert(key_of(a, b));
  }
}

bool PairTable::collide(const NamedSurface& a, const NamedSurface& b) const {
  if (a.name != b.name && !meet(a.filter, b.filter)) return false;
  return apart_.empty() || apart_.count(key_of(a.name, b.name)) == 0;
}

SurfaceMatrix::SurfaceMatrix(std::span<const NamedSurface> rows, std::span<const NamedSurface> columns,
                             const PairTable& table)
    : columns_(columns.size()) {
  pairs_.reserve(rows.size() * columns.size());
  collide_.reserve(pairs_.capacity());
  for (const NamedSurface& row : rows)
    for (const NamedSurface& column : columns) {
      pairs_.push_back(table.resolve(row, column));
      collide_.push_back(table.collide(row, column) ? 1 : 0);
    }
}

}  // namespace souple
