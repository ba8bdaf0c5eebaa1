#pragma once

#include "random.h"

#include <string>
#include <string_view>

namespace souple::fuzz {

/// A change that keeps most files valid: numbers become other numbers, lines and members move, and the counts
/// and lengths that tell of them follow. The name of the format says what its bytes mean.
void change_structure(std::string_view format, std::string& bytes, Random& random);

/// Changes one number, or lines, of the text before `end`. A number takes a value from another line of the same shape.
/// Lines of one shape change places, and a line that comes or goes changes the count before it.
void change_text(std::string& text, std::size_t end, Random& random);

/// Changes one value of a JSON text, or moves, copies or removes a member.
void change_json(std::string& text, Random& random);

}  // namespace souple::fuzz
