#pragma once

#include "souple/scene/codec.h"

#include <array>
#include <functional>
#include <type_traits>
#include <utility>
#include <variant>

namespace souple::scene_format {

/// Maps an object's address to the address of one of its members.
using Access = void* (*)(void*);

/// The member reached through `Members`, one after the other: <&Scene::settings, &Settings::gravity>. Without
/// members, the object itself, which is how a variant reads itself.
template <class T, auto... Members>
void* member_address(void* object) {
  return &(*static_cast<T*>(object).*....*Members);
}
template <class T, auto... Members>
using MemberType = std::remove_reference_t<decltype((std::declval<T&>().*....*Members))>;

/// One alternative of a variant: how to make it current, and its address if it is current.
struct Alternative {
  std::string name, doc;
  AnyCodecPtr codec;
  void* (*emplace)(void* variant);
  const void* (*get)(const void* variant);  ///< nullptr if another alternative is current
};

template <class V, class A>
Alternative alternative(const char* name, CodecPtr<A> codec, const char* doc) {
  return {name, doc, std::move(codec),
          [](void* variant) -> void* { return &static_cast<V*>(variant)->template emplace<A>(); },
          [](const void* variant) -> const void* { return std::get_if<A>(static_cast<const V*>(variant)); }};
}

/// One entry of a table: reads one or several keys of a JSON object.
class Entry {
 public:
  virtual ~Entry() = default;
  virtual std::vector<std::string> keys() const = 0;
  virtual void read(const Json& json, const JsonPath& path, void* object) const = 0;
  /// Appends the values that differ from `fallback`.
  virtual void write(const void* object, const void* fallback, Json& json) const = 0;
  virtual void describe(Format& format, const void* fallback, TableInfo& info) const = 0;
};

/// A single key.
class Key : public Entry {
 public:
  Key(std::string name, Access access, AnyCodecPtr codec, std::string doc, bool required);
  std::vector<std::string> keys() const override { return {name_}; }
  void read(const Json& json, const JsonPath& path, void* object) const override;
  void write(const void* object, const void* fallback, Json& json) const override;
  void describe(Format& format, const void* fallback, TableInfo& info) const override;

 private:
  Json written(const void* object) const;

  std::string name_;
  Access access_;
  AnyCodecPtr codec_;
  std::string doc_;
  bool required_;
};

/// Keys of which exactly one must be present; it selects the alternative of a variant.
class Choice : public Entry {
 public:
  Choice(Access access, std::vector<Alternative> options) : access_(access), options_(std::move(options)) {}
  std::vector<std::string> keys() const override;
  void read(const Json& json, const JsonPath& path, void* object) const override;
  void write(const void* object, const void* fallback, Json& json) const override;
  void describe(Format& format, const void* fallback, TableInfo& info) const override;

 private:
  Access access_;
  std::vector<Alternative> options_;
};

/// The part of a table that does not depend on its type.
class TableCore {
 public:
  /// `name` is the heading in the manual and the definition's name in the schema.
  TableCore(const char* name, const char* doc) : name_(name), doc_(doc) {}

  std::vector<std::string> keys() const;
  /// Keys of other tables and their owners, for better messages.
  void foreign(std::vector<std::pair<std::string, std::string>> keys) { foreign_ = std::move(keys); }

 protected:
  // No templates, and text as plain pointers: otherwise a hundred keys take ten seconds to compile.
  void add_key(const char* name, Access access, AnyCodecPtr codec, const char* doc, bool required);
  void add_choice(Access access, std::vector<Alternative> options);
  void read_object(const Json& json, const JsonPath& path, void* object) const;
  Json write_object(const void* object, const void* fallback) const;
  TypeInfo describe_object(Format& format, const void* fallback) const;

  std::string name_, doc_;
  std::vector<std::unique_ptr<Entry>> entries_;
  std::vector<std::pair<std::string, std::string>> needs_, excludes_, foreign_;
  std::vector<std::function<void(const void*, const JsonPath&)>> rules_;
  std::function<void(const Json&, const JsonPath&, void*)> before_;

 private:
  void reject_unknown_keys(const Json& json, const JsonPath& path) const;
};

/// The keys of one JSON object, read in the order of declaration; unknown keys are errors.
template <class T>
class Table : public Codec<T>, public TableCore {
 public:
  using TableCore::TableCore;

  template <auto... Members>
  Table& key(const char* name, const CodecPtr<MemberType<T, Members...>>& codec, const char* doc) {
    add_key(name, &member_address<T, Members...>, codec, doc, false);
    return *this;
  }
  template <auto... Members>
  Table& required(const char* name, const CodecPtr<MemberType<T, Members...>>& codec, const char* doc) {
    add_key(name, &member_address<T, Members...>, codec, doc, true);
    return *this;
  }
  /// The variant at `Members`; the key that is present selects its alternative.
  template <auto... Members>
  Table& choice(std::vector<Alternative> options) {
    add_choice(&member_address<T, Members...>, std::move(options));
    return *this;
  }
  /// `key` requires `other`.
  Table& needs(const char* key, const char* other) {
    needs_.emplace_back(key, other);
    return *this;
  }
  /// At most one of the two keys.
  Table& excludes(const char* key, const char* other) {
    excludes_.emplace_back(key, other);
    return *this;
  }
  /// Rules over several keys; run last and fail through their path.
  Table& check(void (*rule)(const T&, const JsonPath&)) {
    rules_.push_back(
        [rule](const void* object, const JsonPath& path) { rule(*static_cast<const T*>(object), path); });
    return *this;
  }
  /// Initial values other than T{}. `before` sees the JSON first, e.g. to start from a preset; `fallback`
  /// turns a T{} into the defaults for a given value.
  // NOLINTNEXTLINE(performance-unnecessary-value-param): moved from; clang-tidy misses that in a template
  Table& start(std::function<void(const Json&, const JsonPath&, void*)> before,
               std::function<void(const T& value, T& fallback)> fallback) {
    before_ = std::move(before);
    fallback_ = std::move(fallback);
    return *this;
  }
  void read(const Json& json, const JsonPath& path, T& value) const override {
    read_object(json, path, &value);
  }
  Json write(const T& value) const override {
    const T fallback = fallback_of(value);
    return write_object(&value, &fallback);
  }
  TypeInfo describe(Format& format) const override {
    const T fallback = fallback_of(T{});
    return describe_object(format, &fallback);
  }

 private:
  T fallback_of(const T& value) const {
    T fallback{};
    if (fallback_) fallback_(value, fallback);
    return fallback;
  }
  std::function<void(const T&, T&)> fallback_;
};

/// An object whose key "kind" selects the table of a variant.
class KindsCore {
 public:
  explicit KindsCore(std::vector<Alternative> kinds) : kinds_(std::move(kinds)) {}

 protected:
  void read_kind(const Json& json, const JsonPath& path, void* variant) const;
  Json write_kind(const void* variant) const;
  TypeInfo describe_kinds(Format& format) const;

 private:
  std::vector<Alternative> kinds_;
};
template <class V>
class Kinds : public Codec<V>, public KindsCore {
 public:
  using KindsCore::KindsCore;
  void read(const Json& json, const JsonPath& path, V& value) const override {
    read_kind(json, path, &value);
  }
  Json write(const V& value) const override { return write_kind(&value); }
  TypeInfo describe(Format& format) const override { return describe_kinds(format); }
};

}  // namespace souple::scene_format
