#include "souple/contacts/surfaces/pair_search.h"

#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {
namespace {

constexpr auto itself = [](std::uint32_t a, std::uint32_t b) { return a == b; };

}  // namespace

PairSearch::PairSearch(const ElementSurfaces& surfaces) {
  const std::size_t n = surfaces.size();
  groups_.set_count(n);
  has_elements_.assign(n, 0), found_.resize(n), elements_.resize(n);
  over_.reserve(n), is_over_.reserve(n), chosen_.reserve(n), moved_in_.reserve(surfaces.particle_count());
  for (std::uint32_t a = 0; a < n; ++a) {
    const ContactSurface& surface = surfaces[a];
    elements_[a] = surface.reserved_end - surface.begin + surface.edges.size();
    if (!surface.self_collision) continue;
    within_elements_.add_triangles(surface.triangles, surface.begin, a);
    within_elements_.add_edges(surface.edges, surface.begin, a);
  }
  within_elements_.index_particles();
}

std::size_t PairSearch::budget(const ElementSurfaces& surfaces, std::size_t group) const {
  std::size_t elements = 0;
  for (const std::uint32_t a : groups_.members(group))
    if (is_searched(surfaces, a)) elements += elements_[a];
  return pairs_of_any + pairs_of_element * elements;
}

void PairSearch::choose_elements(const Input& input) {
  const auto n = static_cast<std::uint32_t>(has_elements_.size());
  bool current = true;
  for (std::uint32_t a = 0; a < n; ++a)
    current = current && (has_elements_[a] != 0) == groups_.overlaps_other(a);
  if (current) return;
  between_elements_.clear();
  for (std::uint32_t a = 0; a < n; ++a) {
    has_elements_[a] = groups_.overlaps_other(a) ? 1 : 0;
    if (has_elements_[a] == 0) continue;
    const ContactSurface& surface = input.surfaces[a];
    between_elements_.add_triangles(surface.triangles, surface.begin, a);
    between_elements_.add_edges(surface.edges, surface.begin, a);
    if (surface.particles_only) between_elements_.add_particles(surface.begin, surface.reserved_end, a);
  }
  between_elements_.index_particles();
}

void PairSearch::find_all(const Input& input) {
  choose_elements(input);
  chosen_.assign(groups_.size(), 0);
  for (std::uint32_t a = 0; a < input.surfaces.size(); ++a)
    if (is_searched(input.surfaces, a)) chosen_[groups_.of(a)] = 1;
  const std::size_t most = budget_of_chosen(input);
  const auto others = [&](std::uint32_t a, std::uint32_t b) {
    return input.surfaces.collides_with_other(a, b) && groups_.of(a) == groups_.of(b);
  };
  bool complete = within_finder_.find(within_elements_, input.paths.relative_boxes(), itself, input.position,
                                      within_, input.threads, most);
  complete = between_finder_.find(between_elements_, input.paths.boxes(), others, input.position, between_,
                                  input.threads, most) &&
             complete;
  find_over(input, {}, complete);
}

void PairSearch::find_moved(const Input& input, std::span<const std::uint32_t> moved) {
  bool any_new = false;
  for (std::uint32_t a = 0; a < has_elements_.size(); ++a) any_new = any_new || is_new(a);
  if (any_new) {
    choose_elements(input);
    between_finder_.begin(between_elements_, input.paths.boxes(), input.position, input.threads);
  }
  chosen_.assign(groups_.size(), 0);
  for (const std::uint32_t i : moved) chosen_[groups_.of(input.surfaces.of(i))] = 1;
  find_over(input, moved, find(input, moved, budget_of_chosen(input)));
}

std::size_t PairSearch::budget_of_chosen(const Input& input) const {
  std::size_t sum = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g)
    if (chosen_[g] != 0) sum += budget(input.surfaces, g);
  return sum;
}

