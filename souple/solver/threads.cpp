#include "souple/solver/threads.h"

namespace souple {
namespace {

class SerialThreads final : public Threads {
 public:
  int count() const override { return 1; }
  void for_each(std::size_t n, std::size_t, RangeFunction f) override {
    if (n > 0) f(0, n);
  }
};

}  // namespace

std::unique_ptr<Threads> make_threads(Threading, int) {
  return std::make_unique<SerialThreads>();
}

}  // namespace souple
