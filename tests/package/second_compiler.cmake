# The whole project but its tests with the other compiler, warnings as errors. Not optimised: only the warnings matter.
include(${CMAKE_CURRENT_LIST_DIR}/nested.cmake)
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD} -G ${GENERATOR} -DCMAKE_C_COMPILER=${CC} -DCMAKE_CXX_COMPILER=${CXX}
    -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-O0 -DDFIELD_BUILD_TESTS=OFF -DDFIELD_WARNINGS_AS_ERRORS=ON)
run(${CMAKE_COMMAND} --build ${BUILD} --parallel 2)
