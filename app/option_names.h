#pragma once

#include "souple/error.h"
#include "souple/scene/nearest.h"
#include "souple/solver/solver_names.h"
#include "souple/stages/settings.h"

#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Names of settings on the command line and in results.

namespace souple::app {

inline constexpr std::pair<const char*, Threading> threading_names[] = {{"automatic", Threading::automatic},
                                                                        {"serial", Threading::serial},
                                                                        {"pool", Threading::pool},
                                                                        {"tbb", Threading::tbb}};

/// The arguments that an option accepts, with their values.
template <class Value>
using OptionValues = std::vector<std::pair<std::string, Value>>;

/// Throws Error that names the option and lists the accepted arguments.
template <class Value>
Value value_of(const OptionValues<Value>& words, const std::string& word, const char* option) {
  std::vector<std::string> known;
  std::string list;
  for (const auto& [name, value] : words) {
    if (name == word) return value;
    known.push_back(name);
    list += (list.empty() ? "" : ", ") + name;
  }
  const std::string nearest = scene_format::nearest_word(word, known);
  throw Error(std::string(option) + " \"" + word + "\": expected one of " + list +
              (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
}

template <class Value, std::size_t n>
OptionValues<Value> option_values(const std::pair<const char*, Value> (&names)[n]) {
  return {std::begin(names), std::end(names)};
}

/// An enumeration of `n` values, whose names a function knows.
template <std::size_t n, class Value>
OptionValues<Value> option_values(std::string_view (*name)(Value)) {
  OptionValues<Value> words;
  for (std::size_t i = 0; i < n; ++i) words.emplace_back(name(static_cast<Value>(i)), static_cast<Value>(i));
  return words;
}

}  // namespace souple::app
