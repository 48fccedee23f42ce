# One ctest a suite of a program of tests: loading deal.II's two hundred libraries takes longer than most tests.
# Included: kerf_discover_suites(TARGET PREFIX [LONG REGEX] [LABEL LABEL LABELLED REGEX]) registers PREFIX.SUITE for
# each suite; those whose names match LONG have the label long and two hours, those that match LABELLED have LABEL.
# Run by the build (cmake -P): writes these tests to RESULT, from what PROGRAM says it has.

if(CMAKE_SCRIPT_MODE_FILE)
  execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE list COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE "[[;]|]" "_" list "${list}") # of comments on parameters
  string(REPLACE "\n" ";" lines "${list}")
  set(suites "")
  foreach(line IN LISTS lines)
    if(line MATCHES "^([^ ]+)\\.( |$)")
      set(suite ${CMAKE_MATCH_1})
      list(APPEND suites ${suite})
      set(n_${suite} 0)
    elseif(line MATCHES "^  [^ ]")
      math(EXPR n_${suite} "${n_${suite}} + 1")
    endif()
  endforeach()
  set(tests "")
  foreach(suite IN LISTS suites)
    set(name ${PREFIX}.${suite})
    string(APPEND tests "add_test([==[${name}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${suite}.*]==] --gtest_brief=1)\n")
    # Suites of many tests begin first, so that none is left alone at the end.
    set(properties "COST ${n_${suite}} WORKING_DIRECTORY [==[${FOLDER}]==]")
    if(LONG AND suite MATCHES "${LONG}")
      string(APPEND properties " LABELS long TIMEOUT 7200")
    elseif(LABEL AND suite MATCHES "${LABELLED}")
      string(APPEND properties " LABELS ${LABEL}")
    endif()
    string(APPEND tests "set_tests_properties([==[${name}]==] PROPERTIES ${properties})\n")
  endforeach()
  file(WRITE ${RESULT} "${tests}")
  return()
endif()

function(kerf_discover_suites target prefix)
  cmake_parse_arguments(SUITES "" "LONG;LABEL;LABELLED" "" ${ARGN})
  set(script ${PROJECT_SOURCE_DIR}/cmake/discover_suites.cmake)
  set(result ${CMAKE_CURRENT_BINARY_DIR}/${target}_suites.cmake)
  set(if_built ${CMAKE_CURRENT_BINARY_DIR}/${target}_if_built.cmake)
  file(WRITE ${if_built} "if(EXISTS [==[${result}]==])\n  include([==[${result}]==])\nelse()\n"
    "  add_test(${target}_NOT_BUILT ${target}_NOT_BUILT)\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${if_built})
  add_custom_command(TARGET ${target} POST_BUILD BYPRODUCTS ${result} VERBATIM
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${target}> -DPREFIX=${prefix} -DRESULT=${result}
            -DFOLDER=${CMAKE_CURRENT_BINARY_DIR} -DLONG=${SUITES_LONG} -DLABEL=${SUITES_LABEL}
            -DLABELLED=${SUITES_LABELLED} -P ${script})
  set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${script})
endfunction()
