#include "souple/multilevel/level_cache.h"

#include "souple/assert.h"
#include "souple/math/bit_cast.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

namespace souple {
namespace {

/// Blocks of fewer particles are built on one thread each, larger ones on all threads.
constexpr std::size_t large_block = 4096;

/// FNV-1a over what the shape of levels depends on.
std::uint64_t hash_of(std::span<const Link> links, std::span<const char> fixed) {
  std::uint64_t hash = 14695981039346656037u;
  const auto mix = [&hash](std::uint64_t value) { hash = (hash ^ value) * 1099511628211u; };
  for (const Link& link : links) mix(link.a), mix(link.b), mix(bit_cast<std::uint32_t>(link.length));
  for (const char f : fixed) mix(static_cast<std::uint64_t>(f));
  return hash;
}

bool of_same_shape(const Link& p, const Link& q) {
  return p.a == q.a && p.b == q.b && p.length == q.length;
}

/// Appends values, each plus `offset`.
void append(std::vector<std::uint32_t>& to, std::span<const std::uint32_t> from, std::size_t offset) {
  for (const std::uint32_t value : from) to.push_back(value + static_cast<std::uint32_t>(offset));
}

/// Appends begins of ranges: the first is the end of the last existing range.
void append_begins(std::vector<std::uint32_t>& to, std::span<const std::uint32_t> from, std::size_t offset) {
  if (to.empty()) to.push_back(0);
  append(to, from.subspan(1), offset);
}

}  // namespace

void LevelCache::Block::build_levels(std::size_t coarsest_size, Threads& threads) {
  std::vector<char> classes = fixed;
  while (classes.size() > coarsest_size) {
    CoarseLevel level =
        build_level(levels.empty() ? std::span<const Link>(links) : levels.back().links, classes, threads);
    if (level.finer.size() == classes.size()) break;
    std::vector<char> next;
    for (const std::uint32_t i : level.finer) next.push_back(classes[i]);
    classes = std::move(next);
    levels.push_back(std::move(level));
  }
  built = true;
}

// A block ends before the first particle that no link of the particles before reaches.
void LevelCache::find_blocks(std::span<const Link> links, std::span<const float> masses) {
  std::unordered_multimap<std::uint64_t, std::shared_ptr<Block>> known;
  for (Place& place : blocks_) {
    const std::uint64_t hash = place.block->hash;
    if (known.find(hash) == known.end()) known.emplace(hash, std::move(place.block));
  }
  blocks_.clear();
  const std::vector<char> classes = classes_of(links, masses);
  std::vector<Link> own;
  std::vector<char> fixed;
  std::size_t e = 0;
  for (std::uint32_t begin = 0; begin < masses.size();) {
    own.clear(), fixed.clear();
    std::uint32_t end = begin + 1;
    const std::size_t first_link = e;
    for (; e < links.size() && links[e].a < end; ++e) {
      end = std::max(end, links[e].b + 1);
      own.push_back(links[e]);
      own.back().a -= begin, own.back().b -= begin;
    }
    for (std::uint32_t i = begin; i < end; ++i) fixed.push_back(classes[i]);
    const std::uint64_t hash = hash_of(own, fixed);
    const auto [first, last] = known.equal_range(hash);
    const auto found = std::find_if(first, last, [&](const auto& entry) {
      const Block& block = *entry.second;
      return block.fixed == fixed &&
             std::equal(own.begin(), own.end(), block.links.begin(), block.links.end(), of_same_shape);
    });
    std::shared_ptr<Block> block;
    if (found != last) {
      block = found->second;
    } else {
      block = std::make_shared<Block>();
      block->hash = hash, block->links = own, block->fixed = fixed;
      known.emplace(hash, block);
    }
    blocks_.push_back({std::move(block), {begin, end}, {first_link, e}});
    begin = end;
  }
  SOUPLE_ASSERT(e == links.size(), "links are sorted by their lower particle");
}

void LevelCache::build_blocks(std::size_t coarsest_size, Threads& threads) {
  std::vector<Block*> small;
  for (const Place& place : blocks_) {
    if (place.block->built) continue;
    if (place.block->fixed.size() < large_block) {
      small.push_back(place.block.get());
    } else {
      place.block->build_levels(coarsest_size, threads);
    }
  }
  std::sort(small.begin(), small.end());  // equal blocks are one: their order does not matter
  small.erase(std::unique(small.begin(), small.end()), small.end());
  threads.for_each(small.size(), 1, [&](std::size_t begin, std::size_t end) {
    const std::unique_ptr<Threads> alone = make_threads(Threading::serial, 1);
    for (std::size_t k = begin; k < end; ++k) small[k]->build_levels(coarsest_size, *alone);
  });
}

// A level of some blocks, one after the other: numbers are offset by the particles and links of the blocks before.
CoarseLevel LevelCache::join(std::span<const Place* const> blocks, std::size_t level) {
  CoarseLevel all;
  std::size_t finer = 0, finer_links = 0, link_count = 0;
  for (const Place* const place : blocks) link_count += place->block->levels[level].links.size();
  for (const Place* const place : blocks) {
    const Block& block = *place->block;
    const CoarseLevel& own = block.levels[level];
    const std::size_t coarse = all.finer.size(), links = all.links.size();
    append(all.finer, own.finer, finer);
    for (Link link : own.links) {
      link.a += static_cast<std::uint32_t>(coarse), link.b += static_cast<std::uint32_t>(coarse);
      all.links.push_back(link);
    }
    append_begins(all.path_begin, own.path_begin, all.path.size());
    append(all.path, own.path, finer_links);
    append_begins(all.parent_begin, own.parent_begin, all.parent.size());
    append(all.parent, own.parent, coarse);
    all.weight.insert(all.weight.end(), own.weight.begin(), own.weight.end());
    append_begins(all.child_begin, own.child_begin, all.child.size());
    append(all.child, own.child, finer);
    for (const std::uint32_t to : own.energy_to)
      all.energy_to.push_back(static_cast<std::uint32_t>(
          to < own.links.size() ? links + to : link_count + coarse + (to - own.links.size())));
    finer += block.particles_above(level);
    finer_links += level == 0 ? block.links.size() : block.levels[level - 1].links.size();
  }
  return all;
}

JoinedLevels LevelCache::join(std::span<const Place* const> blocks, std::span<const Link> links,
                              std::span<const float> masses) {
  JoinedLevels result;
  std::vector<float> mass;
  std::vector<Link> own;
  for (const Place* const place : blocks) {
    result.particles.push_back(place->particles), result.links.push_back(place->links);
    for (std::size_t e = place->links.begin; e < place->links.end; ++e) own.push_back(links[e]);
    for (std::size_t i = place->particles.begin; i < place->particles.end; ++i) mass.push_back(masses[i]);
  }
  for (std::size_t l = 0; l < blocks.front()->block->levels.size(); ++l) {
    const CoarseLevel* const finer = result.levels.empty() ? nullptr : &result.levels.back();
    CoarseLevel level = join(blocks, l);
    take_masses(finer != nullptr ? finer->mass : mass, level);
    take_energies(finer != nullptr ? finer->links : own, level);
    result.levels.push_back(std::move(level));
  }
  return result;
}

std::vector<JoinedLevels> LevelCache::build(std::span<const Link> links, std::span<const float> masses,
                                            std::size_t coarsest_size, Threads& threads) {
  find_blocks(links, masses);
  build_blocks(coarsest_size, threads);
  std::map<std::size_t, std::vector<const Place*>> by_depth;
  for (const Place& place : blocks_)
    if (!place.block->levels.empty()) by_depth[place.block->levels.size()].push_back(&place);
  std::vector<JoinedLevels> result;
  result.reserve(by_depth.size());
  for (const auto& [depth, blocks] : by_depth) result.push_back(join(blocks, links, masses));
  return result;
}

}  // namespace souple
