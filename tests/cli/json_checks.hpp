// Checks of reports: that a key is there, of the right type, within sane bounds.
#pragma once

#include <catch2/catch.hpp>
#include <string>

#include "tests/cli/command.hpp"

namespace dfield::test {

// The number under `key`, which must lie in [low, high].
inline double number(const Json& json, const std::string& key, double low, double high) {
    INFO(key << " of " << json.dump());
    REQUIRE(json.contains(key));
    REQUIRE(json.at(key).is_number());
    const double value = json.at(key).get<double>();
    CHECK(value >= low);
    CHECK(value <= high);
    return value;
}

inline bool is_hash(const Json& json) {
    return json.is_string() && json.get<std::string>().size() == 32 &&
           json.get<std::string>().find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace dfield::test
