#pragma once

#include <Core/Utils/Index.hpp>
#include <algorithm>
#include <cstddef>
#include <deque>
#include <stdexcept>
#include <utility>
#include <vector>

namespace Ra {
namespace Core {
namespace Utils {

/// Objects in the order of their indices; a new one gets the least index that is free.
template <typename T>
class IndexMap {
 public:
  using Iterator = typename std::deque<T>::iterator;
  using ConstIterator = typename std::deque<T>::const_iterator;

  Index insert(T object) {
    std::size_t place = 0;
    while (place < m_index.size() && m_index[place] == static_cast<int>(place)) ++place;
    const Index idx(place);
    m_data.insert(m_data.begin() + static_cast<std::ptrdiff_t>(place), std::move(object));
    m_index.insert(m_index.begin() + static_cast<std::ptrdiff_t>(place), idx);
    return idx;
  }

  // The index is there until the object is gone: what its destructor asks finds it.
  bool remove(const Index& idx) {
    const std::size_t place = find(idx);
    if (place == m_index.size()) return false;
    m_data.erase(m_data.begin() + static_cast<std::ptrdiff_t>(place));
    m_index.erase(m_index.begin() + static_cast<std::ptrdiff_t>(place));
    return true;
  }

  const T& at(const Index& idx) const { return m_data.at(find(idx)); }
  T& access(const Index& idx) { return m_data.at(find(idx)); }
  const T& operator[](const Index& idx) const { return at(idx); }
  T& operator[](const Index& idx) { return access(idx); }

  bool contains(const Index& idx) const { return find(idx) < m_index.size(); }
  bool empty() const { return m_data.empty(); }
  std::size_t size() const { return m_data.size(); }
  Index index(uint place) const { return place < m_index.size() ? m_index[place] : Index::Invalid(); }

  Iterator begin() { return m_data.begin(); }
  Iterator end() { return m_data.end(); }
  ConstIterator begin() const { return m_data.begin(); }
  ConstIterator end() const { return m_data.end(); }
  ConstIterator cbegin() const { return m_data.cbegin(); }
  ConstIterator cend() const { return m_data.cend(); }

 private:
  std::size_t find(const Index& idx) const {
    return static_cast<std::size_t>(std::find(m_index.begin(), m_index.end(), idx) - m_index.begin());
  }

  std::deque<T> m_data;
  std::vector<Index> m_index;
};

}  // namespace Utils
}  // namespace Core
}  // namespace Ra
