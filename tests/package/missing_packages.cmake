# A library that is missing at configure time is named with its Debian package, all of them in one message, and each
# is a package that scripts/install-deps installs.
include(${CMAKE_CURRENT_LIST_DIR}/nested.cmake)
execute_process(COMMAND ${SOURCE}/scripts/install-deps --list OUTPUT_VARIABLE installed COMMAND_ERROR_IS_FATAL ANY)

function(expect_error options packages)
  file(REMOVE_RECURSE ${BUILD})
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD} -G ${GENERATOR} ${options}
                  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(result EQUAL 0)
    message(FATAL_ERROR "configured without ${packages} (${options})")
  endif()
  string(REGEX MATCHALL "\n +[a-z0-9-]+  \\(" named "${output}")
  list(TRANSFORM named REPLACE "[ \n(]" "")
  set(sorted ${packages})
  list(SORT sorted)
  list(REMOVE_DUPLICATES named)
  list(SORT named)
  if(NOT named STREQUAL sorted)
    message(FATAL_ERROR "expected the packages '${sorted}', got '${named}':\n${output}")
  endif()
  foreach(package IN LISTS packages)
    if(NOT installed MATCHES "(^|\n)${package}\n")
      message(FATAL_ERROR "scripts/install-deps does not install ${package}")
    endif()
  endforeach()
endfunction()

expect_error(-DCMAKE_DISABLE_FIND_PACKAGE_embree=ON libembree-dev)

# Nothing anywhere: no header, no library, no CMake package.
set(nothing -DCMAKE_FIND_ROOT_PATH=${BUILD}/nowhere)
foreach(kind IN ITEMS INCLUDE LIBRARY PACKAGE)
  list(APPEND nothing -DCMAKE_FIND_ROOT_PATH_MODE_${kind}=ONLY)
endforeach()
set(runtime libzstd-dev libhwy-dev libxxhash-dev libglm-dev)
set(baker libembree-dev libopenmesh-dev libtinygltf-dev libtbb-dev nlohmann-json3-dev libcli11-dev libstb-dev
    libteem-dev libnifti2-dev zlib1g-dev libopenexr-dev)
expect_error("${nothing}" "${runtime};${baker};catch2")
expect_error("${nothing};-DDFIELD_BUILD_BAKER=OFF;-DDFIELD_BUILD_TESTS=OFF" "${runtime}")
