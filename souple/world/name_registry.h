#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace souple {

/// Names, each once: of a world's objects and colliders, or of its joints.
class NameRegistry {
 public:
  enum class Owner : std::uint8_t { object, collider, joint };
  struct Entry {
    Owner owner = Owner::object;
    std::uint32_t id = 0;
  };

  /// Throws Error when the name is taken.
  void require_free(std::string_view name) const;
  /// The first free name of `base`, base2, base3, ...
  std::string first_free(std::string_view base) const;
  /// Null if nothing has the name.
  const Entry* find(std::string_view name) const;
  void add(std::string_view name, const Entry& entry);
  void remove(std::string_view name);

 private:
  std::map<std::string, Entry, std::less<>> entries_;
  /// Per base: base2 to base(n - 1) are taken. Each base of a name that was added or removed has an entry.
  std::map<std::string, std::uint64_t, std::less<>> first_free_;
};

}  // namespace souple
