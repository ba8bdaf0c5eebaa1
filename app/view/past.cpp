#include "app/view/past.h"

#include <utility>

namespace souple::viewer {

void Past::add(PastState state) {
  bytes_ += state.snapshot.bytes.size();
  states_.push_back(std::move(state));
  while (bytes_ > max_bytes_ && states_.size() > 1) {
    bytes_ -= states_.front().snapshot.bytes.size();
    states_.pop_front();
  }
  shown_ = states_.size() - 1;
  steps_ = 0;
}

void Past::move_on() {
  if (!shown_) return;
  while (states_.size() > *shown_ + 1) {
    bytes_ -= states_.back().snapshot.bytes.size();
    states_.pop_back();
  }
  shown_.reset();
  steps_ = 0;
}

void Past::clear() {
  states_.clear();
  bytes_ = steps_ = 0;
  shown_.reset();
}

}  // namespace souple::viewer
