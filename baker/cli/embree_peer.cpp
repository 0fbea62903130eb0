#include "baker/cli/embree_peer.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>

#include "baker/parallel.hpp"

namespace dfield::cli {
namespace {

template<int kWidth>
struct PacketOf;
template<>
struct PacketOf<4> {
    using Type = RTCRay4;
    static constexpr auto kTrace = rtcOccluded4;
};
template<>
struct PacketOf<8> {
    using Type = RTCRay8;
    static constexpr auto kTrace = rtcOccluded8;
};
template<>
struct PacketOf<16> {
    using Type = RTCRay16;
    static constexpr auto kTrace = rtcOccluded16;
};

RTCIntersectContext context_for(const EmbreeMode& mode) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        mode.coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

// Seconds of the fastest of several runs over [0, count); `reset` is not counted.
template<class Reset, class Trace>
double fastest(int threads, int repetitions, std::size_t count, const Reset& reset, const Trace& trace) {
    double best = std::numeric_limits<double>::infinity();
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        reset();
        const auto start = std::chrono::steady_clock::now();
        if (threads == 1)
            trace(std::size_t{0}, count);
        else
            parallel_ranges(threads, count, 256, trace);
        best =
            std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return best;
}

double time_single(const EmbreeScene& scene, std::span<const PeerRay> rays, const EmbreeMode& mode,
                   int threads, int repetitions, std::vector<std::uint8_t>& occluded) {
    std::vector<RTCRay> prepared(rays.size());
    const auto reset = [&] {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const auto& [o, d] = rays[i];
            prepared[i] = {o.x, o.y, o.z, 0, d.x, d.y, d.z, 0, std::numeric_limits<float>::infinity(),
                           ~0u, 0,   0};
        }
    };
    const double seconds =
        fastest(threads, repetitions, rays.size(), reset, [&](std::size_t begin, std::size_t end) {
            RTCIntersectContext context = context_for(mode);
            for (std::size_t i = begin; i < end; ++i) rtcOccluded1(scene.get(), &context, &prepared[i]);
        });
    for (std::size_t i = 0; i < rays.size(); ++i) occluded[i] = prepared[i].tfar < 0;
    return seconds;
}

template<int kWidth>
double time_packets(const EmbreeScene& scene, std::span<const PeerRay> rays, const EmbreeMode& mode,
                    int threads, int repetitions, std::vector<std::uint8_t>& occluded) {
    using Packet = typename PacketOf<kWidth>::Type;
    struct alignas(64) Masks {
        std::array<int, kWidth> valid;
    };
    const std::size_t packets = (rays.size() + kWidth - 1) / kWidth;
    std::vector<Packet> prepared(packets);
    std::vector<Masks> masks(packets);
    const auto reset = [&] {
        for (std::size_t i = 0; i < packets * kWidth; ++i) {
            const bool real = i < rays.size();
            const PeerRay& ray = rays[real ? i : rays.size() - 1];
            set_ray(prepared[i / kWidth], i % kWidth, ray.origin, ray.direction, 0,
                    std::numeric_limits<float>::infinity());
            masks[i / kWidth].valid[i % kWidth] = real ? -1 : 0;
        }
    };
    const double seconds =
        fastest(threads, repetitions, packets, reset, [&](std::size_t begin, std::size_t end) {
            RTCIntersectContext context = context_for(mode);
            for (std::size_t i = begin; i < end; ++i)
                PacketOf<kWidth>::kTrace(masks[i].valid.data(), scene.get(), &context, &prepared[i]);
        });
    for (std::size_t i = 0; i < rays.size(); ++i) occluded[i] = prepared[i / kWidth].tfar[i % kWidth] < 0;
    return seconds;
}

}  // namespace

std::string EmbreeMode::name() const {
    return "rtcOccluded" + std::to_string(width) + (coherent ? " coherent" : " incoherent");
}

std::span<const EmbreeMode> embree_modes(bool instanced) {
    static constexpr std::array<EmbreeMode, 7> kModes{
        {{16, false}, {8, false}, {4, false}, {1, false}, {16, true}, {8, true}, {4, true}}};
    const std::span<const EmbreeMode> all(kModes);
    return instanced ? all.first(4) : all;  // the incoherent ones come first
}

double time_occluded(const EmbreeScene& scene, std::span<const PeerRay> rays, const EmbreeMode& mode,
                     int threads, int repetitions, std::vector<std::uint8_t>& occluded) {
    occluded.assign(rays.size(), 0);
    if (rays.empty()) return 0;
    switch (mode.width) {
        case 1:
            return time_single(scene, rays, mode, threads, repetitions, occluded);
        case 4:
            return time_packets<4>(scene, rays, mode, threads, repetitions, occluded);
        case 8:
            return time_packets<8>(scene, rays, mode, threads, repetitions, occluded);
        default:
            return time_packets<16>(scene, rays, mode, threads, repetitions, occluded);
    }
}

}  // namespace dfield::cli
