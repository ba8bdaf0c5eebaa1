#pragma once

#include "souple/world/materials.h"

#include <vector>

// The numbers of materials that a panel shows, with the range that a slider spans: the one list of them, for
// our own viewer and for those of others.

namespace souple::host {

/// When a knob turns anything.
enum class KnobUse { always, membrane, pbd };

struct KnobRange {
  float least = 0, most = 1;
  bool logarithmic = false;  ///< then least > 0; a value of 0 stands at the left end
};

/// One number of a material. The range is what is useful, not all that is allowed.
template <class Material>
struct Knob {
  const char* label;  ///< for people; begins with spaces where it belongs to the one above
  const char* name;   ///< as in scene files
  const char* unit;   ///< UTF-8; empty: a plain number
  float Material::*field;
  KnobRange range;
  KnobUse use = KnobUse::always;
};

const std::vector<Knob<ClothMaterial>>& knobs(const ClothMaterial&);
const std::vector<Knob<SoftBodyMaterial>>& knobs(const SoftBodyMaterial&);
const std::vector<Knob<RopeMaterial>>& knobs(const RopeMaterial&);
const std::vector<Knob<GrainsMaterial>>& knobs(const GrainsMaterial&);
const std::vector<Knob<ObstacleMaterial>>& knobs(const ObstacleMaterial&);
const std::vector<Knob<FluidMaterial>>& knobs(const FluidMaterial&);

bool uses_membrane(const ClothMaterial& material);
template <class Material>
bool uses_membrane(const Material&) {
  return false;
}

/// Whether the knob turns anything of this material; `pbd`: in Mode::pbd.
template <class Of, class Material>
bool is_used(const Knob<Of>& knob, const Material& material, bool pbd) {
  const Of& plain = material;
  return knob.use == KnobUse::always || (knob.use == KnobUse::pbd ? pbd : uses_membrane(plain));
}

}  // namespace souple::host
