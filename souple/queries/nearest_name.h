#pragma once

#include <span>
#include <string>
#include <string_view>

namespace souple {

/// "; did you mean 'flag'?" if a name is similar, "; there are: a, b" if there are few names, "; there is
/// none" without names, or nothing.
std::string nearest_name(std::string_view name, std::span<const std::string_view> names);

}  // namespace souple
