# The first C++ example of README.md is examples/hello/main.cpp, to the letter.
file(READ ${SOURCE}/README.md readme)
file(READ ${SOURCE}/examples/hello/main.cpp hello)
string(FIND "${readme}" "```cpp\n${hello}```" at)
if(at EQUAL -1)
  message(FATAL_ERROR "README.md does not show examples/hello/main.cpp as it is; copy it between ```cpp and ```")
endif()

# And the one of docs/embedding.md is examples/embed/main.cpp.
file(READ ${SOURCE}/docs/embedding.md embedding)
file(READ ${SOURCE}/examples/embed/main.cpp embed)
string(FIND "${embedding}" "```cpp\n${embed}```" at)
if(at EQUAL -1)
  message(FATAL_ERROR "docs/embedding.md does not show examples/embed/main.cpp as it is; copy it between ```cpp and ```")
endif()
