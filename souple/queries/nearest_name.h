#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace souple {

/// Optimal string alignment distance, ignoring case: insertions, deletions, replacements and swaps of neighbors.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// "; did you mean 'flag'?" if a name is similar, "; there are: a, b" if there are few names, "; there is
/// none" without names, or nothing.
std::string nearest_name(std::string_view name, std::span<const std::string_view> names);

}  // namespace souple