bool PairSearch::find(const Input& input, std::span<const std::uint32_t> moved, std::size_t most) {
  const auto others = [&](std::uint32_t a, std::uint32_t b) {
    return input.surfaces.collides_with_other(a, b) && groups_.of(a) == groups_.of(b);
  };
  const bool within = within_finder_.find_moved(moved, input.paths.relative_boxes(), itself, input.position,
                                                within_, input.threads, most);
  return between_finder_.find_moved(moved, input.paths.boxes(), others, input.position, between_,
                                    input.threads, most) &&
         within;
}

// `moved`: whose pairs were searched; empty: all. If the search was not `complete`, it left no pairs, and each group is
// searched by itself.
void PairSearch::find_over(const Input& input, std::span<const std::uint32_t> moved, bool complete) {
  over_.clear();
  is_over_.assign(groups_.size(), 0);
  if (complete) count(input);
  const auto chosen = std::count(chosen_.begin(), chosen_.end(), 1);
  for (std::uint32_t g = 0; g < groups_.size(); ++g) {
    if (chosen_[g] == 0) continue;
    const bool fits = complete ? !exceeds_budget(input, g)
                               : chosen > 1 && find_of(input, moved, budget(input.surfaces, g),
                                                       [g](std::uint32_t group) { return group == g; });
    if (!fits) is_over_[g] = 1, over_.push_back(g);
  }
  if (over_.empty() && complete) return;
  if (!complete)
    find_of(input, moved, NearPairFinder::unlimited, [&](std::uint32_t g) { return is_over_[g] == 0; });
  drop_over(input, within_), drop_over(input, between_);
  count(input);
}

// Searches for the pairs of the particles in `moved`, or of all, that are in groups of which `is_in` is true.
template <class Predicate>
bool PairSearch::find_of(const Input& input, std::span<const std::uint32_t> moved, std::size_t most,
                         const Predicate& is_in) {
  moved_in_.clear();
  for (const std::uint32_t i : moved)
    if (is_in(groups_.of(input.surfaces.of(i)))) moved_in_.push_back(i);
  for (std::uint32_t a = 0; moved.empty() && a < input.surfaces.size(); ++a)
    for (std::uint32_t i = input.surfaces[a].begin; is_in(groups_.of(a)) && i < input.surfaces[a].end; ++i)
      if (input.surfaces.of(i) == a) moved_in_.push_back(i);
  return find(input, moved_in_, most);
}

bool PairSearch::find_group(const Input& input, std::size_t group, std::size_t most) {
  const bool complete = find_of(input, {}, most, [group](std::uint32_t g) { return g == group; });
  count(input);
  return complete;
}

bool PairSearch::exceeds_budget(const Input& input, std::size_t group) const {
  std::array<std::size_t, 2> sum{};
  for (const std::uint32_t a : groups_.members(group))
    for (std::size_t kind = 0; kind < 2; ++kind) sum[kind] += found_[a][kind];
  return std::max(sum[0], sum[1]) > budget(input.surfaces, group);
}

void PairSearch::count(const Input& input) {
  std::fill(found_.begin(), found_.end(), std::array<std::size_t, 2>{});
  const std::array<const NearPairs*, 2> kinds{&within_, &between_};
  for (std::size_t kind = 0; kind < 2; ++kind)
    for (const std::vector<NearPair>* const list : {&kinds[kind]->vertex_triangle, &kinds[kind]->edge_edge})
      for (const NearPair& pair : *list) ++found_[input.surfaces.of(pair.particle[0])][kind];
}

void PairSearch::drop_over(const Input& input, NearPairs& pairs) const {
  for (std::vector<NearPair>* const list : {&pairs.vertex_triangle, &pairs.edge_edge})
    std::erase_if(*list, [&](const NearPair& pair) {
      return is_over_[groups_.of(input.surfaces.of(pair.particle[0]))] != 0;
    });
}

std::size_t PairSearch::bytes() const {
  return bytes_of(elements_, has_elements_, within_.vertex_triangle, within_.edge_edge,
                  between_.vertex_triangle, between_.edge_edge, found_, over_, moved_in_) +
         groups_.bytes() + within_elements_.bytes() + between_elements_.bytes() + within_finder_.bytes() +
         between_finder_.bytes();
}

}  // namespace souple
