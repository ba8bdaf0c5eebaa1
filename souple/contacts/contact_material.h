#pragma once

#include "souple/broad_phase/collision_filter.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace souple {

/// Friction and restitution of an object or a collider.
struct ContactMaterial {
  float friction = 0.5f;                    ///< coefficient of static friction
  std::optional<float> kinetic_friction{};  ///< coefficient; that of static friction when absent
  float restitution = 0;                    ///< coefficient, in [0, 1]
  /// Largest moment of a contact about the center of a ball that rotates, as a part of radius times normal force.
  std::optional<float> rolling_friction{};
};

/// Combined coefficients of two materials in contact.
struct ContactMaterialPair {
  float static_friction = 0;
  float kinetic_friction = 0;  ///< never above static_friction
  float restitution = 0;
  float rolling_friction = 0;
  float radius = std::numeric_limits<float>::infinity();  ///< of the smaller side [m]
};

/// Throws Error when a coefficient is negative or not finite, the kinetic friction is above the static one or
/// the restitution is above 1. `where` names the object or pair in the message.
void validate(const ContactMaterial& material, std::string_view where);
void validate(const ContactMaterialPair& pair, std::string_view where);

/// A material with the name and filter of its object or collider.
struct NamedContactMaterial {
  std::string_view name;
  ContactMaterial material;
  CollisionFilter filter{};
  /// Radius of the object at rest, which determines how fast overlaps are removed [m]. Colliders: infinite.
  float radius = std::numeric_limits<float>::infinity();
};

/// Pairs of objects or colliders that deviate from the default rule, by name. The order of the two names does
/// not matter.
class PairOverrides {
 public:
  /// Throws Error when the pair is not valid.
  void set(std::string_view a, std::string_view b, const ContactMaterialPair& pair);
  /// Enables or disables collisions of a pair; the default is enabled. A pair of one name with itself disables the
  /// object's self-collision, or leaves it as the object has it.
  void set_collide(std::string_view a, std::string_view b, bool collide);
  bool collide(std::string_view a, std::string_view b) const;

  /// Calls f(name, other name, pair or null, collide) for every pair that deviates, once.
  template <class Function>
  void for_each(const Function& f) const {
    for (const auto& [names, pair] : overrides_)
      f(names.first, names.second, &pair, non_colliding_.count(names) == 0);
    for (const auto& names : non_colliding_)
      if (overrides_.count(names) == 0)
        f(names.first, names.second, static_cast<const ContactMaterialPair*>(nullptr), false);
  }

 private:
  std::map<std::pair<std::string, std::string>, ContactMaterialPair> overrides_;
  std::set<std::pair<std::string, std::string>> non_colliding_;
};

/// Combined materials of every row with every column, by index: what contacts read during a step. Keeps the materials of
/// rows and columns and the pairs that deviate, and combines them when asked: 10,000 objects have 50 million pairs.
class ContactMaterialTable {
 public:
  ContactMaterialTable() = default;
  ContactMaterialTable(std::span<const NamedContactMaterial> rows,
                       std::span<const NamedContactMaterial> columns, const PairOverrides& table);

  /// An override keeps the rolling friction of the default rule.
  ContactMaterialPair at(std::size_t row, std::size_t column) const;
  /// `at(row, column).radius`.
  float radius(std::size_t row, std::size_t column) const {
    return std::min(rows_[row].radius, columns_[column].radius);
  }
  /// False: row and column pass through each other.
  bool collide(std::size_t row, std::size_t column) const;
  std::size_t rows() const { return columns_.empty() ? 0 : rows_.size(); }
  std::size_t columns() const { return columns_.size(); }
  /// Calls f(column) for the columns that a row does not collide with although their filters let it, ascending.
  template <class Function>
  void for_each_ignored(std::size_t row, const Function& f) const {
    for (const Exception& exception : exceptions_of(row))
      if (!exception.collide) f(exception.column);
  }

 private:
  struct Side {
    ContactMaterial material;
    float root_of_friction = 0, root_of_kinetic_friction = 0, root_of_rolling_friction = 0;
    CollisionFilter filter;
    float radius = 0;
  };
  struct Exception {
    std::uint32_t row = 0, column = 0;
    std::optional<ContactMaterialPair> pair{};
    bool collide = true;
  };
  static Side side_of(const NamedContactMaterial& material);
  static float mean(float x, float y, float root_of_x, float root_of_y);
  static float combined_rolling(const Side& a, const Side& b);
  /// Geometric mean of the frictions and of the rolling frictions, the larger restitution. Where only one material has
  /// a rolling friction, it counts.
  static ContactMaterialPair combined(const Side& a, const Side& b);
  std::span<const Exception> exceptions_of(std::size_t row) const;
  const Exception* find(std::size_t row, std::size_t column) const;

  std::vector<Side> rows_, columns_;
  std::vector<Exception> exceptions_;            // by row, then column
  std::vector<std::uint32_t> exceptions_begin_;  // per row
  bool is_square_ = false;  // row k is column k: filters do not apply to an object's self-collision
};

}  // namespace souple
