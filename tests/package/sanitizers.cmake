# The tests of malformed files and models once more, under AddressSanitizer and UndefinedBehaviorSanitizer.
include(${CMAKE_CURRENT_LIST_DIR}/nested.cmake)
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD} -G ${GENERATOR} -DDFIELD_SANITIZE=ON -DDFIELD_WARNINGS_AS_ERRORS=ON)
run(${CMAKE_COMMAND} --build ${BUILD} --parallel 2 --target dfield_robust_tests)
execute_process(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir ${BUILD} -L robust --no-tests=error --output-on-failure -j 2
                COMMAND_ERROR_IS_FATAL ANY)
