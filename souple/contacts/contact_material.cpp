#include "souple/contacts/contact_material.h"

#include "souple/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

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
  check(where, "rolling_friction", material.rolling_friction.value_or(0.0f), any,
        "a finite number of at least 0");
}

void validate(const ContactMaterialPair& pair, std::string_view where) {
  check(where, "static friction", pair.static_friction, any, "a finite number of at least 0");
  check(where, "kinetic friction", pair.kinetic_friction, pair.static_friction,
        "a number from 0 to the static friction");
  check(where, "restitution", pair.restitution, 1, "a number from 0 to 1");
  check(where, "rolling friction", pair.rolling_friction, any, "a finite number of at least 0");
}

void PairOverrides::set(std::string_view a, std::string_view b, const ContactMaterialPair& pair) {
  validate(pair, "material pair '" + std::string(a) + "', '" + std::string(b) + "'");
  overrides_[key_of(a, b)] = pair;
}

void PairOverrides::set_collide(std::string_view a, std::string_view b, bool collide) {
  if (collide) {
    non_colliding_.erase(key_of(a, b));
  } else {
    non_colliding_.insert(key_of(a, b));
  }
}

bool PairOverrides::collide(std::string_view a, std::string_view b) const {
  return non_colliding_.count(key_of(a, b)) == 0;
}

ContactMaterialTable::Side ContactMaterialTable::side_of(const NamedContactMaterial& of) {
  return {of.material,
          std::sqrt(of.material.friction),
          std::sqrt(of.material.kinetic_friction.value_or(of.material.friction)),
          std::sqrt(of.material.rolling_friction.value_or(0.0f)),
          of.filter,
          of.radius};
}

// Root of each factor: the product cannot overflow. Equal frictions are returned unchanged.
float ContactMaterialTable::mean(float x, float y, float root_of_x, float root_of_y) {
  return x == y ? x : root_of_x * root_of_y;
}

float ContactMaterialTable::combined_rolling(const Side& a, const Side& b) {
  const std::optional<float> x = a.material.rolling_friction, y = b.material.rolling_friction;
  if (!x || !y) return x.value_or(y.value_or(0.0f));
  return mean(*x, *y, a.root_of_rolling_friction, b.root_of_rolling_friction);
}

ContactMaterialPair ContactMaterialTable::combined(const Side& a, const Side& b) {
  const float static_friction =
      mean(a.material.friction, b.material.friction, a.root_of_friction, b.root_of_friction);
  const float kinetic_friction = mean(a.material.kinetic_friction.value_or(a.material.friction),
                                      b.material.kinetic_friction.value_or(b.material.friction),
                                      a.root_of_kinetic_friction, b.root_of_kinetic_friction);
  return {static_friction, std::min(kinetic_friction, static_friction),
          std::max(a.material.restitution, b.material.restitution), combined_rolling(a, b),
          std::min(a.radius, b.radius)};
}

ContactMaterialTable::ContactMaterialTable(std::span<const NamedContactMaterial> rows,
                                           std::span<const NamedContactMaterial> columns,
                                           const PairOverrides& table) {
  std::unordered_multimap<std::string_view, std::uint32_t> row_of, column_of;
  for (const NamedContactMaterial& row : rows)
    row_of.emplace(row.name, static_cast<std::uint32_t>(rows_.size())), rows_.push_back(side_of(row));
  for (const NamedContactMaterial& column : columns)
    column_of.emplace(column.name, static_cast<std::uint32_t>(columns_.size())),
        columns_.push_back(side_of(column));
  is_square_ = rows.data() == columns.data() && rows.size() == columns.size();
  const auto add = [&](std::string_view row, std::string_view column, const ContactMaterialPair* pair,
                       bool collide) {
    const auto [first_row, last_row] = row_of.equal_range(row);
    const auto [first_column, last_column] = column_of.equal_range(column);
    for (auto r = first_row; r != last_row; ++r)
      for (auto c = first_column; c != last_column; ++c) {
        exceptions_.push_back({r->second, c->second, {}, collide});
        if (pair != nullptr) exceptions_.back().pair = *pair;
      }
  };
  table.for_each(
      [&](const std::string& a, const std::string& b, const ContactMaterialPair* pair, bool collide) {
        add(a, b, pair, collide);
        if (a != b) add(b, a, pair, collide);
      });
  std::sort(exceptions_.begin(), exceptions_.end(), [](const Exception& a, const Exception& b) {
    return std::pair(a.row, a.column) < std::pair(b.row, b.column);
  });
  exceptions_begin_.assign(rows.size() + 1, 0);
  for (const Exception& exception : exceptions_) ++exceptions_begin_[exception.row + std::size_t{1}];
  std::partial_sum(exceptions_begin_.begin(), exceptions_begin_.end(), exceptions_begin_.begin());
}

std::span<const ContactMaterialTable::Exception> ContactMaterialTable::exceptions_of(std::size_t row) const {
  const std::uint32_t begin = exceptions_begin_[row];
  return std::span(exceptions_).subspan(begin, exceptions_begin_[row + 1] - begin);
}

const ContactMaterialTable::Exception* ContactMaterialTable::find(std::size_t row, std::size_t column) const {
  const std::span<const Exception> of_row = exceptions_of(row);
  const auto at = std::partition_point(of_row.begin(), of_row.end(),
                                       [&](const Exception& e) { return e.column < column; });
  return at != of_row.end() && at->column == column ? &*at : nullptr;
}

ContactMaterialPair ContactMaterialTable::at(std::size_t row, std::size_t column) const {
  const Exception* const exception = find(row, column);
  const ContactMaterialPair usual = combined(rows_[row], columns_[column]);
  if (exception == nullptr || !exception->pair) return usual;
  ContactMaterialPair result = *exception->pair;
  result.rolling_friction = usual.rolling_friction;
  result.radius = usual.radius;
  return result;
}

bool ContactMaterialTable::collide(std::size_t row, std::size_t column) const {
  const bool itself = is_square_ && row == column;
  if (!itself && !may_collide(rows_[row].filter, columns_[column].filter)) return false;
  const Exception* const exception = find(row, column);
  return exception == nullptr || exception->collide;
}

}  // namespace souple
