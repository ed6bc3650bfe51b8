# relume_discover_suites(TARGET PROPERTIES...) makes one test of ctest of each suite of a program of GoogleTest: cases of a suite
# share a process, so that the device and its shaders are made once and not once per case. Each test writes
# results/SUITE.xml in the build folder of the tests, by which cases are counted.
#
# With RELUME_TESTS_AFTER set to another such program, none starts before that program's have ended, however they ended.
#
# The program names its suites after it is linked: this file runs as a script then.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(RELUME_SUITES_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

  function(relume_discover_suites TARGET)
    set(LIST ${CMAKE_CURRENT_BINARY_DIR}/${TARGET}_suites.cmake)
    set(NAMES ${CMAKE_CURRENT_BINARY_DIR}/${TARGET}_names.cmake)
    set(BEFORE "")
    if(RELUME_TESTS_AFTER)
      set(BEFORE ${CMAKE_CURRENT_BINARY_DIR}/${RELUME_TESTS_AFTER}_names.cmake)
    endif()
    string(REPLACE ";" "|" PROPERTIES "${ARGN}") # a list would fall apart on the command line
    add_custom_command(TARGET ${TARGET} POST_BUILD BYPRODUCTS ${LIST} ${NAMES}
      COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${TARGET}> -DLIST=${LIST} -DNAMES=${NAMES} -DBEFORE=${BEFORE}
              -DRESULTS=${CMAKE_CURRENT_BINARY_DIR}/results -DPROPERTIES=${PROPERTIES} -P ${RELUME_SUITES_SCRIPT}
      VERBATIM)
    # A program that is not built yet is told as a test that fails.
    set(INCLUDED ${CMAKE_CURRENT_BINARY_DIR}/${TARGET}_include.cmake)
    file(WRITE ${INCLUDED} "if(EXISTS \"${LIST}\")\n  include(\"${LIST}\")\nelse()\n  add_test(${TARGET}_NOT_BUILT ${TARGET}_NOT_BUILT)\nendif()\n")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${INCLUDED})
  endfunction()
  return()
endif()

execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE LISTED RESULT_VARIABLE STATUS)
if(NOT STATUS EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} does not list its tests (${STATUS}): ${LISTED}")
endif()
string(REPLACE "|" "]=] [=[" PROPERTIES "[=[${PROPERTIES}]=]") # they may hold spaces
string(REGEX MATCHALL "(^|\n)[A-Za-z_0-9/]+\\." SUITES "${LISTED}") # cases are indented
set(TESTS "")
set(TESTS_NAMES "")
if(BEFORE)
  set(TESTS "set(BEFORE)\ninclude([=[${BEFORE}]=] OPTIONAL)\n") # it may not be built
endif()
foreach(SUITE IN LISTS SUITES)
  string(REGEX REPLACE "[\n.]" "" SUITE "${SUITE}")
  string(REPLACE "/" "." RESULT "${SUITE}")
  string(APPEND TESTS "add_test([=[${SUITE}]=] \"${PROGRAM}\" \"--gtest_filter=${SUITE}.*\" "
                      "\"--gtest_output=xml:${RESULTS}/${RESULT}.xml\")\n"
                      "set_tests_properties([=[${SUITE}]=] PROPERTIES ${PROPERTIES})\n")
  if(BEFORE)
    string(APPEND TESTS "set_tests_properties([=[${SUITE}]=] PROPERTIES DEPENDS \"\${BEFORE}\")\n")
  endif()
  list(APPEND TESTS_NAMES "${SUITE}")
endforeach()
file(WRITE ${LIST} "${TESTS}")
file(WRITE ${NAMES} "set(BEFORE [=[${TESTS_NAMES}]=])\n")
