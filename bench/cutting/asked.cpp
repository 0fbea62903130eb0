#include "bench/cutting/asked.hpp"

namespace dfield::cutting {
namespace {

constexpr const char *kRate = "%.1f G/s", *kTimes = "%.1f ×", *kRatio = "%.2f ×", *kSeconds = "%.2f s",
                     *kPercent = "%.1f%%", *kRms = "%.5f", *kVolumes = "%.2f volumes";
constexpr const char *kScan = "its scan was not there, or its piece was left out",
                     *kPiece = "left out of this run";

constexpr volumes::Asked kAsked[] = {
    {"/haze/rate", "LAO, dense haze, 54 rays, samples", {true, 6, 10, kRate}, kPiece},
    {"/haze/against_scalar", "the same against the plain scalar loop", {true, 30, {}, kTimes}, kPiece},
    {"/engine/rays/54/gsamples", "LAO, engine, effective samples", {true, 14, 40, kRate}, kScan},
    {"/skeleton/two_threads", "512³, M = 50, 54 rays, two threads, exact", {false, 8, 1.9, kSeconds}, kScan},
    {"/approximate/skeleton/two_threads/approximate",
     "the same, approximate",
     {false, 8, 1.9, kSeconds},
     kScan},
    {"/approximate/skeleton/speedup", "approximate against exact, one core", {true, 2, 4, kRatio}, kScan},
    {"/approximate/skeleton/rms", "its RMS", {false, 5e-4, {}, kRms}, kScan},
    {"/engine/rays/54/speedup", "CAO over LAO, engine, its mask 14.94% dilated", {true, 4, 8, kTimes}, kScan},
    {"/beetle/rays/54/speedup", "the same, beetle's size, 20.24%", {true, 4, 8, kTimes}, kScan},
    {"/skeleton/rays/54/speedup", "the same, skeleton's size, 16.13%", {true, 4, 8, kTimes}, kScan},
    {"/moving/sparse",
     "CAO, clip moving 1.5 voxels a frame, sparser volumes, the worse",
     {true, 8, 20, kTimes},
     kPiece},
    {"/engine/rays/54/slowdown", "second clip mesh, engine", {false, 12, 5, kPercent}, kScan},
    {"/beetle/rays/54/slowdown", "the same, beetle's size", {false, 12, 5, kPercent}, kScan},
    {"/skeleton/rays/54/slowdown", "the same, skeleton's size", {false, 12, 5, kPercent}, kScan},
    {"/accuracy/worst/6", "RMS against 512 rays: 6 rays, worst scene", {false, 0.03907, {}, kRms}, kScan},
    {"/accuracy/worst/14", "14 rays", {false, 0.01205, {}, kRms}, kScan},
    {"/accuracy/worst/26", "26 rays", {false, 9.759e-3, {}, kRms}, kScan},
    {"/accuracy/worst/54", "54 rays", {false, 6.937e-3, {}, kRms}, kScan},
    {"/accuracy/better/54",
     "RMS of the better set of 54 to that of the paper's, worst scene",
     {false, 1, {}, kRatio},
     kScan},
    {"/engine/memory", "memory, engine", {false, 5, 3, kVolumes}, kScan},
    {"/skeleton/memory", "memory, 512³", {false, 5, 3, kVolumes}, kScan},
};

}  // namespace

std::span<const volumes::Asked> asked() {
    return kAsked;
}

}  // namespace dfield::cutting
