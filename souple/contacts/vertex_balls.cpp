#include "souple/contacts/vertex_balls.h"

#include "souple/broad_phase/spatial_hash.h"
#include "souple/contacts/anchor.h"
#include "souple/contacts/contact_law.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {
namespace {

constexpr std::size_t chunk_size = 1024;  // balls
constexpr std::size_t batch_size = 1024;  // pairs

// A contact may begin late by this part of the radius, and this part of the balls later still. A search costs more than
// all else in a step, and loose corners that flutter would repeat it.
constexpr float lateness = 0.3f;
constexpr std::size_t part_of_leavers = 64;

}  // namespace

void VertexBalls::build(const ContactGeometry& geometry) {
  clear();
  std::size_t end = 0;
  for (std::uint32_t a = 0; a < geometry.surfaces.size(); ++a) {
    const ContactSurface& surface = geometry.surfaces[a];
    if (!surface.vertex_balls) continue;
    sheets_.push_back({VertexBallPairs(surface, geometry.joined), a, surface.radius});
    end = std::max<std::size_t>(end, surface.end);
  }
  place_.assign(end, {});
}

void VertexBalls::list_chunks() {
  chunks_.clear();
  for (std::uint32_t s = 0; s < sheets_.size(); ++s)
    for (std::size_t begin = 0, n = sheets_[s].pairs.count(); sheets_[s].moves && begin < n;
         begin += chunk_size)
      chunks_.push_back({s, begin, std::min(n, begin + chunk_size)});
}

// Sums of chunks are added in order: the same bits for any number of threads.
template <class Function>
void VertexBalls::for_each_chunk(Threads& threads, const Function& f) {
  threads.each(chunks_.size(), 1, [&](std::size_t c) { f(chunks_[c], sheets_[chunks_[c].sheet]); });
}

void VertexBalls::begin_step(const ContactInput& input, Threads& threads) {
  kernels_ = &kernels::find_vertex_ball_kernels(instruction_set());
  step_ = input.step;
  substeps_left_ = 0;
  clear_contacts();
  for (Sheet& sheet : sheets_) {
    sheet.pairs.clear();
    sheet.moves = input.tables.objects[sheet.object].moves;
    sheet.material = input.tables.against_objects.at(sheet.object, sheet.object);
  }
  list_chunks();
  find_mean_velocity(input, threads);
  const float dt = step_.dt;
  for_each_chunk(threads, [&](const Chunk& chunk, Sheet& sheet) {
    for (std::size_t m = chunk.begin; m < chunk.end; ++m) {
      const std::size_t i = sheet.pairs.begin() + m;
      sheet.pairs.set(m, input.particles.relative(i, sheet.pairs.corner()),
                      dt * length(input.velocity[i].xyz() - sheet.mean_motion));
    }
  });
  due_.clear();
  for (std::uint32_t s = 0; s < sheets_.size(); ++s)
    if (sheets_[s].moves) due_.push_back(s);
  search(threads);
}

void VertexBalls::find_mean_velocity(const ContactInput& input, Threads& threads) {
  for_each_chunk(threads, [&](Chunk& chunk, const Sheet& sheet) {
    chunk.motion = {}, chunk.mass = 0;
    for (std::size_t m = chunk.begin; m < chunk.end; ++m) {
      const std::size_t i = sheet.pairs.begin() + m;
      const float w = input.particles.inverse_mass(i);
      chunk.motion += Vec3d(input.velocity[i].xyz());
      chunk.mass += w > 0 ? 1 / double(w) : 0;
    }
  });
  add_up([](const Chunk& chunk) { return chunk.motion; },
         [&](Sheet& sheet, const Vec3d& sum) {
           sheet.mean_motion = Vec3f(sum * (1 / static_cast<double>(sheet.pairs.count())));
           sheet.pairs.begin_search(input.particles.position[sheet.pairs.begin()].xyz());
         });
  for (Sheet& sheet : sheets_) sheet.mass = 0;
  for (const Chunk& chunk : chunks_) sheets_[chunk.sheet].mass += chunk.mass;
}

/// Calls f(sheet, sum of value(chunk)) for each sheet that moves. Sums are added in order: the same bits for any number of
/// threads.
template <class Value, class Function>
void VertexBalls::add_up(const Value& value, const Function& f) {
  for (auto chunk = chunks_.begin(); chunk != chunks_.end();) {
    const std::uint32_t s = chunk->sheet;
    Vec3d sum;
    for (; chunk != chunks_.end() && chunk->sheet == s; ++chunk) sum += value(*chunk);
    f(sheets_[s], sum);
  }
}

