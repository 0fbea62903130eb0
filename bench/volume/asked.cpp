#include "bench/volume/asked.hpp"

namespace dfield::volumes {
namespace {

constexpr const char *kTimes = "%.1f ×", *kRatio = "%.2f ×", *kPercent = "%.0f%%", *kRms = "%.3f",
                     *kRate = "%.0f M/s", *kBytes = "%.1f bytes";
constexpr const char *kOpenVdb = "no OpenVDB in this build", *kBonsai = "no bonsai",
                     *kPiece = "left out of this run";

constexpr Asked kAsked[] = {
    {"/distance/against_openvdb",
     "250³ distance field, all in, against OpenVDB's `fogToSdf`, one thread",
     {true, 60, 120, kTimes},
     kOpenVdb},
    {"/distance/against_scalar", "the same against the scalar reference", {true, 10, {}, kTimes}, kPiece},
    {"/table2/overhead_octants",
     "overhead of 8-octant occlusion over the distance field, 250³",
     {false, 40, 20, kPercent},
     kPiece},
    {"/bonsai/rate_paper", "bonsai 256³, paper's form, all in, voxels", {true, 60, 120, kRate}, kBonsai},
    {"/accuracy_of_scans/bonsai/forms/improved/rms",
     "RMS on it, improved form",
     {false, 0.06, {}, kRms},
     kBonsai},
    {"/accuracy_of_scans/bonsai/improved_over_paper",
     "the same against the paper's form",
     {false, 1, {}, kRatio},
     kBonsai},
    {"/table2/overhead_improved", "overhead of the improved form, 250³", {false, 120, 60, kPercent}, kPiece},
    {"/scale/ratio", "cost per voxel, 512³ against 128³, worst job", {false, 1.25, 1.05, kRatio}, kPiece},
    {"/threads/ratio", "two threads against one, 250³, worst job", {true, 1.7, 1.9, kRatio}, kPiece},
    {"/accuracy/gyroid/forms/paper/rms",
     "RMS, gyroid, paper's form: as published, no better",
     {true, 0.10, {}, kRms},
     kPiece},
    {"/accuracy/floor/forms/paper/rms",
     "RMS, floor with boxes, paper's form: likewise",
     {true, 0.33, {}, kRms},
     kPiece},
    {"/accuracy/gyroid/forms/improved/rms", "RMS, gyroid, improved form", {false, 0.03, 0.015, kRms}, kPiece},
    {"/accuracy/floor/forms/improved/rms",
     "RMS, floor with boxes, improved form",
     {false, 0.06, 0.03, kRms},
     kPiece},
    {"/sphere/rms",
     "distance error within 5 voxels of a sphere, worst radius, voxels",
     {false, 0.11, 0.05, kRms},
     kPiece},
    {"/memory/octants_bytes_a_voxel",
     "peak memory for distances and 8 octants, 512³, a voxel",
     {false, 40, 14, kBytes},
     kPiece},
};

}  // namespace

std::span<const Asked> asked() {
    return kAsked;
}

}  // namespace dfield::volumes
