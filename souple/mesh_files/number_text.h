#pragma once

#include <string>
#include <string_view>

namespace souple::mesh_detail {

/// Parses a number without sign, such as "1.5e-3", as std::from_chars does: independent of the locale, the nearest
/// double, whole texts only. False for anything else, and for numbers beyond the range of double; those below it become 0.
bool parse_unsigned_real(std::string_view text, double& value);
/// Appends the shortest text that parses to the same float, as std::to_chars does.
void append_real(std::string& out, float value);

// Substitutes where the standard library lacks floating from_chars and to_chars (libc++ before version 20).
bool parse_unsigned_real_portably(std::string_view text, double& value);
void append_real_portably(std::string& out, float value);

}  // namespace souple::mesh_detail
