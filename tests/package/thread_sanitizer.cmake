# Queries of snapshots beside edits, and the thread adapter, once more under ThreadSanitizer.
include(${CMAKE_CURRENT_LIST_DIR}/nested.cmake)
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD} -G ${GENERATOR} -DDFIELD_SANITIZE=thread -DDFIELD_BUILD_BAKER=OFF
    -DDFIELD_BUILD_TESTS=ON -DDFIELD_BUILD_EXAMPLES=OFF)
run(${CMAKE_COMMAND} --build ${BUILD} --parallel 2 --target test_threads)
execute_process(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir ${BUILD} -R "^threads$" --no-tests=error --output-on-failure
                COMMAND_ERROR_IS_FATAL ANY)
