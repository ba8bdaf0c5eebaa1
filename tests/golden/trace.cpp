#include "trace.h"

#include "souple/error.h"
#include "souple/files/atomic_file.h"
#include "souple/files/file.h"
#include "souple/math/fnv1a.h"
#include "souple/world/world.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

namespace souple::test {
namespace {

constexpr std::string_view base64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::size_t code_size = 2;

const Trace::Line* find_line(const Trace& trace, const QuantityCode& code) {
  const auto line = std::find_if(trace.lines.begin(), trace.lines.end(), [&](const Trace::Line& other) {
    return other.object == code.object && other.quantity == code.quantity;
  });
  return line == trace.lines.end() ? nullptr : &*line;
}

/// `"a", "b"`: what stands in `these` and not in `those`, each once.
std::string names_only_in(const std::vector<std::string>& these, const std::vector<std::string>& those) {
  std::vector<std::string> names;
  for (const std::string& name : these) {
    const bool known = std::find(those.begin(), those.end(), name) != those.end();
    const bool listed = std::find(names.begin(), names.end(), name) != names.end();
    if (!known && !listed) names.push_back(name);
  }
  return names.empty() ? "" : fmt::format("\"{}\"", fmt::join(names, "\", \""));
}

Trace::Line parse_line(const std::string& text) {
  const std::size_t codes = text.rfind(' ');
  const std::size_t quantity = codes == std::string::npos || codes == 0 ? codes : text.rfind(' ', codes - 1);
  if (quantity == std::string::npos || quantity == 0) throw Error("is not an object, a quantity and codes");
  Trace::Line line{text.substr(0, quantity), text.substr(quantity + 1, codes - quantity - 1),
                   text.substr(codes + 1)};
  if (line.codes.empty() || line.codes.size() % code_size != 0)
    throw Error(fmt::format("has {} characters of codes, not {} a frame", line.codes.size(), code_size));
  if (line.codes.find_first_not_of(base64) != std::string::npos) throw Error("has a code that is not base64");
  return line;
}

/// An object's positions come first, its velocities right after.
void add_line(Trace& trace, Trace::Line line) {
  const bool second = trace.lines.size() % 2 == 1;
  if (second && (line.quantity != "velocities" || line.object != trace.lines.back().object))
    throw Error(fmt::format("is not the velocities of \"{}\"", trace.lines.back().object));
  if (!second && line.quantity != "positions") throw Error("is not the positions of an object");
  if (find_line(trace, {line.object, line.quantity, ""}))
    throw Error(fmt::format("gives {} of \"{}\" again", line.quantity, line.object));
  if (!trace.lines.empty() && line.codes.size() != trace.lines[0].codes.size())
    throw Error(
        fmt::format("has {} frames, the first line {}", line.codes.size() / code_size, trace.frames()));
  trace.lines.push_back(std::move(line));
}

}  // namespace

std::string code_of(std::span<const Vec3f> values) {
  // The upper bits of a product by 2^64 / golden ratio depend on all of the hash (Knuth, section 6.4). The upper bits
  // of FNV-1a itself hardly depend on the last bytes, and its lower ones little on the upper bits of a byte.
  const std::uint64_t bits = fnv1a64(std::as_bytes(values)) * 11400714819323198485ull >> 52;
  return {base64[bits >> 6], base64[bits & 63]};
}

FrameCodes codes_of(const World& world) {
  FrameCodes codes;
  for (const ObjectId object : world.objects()) {
    codes.push_back({world.name(object), "positions", code_of(world.positions(object))});
    codes.push_back({world.name(object), "velocities", code_of(world.velocities(object))});
  }
  return codes;
}

int Trace::frames() const {
  return lines.empty() ? 0 : static_cast<int>(lines[0].codes.size() / code_size);
}

void append(Trace& trace, const FrameCodes& codes) {
  if (trace.lines.empty()) {
    for (const QuantityCode& code : codes) trace.lines.push_back({code.object, code.quantity, ""});
  }
  const auto same = [](const Trace::Line& line, const QuantityCode& code) {
    return line.object == code.object && line.quantity == code.quantity;
  };
  if (!std::equal(trace.lines.begin(), trace.lines.end(), codes.begin(), codes.end(), same))
    throw Error("a trace's objects stay the same from frame to frame");
  for (std::size_t i = 0; i < codes.size(); ++i) trace.lines[i].codes += codes[i].code;
}

std::string trace_text(const Trace& trace) {
  std::string text;
  for (const Trace::Line& line : trace.lines)
    text += fmt::format("{} {} {}\n", line.object, line.quantity, line.codes);
  return text;
}

Trace parse_trace(const std::string& text, const std::string& source) {
  if (text.empty()) throw Error(source + " is empty");
  Trace trace;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = text.find('\n', begin);
    try {
      if (end == std::string::npos) throw Error("is cut off");
      add_line(trace, parse_line(text.substr(begin, end - begin)));
    } catch (const Error& error) {
      throw Error(fmt::format("{}, line {}: {}", source, number + 1, error.what()));
    }
    begin = end + 1;
  }
  if (trace.lines.size() % 2 == 1) throw Error(source + " ends before the last object's velocities");
  return trace;
}

Trace read_trace(const std::filesystem::path& file) {
  return parse_trace(read_whole_file(file), file.filename().string());
}

void write_trace(const std::filesystem::path& file, const Trace& trace) {
  const std::string text = trace_text(trace);
  if (std::filesystem::exists(file) && read_whole_file(file) == text) return;
  create_folder(file.parent_path());
  write_file_atomically(file, text);
}

std::string changes_of_objects(const Trace& trace, const FrameCodes& codes) {
  std::vector<std::string> before, now;
  for (const Trace::Line& line : trace.lines) before.push_back(line.object);
  for (const QuantityCode& code : codes) now.push_back(code.object);
  const std::string added = names_only_in(now, before), removed = names_only_in(before, now);
  std::vector<std::string> changes;
  if (!added.empty()) changes.push_back("added: " + added);
  if (!removed.empty()) changes.push_back("removed: " + removed);
  return fmt::format("{}", fmt::join(changes, "; "));
}

std::optional<Difference> difference_in(const Trace& trace, int frame, const FrameCodes& codes) {
  if (frame < 1 || frame > trace.frames()) throw Error(fmt::format("the trace has no frame {}", frame));
  Difference difference{frame, {}, 0};
  const std::size_t place = static_cast<std::size_t>(frame - 1) * code_size;
  for (const QuantityCode& code : codes) {
    const Trace::Line* line = find_line(trace, code);
    if (!line) continue;
    ++difference.compared;
    if (line->codes.compare(place, code_size, code.code) != 0) difference.quantities.push_back(code);
  }
  if (difference.quantities.empty()) return std::nullopt;
  return difference;
}

std::optional<Difference> first_difference(const Trace& trace, int last,
                                           const std::function<FrameCodes()>& next) {
  for (int frame = 1; frame <= last; ++frame) {
    if (auto difference = difference_in(trace, frame, next())) return difference;
  }
  return std::nullopt;
}

std::string difference_text(const Difference& difference) {
  std::vector<std::string> quantities;
  for (const QuantityCode& code : difference.quantities)
    quantities.push_back(fmt::format("{} of \"{}\"", code.quantity, code.object));
  std::string text = fmt::format("first differs in frame {}: {} ({} of {} quantities)", difference.frame,
                                 fmt::join(quantities, ", "), quantities.size(), difference.compared);
  if (difference.frame == 2) text += "; frame 1 agrees";
  if (difference.frame > 2) text += fmt::format("; frames 1-{} agree", difference.frame - 1);
  return text;
}

}  // namespace souple::test
