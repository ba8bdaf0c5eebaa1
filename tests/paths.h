#pragma once

#include <string>

namespace souple {

/// The path of a file of the checkout, such as source_path("scenes/curtain.json"); without an argument the checkout's.
std::string source_path(const std::string& file = {});

}  // namespace souple
