#include "souple/scene/keys/parts.h"

namespace souple::scene_format {

namespace {

/// Three counts, or one for all three axes.
class Counts : public Codec<std::array<int, 3>> {
 public:
  explicit Counts(int max) : range_(within(1, max)) {}
  void read(const Json& json, const JsonPath& path, std::array<int, 3>& value) const override {
    if (!json.is(Json::Kind::number)) return three_.read(json, path, value);
    count_->read(json, path, value[0]);
    value.fill(value[0]);
  }
  Json write(const std::array<int, 3>& value) const override { return three_.write(value); }
  TypeInfo describe(Format& format) const override {
    return {
        range_.text("whole number") + ", or three of them",
        Json::object({{"oneOf", Json::array({range_.schema("integer"), three_.describe(format).schema})}})};
  }

 private:
  Range range_;
  CodecPtr<int> count_ = number<int>(range_);
  Array<int, 3> three_{count_, "a whole number or three of them, [x, y, z]", ""};
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
    const Json numbers =
        Json::object({{"type", Json::of("array")}, {"items", group_.describe(format).schema}});
    return {"list of whole numbers from 0 to 31, or \"all\"",
            Json::object({{"oneOf", Json::array({numbers, Json::object({{"const", Json::of("all")}})})}})};
  }

 private:
  Number<std::uint32_t> group_{within(0, 31)};
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
    return {text(), Json::object({{"enum", std::move(words)}})};
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

CodecPtr<SelfCollision> self_collision(bool particles) {
  return std::make_shared<SelfCollisionWord>(particles);
}

}  // namespace souple::scene_format
