#pragma once

#include <span>
#include <string>
#include <string_view>

namespace souple::scene_format {

/// The known word closest to `word` by edit distance (insertions, deletions, replacements and swaps of
/// neighbors, ignoring case), or empty if none is close enough.
std::string nearest_word(std::string_view word, std::span<const std::string> known);

/// End of an error message that rejects `word`: `; it was renamed to "color"` for a name of an older version,
/// `; did you mean "density"?` for a misspelling, else `; known: a, b, c`. Empty if `known` is empty.
std::string suggestion(std::string_view word, std::span<const std::string> known);

}  // namespace souple::scene_format
