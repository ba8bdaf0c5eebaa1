#pragma once

#include <memory>

// The instance is made, asked for and destroyed by hand; its destructor may be private.
#define RA_SINGLETON_INTERFACE(TYPE)                                \
 public:                                                            \
  template <typename... Args>                                       \
  static TYPE* createInstance(const Args&... args) {                \
    s_instance = std::unique_ptr<TYPE, Deleter>(new TYPE(args...)); \
    return s_instance.get();                                        \
  }                                                                 \
  static TYPE* getInstance() {                                      \
    return s_instance.get();                                        \
  }                                                                 \
  static void destroyInstance() {                                   \
    s_instance.reset();                                             \
  }                                                                 \
                                                                    \
 protected:                                                         \
  TYPE(const TYPE&) = delete;                                       \
  void operator=(const TYPE&) = delete;                             \
  struct Deleter {                                                  \
    void operator()(TYPE* instance) const { delete instance; }      \
  };                                                                \
  static std::unique_ptr<TYPE, Deleter> s_instance

#define RA_SINGLETON_IMPLEMENTATION(TYPE) std::unique_ptr<TYPE, TYPE::Deleter> TYPE::s_instance
