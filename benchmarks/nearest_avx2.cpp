#include "benchmarks/nearest_packs.h"

namespace souple {

void triangles_of_avx2(const float* x, int count, float* sum) {
  triangles_of_packs<simd::Avx2>(x, count, sum);
}
void edges_of_avx2(const float* x, int count, float* sum) {
  edges_of_packs<simd::Avx2>(x, count, sum);
}

}  // namespace souple
