# Installs BUILD, moves the installation elsewhere, and lets tests/consumer use it there through find_package and
# through pkg-config.
include(${CMAKE_CURRENT_LIST_DIR}/nested.cmake)
file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/staged)
file(RENAME ${WORK}/staged ${WORK}/prefix)

run(${CMAKE_COMMAND} -S ${SOURCE}/tests/consumer -B ${WORK}/cmake -G ${GENERATOR} -DCMAKE_BUILD_TYPE=${BUILD_TYPE}
    -DCMAKE_PREFIX_PATH=${WORK}/prefix -DFIELD=${FIELD})
run(${CMAKE_COMMAND} --build ${WORK}/cmake)
run(${CMAKE_CTEST_COMMAND} --test-dir ${WORK}/cmake --output-on-failure)
file(STRINGS ${WORK}/cmake/CMakeCache.txt found REGEX "^dfield_DIR:")
if(NOT found MATCHES "${WORK}/prefix")
  message(FATAL_ERROR "the consumer has found another dfield: ${found}")
endif()

file(GLOB_RECURSE pc ${WORK}/prefix/*/dfield.pc)
find_program(make NAMES gmake make)
find_program(pkg_config NAMES pkg-config pkgconf)
if(NOT pc OR NOT make OR NOT pkg_config)
  message(FATAL_ERROR "no dfield.pc, make or pkg-config: '${pc}' '${make}' '${pkg_config}'")
endif()
get_filename_component(pc_folder ${pc} DIRECTORY)
file(MAKE_DIRECTORY ${WORK}/make)
run(${CMAKE_COMMAND} -E chdir ${WORK}/make ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${pc_folder}
    ${make} -f ${SOURCE}/tests/consumer/Makefile VPATH=${SOURCE}/tests/consumer FIELD=${FIELD} check)

# The installed command starts without help from the environment.
if(EXISTS ${WORK}/prefix/bin/dfield)
  run(${CMAKE_COMMAND} -E env --unset=LD_LIBRARY_PATH ${WORK}/prefix/bin/dfield --version)
endif()
