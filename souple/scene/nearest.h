#pragma once

#include <span>
#include <string>
#include <string_view>

namespace souple::scene_format {

/// The known word closest to `word` by edit distance (insertions, deletions, replacements and swaps of
/// neighbors, case ignored), or empty when none is close enough to be what was meant.
std::string nearest_word(std::string_view word, std::span<const std::string> known);

/// `; did you mean "density"?`, or `; known: a, b, c` when nothing is close, or nothing at all.
std::string suggestion(std::string_view word, std::span<const std::string> known);

}  // namespace souple::scene_format