// Searches the sheets that are due, whose balls are set.
void VertexBalls::search(Threads& threads) {
  blocks_.clear();
  for (const std::uint32_t s : due_)
    for (std::uint32_t block = 0; block < sheets_[s].pairs.block_count(); ++block)
      blocks_.push_back({s, block});
  const auto for_each_due = [&](const auto& f) {
    threads.each(due_.size(), 1, [&](std::size_t k) { f(sheets_[due_[k]].pairs); });
  };
  const auto for_each_block = [&](const auto& f) {
    threads.each(blocks_.size(), 1, [&](std::size_t k) { f(sheets_[blocks_[k][0]].pairs, blocks_[k][1]); });
  };
  for_each_due([](VertexBallPairs& pairs) { pairs.sort(); });
  for_each_block([](VertexBallPairs& pairs, std::size_t block) { pairs.gather(block); });
  for_each_block([&](VertexBallPairs& pairs, std::size_t block) { pairs.search(block, *kernels_); });
  for_each_due([](VertexBallPairs& pairs) { pairs.end_search(); });
  list_batches();
}

void VertexBalls::list_batches() {
  batches_.clear();
  color_batch_.assign(1, 0);
  std::size_t colors = 0, slot = 0;
  for (const Sheet& sheet : sheets_) colors = std::max(colors, sheet.pairs.color_count());
  for (std::size_t color = 0; color < colors; ++color) {
    for (std::uint32_t s = 0; s < sheets_.size(); ++s) {
      if (color >= sheets_[s].pairs.color_count()) continue;
      const auto [first, last] = sheets_[s].pairs.pairs_of(color);
      for (std::size_t begin = first; begin < last; begin += batch_size) {
        const std::size_t end = std::min(last, begin + batch_size);
        batches_.push_back({s, begin, end, slot});
        slot += end - begin;
      }
    }
    color_batch_.push_back(batches_.size());
  }
  resize_with_spare(found_, slot, 1);
  color_begin_.assign(color_batch_.size(), 0);
}

void VertexBalls::refresh(const ParticleView& particles, const Substep& substep, double, Threads& threads) {
  clear_contacts();
  if (chunks_.empty()) return;
  last_h_ = substep.h;
  if (substeps_left_ == 0) substeps_left_ = substep.count;
  find_motion(particles, threads);
  bound_motion(particles, threads);
  // In the last quarter of a step a search would serve too few substeps: the next step searches anyway.
  if (4 * substeps_left_ > substep.count) search_again(particles, threads);
  --substeps_left_;
  find_contacts(particles, threads);
}

void VertexBalls::find_motion(const ParticleView& particles, Threads& threads) {
  for_each_chunk(threads, [&](Chunk& chunk, const Sheet& sheet) {
    chunk.displacement = chunk.motion = {};
    for (std::size_t m = chunk.begin; m < chunk.end; ++m) {
      const std::size_t i = sheet.pairs.begin() + m;
      const Vec3f x = particles.relative(i, sheet.pairs.corner());
      place_[i] = {x.x, x.y, x.z, particles.inverse_mass(i)};
      chunk.displacement += Vec3d(x - sheet.pairs.place(m));
      chunk.motion += Vec3d(particles.moved(i));
    }
  });
  const auto mean = [](const Sheet& sheet, const Vec3d& sum) {
    return Vec3f(sum * (1 / static_cast<double>(sheet.pairs.count())));
  };
  add_up([](const Chunk& chunk) { return chunk.motion; },
         [&](Sheet& sheet, const Vec3d& sum) { sheet.mean_motion = mean(sheet, sum); });
  add_up([](const Chunk& chunk) { return chunk.displacement; },
         [&](Sheet& sheet, const Vec3d& sum) { sheet.mean_displacement = mean(sheet, sum); });
}

