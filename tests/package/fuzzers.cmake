# The libFuzzer targets, with clang and its sanitizers, for a short run each.
include(${CMAKE_CURRENT_LIST_DIR}/nested.cmake)
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD} -G ${GENERATOR} -DCMAKE_C_COMPILER=${CC} -DCMAKE_CXX_COMPILER=${CXX}
    -DDFIELD_FUZZ=ON -DDFIELD_SANITIZE=ON -DDFIELD_BUILD_TESTS=ON -DDFIELD_BUILD_EXAMPLES=OFF)
run(${CMAKE_COMMAND} --build ${BUILD} --parallel 2 --target dfield_fuzzers)
execute_process(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir ${BUILD} -R "^fuzz_" --no-tests=error --output-on-failure
                COMMAND_ERROR_IS_FATAL ANY)
