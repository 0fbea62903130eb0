#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include "tests/test_data.hpp"

int main(int argc, char** argv) {
    const int failures = Catch::Session().run(argc, argv);
    if (failures != 0) return EXIT_FAILURE;
    return dfield::test::skipped ? 77 : EXIT_SUCCESS;
}
