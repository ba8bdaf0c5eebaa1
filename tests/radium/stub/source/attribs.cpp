#include <Core/Utils/Attribs.hpp>
#include <algorithm>

namespace Ra {
namespace Core {
namespace Utils {

void AttribManager::copyAllAttributes(const AttribManager& other) {
  m_attribs.clear();
  for (const auto& attrib : other.m_attribs) {
    if (!attrib) continue;
    m_attribsIndex[attrib->getName()] = Index(m_attribs.size());
    m_attribs.push_back(attrib->clone());
  }
}

void AttribManager::clear() {
  m_attribs.clear();
  m_attribsIndex.clear();
}

Index AttribManager::place(std::unique_ptr<AttribBase> attrib) {
  auto free = std::find(m_attribs.begin(), m_attribs.end(), nullptr);
  if (free == m_attribs.end()) free = m_attribs.emplace(m_attribs.end());
  *free = std::move(attrib);
  return Index(free - m_attribs.begin());
}

}  // namespace Utils
}  // namespace Core
}  // namespace Ra
