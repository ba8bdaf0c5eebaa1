#pragma once

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
};

/// Combined coefficients of two materials in contact.
struct ContactMaterialPair {
  float static_friction = 0;
  float kinetic_friction = 0;  ///< never above static_friction
  float restitution = 0;
  float radius = std::numeric_limits<float>::infinity();  ///< of the smaller side [m]
};

/// Throws Error when a coefficient is negative or not finite, the kinetic friction is above the static one or
/// the restitution is above 1. `where` names the object or pair in the message.
void validate(const ContactMaterial& material, std::string_view where);
void validate(const ContactMaterialPair& pair, std::string_view where);

/// Default rule for two materials: geometric mean of the frictions, the larger restitution.
ContactMaterialPair combine(const ContactMaterial& a, const ContactMaterial& b);

/// Collision groups of an object or a collider, one bit for each of 32: those that it belongs to (`groups`)
/// and those that it collides with (`mask`).
struct CollisionFilter {
  std::uint32_t groups = 1;
  std::uint32_t mask = ~0u;
};

/// True when each side belongs to a group in the mask of the other side.
inline bool may_collide(const CollisionFilter& a, const CollisionFilter& b) {
  return (a.groups & b.mask) != 0 && (b.groups & a.mask) != 0;
}

/// A material with the name and filter of its object or collider.
struct NamedContactMaterial {
  std::string_view name;
  ContactMaterial material;
  CollisionFilter filter{};
  /// Of the object at rest, which determines how fast overlaps are removed [m]. Colliders: infinite.
  float radius = std::numeric_limits<float>::infinity();
};

/// Pairs of objects or colliders that deviate from the default rule, by name. The order of the two names does
/// not matter.
class PairOverrides {
 public:
  /// Throws Error when the pair is not valid.
  void set(std::string_view a, std::string_view b, const ContactMaterialPair& pair);
  const ContactMaterialPair* find(std::string_view a, std::string_view b) const;
  ContactMaterialPair resolve(const NamedContactMaterial& a, const NamedContactMaterial& b) const;

  /// Enables or disables collisions of a pair; the default is enabled. The same name twice: disables the
  /// object's self-collision, or leaves it as the object has it.
  void set_collide(std::string_view a, std::string_view b, bool collide);
  /// Combines set_collide and the filters. Filters do not apply to an object's self-collision.
  bool collide(const NamedContactMaterial& a, const NamedContactMaterial& b) const;

 private:
  std::map<std::pair<std::string, std::string>, ContactMaterialPair> overrides_;
  std::set<std::pair<std::string, std::string>> non_colliding_;
};

/// Combined materials of every row with every column, by index: the table that contacts read during a step.
class ContactMaterialTable {
 public:
  ContactMaterialTable() = default;
  ContactMaterialTable(std::span<const NamedContactMaterial> rows,
                       std::span<const NamedContactMaterial> columns, const PairOverrides& table);

  const ContactMaterialPair& at(std::size_t row, std::size_t column) const {
    return pairs_[row * columns_ + column];
  }
  /// False: row and column pass through each other.
  bool collide(std::size_t row, std::size_t column) const { return collide_[row * columns_ + column] != 0; }
  std::size_t rows() const { return columns_ == 0 ? 0 : pairs_.size() / columns_; }
  std::size_t columns() const { return columns_; }

 private:
  std::vector<ContactMaterialPair> pairs_;
  std::vector<std::uint8_t> collide_;
  std::size_t columns_ = 0;
};

}  // namespace souple
