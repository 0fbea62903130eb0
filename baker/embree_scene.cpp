#include "baker/embree_scene.hpp"

#include <cstdlib>
#include <glm/vec4.hpp>
#include <map>
#include <mutex>
#include <new>

#include "baker/error.hpp"
#include "baker/parallel.hpp"

namespace dfield {
namespace {

// One device for each configuration, for the life of the process: making one costs milliseconds, and scenes
// of one device can be instanced in each other.
struct Device {
    RTCDevice device = nullptr;
    std::string instruction_set;
};

const Device& device_for(EmbreeUse use) {
    static std::mutex mutex;
    static std::map<std::string, Device> devices;
    const std::string isa = use == EmbreeUse::kBake ? bake_instruction_set() : std::string();
    const std::lock_guard lock(mutex);
    Device& entry = devices[isa];
    if (!entry.device) {
        // threads: a bound only; commit runs in our own arena.
        const std::string config = isa.empty() ? "threads=0" : "threads=0,isa=" + isa;
        entry.device = rtcNewDevice(config.c_str());
        if (!entry.device)
            throw Error(ExitCode::kInternal, "Embree could not start with " + config + " (error " +
                                                 std::to_string(rtcGetDeviceError(nullptr)) + ")");
        entry.instruction_set = isa.empty() ? "native" : isa;
    }
    return entry;
}

}  // namespace

std::string bake_instruction_set() {
    // For the test that bakes with every instruction set of this machine and compares the payloads.
    if (const char* forced = std::getenv("DFIELD_BAKE_ISA")) return forced;
#if defined(__x86_64__) || defined(_M_X64)
    // Without fused multiply-add, so that SSE, which Embree falls back to on older machines, gives the same
    // hits.
    return "avx";
#else
    return {};
#endif
}

EmbreeScene::EmbreeScene(EmbreeUse use) : use_(use) {
    const Device& device = device_for(use);
    device_ = device.device;
    instruction_set_ = device.instruction_set;
    scene_ = rtcNewScene(device_);
    if (!scene_) throw std::bad_alloc();
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneFlags(scene_, use == EmbreeUse::kBake ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
}

EmbreeScene::~EmbreeScene() {
    rtcReleaseScene(scene_);
}

unsigned EmbreeScene::add_mesh(const TriangleMesh& mesh, const glm::mat4& transform) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions.size()));
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh.triangles.size()));
    if (!positions || !indices) {
        rtcReleaseGeometry(geometry);
        throw std::bad_alloc();
    }
    for (const glm::vec3& position : mesh.positions) {
        const glm::vec3 moved(transform * glm::vec4(position, 1));
        for (int axis = 0; axis < 3; ++axis) *positions++ = moved[axis];
    }
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner) *indices++ = triangle[corner];
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
    rtcCommitGeometry(geometry);
    const unsigned id = rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    return id;
}

unsigned EmbreeScene::add_instance(const EmbreeScene& scene, const glm::mat4& transform) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, scene.scene_);
    rtcSetGeometryTimeStepCount(geometry, 1);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &transform[0][0]);
    rtcCommitGeometry(geometry);
    const unsigned id = rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    return id;
}

void EmbreeScene::commit(int threads) {
    parallel_ranges(threads, 1, 1, [&](std::size_t, std::size_t) { rtcJoinCommitScene(scene_); });
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
        if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
        throw Error(ExitCode::kInternal,
                    "Embree could not build the scene (error " + std::to_string(error) + ")");
    }
}

}  // namespace dfield
