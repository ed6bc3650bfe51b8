# relume_discover_suites(TARGET PROPERTIES...) makes one test of ctest of each suite of a program of GoogleTest: cases of a suite
# share a process, so that the device and its shaders are made once and not once per case. Each test writes
# results/SUITE.xml in the build folder of the tests, by which cases are counted.
#
# With RELUME_TESTS_AFTER set to other such programs, none starts before those programs' have ended, however they ended.
# Suites of RELUME_LONGEST start before the others, so that none of them is left for the end; a later run of the same build
# goes by the times that ctest has measured.
#
# The program names its suites after it is linked: this file runs as a script then.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(RELUME_SUITES_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

  function(relume_discover_suites TARGET)
    set(LIST ${CMAKE_CURRENT_BINARY_DIR}/${TARGET}_suites.cmake)
    set(NAMES ${CMAKE_CURRENT_BINARY_DIR}/${TARGET}_names.cmake)
    list(TRANSFORM RELUME_TESTS_AFTER REPLACE "(.+)" "${CMAKE_CURRENT_BINARY_DIR}/\\1_names.cmake" OUTPUT_VARIABLE BEFORE)
    foreach(LISTED BEFORE RELUME_LONGEST ARGN) # a list would fall apart on the command line
      string(REPLACE ";" "|" ${LISTED} "${${LISTED}}")
    endforeach()
    add_custom_command(TARGET ${TARGET} POST_BUILD BYPRODUCTS ${LIST} ${NAMES}
      COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${TARGET}> -DLIST=${LIST} -DNAMES=${NAMES} -DBEFORE=${BEFORE}
              -DRESULTS=${CMAKE_CURRENT_BINARY_DIR}/results -DLONGEST=${RELUME_LONGEST} -DPROPERTIES=${ARGN}
              -P ${RELUME_SUITES_SCRIPT}
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
string(REPLACE "|" ";" LONGEST "${LONGEST}")
string(REPLACE "|" ";" BEFORE "${BEFORE}")
set(TESTS "set(ALL_BEFORE)\n")
set(TESTS_NAMES "")
foreach(NAMED IN LISTS BEFORE) # which may not be built
  string(APPEND TESTS "set(BEFORE)\ninclude([=[${NAMED}]=] OPTIONAL)\nlist(APPEND ALL_BEFORE \${BEFORE})\n")
endforeach()
foreach(SUITE IN LISTS SUITES)
  string(REGEX REPLACE "[\n.]" "" SUITE "${SUITE}")
  string(REPLACE "/" "." RESULT "${SUITE}")
  string(APPEND TESTS "add_test([=[${SUITE}]=] \"${PROGRAM}\" \"--gtest_filter=${SUITE}.*\" "
                      "\"--gtest_output=xml:${RESULTS}/${RESULT}.xml\")\n"
                      "set_tests_properties([=[${SUITE}]=] PROPERTIES ${PROPERTIES})\n")
  if(BEFORE)
    string(APPEND TESTS "set_tests_properties([=[${SUITE}]=] PROPERTIES DEPENDS \"\${ALL_BEFORE}\")\n")
  endif()
  list(FIND LONGEST ${SUITE} PLACE)
  if(PLACE GREATER_EQUAL 0)
    list(LENGTH LONGEST COST)
    math(EXPR COST "60 * (${COST} - ${PLACE})") # so many seconds none takes
    string(APPEND TESTS "set_tests_properties([=[${SUITE}]=] PROPERTIES COST ${COST})\n")
  endif()
  list(APPEND TESTS_NAMES "${SUITE}")
endforeach()
file(WRITE ${LIST} "${TESTS}")
file(WRITE ${NAMES} "set(BEFORE [=[${TESTS_NAMES}]=])\n")
