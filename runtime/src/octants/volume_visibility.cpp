#include "octants/volume_visibility.hpp"

#include <array>

#include "kind.hpp"
#include "octants/volume_caster.hpp"
#include "receivers.hpp"

namespace dfield::runtime {
namespace {

constexpr std::size_t kCallBlocks = 16;  // that share what is prepared of an instance

struct Block {
    VolumeBlock receivers;
    std::array<std::size_t, kVolumeBlock> index;  // of the caller's
    std::array<dfield_instance, kVolumeBlock> owner;
    alignas(64) std::array<float, kVolumeBlock> product;
};

// Takes usable receivers from `next` on.
void fill(const ReceiverReader& reader, std::size_t end, std::size_t& next, Block& block) {
    VolumeBlock& r = block.receivers;
    r.count = 0;
    for (; next < end && r.count < kVolumeBlock; ++next) {
        const UnitReceiver receiver = reader[next];
        if (!receiver.usable()) continue;
        const std::size_t i = r.count++;
        r.x[i] = receiver.position.x, r.y[i] = receiver.position.y, r.z[i] = receiver.position.z;
        r.nx[i] = receiver.normal.x, r.ny[i] = receiver.normal.y, r.nz[i] = receiver.normal.z;
        block.index[i] = next;
        block.owner[i] = receiver.owner;
    }
    for (std::size_t i = r.count; i < kVolumeBlock; ++i) {
        r.x[i] = r.y[i] = r.z[i] = r.nx[i] = r.ny[i] = 0;
        r.nz[i] = 1;
    }
    block.product.fill(1);
}

}  // namespace

VolumeShare volume_share(const SceneState& scene, const dfield_ao& ao) {
    bool some = false, all = !scene.ground;
    for (const dfield_instance id : scene.active) {
        const bool answers = kind_for(ao, *scene.instances[id].field) == DFIELD_KIND_VOLUME;
        some |= answers;
        all &= answers;
    }
    return !some ? VolumeShare::kNone : all ? VolumeShare::kAll : VolumeShare::kSome;
}

void multiply_volume_visibility(const SceneState& scene, const dfield_ao& ao,
                                const dfield_receivers& receivers, const Strided<float>& visibility) {
    VolumeKernel* const kernel = volume_kernel(scene.context()->simd_targets);
    const ReceiverReader reader(receivers);
    std::array<Block, kCallBlocks> blocks;
    for (std::size_t next = 0; next < receivers.count;) {
        std::size_t used = 0;
        while (used < kCallBlocks && next < receivers.count)
            fill(reader, receivers.count, next, blocks[used++]);
        for (const dfield_instance id : scene.active) {
            const Instance& instance = scene.instances[id];
            if (kind_for(ao, *instance.field) != DFIELD_KIND_VOLUME) continue;
            const VolumeCaster caster(instance);
            for (std::size_t b = 0; b < used; ++b) {
                Block& block = blocks[b];
                alignas(64) std::array<float, kVolumeBlock> open;
                kernel(caster, block.receivers, open.data());
                for (std::size_t i = 0; i < block.receivers.count; ++i)
                    if (block.owner[i] != id) block.product[i] *= open[i];
            }
        }
        for (std::size_t b = 0; b < used; ++b)
            for (std::size_t i = 0; i < blocks[b].receivers.count; ++i)
                *visibility.at(blocks[b].index[i]) *= blocks[b].product[i];
    }
}

}  // namespace dfield::runtime
