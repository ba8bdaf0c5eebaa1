#pragma once

#include <string>

namespace souple {

/// Path of a file of the checkout, such as source_path("scenes/curtain.json"); without argument, of the
/// checkout.
std::string source_path(const std::string& file = {});

}  // namespace souple
