# relume_discover_suites(TARGET PROPERTIES...) makes one test of ctest of each suite of a program of GoogleTest: cases of a suite
# share a process, so that the device and its shaders are made once and not once per case. Each test writes
# results/SUITE.xml in the build folder of the tests, by which cases are counted.
#
# The program names its suites after it is linked: this file runs as a script then.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(RELUME_SUITES_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

  function(relume_discover_suites TARGET)
    set(LIST ${CMAKE_CURRENT_BINARY_DIR}/${TARGET}_suites.cmake)
    string(REPLACE ";" "|" PROPERTIES "${ARGN}") # a list would fall apart on the command line
    add_custom_command(TARGET ${TARGET} POST_BUILD BYPRODUCTS ${LIST}
      COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${TARGET}> -DLIST=${LIST}
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
foreach(SUITE IN LISTS SUITES)
  string(REGEX REPLACE "[\n.]" "" SUITE "${SUITE}")
  string(REPLACE "/" "." RESULT "${SUITE}")
  string(APPEND TESTS "add_test([=[${SUITE}]=] \"${PROGRAM}\" \"--gtest_filter=${SUITE}.*\" "
                      "\"--gtest_output=xml:${RESULTS}/${RESULT}.xml\")\n"
                      "set_tests_properties([=[${SUITE}]=] PROPERTIES ${PROPERTIES})\n")
endforeach()
file(WRITE ${LIST} "${TESTS}")
