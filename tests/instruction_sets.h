#pragma once

#include "souple/simd/instruction_set.h"

#include <vector>

namespace souple {

/// The instruction sets that this processor has, the scalar one first.
inline std::vector<InstructionSet> all_sets() {
  std::vector<InstructionSet> result;
  for (const InstructionSet set : {InstructionSet::scalar, InstructionSet::sse, InstructionSet::avx2,
                                   InstructionSet::avx512, InstructionSet::neon, InstructionSet::wasm})
    if (set <= instruction_set()) result.push_back(set);
  return result;
}

}  // namespace souple
