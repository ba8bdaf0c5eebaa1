#include "souple/geometry/edge_uses.h"

#include "souple/math/lists.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

namespace souple {

EdgeUses::EdgeUses(std::span<const Triangle> triangles) {
  find(triangles, 3, [](const Triangle& t, std::size_t i) { return Edge{t[i], t[(i + 1) % 3]}; });
}

EdgeUses::EdgeUses(std::span<const Tet> tets) {
  find(tets, 6, [](const Tet& t, std::size_t i) {
    return Edge{t[std::size_t(tet_edge[i][0])], t[std::size_t(tet_edge[i][1])]};
  });
}

// A counting sort by the lower vertex, then a sort of the few uses of each.
template <class Element, class Ends>
void EdgeUses::find(std::span<const Element> elements, std::size_t edges, const Ends& ends) {
  std::size_t vertices = 0;
  for (const Element& e : elements)
    vertices = std::max(vertices, *std::max_element(e.begin(), e.end()) + std::size_t{1});
  Lists<EdgeUse> by_low(vertices, [&](const auto& add) {
    for (std::size_t e = 0; e < elements.size(); ++e)
      for (std::size_t i = 0; i < edges; ++i) {
        const auto [a, b] = ends(elements[e], i);
        add(std::min(a, b), {std::min(a, b), std::max(a, b), e * edges + i, a < b});
      }
  });
  for (std::size_t v = 0; v < vertices; ++v)
    std::sort(by_low[v].begin(), by_low[v].end(), [](const EdgeUse& a, const EdgeUse& b) {
      return std::tie(a.high, a.slot) < std::tie(b.high, b.slot);
    });
  uses_ = std::move(by_low).items();
  for (std::size_t u = 0; u < uses_.size(); ++u)
    if (u == 0 || uses_[u].low != uses_[u - 1].low || uses_[u].high != uses_[u - 1].high) begin_.push_back(u);
  begin_.push_back(uses_.size());
}

}  // namespace souple
