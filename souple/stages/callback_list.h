#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace souple {

/// Functions of the user with handles, in order of addition. Functions may be added and removed while for_each calls them:
/// a new one is called from the next for_each on, a removed one not again.
template <class Function>
class CallbackList {
 public:
  void add(std::uint32_t id, Function function) {
    entries_.push_back(std::make_unique<Entry>(Entry{id, std::move(function)}));
    ++count_;
  }
  /// False if there is no such function. It is freed by `erase_removed`.
  bool remove(std::uint32_t id) {
    for (const auto& entry : entries_)
      if (entry->id == id && !entry->removed) {
        entry->removed = true;
        --count_;
        return true;
      }
    return false;
  }
  void clear() {
    for (const auto& entry : entries_) entry->removed = true;
    count_ = 0;
  }
  /// Outside for_each only.
  void erase_removed() {
    if (count_ < entries_.size()) std::erase_if(entries_, [](const auto& entry) { return entry->removed; });
  }
  bool empty() const { return count_ == 0; }

  template <class Call>
  void for_each(const Call& call) const {
    const std::size_t count = entries_.size();
    for (std::size_t k = 0; k < count; ++k)
      if (!entries_[k]->removed) call(entries_[k]->function);
  }

 private:
  struct Entry {
    std::uint32_t id;
    Function function;
    bool removed = false;
  };
  std::vector<std::unique_ptr<Entry>> entries_;  // their addresses stay while the list grows
  std::size_t count_ = 0;                        // of those not removed
};

}  // namespace souple
