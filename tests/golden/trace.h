#pragma once

#include "souple/math/vec3.h"
#include "souple/world/world.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace souple::test {

/// A short code of an object's positions or velocities in a frame.
struct QuantityCode {
  std::string object;
  std::string quantity;  ///< "positions" or "velocities"
  std::string code;      ///< see code_of
  friend bool operator==(const QuantityCode&, const QuantityCode&) = default;
};

/// All quantities of a world in one frame, in the order of its objects.
using FrameCodes = std::vector<QuantityCode>;

/// Two characters of base64: 12 bits of a hash of the values' bytes. One difference
/// in 4096 is not detected.
std::string code_of(std::span<const Vec3f> values);
FrameCodes codes_of(const World& world);

/// tests/golden/trace/SCENE.txt: the codes of every frame from the first on. tests/golden.json says that a
/// scene changed; the trace gives the first changed quantity.
struct Trace {
  struct Line {
    std::string object, quantity;
    std::string codes;  ///< two characters per frame
  };
  std::vector<Line> lines;

  int frames() const;  ///< equal in every line
};

/// Appends a frame. The first frame defines the objects; all others must have them too.
void append(Trace& trace, const FrameCodes& codes);

/// One line of text per line of the trace: object, quantity, codes. Each object has first its positions, then its
/// velocities.
std::string trace_text(const Trace& trace);
/// Throws Error, which begins with `source` and the line's number, for any text that trace_text does not
/// write.
Trace parse_trace(const std::string& text, const std::string& source);
Trace read_trace(const std::filesystem::path& file);
/// Does not rewrite a file with equal content.
void write_trace(const std::filesystem::path& file, const Trace& trace);

/// The objects present in only one of the two, as text: `added: "crate"; removed: "duck", "ring"`; or empty.
std::string changes_of_objects(const Trace& trace, const FrameCodes& codes);

/// First difference of a simulation from the trace.
struct Difference {
  int frame = 0;
  FrameCodes quantities;     ///< quantities that differ in this frame
  std::size_t compared = 0;  ///< number of common quantities
};

/// Compares one frame, counted from 1; quantities of only one side are not compared.
std::optional<Difference> difference_in(const Trace& trace, int frame, const FrameCodes& codes);
/// Compares frames 1 to `last`; `next` returns their codes in order and is called only as often as necessary.
std::optional<Difference> first_difference(const Trace& trace, int last,
                                           const std::function<FrameCodes()>& next);

/// `first differs in frame 17: positions of "duck" (1 of 8 quantities); frames 1-16 agree`.
std::string difference_text(const Difference& difference);

}  // namespace souple::test
