#pragma once

#include "souple/world/materials.h"

#include <vector>

// The numbers of materials that a panel shows, with the range that a slider spans: the one list of them, for
// our own viewer and for those of others.

namespace souple::host {

/// When a tunable turns anything.
enum class TunableUse { always, membrane, pbd };

struct TunableRange {
  float least = 0, most = 1;
  bool logarithmic = false;  ///< then least > 0; a value of 0 stands at the left end
};

/// One number of a material. The range is what is useful, not all that is allowed.
template <class Material>
struct Tunable {
  const char* label;  ///< for people; begins with spaces where it belongs to the one above
  const char* name;   ///< as in scene files
  const char* unit;   ///< UTF-8; empty: a plain number
  float Material::*field;
  TunableRange range;
  TunableUse use = TunableUse::always;
};

const std::vector<Tunable<ClothMaterial>>& tunables(const ClothMaterial&);
const std::vector<Tunable<SoftBodyMaterial>>& tunables(const SoftBodyMaterial&);
const std::vector<Tunable<RopeMaterial>>& tunables(const RopeMaterial&);
const std::vector<Tunable<GrainsMaterial>>& tunables(const GrainsMaterial&);
const std::vector<Tunable<ObstacleMaterial>>& tunables(const ObstacleMaterial&);
const std::vector<Tunable<FluidMaterial>>& tunables(const FluidMaterial&);

bool uses_membrane(const ClothMaterial& material);
template <class Material>
bool uses_membrane(const Material&) {
  return false;
}

/// Whether the tunable turns anything of this material; `pbd`: in Mode::pbd.
template <class Of, class Material>
bool is_used(const Tunable<Of>& tunable, const Material& material, bool pbd) {
  const Of& plain = material;
  return tunable.use == TunableUse::always || (tunable.use == TunableUse::pbd ? pbd : uses_membrane(plain));
}

}  // namespace souple::host
