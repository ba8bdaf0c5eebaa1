#pragma once

#include <Core/RaCore.hpp>
#include <cstdio>
#include <sstream>
#include <string>

namespace Ra {
namespace Core {
namespace Utils {

enum TLogLevel { logERROR, logWARNING, logINFO, logDEBUG, logDEBUG1, logDEBUG2, logDEBUG3, logDEBUG4 };

/// One line of the log: it goes to the standard error when the statement ends.
class LogLine {
 public:
  LogLine() = default;
  LogLine(const LogLine&) = delete;
  LogLine& operator=(const LogLine&) = delete;
  ~LogLine() { std::fprintf(stderr, "%s\n", m_text.str().c_str()); }

  std::ostream& start(TLogLevel level) {
    const char* const names[] = {"ERROR", "WARNING", "INFO"};
    return m_text << "- " << names[level] << ": ";
  }

 private:
  std::ostringstream m_text;
};

}  // namespace Utils
}  // namespace Core
}  // namespace Ra

// A Release build of Radium drops what is below INFO.
#ifdef RA_NO_LOG
#define LOG(level) \
  if (true)        \
    ;              \
  else             \
    Ra::Core::Utils::LogLine().start(level)
#else
#define LOG(level)                        \
  if ((level) > Ra::Core::Utils::logINFO) \
    ;                                     \
  else                                    \
    Ra::Core::Utils::LogLine().start(level)
#endif
