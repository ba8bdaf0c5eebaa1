#include "souple/scene/nearest.h"

#include "souple/queries/nearest_name.h"

#include <algorithm>
#include <array>
#include <utility>

namespace souple::scene_format {

namespace {

/// Names in older scene files and commands, and their replacements.
constexpr std::array<std::pair<std::string_view, std::string_view>, 9> renamed{{
    {"bubble_neighbours", "bubble_neighbors"},
    {"centre", "center"},
    {"centres", "centers"},
    {"colour", "color"},
    {"colours", "colors"},
    {"most", "max_particles"},
    {"most_particles", "max_particles"},
    {"neighbours", "neighbors"},
    {"spray_neighbours", "spray_neighbors"},
}};

}  // namespace

std::string nearest_word(std::string_view word, std::span<const std::string> known) {
  constexpr std::size_t max_length = 100;
  if (word.size() > max_length) return {};
  std::string best;
  std::size_t least = 1 + word.size() / 2;  // with more changes it is a different word
  for (const std::string& candidate : known) {
    std::size_t distance = edit_distance(word, candidate);
    // "densty" for "areal_density": a user may write only the last words of a name.
    for (std::size_t i = candidate.find('_'); i != std::string::npos; i = candidate.find('_', i + 1)) {
      distance = std::min(distance, 1 + edit_distance(word, std::string_view(candidate).substr(i + 1)));
    }
    if (distance < least) least = distance, best = candidate;
  }
  return best;
}

std::string suggestion(std::string_view word, std::span<const std::string> known) {
  for (const auto& [old, now] : renamed) {
    if (word == old && std::find(known.begin(), known.end(), now) != known.end()) {
      return "; it was renamed to \"" + std::string(now) + "\"";
    }
  }
  const std::string best = nearest_word(word, known);
  if (!best.empty()) return "; did you mean \"" + best + "\"?";
  if (known.empty()) return {};
  std::string list = "; known: ";
  const char* between = "";
  for (const std::string& name : known) list += between + name, between = ", ";
  return list;
}

}  // namespace souple::scene_format
