# carom_room(<name> [DIR <dir>] [PUBLIC <targets>...] [PRIVATE <targets>...])
#
# One room: a static library `carom::<name>` of every source in the folder and in its detail/, with the folder's public
# headers as a file set. Users write `#include <carom/<dir>/x.hpp>`; a symbolic link in the build tree makes that true,
# so headers stay beside their sources and install needs nothing more.
set(CAROM_INCLUDE_DIR ${PROJECT_BINARY_DIR}/include)

function(carom_room name)
  cmake_parse_arguments(PARSE_ARGV 1 room "" "DIR" "PUBLIC;PRIVATE")
  if(NOT room_DIR)
    set(room_DIR ${name})
  endif()
  file(GLOB sources CONFIGURE_DEPENDS *.cpp detail/*.cpp)
  file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.hpp)
  string(REGEX MATCH "^[^/]+" top ${room_DIR})
  file(MAKE_DIRECTORY ${CAROM_INCLUDE_DIR}/carom)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${top} ${CAROM_INCLUDE_DIR}/carom/${top} SYMBOLIC)
  list(TRANSFORM headers PREPEND ${CAROM_INCLUDE_DIR}/carom/${room_DIR}/)

  # Packages of headers only that our sources alone use: a project that links an installed room does not need them.
  list(TRANSFORM room_PRIVATE REPLACE "^(Eigen3::Eigen|nlohmann_json::nlohmann_json)$" "$<BUILD_INTERFACE:\\1>")

  add_library(carom_${name} STATIC ${sources})
  add_library(carom::${name} ALIAS carom_${name})
  set_target_properties(carom_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(carom_${name} PUBLIC cxx_std_20)
  target_sources(carom_${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${CAROM_INCLUDE_DIR} FILES ${headers})
  target_link_libraries(carom_${name} PUBLIC ${room_PUBLIC} PRIVATE ${room_PRIVATE})
  set_property(TARGET carom_${name} PROPERTY VERIFY_INTERFACE_HEADER_SETS ${PROJECT_IS_TOP_LEVEL})
  carom_own_flags(carom_${name})
  carom_lanes_flags(${sources})
  set_property(GLOBAL APPEND PROPERTY CAROM_LIBRARIES carom_${name})
endfunction()

# One function of a wide kernel holds hundreds of registers' worth of temporaries, which GCC guards one by one under AddressSanitizer: some
# kernels take it minutes, seconds without. What they read and write outside of their own frames stays guarded, and UndefinedBehaviorSanitizer
# checks the indices of arrays in them.
function(carom_lanes_flags)
  if(NOT (PROJECT_IS_TOP_LEVEL AND CAROM_SANITIZE MATCHES "address" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU"))
    return()
  endif()
  foreach(source IN LISTS ARGN)
    file(STRINGS ${source} targets REGEX "hwy/foreach_target.h" LIMIT_COUNT 1)
    if(targets)
      set_property(SOURCE ${source} APPEND PROPERTY COMPILE_OPTIONS --param=asan-stack=0)
    endif()
  endforeach()
endfunction()

# Flags for our own sources only; nothing here reaches a project that links us.
function(carom_own_flags target)
  # Bit-identical results need every product and sum rounded on its own. GCC 12 besides drops (double)(float)x when it
  # vectorises straight-line code, so that pass is off.
  target_compile_options(${target} PRIVATE -ffp-contract=off $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)
  if(PROJECT_IS_TOP_LEVEL)
    target_compile_options(${target} PRIVATE
      -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion -Wold-style-cast $<$<BOOL:${CAROM_WERROR}>:-Werror>
      $<$<CXX_COMPILER_ID:Clang>:-Wno-double-promotion>)  # which counts double{x} as one
    if(CAROM_SANITIZE)
      target_compile_options(${target} PRIVATE -fsanitize=${CAROM_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
      target_link_options(${target} PUBLIC $<BUILD_INTERFACE:-fsanitize=${CAROM_SANITIZE}>)
    endif()
  endif()
  if(CAROM_ASSERT)
    target_compile_definitions(${target} PRIVATE CAROM_ENABLE_ASSERT)
  endif()
endfunction()

# A program of ours, in <build>/bin.
function(carom_program name)
  cmake_parse_arguments(PARSE_ARGV 1 program "" "" "SOURCES;LINK")
  add_executable(${name} ${program_SOURCES})
  target_link_libraries(${name} PRIVATE ${program_LINK})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  carom_own_flags(${name})
endfunction()
