// The kernel where nothing can be skipped and no ray ends early, against the plain scalar loop.
#include <algorithm>

#include "bench/common/turns.hpp"
#include "bench/cutting/pieces.hpp"
#include "bench/cutting/stage.hpp"
#include "bench/volume/jobs.hpp"

namespace dfield::cutting {

Json measure_haze(Lab& lab) {
    const std::uint32_t n = lab.stock.size(96);
    const Scene scene{.name = "haze",
                      .volume = volumes::timed_subject(n).volume,
                      .transfer = transfer_function(lab, "haze")};
    const Stage vectors(scene, 54), scalar(scene, 54, 1, volumes::capped(DFIELD_SIMD_SCALAR));
    std::vector<float> visibility;
    const std::vector<double> seconds = bench::fastest_turns(
        std::array<std::function<void()>, 2>{[&] {
                                                 // As long as the other's turn is, or nearly.
                                                 for (int i = 0; i < lab.stock.rounds(10); ++i)
                                                     vectors.lao(visibility);
                                             },
                                             [&] { scalar.lao(visibility); }},
        lab.stock.rounds(2));
    const double once = seconds[0] / lab.stock.rounds(10);
    return {{"size", n},
            {"rate", vectors.gsamples() / once},
            {"scalar_rate", scalar.gsamples() / seconds[1]},
            {"against_scalar", seconds[1] / once}};
}

void write_haze(const Json& all, bench::Page& page) {
    const Json& figures = all["haze"];
    page.heading(3, "The kernel alone");
    page.paragraph(
        text("A gyroid of bytes, %u³, through `haze.json`: opacities of 0.01 to 0.06 everywhere, so that "
             "every sample "
             "of "
             "54 rays of 20 is taken. G samples a second: %.2f, the plain scalar loop %.3f.",
             figures["size"].get<unsigned>(), figures["rate"].get<double>(),
             figures["scalar_rate"].get<double>()));
}

}  // namespace dfield::cutting
