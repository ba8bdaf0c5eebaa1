#include "souple/world/name_registry.h"

#include "souple/error.h"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/core.h>

namespace souple {
namespace {

/// A name and the number at its end: "cloth12" is the 12th of "cloth". 0: there is none that first_free gives.
struct Numbered {
  std::string_view base;
  std::uint64_t number = 0;
};

Numbered numbered(std::string_view name) {
  const std::size_t last_letter = name.find_last_not_of("0123456789");
  const std::size_t size = last_letter == std::string_view::npos ? 0 : last_letter + 1;
  const std::string_view digits = name.substr(size);
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (digits.empty() || error != std::errc{} || digits.front() == '0') return {name, 0};
  return {name.substr(0, size), number};
}

}  // namespace

void NameRegistry::require_free(std::string_view name) const {
  const Entry* const entry = find(name);
  if (entry == nullptr) return;
  constexpr std::array<std::string_view, 3> owners{"another object", "a collider", "another joint"};
  throw Error(
      fmt::format("the name '{}' is taken by {}", name, owners[static_cast<std::size_t>(entry->owner)]));
}

std::string NameRegistry::first_free(std::string_view base) const {
  std::string name(base);
  if (find(name) == nullptr) return name;
  const auto known = first_free_.find(base);
  std::uint64_t number = known == first_free_.end() ? 2 : known->second;
  do name = fmt::format("{}{}", base, number++);
  while (find(name) != nullptr);
  return name;
}

const NameRegistry::Entry* NameRegistry::find(std::string_view name) const {
  const auto entry = entries_.find(name);
  return entry == entries_.end() ? nullptr : &entry->second;
}

void NameRegistry::add(std::string_view name, const Entry& entry) {
  const auto [base, number] = numbered(name);
  std::uint64_t* const first =
      number < 2 ? nullptr : &first_free_.try_emplace(std::string(base), 2).first->second;
  entries_.emplace(name, entry);
  if (first != nullptr && number == *first) ++*first;
}

void NameRegistry::remove(std::string_view name) {
  const auto [base, number] = numbered(name);
  if (const auto first = first_free_.find(base); number >= 2 && first != first_free_.end())
    first->second = std::min(first->second, number);
  if (const auto entry = entries_.find(name); entry != entries_.end()) entries_.erase(entry);
}

}  // namespace souple
