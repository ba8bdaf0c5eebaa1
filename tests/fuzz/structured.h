#pragma once

#include "random.h"

#include <string>
#include <string_view>

namespace souple::fuzz {

/// A change that keeps most files valid: numbers become other numbers, lines and members move, and the counts
/// and lengths that tell of them follow. The name of the format says what its bytes mean.
void change_structure(std::string_view format, std::string& bytes, Random& random);

}  // namespace souple::fuzz
