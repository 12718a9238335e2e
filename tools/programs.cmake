# The programs gliss and gliss-mpi, and the page of gliss report.

# All rooms for the program and the tests, which know what shared libraries hide.
if(BUILD_SHARED_LIBS)
  add_library(gliss_whole STATIC)
  set_target_properties(gliss_whole PROPERTIES LINKER_LANGUAGE CXX)
  foreach(library IN LISTS libraries)
    get_target_property(sources ${library} SOURCES)
    get_target_property(links ${library} LINK_LIBRARIES)
    list(FILTER links EXCLUDE REGEX "^gliss_")
    target_sources(gliss_whole PRIVATE ${sources})
    target_link_libraries(gliss_whole PUBLIC ${links})
  endforeach()
  target_include_directories(gliss_whole PUBLIC ${CMAKE_BINARY_DIR}/rooms/all)
else()
  add_library(gliss_whole INTERFACE)
  target_link_libraries(gliss_whole INTERFACE gliss_study gliss_scene gliss_haply)
endif()

# What the program and the Python package have in common.
add_library(gliss_results STATIC $<TARGET_OBJECTS:room_results>)
set_target_properties(gliss_results PROPERTIES LINKER_LANGUAGE CXX)
target_link_libraries(gliss_results PUBLIC gliss_whole nlohmann_json::nlohmann_json fmt::fmt)

# The commands, which the programs have in common.
file(GLOB tool_sources CONFIGURE_DEPENDS tools/cli/*.cpp tools/report/*.cpp)
list(FILTER tool_sources EXCLUDE REGEX "/gliss.cpp$")
add_library(gliss_commands OBJECT ${tool_sources})
target_compile_definitions(gliss_commands PRIVATE GLISS_VERSION="${PROJECT_VERSION}")
target_include_directories(gliss_commands PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(gliss_commands PUBLIC gliss_results gliss_options
  PRIVATE CLI11::CLI11)
target_precompile_headers(gliss_commands PRIVATE ${common_headers} <fmt/format.h> <nlohmann/json.hpp>)
add_executable(gliss tools/cli/gliss.cpp)
install(TARGETS gliss OPTIONAL)  # some builds are of the libraries alone
target_link_libraries(gliss PRIVATE gliss_commands)

# gliss-mpi, the same on the ranks of an MPI job. gliss itself never needs MPI.
if(NOT GLISS_SANITIZE AND NOT GLISS_FUZZ)
  set(MPI_CXX_SKIP_MPICXX ON)
  find_package(MPI QUIET COMPONENTS CXX)
endif()
option(GLISS_MPI "Build gliss-mpi: needs MPI 3" ${MPI_FOUND})
if(GLISS_MPI AND NOT MPI_FOUND)
  message(FATAL_ERROR "GLISS_MPI needs MPI 3 or later, such as Open MPI (libopenmpi-dev, openmpi-bin)")
elseif(GLISS_MPI)
  add_executable(gliss_mpi tools/mpi/gliss_mpi.cpp tools/mpi/mpi_team.cpp)
  set_target_properties(gliss_mpi PROPERTIES OUTPUT_NAME gliss-mpi)
  # Its ranks write one file together where there is an HDF5 with MPI (libhdf5-openmpi-dev). What speaks to HDF5 is
  # compiled for that and linked first, so that nothing needs what the libraries have.
  find_package(PkgConfig QUIET)
  if(PkgConfig_FOUND)
    pkg_check_modules(HDF5_OPENMPI QUIET IMPORTED_TARGET hdf5-openmpi)
  endif()
  if(HDF5_OPENMPI_FOUND)
    file(GLOB hdf5_sources CONFIGURE_DEPENDS host/tables/hdf5_*.cpp)
    add_library(tables_mpi OBJECT ${hdf5_sources})
    target_include_directories(tables_mpi PRIVATE $<TARGET_PROPERTY:room_tables,INTERFACE_INCLUDE_DIRECTORIES>)
    target_link_libraries(tables_mpi PRIVATE room_files gliss_options fmt::fmt PUBLIC PkgConfig::HDF5_OPENMPI)
    target_compile_definitions(gliss_mpi PRIVATE GLISS_PARALLEL_HDF5)
    target_link_options(gliss_mpi PRIVATE -Wl,--as-needed)
    target_link_libraries(gliss_mpi PRIVATE tables_mpi)
  else()
    message(STATUS "No HDF5 with MPI (libhdf5-openmpi-dev, pkg-config): rank 0 of gliss-mpi writes results alone")
  endif()
  target_link_libraries(gliss_mpi PRIVATE gliss_commands MPI::MPI_CXX)
  install(TARGETS gliss_mpi OPTIONAL)
elseif(NOT MPI_FOUND)
  message(STATUS "No MPI: gliss-mpi is left out")
endif()

# The page of gliss report, which becomes part of the program: a release has it (tools/release.sh), else npm fetches and
# bundles it.
set(report_folder ${CMAKE_CURRENT_SOURCE_DIR}/tools/report/page)
set(has_page OFF)
if(EXISTS ${report_folder}/report.html)
  set(has_page ON)
else()
  find_program(NODE NAMES node nodejs)
  find_program(NPM npm)
  if(NODE)
    execute_process(COMMAND ${NODE} --version OUTPUT_VARIABLE node_version OUTPUT_STRIP_TRAILING_WHITESPACE)
  endif()
  if(NPM AND node_version MATCHES "^v([0-9]+)" AND CMAKE_MATCH_1 GREATER_EQUAL 18)
    set(has_page ON)
    file(GLOB report_sources CONFIGURE_DEPENDS tools/report/page/* tools/report/page/.npmrc tools/report/page/src/*)
    list(FILTER report_sources EXCLUDE REGEX "node_modules|/src$")
    set(report_folder report)
    add_custom_command(OUTPUT report/report.html
      COMMAND ${NODE} ${CMAKE_CURRENT_SOURCE_DIR}/tools/report/page/build.mjs report
      DEPENDS ${report_sources} VERBATIM)
  endif()
endif()
option(GLISS_REPORT "Build gliss report: needs npm with Node.js 18, and its registry at the first build" ${has_page})
if(GLISS_REPORT AND NOT has_page)
  message(FATAL_ERROR "GLISS_REPORT needs npm with Node.js 18 or later; here is ${NODE} ${node_version}")
elseif(GLISS_REPORT)
  add_custom_target(report_html DEPENDS ${report_folder}/report.html)  # by itself: may need the network
  add_custom_command(OUTPUT report_page_text.cpp
    COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/tools/embed_texts.py
      ${report_folder} report_page_text.cpp tools/report/report_page.h Page report.html
    DEPENDS ${report_folder}/report.html tools/embed_texts.py VERBATIM)
  target_sources(gliss_commands PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/report_page_text.cpp)
  target_compile_definitions(gliss_commands PRIVATE GLISS_WITH_REPORT)
elseif(NOT has_page)
  message(STATUS "No npm with Node.js 18 or later: gliss report is left out")
endif()
