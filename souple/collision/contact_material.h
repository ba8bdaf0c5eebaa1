#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace souple {

/// How an object's or a collider's surface rubs and bounces.
struct ContactMaterial {
  float friction = 0.5f;                    ///< static coefficient
  std::optional<float> kinetic_friction{};  ///< the static one when absent
  float restitution = 0;                    ///< in [0, 1]
};

/// The same for two surfaces that touch.
struct ContactMaterialPair {
  float static_friction = 0;
  float kinetic_friction = 0;  ///< never above the static one
  float restitution = 0;
};

/// Throws Error when a coefficient is negative or not finite, the kinetic friction is above the static one or
/// the restitution above 1; `where` names the owner in the message.
void validate(const ContactMaterial& material, std::string_view where);
void validate(const ContactMaterialPair& pair, std::string_view where);

/// The rule for two surfaces: geometric mean of the frictions, the larger restitution.
ContactMaterialPair combine(const ContactMaterial& a, const ContactMaterial& b);

/// Which of the 32 collision groups something belongs to, and which it wants to meet; one bit each.
struct CollisionFilter {
  std::uint32_t groups = 1;
  std::uint32_t mask = ~0u;
};

/// Two things meet when each belongs to a group that the other wants to meet.
inline bool may_collide(const CollisionFilter& a, const CollisionFilter& b) {
  return (a.groups & b.mask) != 0 && (b.groups & a.mask) != 0;
}

/// A surface and the name of the object or collider that has it.
struct NamedContactMaterial {
  std::string_view name;
  ContactMaterial material;
  CollisionFilter filter{};
};

/// Exceptions to the rule, by the names of objects and colliders; the order of the two names does not matter.
class PairOverrides {
 public:
  /// Throws Error when the pair is not valid.
  void set(std::string_view a, std::string_view b, const ContactMaterialPair& pair);
  const ContactMaterialPair* find(std::string_view a, std::string_view b) const;
  ContactMaterialPair resolve(const NamedContactMaterial& a, const NamedContactMaterial& b) const;

  /// Whether the two collide at all; they do until told otherwise. A name with itself: whether it collides
  /// with itself, if it would.
  void set_collide(std::string_view a, std::string_view b, bool collide);
  /// The switch and the filters together. The filters do not say whether something collides with itself.
  bool collide(const NamedContactMaterial& a, const NamedContactMaterial& b) const;

 private:
  std::map<std::pair<std::string, std::string>, ContactMaterialPair> overrides_;
  std::set<std::pair<std::string, std::string>> non_colliding_;
};

/// Every row against every column, looked up by index: what contacts read in a step.
class ContactMaterialTable {
 public:
  ContactMaterialTable() = default;
  ContactMaterialTable(std::span<const NamedContactMaterial> rows,
                       std::span<const NamedContactMaterial> columns, const PairOverrides& table);

  const ContactMaterialPair& at(std::size_t row, std::size_t column) const {
    return pairs_[row * columns_ + column];
  }
  /// False: the two pass through each other.
  bool collide(std::size_t row, std::size_t column) const { return collide_[row * columns_ + column] != 0; }
  std::size_t rows() const { return columns_ == 0 ? 0 : pairs_.size() / columns_; }
  std::size_t columns() const { return columns_; }

 private:
  std::vector<ContactMaterialPair> pairs_;
  std::vector<std::uint8_t> collide_;
  std::size_t columns_ = 0;
};

}  // namespace souple
