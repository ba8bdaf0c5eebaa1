# souple.1, made from --help. Not under a sanitizer, nor when cross-compiling: the program has to run.
find_program(HELP2MAN_PROGRAM help2man)
if(HELP2MAN_PROGRAM AND TARGET souple_app AND NOT SOUPLE_SANITIZERS AND NOT CMAKE_CROSSCOMPILING)
  set(SOUPLE_MAN_PAGE ${PROJECT_BINARY_DIR}/souple.1)
  add_custom_command(
    OUTPUT ${SOUPLE_MAN_PAGE}
    COMMAND ${HELP2MAN_PROGRAM} --no-info --section=1 --version-string=${PROJECT_VERSION}
            "--name=${PROJECT_DESCRIPTION}" --output=${SOUPLE_MAN_PAGE} $<TARGET_FILE:souple_app>
    DEPENDS souple_app
    VERBATIM)
  add_custom_target(souple_man ALL DEPENDS ${SOUPLE_MAN_PAGE})
endif()
