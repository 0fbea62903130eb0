// The closed forms of h against quadrature.
#include "screen/pipe.hpp"

#include <catch2/catch.hpp>

#include "tests/random.hpp"

using namespace dfield::runtime::screen;

namespace {

// By 20,000 trapezia in t = rho tan(theta), where the integrand has no peak.
double by_trapezia(const Measure& measure, const Pipe& pipe, double low, double high) {
    constexpr int kSteps = 20000;
    const double rho = std::sqrt(static_cast<double>(pipe.rho2));
    const double from = std::atan(low / rho), to = std::atan(high / rho);
    double sum = 0;
    for (int i = 0; i <= kSteps; ++i) {
        const double theta = from + (to - from) * i / kSteps, t = rho * std::tan(theta),
                     r = rho / std::cos(theta);
        const double term = static_cast<double>(measure.derivative(static_cast<float>(r))) / (r * r * r) *
                            (static_cast<double>(pipe.a) + static_cast<double>(pipe.b) * t) * rho /
                            (std::cos(theta) * std::cos(theta));
        sum += i == 0 || i == kSteps ? term / 2 : term;
    }
    return sum * (to - from) / kSteps;
}

}  // namespace

TEST_CASE("Integrals along pipes are those of quadrature", "[screen]") {
    dfield::test::Random random(7);
    for (int i = 0; i < 40; ++i) {
        const double rho = random.uniform(0.05, 0.95), half = std::sqrt(1 - rho * rho);
        Shaded s{};
        s.sight_2 = 1;
        s.pixel_x = s.pixel_y = 1;
        s.normal = {0, 0, 1};
        Pipe pipe(s, static_cast<float>(rho), 0, 0);
        pipe.a = static_cast<float>(random.uniform(-1, 1));
        pipe.b = static_cast<float>(random.uniform(0, 1));
        const double low = random.uniform(-half, half), high = random.uniform(low, half);
        for (std::uint32_t kind = 0; kind <= DFIELD_MEASURE_EXPONENTIAL; ++kind) {
            const Measure measure{static_cast<dfield_fuzzy_measure>(kind),
                                  static_cast<float>(random.uniform(0.5, 4))};
            const double expected = by_trapezia(measure, pipe, low, high);
            INFO("kind " << kind << " rho " << rho << " from " << low << " to " << high);
            CHECK(static_cast<double>(
                      pipe_integral(measure, pipe, static_cast<float>(low), static_cast<float>(high))) ==
                  Approx(expected).epsilon(1e-3).margin(1e-4));
        }
        CHECK(pipe_integral(Measure{}, pipe, 0.5f, 0.5f) == 0);
    }
}

TEST_CASE("Inverses and derivatives of measures", "[screen]") {
    for (std::uint32_t kind = 0; kind <= DFIELD_MEASURE_EXPONENTIAL; ++kind) {
        const Measure measure{static_cast<dfield_fuzzy_measure>(kind), 2.5f};
        double total = 0;
        for (int i = 0; i < 1000; ++i) {
            const float r = (static_cast<float>(i) + 0.5f) / 1000;
            CHECK(measure.inverse(measure.value(r)) == Approx(r).margin(1e-5));
            CHECK(measure.derivative(r) ==
                  Approx((measure.value(r + 5e-4f) - measure.value(r - 5e-4f)) / 1e-3f).margin(2e-3));
            total += 2 * static_cast<double>(measure.value(r)) / 1000;
        }
        CHECK(static_cast<double>(measure.tangent_total()) == Approx(total).margin(1e-5));
    }
}
