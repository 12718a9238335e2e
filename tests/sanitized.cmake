# What runs under sanitizers (GLISS_SANITIZE): tests of what reads foreign bytes, walks arrays or is shared by threads.
# Not what runs programs, measures, or would take minutes: CI has few for this.
if(GLISS_SANITIZE STREQUAL "thread")
  set(parts c_api/c_api contact/motion haply/haply_device loop/loop engine/parallel thread/periodic scene/session
    device/udp_device device/udp_server view/pointer_hand view/view_server)
else()
  set(parts files/atomic_file c_api/c_api files/cache_file chai3d/chai3d tables/csv_file tables/csv_reader device/guard
    haply/haply_device files/hostile_files files/hostile_numbers sweep/hostile_parts loop/loop files/mesh engine/parallel
    tables/result_file scene/scene_error scene/scene_file device/sim_device sweep/sweep device/udp_device
    device/udp_protocol device/udp_server base/units validate/validate view/pointer_hand view/view_protocol view/view_server
    tables/vtp_file)
endif()
list(TRANSFORM parts APPEND _test.cpp OUTPUT_VARIABLE sources)
add_gliss_tests(sanitized_tests ${sources} ${PROJECT_SOURCE_DIR}/tools/cli/terminal/progress_text.cpp)
target_link_libraries(sanitized_tests PRIVATE room_view)
if("c_api/c_api" IN_LIST parts)
  target_sources(sanitized_tests PRIVATE $<TARGET_OBJECTS:room_c_api>)
endif()
set_source_files_properties(support/places.cpp PROPERTIES COMPILE_DEFINITIONS
  "GLISS_TESTS_DIR=\"${CMAKE_CURRENT_SOURCE_DIR}\";GLISS_SHARED_DIR=\"\";GLISS_PROGRAM=\"\";GLISS_MPI_PROGRAM=\"\";GLISS_OPENCL_FAULT=\"\"")
# These headers take most of the time, and optimising under sanitizers as much again.
target_compile_options(sanitized_tests PRIVATE -O0)
target_precompile_headers(sanitized_tests PRIVATE <gmock/gmock.h> <gtest/gtest.h> <Eigen/Geometry> <fmt/format.h>)
add_custom_target(sanitized DEPENDS sanitized_tests)  # and no more than is added here, of all that there is
foreach(shard RANGE 3)
  set(test sanitized_tests_${shard})
  add_test(NAME ${test} COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/sanitized.sh $<TARGET_FILE:sanitized_tests>)
  list(APPEND tests ${test})
  list(APPEND environment_${test} GTEST_TOTAL_SHARDS=4 GTEST_SHARD_INDEX=${shard})
endforeach()
if(GLISS_SANITIZE STREQUAL "thread")
  foreach(source thread/seqlock_tsan contact/lazy_tsan)
    get_filename_component(test ${source} NAME)
    add_executable(${test} ${source}.cpp)
    target_link_libraries(${test} PRIVATE gliss_whole gliss_options)
    add_dependencies(sanitized ${test})
    add_test(NAME ${test} COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/sanitized.sh $<TARGET_FILE:${test}>)
    list(APPEND tests ${test})
  endforeach()
endif()
# The Python package: what needs no program. Python itself is not of these flags, and has to load them first.
if(GLISS_PYTHON)
  add_dependencies(sanitized _gliss)
  add_test(NAME python COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/sanitized.sh ${Python3_EXECUTABLE}
    ${CMAKE_CURRENT_SOURCE_DIR}/python_package.py "" ${PROJECT_BINARY_DIR}/python ${CMAKE_CXX_COMPILER})
  set_tests_properties(python PROPERTIES TIMEOUT 600 SKIP_RETURN_CODE 77 ENVIRONMENT
    "ASAN_OPTIONS=detect_leaks=0;UBSAN_OPTIONS=print_stacktrace=1")
endif()
# Installed and used as shared libraries, by programs of other flags.
if(BUILD_SHARED_LIBS)
  add_dependencies(sanitized ${libraries})
  add_test(NAME shared_libraries COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/shared_libraries.sh ${PROJECT_BINARY_DIR}
    ${CMAKE_CURRENT_SOURCE_DIR}/consumer ${PROJECT_BINARY_DIR}/consumer "-fsanitize=${GLISS_SANITIZE}")
  set_tests_properties(shared_libraries PROPERTIES TIMEOUT 600 SKIP_RETURN_CODE 77 COST 60)
endif()
# Not what asks for speed, and not what builds large surfaces or writes thousands of files.
set(left_out *within_20_ms* *fell_silent_too CacheFile.EveryFlippedBit*
  *KeepsEveryBit* Sweep.gives_* Sweep.hands_* Sweep.meets_* *thousand_ticks* *million_ticks*)
list(JOIN left_out ":" left_out)
foreach(test IN LISTS tests)
  set_tests_properties(${test} PROPERTIES TIMEOUT 600 SKIP_RETURN_CODE 77 ENVIRONMENT
    "${environment_${test}};GTEST_FILTER=-${left_out};UBSAN_OPTIONS=print_stacktrace=1;TSAN_OPTIONS=suppressions=${CMAKE_CURRENT_SOURCE_DIR}/tsan.supp")
endforeach()
