// What a chapter asks of the project, beside what was measured.
#pragma once

#include <optional>
#include <string>

#include "bench/common/page.hpp"

namespace dfield::bench {

struct Bound {
    bool at_least;  // otherwise at most
    double limit;
    std::optional<double> aim;
    const char* format;  // printf, of one double

    bool holds(double bound, double measured) const {
        return at_least ? measured >= bound : measured <= bound;
    }
};

// Columns: the name, "asked", "aim", "measured", "met".
class AskedTable {
  public:
    explicit AskedTable(const std::string& name) : table_({name, "asked", "aim", "measured", "met"}) {}

    void row(const std::string& what, const Bound& bound, double measured);
    // Loud: what was not measured, and why.
    void missing(const std::string& what, const Bound& bound, const std::string& why);

    const Table& table() const { return table_; }

  private:
    Table table_;
};

}  // namespace dfield::bench