void VertexBalls::bound_motion(const ParticleView& particles, Threads& threads) {
  for_each_chunk(threads, [&](Chunk& chunk, const Sheet& sheet) {
    chunk.taken = {}, chunk.left = 0;
    const float late = lateness * sheet.pairs.largest_radius();
    for (std::size_t m = chunk.begin; m < chunk.end; ++m) {
      const std::size_t i = sheet.pairs.begin() + m;
      Vec4f& place = place_[i];
      const Vec3f motion = particles.moved(i) - sheet.mean_motion;
      const float bound = max_motion * sheet.pairs.radius(m);
      if (length_squared(motion) > bound * bound && place.w > 0 && sheet.pairs.has_pair(m)) {
        const Vec3f change = motion * (bound / length(motion) - 1);
        particles.correct(i, change);
        place.set_xyz(place.xyz() + change);
        chunk.taken += Vec3d(change) * (1 / double(place.w));
      }
      const float margin = sheet.pairs.margin(m) + late;
      if (length_squared(place.xyz() - sheet.pairs.place(m) - sheet.mean_displacement) > margin * margin)
        ++chunk.left;
    }
  });
  for (Sheet& sheet : sheets_) sheet.left = 0;
  for (const Chunk& chunk : chunks_) sheets_[chunk.sheet].left += chunk.left;
  if (std::any_of(chunks_.begin(), chunks_.end(), [](const Chunk& chunk) { return chunk.taken != Vec3d{}; }))
    give_back_momentum(particles, threads);
}

void VertexBalls::search_again(const ParticleView& particles, Threads& threads) {
  due_.clear();
  for (std::uint32_t s = 0; s < sheets_.size(); ++s)
    if (sheets_[s].left * part_of_leavers > sheets_[s].pairs.count()) due_.push_back(s);
  if (due_.empty()) return;
  const auto substeps = static_cast<float>(substeps_left_);
  for_each_chunk(threads, [&](const Chunk& chunk, Sheet& sheet) {
    if (!(sheet.left * part_of_leavers > sheet.pairs.count())) return;
    for (std::size_t m = chunk.begin; m < chunk.end; ++m) {
      const std::size_t i = sheet.pairs.begin() + m;
      sheet.pairs.set(m, place_[i].xyz(), substeps * length(particles.moved(i) - sheet.mean_motion));
    }
  });
  search(threads);
}

// Returns the momentum that the bound on motions removed, as equal velocities of all particles.
void VertexBalls::give_back_momentum(const ParticleView& particles, Threads& threads) {
  add_up([](const Chunk& chunk) { return chunk.taken; },
         [](Sheet& sheet, const Vec3d& taken) {
           sheet.shift = sheet.mass > 0 ? Vec3f(taken * (-1 / sheet.mass)) : Vec3f{};
         });
  for_each_chunk(threads, [&](const Chunk& chunk, const Sheet& sheet) {
    if (sheet.shift == Vec3f{}) return;
    for (std::size_t m = chunk.begin; m < chunk.end; ++m) {
      const std::size_t i = sheet.pairs.begin() + m;
      if (!(place_[i].w > 0)) continue;
      particles.correct(i, sheet.shift);
      place_[i].set_xyz(place_[i].xyz() + sheet.shift);
    }
  });
}

void VertexBalls::clear_contacts() {
  contacts_.resize(0);
  std::fill(color_begin_.begin(), color_begin_.end(), 0);
}

kernels::BallRecords VertexBalls::records(const ParticleView& particles) const {
  kernels::BallRecords result;
  result.position = &particles.position.data()->x;
  result.moving = &particles.moving.data()->x;
  result.corrected = particles.corrected.empty() ? result.moving : &particles.corrected.data()->x;
  result.start = &particles.start.data()->x;
  return result;
}

void VertexBalls::find_contacts(const ParticleView& particles, Threads& threads) {
  threads.for_each(batches_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      Batch& batch = batches_[b];
      batch.found = kernels_->find_near(&place_.data()->x, sheets_[batch.sheet].pairs.columns(),
                                        speculative_part, batch.begin, batch.end, &found_[batch.slot]);
    }
  });
  std::size_t count = 0;
  for (std::size_t color = 0; color + 1 < color_batch_.size(); ++color) {
    color_begin_[color] = count;
    for (std::size_t b = color_batch_[color]; b < color_batch_[color + 1]; ++b) {
      batches_[b].contact = count;
      count += batches_[b].found;
    }
  }
  color_begin_.back() = count;
  contacts_.resize(count);
  columns_ = contacts_.columns();
  threads.each(batches_.size(), 1, [&](std::size_t b) {
    const Batch& batch = batches_[b];
    const Sheet& sheet = sheets_[batch.sheet];
    const kernels::BallLaw law{sheet.material.static_friction, sheet.material.kinetic_friction,
                               step_.sliding_threshold(last_h_),
                               step_.depenetration_speed(sheet.release_radius) * last_h_};
    kernels_->describe(records(particles), sheet.pairs.columns(), law, &found_[batch.slot], columns_,
                       batch.contact, batch.contact + batch.found);
  });
}

