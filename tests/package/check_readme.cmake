# The first C++ example of README.md is examples/hello/main.cpp, to the letter.
file(READ ${SOURCE}/README.md readme)
file(READ ${SOURCE}/examples/hello/main.cpp hello)
string(FIND "${readme}" "```cpp\n${hello}```" at)
if(at EQUAL -1)
  message(FATAL_ERROR "README.md does not show examples/hello/main.cpp as it is; copy it between ```cpp and ```")
endif()
