#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

/// Three counts, or one for all three axes.
class Counts : public Codec<std::array<int, 3>> {
 public:
  explicit Counts(int max) : range_(within(1, max)), count_(range_) {}
  void read(const Json& json, const JsonPath& path, std::array<int, 3>& value) const override {
    if (json.is(Json::Kind::number)) {
      int all = 1;
      count_.read(json, path, all);
      value = {all, all, all};
      return;
    }
    if (!json.is(Json::Kind::array) || json.items.size() != 3) {
      path.unexpected("a whole number or three of them, [x, y, z]", json);
    }
    for (std::size_t i = 0; i < 3; ++i) count_.read(json.items[i], path.item(i), value[i]);
  }
  Json write(const std::array<int, 3>& value) const override {
    return Json::array({Json::whole(value[0]), Json::whole(value[1]), Json::whole(value[2])});
  }
  TypeInfo describe(Format&) const override {
    Json three = Json::object();
    three.set("type", Json::of("array"));
    three.set("items", range_.schema("integer"));
    three.set("minItems", Json::whole(3));
    three.set("maxItems", Json::whole(3));
    Json schema = Json::object();
    schema.set("oneOf", Json::array({range_.schema("integer"), three}));
    return {range_.text("whole number") + ", or three of them", schema};
  }

 private:
  Range range_;
  Number<int> count_;
};

/// A bit mask as the list of the bits that are set, or "all".
class Groups : public Codec<std::uint32_t> {
 public:
  void read(const Json& json, const JsonPath& path, std::uint32_t& value) const override {
    if (json.is(Json::Kind::text) && json.text == "all") {
      value = ~0u;
      return;
    }
    if (!json.is(Json::Kind::array))
      path.unexpected("a list of group numbers from 0 to 31, or \"all\"", json);
    value = 0;
    for (std::size_t i = 0; i < json.items.size(); ++i) {
      std::uint32_t group = 0;
      group_.read(json.items[i], path.item(i), group);
      value |= 1u << group;
    }
  }
  Json write(const std::uint32_t& value) const override {
    if (value == ~0u) return Json::of("all");
    Json json = Json::array();
    for (std::uint32_t group = 0; group < 32; ++group)
      if ((value >> group & 1u) != 0) json.items.push_back(Json::whole(group));
    return json;
  }
  TypeInfo describe(Format& format) const override {
    Json all = Json::object(), numbers = Json::object(), schema = Json::object();
    all.set("const", Json::of("all"));
    numbers.set("type", Json::of("array"));
    numbers.set("items", group_.describe(format).schema);
    schema.set("oneOf", Json::array({numbers, all}));
    return {"list of whole numbers from 0 to 31, or \"all\"", schema};
  }

 private:
  Number<std::uint32_t> group_{within(0, 31)};
};

class KindWord : public Codec<std::string> {
 public:
  explicit KindWord(std::string kind) : kind_(std::move(kind)) {}
  void read(const Json&, const JsonPath&, std::string&) const override {}
  Json write(const std::string&) const override { return Json::of(kind_); }
  TypeInfo describe(Format&) const override {
    Json schema = Json::object();
    schema.set("const", Json::of(kind_));
    return {"\"" + kind_ + "\"", schema};
  }

 private:
  std::string kind_;
};

class SelfCollisionWord : public Codec<SelfCollision> {
 public:
  explicit SelfCollisionWord(bool with_particles) : particles_(with_particles) {}
  void read(const Json& json, const JsonPath& path, SelfCollision& value) const override {
    if (json.is(Json::Kind::boolean)) {
      value = json.boolean ? SelfCollision::surfaces : SelfCollision::off;
    } else if (json.is(Json::Kind::text) && json.text == surfaces) {
      value = SelfCollision::surfaces;
    } else if (particles_ && json.is(Json::Kind::text) && json.text == particles) {
      value = SelfCollision::particles;
    } else {
      path.unexpected(text(), json);
    }
  }
  Json write(const SelfCollision& value) const override {
    return value == SelfCollision::particles ? Json::of(particles) : Json::of(value != SelfCollision::off);
  }
  TypeInfo describe(Format&) const override {
    Json words = Json::array({Json::of(true), Json::of(false), Json::of(surfaces)});
    if (particles_) words.items.push_back(Json::of(particles));
    Json schema = Json::object();
    schema.set("enum", words);
    return {text(), schema};
  }

 private:
  static constexpr const char *surfaces = "surfaces", *particles = "particles";
  std::string text() const {
    return particles_ ? "true, false, \"surfaces\" or \"particles\"" : "true, false or \"surfaces\"";
  }

  bool particles_;
};

}  // namespace

CodecPtr<std::array<int, 3>> counts(int max) {
  return std::make_shared<Counts>(max);
}

CodecPtr<std::uint32_t> groups() {
  return std::make_shared<Groups>();
}

CodecPtr<std::string> kind_word(std::string kind) {
  return std::make_shared<KindWord>(std::move(kind));
}

CodecPtr<SelfCollision> self_collision(bool particles) {
  return std::make_shared<SelfCollisionWord>(particles);
}

}  // namespace souple::scene_format
