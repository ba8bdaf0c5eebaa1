#include "structured.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <iterator>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace souple::fuzz {

namespace {

using Json = nlohmann::json;

struct Token {
  std::size_t begin, size;
  bool is_number;
};

struct Line {
  std::size_t begin, size;  ///< with its line end
  std::vector<Token> tokens;
  std::string shape;  ///< words, and a mark for each number
};

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/// Numbers as any of the formats writes them; the indices of an OBJ's corner count as one.
bool is_number(std::string_view word) {
  const bool digits =
      std::any_of(word.begin(), word.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  return digits && word.find_first_not_of("0123456789+-.eE/") == std::string_view::npos;
}

std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    Line line{begin, end - begin, {}, {}};
    for (std::size_t at = begin; at < end;) {
      if (is_blank(text[at])) {
        ++at;
        continue;
      }
      std::size_t stop = at;
      while (stop < end && !is_blank(text[stop])) ++stop;
      const std::string_view word = text.substr(at, stop - at);
      line.tokens.push_back({at, word.size(), is_number(word)});
      line.shape += is_number(word) ? "0 " : std::string(word) + " ";
      at = stop;
    }
    lines.push_back(std::move(line));
    begin = end;
  }
  return lines;
}

std::string text_of(const std::string& text, const Token& token) {
  return text.substr(token.begin, token.size);
}

/// A number that is like `word` for a reader, or nearly.
std::string altered_number(const std::string& word, Random& random) {
  const bool is_whole = word.find_first_of(".eE/") == std::string::npos;
  switch (random.below(is_whole ? 3 : 7)) {
    case 0:
      return word.find('/') == std::string::npos && word[0] != '+' && word[0] != '-' ? "+" + word : word;
    case 1:
      return word[0] == '-' ? word.substr(1) : word;
    case 2: {
      const char digit = char('0' + random.below(10));
      std::string changed = word;
      const std::size_t at = word.find_first_of("0123456789");
      changed[at] = digit;
      return changed;
    }
    case 3:
      return word.find_first_of("eE/") == std::string::npos
                 ? word + "e" + std::to_string(int(random.below(80)) - 40)
                 : word;
    case 4:
      return word.find_first_of("eE/") == std::string::npos ? word + std::string(1 + random.below(40), '7')
                                                            : word;
    case 5:
      return "-" + word.substr(word[0] == '-' || word[0] == '+' ? 1 : 0);
    default:
      return "1e-320";
  }
}

/// Line of the same shape as line `i`; `i` where there is none.
std::size_t line_like(const std::vector<Line>& lines, std::size_t i, Random& random) {
  std::vector<std::size_t> same;
  for (std::size_t j = 0; j < lines.size(); ++j) {
    if (lines[j].shape == lines[i].shape) same.push_back(j);
  }
  return same[random.below(same.size())];
}

/// The last whole number `count` before `end` becomes `count + change`.
void mend_count(std::string& text, const std::vector<Line>& lines, std::size_t end, std::size_t count,
                int change) {
  for (std::size_t i = end; i-- > 0;) {
    for (const Token& token : lines[i].tokens) {
      if (text_of(text, token) != std::to_string(count)) continue;
      text.replace(token.begin, token.size, std::to_string(int(count) + change));
      return;
    }
  }
}

/// Removes line `i`, or adds a copy of it, and mends the count of the lines of its shape.
void change_count(std::string& text, const std::vector<Line>& lines, std::size_t i, bool removes) {
  std::size_t first = i, last = i;
  while (first > 0 && lines[first - 1].shape == lines[i].shape) --first;
  while (last + 1 < lines.size() && lines[last + 1].shape == lines[i].shape) ++last;
  const std::string line = text.substr(lines[i].begin, lines[i].size);
  if (removes) {
    text.erase(lines[i].begin, lines[i].size);
  } else {
    text.insert(lines[i].begin, line);
  }
  mend_count(text, lines, first, last - first + 1, removes ? -1 : 1);
}

