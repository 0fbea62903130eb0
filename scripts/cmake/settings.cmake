# Language level, warnings, sanitizers and ccache: what every target of the project shares.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 99)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_C_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

find_program(DFIELD_CCACHE ccache DOC "Compiler cache, used when there is one")
mark_as_advanced(DFIELD_CCACHE)
if(DFIELD_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${DFIELD_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${DFIELD_CCACHE})
endif()

# What every own target is compiled with. -ffp-contract=off: bakes must not depend on whether a compiler fuses.
add_library(dfield_settings INTERFACE)
target_include_directories(dfield_settings INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_definitions(dfield_settings INTERFACE GLM_FORCE_CXX17)
if(MSVC)
  target_compile_options(dfield_settings INTERFACE /W4 /fp:precise $<$<BOOL:${DFIELD_WARNINGS_AS_ERRORS}>:/WX>)
else()
  target_compile_options(dfield_settings INTERFACE -Wall -Wextra -ffp-contract=off)
  if(DFIELD_WARNINGS_AS_ERRORS)
    target_compile_options(dfield_settings INTERFACE -Werror)
  endif()
  if(DFIELD_SANITIZE)
    # -O1 after the build type's own level: fast enough for thousands of malformed files, with usable traces. With the
    # sanitizers g++ warns of uninitialised members deep in its own <regex> and <functional>.
    target_compile_options(dfield_settings INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all
                           -fno-omit-frame-pointer -O1 -g1 -UNDEBUG
                           $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    target_link_options(dfield_settings INTERFACE -fsanitize=address,undefined)
  endif()
endif()
