#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace souple {

/// How an object's or a collider's surface rubs and bounces.
struct Surface {
  float friction = 0.5f;                    ///< static coefficient
  std::optional<float> kinetic_friction{};  ///< the static one when absent
  float restitution = 0;                    ///< in [0, 1]
};

/// The same for two surfaces that touch.
struct SurfacePair {
  float static_friction = 0;
  float kinetic_friction = 0;  ///< never above the static one
  float restitution = 0;
};

/// Throws Error when a coefficient is negative or not finite, the kinetic friction is above the static one or
/// the restitution above 1; `where` names the owner in the message.
void validate(const Surface& surface, std::string_view where);
void validate(const SurfacePair& pair, std::string_view where);

/// The rule for two surfaces: geometric mean of the frictions, the larger restitution.
SurfacePair combine(const Surface& a, const Surface& b);

/// A surface and the name of the object or collider that has it.
struct NamedSurface {
  std::string_view name;
  Surface surface;
};

/// Exceptions to the rule, by the names of objects and colliders; the order of the two names does not matter.
class PairTable {
 public:
  /// Throws Error when the pair is not valid.
  void set(std::string_view a, std::string_view b, const SurfacePair& pair);
  void erase(std::string_view a, std::string_view b);
  const SurfacePair* find(std::string_view a, std::string_view b) const;
  SurfacePair resolve(const NamedSurface& a, const NamedSurface& b) const;
  const std::map<std::pair<std::string, std::string>, SurfacePair>& entries() const { return entries_; }

 private:
  std::map<std::pair<std::string, std::string>, SurfacePair> entries_;
};

/// Every row against every column, looked up by index: what contacts read in a step.
class SurfaceMatrix {
 public:
  SurfaceMatrix() = default;
  SurfaceMatrix(std::span<const NamedSurface> rows, std::span<const NamedSurface> columns,
                const PairTable& table);

  const SurfacePair& at(std::size_t row, std::size_t column) const { return pairs_[row * columns_ + column]; }
  std::size_t rows() const { return columns_ == 0 ? 0 : pairs_.size() / columns_; }
  std::size_t columns() const { return columns_; }

 private:
  std::vector<SurfacePair> pairs_;
  std::size_t columns_ = 0;
};

}  // namespace souple