void change_number(std::string& text, const std::vector<Line>& lines, Random& random) {
  for (int attempt = 0; attempt < 20; ++attempt) {
    const std::size_t i = random.below(lines.size());
    if (lines[i].tokens.empty()) continue;
    const std::size_t k = random.below(lines[i].tokens.size());
    const Token token = lines[i].tokens[k];
    if (!token.is_number) continue;
    const Token other = lines[line_like(lines, i, random)].tokens[k];
    const bool takes_other = random.below(2) == 0;
    text.replace(token.begin, token.size,
                 takes_other ? text_of(text, other) : altered_number(text_of(text, token), random));
    return;
  }
}

}  // namespace

void change_text(std::string& text, std::size_t end, Random& random) {
  const std::vector<Line> lines = lines_of(std::string_view(text).substr(0, end));
  if (lines.empty()) return;
  const std::size_t i = random.below(lines.size()), j = line_like(lines, i, random);
  const std::string here = text.substr(lines[i].begin, lines[i].size),
                    there = text.substr(lines[j].begin, lines[j].size);
  switch (random.below(8)) {
    case 0:
      if (i < j) {
        text.replace(lines[j].begin, lines[j].size, here);
        text.replace(lines[i].begin, lines[i].size, there);
      }
      return;
    case 1:
      text.replace(lines[i].begin, lines[i].size, there);
      return;
    case 2:
      change_count(text, lines, i, random.below(2) == 0);
      return;
    case 3:
      if (!lines[i].tokens.empty())
        text.insert(lines[i].tokens[random.below(lines[i].tokens.size())].begin,
                    std::string(1 + random.below(3), ' '));
      return;
    default:
      change_number(text, lines, random);
  }
}

namespace {

struct Place {
  Json* parent;
  std::string key;        ///< of an object's member
  std::size_t index = 0;  ///< of an array's element
  Json& value() const { return parent->is_object() ? (*parent)[key] : (*parent)[index]; }
};

void collect(Json& node, std::vector<Place>& places) {
  if (node.is_object()) {
    for (auto& [key, value] : node.items()) {
      places.push_back({&node, key});
      collect(value, places);
    }
  } else if (node.is_array()) {
    for (std::size_t i = 0; i < node.size(); ++i) {
      places.push_back({&node, {}, i});
      collect(node[i], places);
    }
  }
}

/// A number near or far, whole where the value is.
void change_number(Json& value, Random& random) {
  const double factors[] = {0.5, 2, 0.1, 0.999, 3, -1, 0, 1e-30};
  const double factor = factors[random.below(std::size(factors))];
  if (value.is_number_float()) {
    value = value.get<double>() * factor;
  } else if (random.below(2) == 0) {
    value = value.get<std::int64_t>() / 2 + std::int64_t(random.below(3));
  } else {
    value = value.get<std::int64_t>() + std::int64_t(random.below(4));
  }
}

void change_text_value(Json& value, Random& random) {
  const char* const endings[] = {"", "2", "-", "\xc3\xa9", "_x", "0000"};
  value = value.get<std::string>() + endings[random.below(std::size(endings))];
}

void change_elements(Json& array, std::size_t at, Random& random) {
  switch (random.below(3)) {
    case 0:
      array.erase(at);
      return;
    case 1: {
      const Json copy = array[at];
      array.push_back(copy);
      return;
    }
    default:
      std::swap(array[at], array[random.below(array.size())]);
  }
}

}  // namespace

void change_json(std::string& text, Random& random) {
  Json root = Json::parse(text, nullptr, false);
  if (!root.is_structured()) return;
  std::vector<Place> places;
  collect(root, places);
  if (places.empty()) return;
  const Place place = places[random.below(places.size())];
  Json& value = place.value();
  if (random.below(3) == 0) {  // what the same key has elsewhere
    std::vector<Place> same;
    for (const Place& other : places) {
      if (other.key == place.key && other.parent->is_object() == place.parent->is_object())
        same.push_back(other);
    }
    const Json copy = same[random.below(same.size())].value();
    value = copy;
  } else if (value.is_number()) {
    change_number(value, random);
  } else if (value.is_boolean()) {
    value = !value.get<bool>();
  } else if (value.is_string()) {
    change_text_value(value, random);
  } else if (place.parent->is_array()) {
    change_elements(*place.parent, place.index, random);
  } else {
    place.parent->erase(place.key);
  }
  text = root.dump(random.below(4) == 0 ? 1 : -1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace souple::fuzz