// Calls f(sheet, first contact, end of contacts) for parts of [begin, end) that belong to one sheet, or to sheets of one
// material.
template <class Function>
void VertexBalls::for_each_sheet_of(std::size_t begin, std::size_t end, std::size_t first_batch,
                                    const Function& f) const {
  const auto friction = [&](const Batch& batch) { return sheets_[batch.sheet].material.static_friction; };
  auto batch =
      std::upper_bound(batches_.begin() + static_cast<std::ptrdiff_t>(first_batch), batches_.end(), begin,
                       [](std::size_t at, const Batch& b) { return at < b.contact + b.found; });
  while (begin < end) {
    const Batch& first = *batch;
    while (batch != batches_.end() && batch->contact < end && friction(*batch) == friction(first)) ++batch;
    const std::size_t last = batch == batches_.end() ? end : std::min(end, batch->contact);
    f(sheets_[first.sheet], begin, last);
    begin = last;
  }
}

void VertexBalls::project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
                          const Substep&) {
  const auto c = static_cast<std::size_t>(color);
  for_each_sheet_of(color_begin_[c] + begin, color_begin_[c] + end, color_batch_[c],
                    [&](const Sheet& sheet, std::size_t first, std::size_t last) {
                      kernels_->project(records(particles), columns_, sheet.material.static_friction, first,
                                        last);
                    });
}

std::uint32_t VertexBalls::particle_of(int color, std::size_t index, const ParticleView& particles) const {
  const std::size_t c = color_begin_[static_cast<std::size_t>(color)] + index;
  return particles.first_movable(std::array{columns_.first_float[0][c] / 4, columns_.first_float[1][c] / 4});
}

void VertexBalls::visit_impulses(const ParticleView& particles, const ImpulseFunction& f) const {
  for (std::size_t c = 0; c < size(); ++c) {
    if (!(columns_.normal_sum[c] > 0)) continue;
    const Anchor<2> anchor = between(columns_.first_float[0][c] / 4, columns_.first_float[1][c] / 4);
    const auto vector = [c](float* const(&of)[3]) { return Vec3f{of[0][c], of[1][c], of[2][c]}; };
    f(anchor.impulse(vector(columns_.normal) * columns_.normal_sum[c] + vector(columns_.tangent_sum),
                     anchor.inverse_mass(particles)));
  }
}

ContactReport VertexBalls::report() const {
  return summarize(
      size(), [&](std::size_t c) { return columns_.normal_sum[c]; }, [](std::size_t) { return 0.0f; });
}

void VertexBalls::events(const ParticleView& particles, std::vector<ContactPush>& out) const {
  const std::size_t first = out.size();
  for (std::size_t c = 0; c < size(); ++c) {
    if (!(columns_.normal_sum[c] > 0)) continue;
    const std::uint32_t i = columns_.first_float[0][c] / 4, j = columns_.first_float[1][c] / 4;
    const Vec3f normal{columns_.normal[0][c], columns_.normal[1][c], columns_.normal[2][c]};
    const float impulse = normal_impulse(columns_.normal_sum[c], 0, last_h_ > 0 ? 1 / last_h_ : 0.0f,
                                         particles.inverse_mass(i) + particles.inverse_mass(j));
    const Vec3f point = particles.relative(i, {}) + particles.difference(j, i) * 0.5f;
    out.push_back({i, j, point, normal, impulse});
  }
  sort_pushes(out, first);
}

void VertexBalls::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  for (int color = 0; color < color_count(); ++color)
    for (std::size_t c = color_begin_[static_cast<std::size_t>(color)];
         c < color_begin_[static_cast<std::size_t>(color) + 1]; ++c) {
      const std::uint32_t pair[] = {columns_.first_float[0][c] / 4, columns_.first_float[1][c] / 4};
      const Vec3f n{columns_.normal[0][c], columns_.normal[1][c], columns_.normal[2][c]};
      const Vec3f q = particles.moving[pair[0]].xyz() - particles.moving[pair[1]].xyz();
      visitor({pair, color, 0, max(0.0f, -(columns_.gap[c] + dot(n, q)))});
    }
}

void VertexBalls::clear() {
  sheets_.clear(), chunks_.clear(), batches_.clear();
  color_begin_.assign(1, 0), color_batch_.assign(1, 0);
  contacts_.resize(0);
}

std::size_t VertexBalls::bytes() const {
  std::size_t sum =
      bytes_of(sheets_, chunks_, place_, due_, blocks_, batches_, found_, color_begin_, color_batch_) +
      contacts_.bytes();
  for (const Sheet& sheet : sheets_) sum += sheet.pairs.bytes();
  return sum;
}

}  // namespace souple
