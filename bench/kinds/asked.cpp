#include "bench/kinds/asked.hpp"

namespace dfield::kinds {
namespace {

constexpr const char *kTimes = "%.1f ×", *kRatio = "%.2f ×", *kGrey = "%.2f", *kPercent = "%.2f%%",
                     *kKilobytes = "%.1f KB";

constexpr Asked kAsked[] = {
    {Figure::kMapsSpeedup,
     "displacement maps, 4226 × 32², bunny, any rays, against Embree",
     {true, 7, 20, kTimes}},
    {Figure::kLinesSpeedup,
     "line table, bunny at ≤ 2.2 grey, any rays, against Embree",
     {true, 25, 40, kTimes}},
    {Figure::kDirectionsSpeedup,
     "direction maps, bunny at ≤ 2.0 grey within 160 KB, against Embree",
     {true, 200, 500, kTimes}},
    {Figure::kDirectionsSpeedupAvx2, "the same with AVX2", {true, 80, {}, kTimes}},
    {Figure::kDirectionsSpeedupHole, "the same, cube with a hole", {true, 80, 250, kTimes}},
    {Figure::kDirectionsSpeedupMillion, "the same, a million triangles", {true, 600, 1500, kTimes}},
    {Figure::kSmallErrorBunny, "least error within 160 KB, bunny", {false, 2.0, 1.2, kGrey}},
    {Figure::kSmallErrorIgea, "least error within 160 KB, igea", {false, 1.35, 0.7, kGrey}},
    {Figure::kSmallErrorTree, "least error within 160 KB, lemon tree", {false, 3.4, 1.5, kGrey}},
    {Figure::kLargeErrorBunny, "least error within 600 KB, bunny", {false, 1.5, 0.8, kGrey}},
    {Figure::kLargeErrorIgea, "least error within 600 KB, igea", {false, 1.05, 0.5, kGrey}},
    {Figure::kLargeErrorTree, "least error within 600 KB, lemon tree", {false, 3.1, 1.0, kGrey}},
    {Figure::kNonUniformScale,
     "non-uniform scale, error against the unscaled instance's, worst kind",
     {false, 1.3, 1.1, kRatio}},
    {Figure::kMirroredScale, "mirrored scale, the same", {false, 1.3, 1.1, kRatio}},
    {Figure::kCrowdSpeedup,
     "100,000 receivers, 100 rotated bunnies, from scratch, against Embree",
     {true, 80, 400, kTimes}},
    {Figure::kCrowdError, "its error", {false, 2.0, {}, kGrey}},
    {Figure::kSwarmSpeedup,
     "20,000 receivers, 1,000 moving trees and bunnies, against Embree",
     {true, 80, 300, kTimes}},
    {Figure::kOneMoved, "one of them moved, against all from scratch", {false, 2, 0.5, kPercent}},
    {Figure::kFileBytes,
     "1-bit direction maps of the bunny on disk, 1026 × 64²",
     {false, 60, 30, kKilobytes}},
    {Figure::kTwoThreads, "two threads against one, 100 bunnies", {true, 1.8, {}, kRatio}},
};

}  // namespace

std::span<const Asked> asked() {
    return kAsked;
}

}  // namespace dfield::kinds
