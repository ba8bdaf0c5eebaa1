#pragma once

#include "souple/error.h"
#include "souple/scene/nearest.h"
#include "souple/solver/solver_names.h"
#include "souple/stages/settings.h"

#include <string>
#include <utility>
#include <vector>

// Names of settings on the command line and in results.

namespace souple::app {

inline constexpr std::pair<const char*, Threading> threading_names[] = {{"automatic", Threading::automatic},
                                                                        {"serial", Threading::serial},
                                                                        {"pool", Threading::pool},
                                                                        {"tbb", Threading::tbb}};

/// Throws Error, starting with the option, when `word` is not a known name.
template <class Value, std::size_t n>
Value value_of(const std::pair<const char*, Value> (&names)[n], const std::string& word, const char* option) {
  std::vector<std::string> known;
  for (const auto& [name, value] : names) {
    if (name == word) return value;
    known.emplace_back(name);
  }
  throw Error(std::string(option) + ": there is no \"" + word + "\"" + scene_format::suggestion(word, known));
}

}  // namespace souple::app
