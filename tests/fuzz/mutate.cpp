// mutate FORMAT CORPUS_FOLDER [COUNT [FIRST_SEED]]: reads COUNT mutants of the corpus' files. Most have changes that
// the structure of their format allows (structured.h). So three of ten pass the reader's first checks and are taken;
// fewer is a failure of this program. The others have any bytes changed. A reader may take or refuse (souple::Error)
// each. Any other exception, a crash or a slow mutant is a find, told by its seed. A seed makes one mutant on every
// machine: `mutate FORMAT CORPUS 1 SEED` repeats it, and with SOUPLE_MUTANT=FILE writes it there.

#include "formats.h"
#include "random.h"
#include "souple/error.h"
#include "structured.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <unistd.h>
#include <vector>

namespace {

using souple::fuzz::Random;

constexpr const char* odd_words[] = {"0",
                                     "-1",
                                     "1",
                                     "2147483647",
                                     "-2147483648",
                                     "4294967295",
                                     "4294967296",
                                     "1e308",
                                     "nan",
                                     "-inf",
                                     "1e-400",
                                     "9223372036854775807",
                                     "-9223372036854775808",
                                     "1e",
                                     "--1",
                                     "+",
                                     "99999999999999999999",
                                     "\"",
                                     "/",
                                     "//",
                                     "1/1/1",
                                     "\\\n",
                                     "$EndNodes",
                                     "end_header",
                                     "\xff\xfe",
                                     "#",
                                     "\r",
                                     "list",
                                     "{",
                                     "}",
                                     "[",
                                     "null",
                                     "0x10",
                                     "1,5",
                                     "element"};

struct Range {
  std::size_t begin, size;
};

Range random_line(const std::string& text, Random& random) {
  const std::size_t at = random.below(text.size());
  const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  const std::size_t after = text.find('\n', at);
  const std::size_t end = after == std::string::npos ? text.size() : after + 1;
  return {begin, std::max(end, begin) - begin};
}

Range random_word(const std::string& text, Random& random) {
  const std::size_t at = random.below(text.size());
  const char* const blanks = " \t\r\n";
  const std::size_t before = text.find_last_of(blanks, at);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  const std::size_t after = text.find_first_of(blanks, begin);
  return {begin, (after == std::string::npos ? text.size() : after) - begin};
}

/// Any change of bytes, whatever they mean.
void change_bytes(std::string& text, const std::string& other, Random& random) {
  const std::size_t kind = random.below(10);
  const std::size_t at = random.below(text.size());
  const Range line = random_line(text, random), word = random_word(text, random);
  const Range other_line = random_line(other, random);
  switch (kind) {
    case 0:
      text.resize(at);
      break;
    case 1:
      if (!text.empty()) text[at] = char(random.next() & 0xff);
      break;
    case 2:
      if (!text.empty()) text[at] = char(text[at] ^ (1 << random.below(8)));
      break;
    case 3:
      text.erase(line.begin, line.size);
      break;
    case 4:
      text.insert(line.begin, text.substr(line.begin, line.size));
      break;
    case 5:
      text.insert(line.begin, other.substr(other_line.begin, other_line.size));
      break;
    case 6:
      text.replace(word.begin, word.size, odd_words[random.below(std::size(odd_words))]);
      break;
    case 7:
      text.erase(at, random.below(16));
      break;
    case 8:
      text.insert(at, std::string(random.below(8), char(random.next() & 0xff)));
      break;
    default: {  // a 32-bit number of a binary file
      const char odd[] = {0, 1, char(0x7f), char(0x80), char(0xff)};
      const char fill = odd[random.below(std::size(odd))];
      for (std::size_t i = at; i < std::min(text.size(), at + 4); ++i) text[i] = fill;
    }
  }
}

std::string mutant(std::string_view format, const std::vector<std::string>& corpus, std::uint64_t seed) {
  Random random(seed);
  const std::string& original = corpus[random.below(corpus.size())];
  const std::string& other = corpus[random.below(corpus.size())];
  const bool keeps_structure = random.below(6) > 0;
  const std::size_t changes = 1 + random.below(keeps_structure ? 3 : 6);
  std::string text = original;
  for (std::size_t i = 0; i < changes || (text == original && i < 20); ++i) {
    if (keeps_structure) {
      souple::fuzz::change_structure(format, text, random);
    } else {
      change_bytes(text, other, random);
    }
  }
  return text;
}

std::vector<std::string> read_corpus(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_regular_file()) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> corpus;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return corpus;
}

// Data that a signal handler may touch: the text of the seed, ready to be written.
char seed_text[64];
std::size_t seed_length = 0;

void note_seed(std::uint64_t seed) {
  const std::string text = "died at seed " + std::to_string(seed) + "\n";
  seed_length = text.copy(seed_text, sizeof(seed_text));
}

extern "C" void report_seed(int signal) {
  // Nothing can be done where even this write fails.
  const auto written = write(STDERR_FILENO, seed_text, seed_length);
  (void)written;
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// False where the mutant was a find.
bool try_mutant(const souple::fuzz::Format& format, const std::string& bytes, std::uint64_t seed,
                std::uint64_t& taken) {
  constexpr double slow_seconds = 2.0;
  const auto start = std::chrono::steady_clock::now();
  try {
    format.parse(bytes);
    ++taken;
  } catch (const souple::Error& error) {
    if (*error.what() != '\0') return true;
    std::cerr << "seed " << seed << ": an Error without a message\n";
    return false;
  } catch (const std::exception& error) {
    std::cerr << "seed " << seed << ": " << error.what() << "\n";
    return false;
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  if (seconds.count() < slow_seconds) return true;
  std::cerr << "seed " << seed << ": took " << seconds.count() << " s\n";
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc > 5) {
    std::cerr << "usage: mutate FORMAT CORPUS_FOLDER [COUNT [FIRST_SEED]]\n";
    return 2;
  }
  const souple::fuzz::Format* const format = souple::fuzz::find_format(argv[1]);
  const std::vector<std::string> corpus = read_corpus(argv[2]);
  if (format == nullptr || corpus.empty()) {
    std::cerr << "mutate: no format " << argv[1] << " or no files in " << argv[2] << "\n";
    return 2;
  }
  const std::uint64_t count = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1000;
  const std::uint64_t first = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1;
  for (int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGALRM}) std::signal(signal, report_seed);
  std::uint64_t taken = 0, finds = 0;
  // The corpus itself must be fine.
  for (const std::string& bytes : corpus) format->parse(bytes);
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    note_seed(seed);
    alarm(20);
    const std::string bytes = mutant(format->name, corpus, seed);
    if (const char* path = std::getenv("SOUPLE_MUTANT")) std::ofstream(path, std::ios::binary) << bytes;
    if (!try_mutant(*format, bytes, seed, taken)) ++finds;
  }
  std::cout << format->name << ": " << count << " mutants, " << taken << " taken, " << count - taken - finds
            << " refused, " << finds << " finds\n";
  const bool enough = taken * 10 >= count * 3 || count < 1000;
  if (!enough)
    std::cerr << "mutate: less than 30 % of the mutants were taken: most test the first checks only\n";
  return finds == 0 && enough ? 0 : 1;
}
