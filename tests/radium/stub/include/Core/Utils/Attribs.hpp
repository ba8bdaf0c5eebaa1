#pragma once

#include <Core/Containers/VectorArray.hpp>
#include <Core/Utils/Index.hpp>
#include <Core/Utils/Observable.hpp>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace Ra {
namespace Core {
namespace Utils {

template <typename T>
class Attrib;

/// Values for every vertex. Whoever observes hears of new data and of the end of a lock.
class AttribBase : public ObservableVoid {
 public:
  explicit AttribBase(std::string name) : m_name(std::move(name)) {}

  std::string getName() const { return m_name; }
  void setName(const std::string& name) { m_name = name; }
  bool isLocked() const { return m_isLocked; }
  void unlock() {
    m_isLocked = false;
    notify();
  }

  template <typename T>
  Attrib<T>& cast() {
    return static_cast<Attrib<T>&>(*this);
  }
  template <typename T>
  const Attrib<T>& cast() const {
    return static_cast<const Attrib<T>&>(*this);
  }

  virtual void resize(std::size_t size) = 0;
  virtual std::size_t getSize() const = 0;
  virtual const void* dataPtr() const = 0;
  virtual std::unique_ptr<AttribBase> clone() = 0;

 protected:
  void lock() { m_isLocked = true; }

 private:
  std::string m_name;
  bool m_isLocked = false;
};

template <typename T>
class Attrib : public AttribBase {
 public:
  using value_type = T;
  using Container = VectorArray<T>;

  explicit Attrib(const std::string& name) : AttribBase(name) {}

  const Container& data() const { return m_data; }
  Container& getDataWithLock() {
    lock();
    return m_data;
  }
  void setData(const Container& data) {
    m_data = data;
    notify();
  }
  void setData(Container&& data) {
    m_data = std::move(data);
    notify();
  }

  void resize(std::size_t size) override { m_data.resize(size); }
  std::size_t getSize() const override { return m_data.size(); }
  const void* dataPtr() const override { return m_data.data(); }
  std::unique_ptr<AttribBase> clone() override {
    auto copy = std::make_unique<Attrib<T>>(getName());
    copy->m_data = m_data;
    return copy;
  }

 private:
  Container m_data;
};

template <typename T>
class AttribHandle {
 public:
  using value_type = T;
  using AttribType = Attrib<T>;
  using Container = typename Attrib<T>::Container;

  Index idx() const { return m_idx; }
  std::string attribName() const { return m_name; }

 private:
  friend class AttribManager;

  Index m_idx;
  std::string m_name;
};

/// The attributes of one geometry. Whoever observes hears the names of those that come and go.
class AttribManager : public Observable<const std::string&> {
 public:
  AttribManager() = default;
  // Those who observe stay with the object, not with what it holds.
  AttribManager(AttribManager&& other) noexcept
      : Observable(),
        m_attribs(std::move(other.m_attribs)),
        m_attribsIndex(std::move(other.m_attribsIndex)) {}
  AttribManager& operator=(AttribManager&& other) noexcept {
    m_attribs = std::move(other.m_attribs);
    m_attribsIndex = std::move(other.m_attribsIndex);
    return *this;
  }

  void copyAllAttributes(const AttribManager& other);
  void clear();

  int getNumAttribs() const { return static_cast<int>(m_attribsIndex.size()); }
  bool contains(const std::string& name) const { return m_attribsIndex.count(name) > 0; }

  template <typename T>
  bool isValid(const AttribHandle<T>& handle) const {
    const auto found = m_attribsIndex.find(handle.m_name);
    return handle.m_idx.isValid() && found != m_attribsIndex.end() && found->second == handle.m_idx;
  }

  template <typename T>
  AttribHandle<T> findAttrib(const std::string& name) const {
    AttribHandle<T> handle;
    const auto found = m_attribsIndex.find(name);
    if (found != m_attribsIndex.end()) {
      handle.m_idx = found->second;
      handle.m_name = name;
    }
    return handle;
  }

  AttribBase* getAttribBase(const std::string& name) const {
    const auto found = m_attribsIndex.find(name);
    return found == m_attribsIndex.end() ? nullptr : m_attribs[slot(found->second)].get();
  }

  template <typename T>
  Attrib<T>* getAttribPtr(const AttribHandle<T>& handle) const {
    return static_cast<Attrib<T>*>(m_attribs.at(slot(handle.m_idx)).get());
  }
  template <typename T>
  Attrib<T>& getAttrib(const AttribHandle<T>& handle) {
    return *getAttribPtr(handle);
  }
  template <typename T>
  const Attrib<T>& getAttrib(const AttribHandle<T>& handle) const {
    return *getAttribPtr(handle);
  }
  template <typename T>
  Attrib<T>& getAttrib(const std::string& name) {
    return getAttrib(findAttrib<T>(name));
  }
  template <typename T>
  const Attrib<T>& getAttrib(const std::string& name) const {
    return getAttrib(findAttrib<T>(name));
  }

  // Radium copies also what it may move: the caller keeps its array, ours keeps its storage.
  template <typename T>
  void setAttrib(const AttribHandle<T>& handle, const typename AttribHandle<T>::Container& data) {
    getAttribPtr(handle)->setData(data);
  }

  template <typename T>
  AttribHandle<T> addAttrib(const std::string& name) {
    AttribHandle<T> handle = findAttrib<T>(name);
    if (isValid(handle)) return handle;
    handle.m_idx = place(std::make_unique<Attrib<T>>(name));
    handle.m_name = name;
    m_attribsIndex[name] = handle.m_idx;
    notify(name);
    return handle;
  }

  template <typename T>
  void removeAttrib(AttribHandle<T>& handle) {
    const std::string name = handle.m_name;
    const auto found = m_attribsIndex.find(name);
    if (found != m_attribsIndex.end()) {
      m_attribs[slot(found->second)].reset();
      m_attribsIndex.erase(found);
    }
    handle = AttribHandle<T>();
    notify(name);
  }

  template <typename Function>
  void for_each_attrib(const Function& function) const {
    for (const auto& attrib : m_attribs) {
      if (attrib) function(attrib.get());
    }
  }

 private:
  static std::size_t slot(const Index& idx) { return static_cast<std::size_t>(idx.getValue()); }
  Index place(std::unique_ptr<AttribBase> attrib);

  std::vector<std::unique_ptr<AttribBase>> m_attribs;
  std::map<std::string, Index> m_attribsIndex;
};

}  // namespace Utils
}  // namespace Core
}  // namespace Ra
