#include "formats.h"
#include "souple/error.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>

/// One program per format: SOUPLE_FUZZ_FORMAT is its name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const souple::fuzz::Format* const format = souple::fuzz::find_format(SOUPLE_FUZZ_FORMAT);
  if (format == nullptr) std::abort();
  try {
    format->parse({reinterpret_cast<const char*>(data), size});
  } catch (const souple::Error&) {
  }
  return 0;
}
