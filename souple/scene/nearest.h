#pragma once

#include <span>
#include <string>
#include <string_view>

namespace souple::scene_format {

/// The known word closest to `word` by edit distance (insertions, deletions, replacements and swaps of
/// neighbors, case ignored), or empty when none is close enough to be what was meant.
std::string nearest_word(std::string_view word, std::span<const std::string> known);

/// How an error message ends that refuses `word`: `; it was renamed to "color"` for a name of older versions,
/// `; did you mean "density"?` for a misspelled one, else `; known: a, b, c`. Empty when `known` is.
std::string suggestion(std::string_view word, std::span<const std::string> known);

}  // namespace souple::scene_format
