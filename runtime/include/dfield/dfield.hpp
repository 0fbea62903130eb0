// Header-only RAII over dfield.h for C++17 and later. Failing calls throw dfield::Exception; define
// DFIELD_NO_EXCEPTIONS to use the C functions directly instead.
#ifndef DFIELD_DFIELD_HPP
#define DFIELD_DFIELD_HPP

#include <memory>
#include <stdexcept>
#include <string>

#include "dfield/dfield.h"

namespace dfield {

class Exception : public std::runtime_error {
  public:
    Exception(dfield_status status, const std::string& message)
        : std::runtime_error(message), status_(status) {}
    dfield_status status() const noexcept { return status_; }

  private:
    dfield_status status_;
};

inline void check(dfield_status status) {
    if (status != DFIELD_OK) throw Exception(status, dfield_error_message());
}

namespace detail {
template<class T, void (*Release)(T*)>
struct Releaser {
    void operator()(T* object) const noexcept { Release(object); }
};
template<class T, void (*Release)(T*)>
using Handle = std::unique_ptr<T, Releaser<T, Release>>;
}  // namespace detail

class Context {
  public:
    explicit Context(const dfield_context_desc* desc = nullptr) {
        dfield_context* handle = nullptr;
        check(dfield_context_create(desc, &handle));
        handle_.reset(handle);
    }
    dfield_simd simd() const noexcept { return dfield_context_get_simd(handle_.get()); }
    dfield_context* get() const noexcept { return handle_.get(); }

  private:
    detail::Handle<dfield_context, dfield_context_release> handle_;
};

class Field {
  public:
    static Field load(const Context& context, const char* path) {
        dfield_field* handle = nullptr;
        check(dfield_field_load_file(context.get(), path, &handle));
        return Field(handle);
    }
    static Field load(const Context& context, const void* bytes, std::size_t size) {
        dfield_field* handle = nullptr;
        check(dfield_field_load_memory(context.get(), bytes, size, &handle));
        return Field(handle);
    }
    // A part of the file: `kinds` as in dfield_load_desc.
    static Field load(const Context& context, const void* bytes, std::size_t size, std::uint32_t kinds,
                      std::uint32_t direction_levels = 0) {
        dfield_load_desc desc{};
        desc.struct_size = sizeof desc;
        desc.kinds = kinds;
        desc.direction_levels = direction_levels;
        dfield_field* handle = nullptr;
        check(dfield_field_load_part(context.get(), &desc, bytes, size, &handle));
        return Field(handle);
    }
    dfield_field_info info() const {
        dfield_field_info result{};
        check(dfield_field_get_info(handle_.get(), &result));
        return result;
    }
    const float* self_visibility() const noexcept { return dfield_field_get_self_visibility(handle_.get()); }
    dfield_field* get() const noexcept { return handle_.get(); }

  private:
    explicit Field(dfield_field* handle) : handle_(handle) {}
    detail::Handle<dfield_field, dfield_field_release> handle_;
};

class Ao {
  public:
    static dfield_ao_desc defaults() noexcept {
        dfield_ao_desc desc;
        dfield_ao_desc_init(&desc);
        return desc;
    }
    explicit Ao(const Context& context, const dfield_ao_desc& desc = defaults()) {
        dfield_ao* handle = nullptr;
        check(dfield_ao_create(context.get(), &desc, &handle));
        handle_.reset(handle);
    }
    const float* directions() const noexcept { return dfield_ao_get_directions(handle_.get()); }
    std::size_t mask_words() const noexcept { return dfield_ao_get_mask_words(handle_.get()); }
    dfield_kind kind(const Field& field) const {
        dfield_kind result = DFIELD_KIND_AUTO;
        check(dfield_ao_get_kind(handle_.get(), field.get(), &result));
        return result;
    }
    // Visibility from masks; weights may be null. As dfield_ao_gather.
    void gather(const dfield_receivers& receivers, const std::uint32_t* masks, const float* weights,
                float* result) const {
        check(dfield_ao_gather(handle_.get(), &receivers, masks, 0, weights, result, 0));
    }
    dfield_ao* get() const noexcept { return handle_.get(); }

  private:
    detail::Handle<dfield_ao, dfield_ao_release> handle_;
};

// All members null: nothing is wanted yet.
inline dfield_outputs no_outputs() noexcept {
    dfield_outputs outputs{};
    outputs.struct_size = sizeof outputs;
    return outputs;
}

// The queries, of a scene or of a snapshot. Any number of threads may ask.
template<class Derived>
class Queries {
  public:
    void trace(const dfield_rays& rays, const dfield_hits& hits) const {
        check(dfield_scene_trace(scene(), &rays, &hits));
    }
    void occluded(const dfield_rays& rays, std::uint8_t* result) const {
        check(dfield_scene_occluded(scene(), &rays, result));
    }
    void ambient(const Ao& ao, const dfield_receivers& receivers, const dfield_outputs& outputs) const {
        check(dfield_scene_ambient(scene(), ao.get(), &receivers, &outputs));
    }
    void visibility(const Ao& ao, const dfield_receivers& receivers, float* result,
                    std::size_t stride = 0) const {
        check(dfield_scene_visibility(scene(), ao.get(), &receivers, result, stride));
    }
    void visibility_mask(const Ao& ao, const dfield_receivers& receivers, std::uint32_t* masks,
                         std::size_t stride = 0) const {
        check(dfield_scene_visibility_mask(scene(), ao.get(), &receivers, masks, stride));
    }

  private:
    const dfield_scene* scene() const noexcept { return static_cast<const Derived*>(this)->scene_handle(); }
};

// Shared: copies are the same snapshot.
class Snapshot : public Queries<Snapshot> {
  public:
    explicit Snapshot(dfield_snapshot* taken_over) noexcept : handle_(taken_over) {}
    Snapshot(const Snapshot& other) noexcept : handle_(other.get()) { dfield_snapshot_retain(other.get()); }
    Snapshot(Snapshot&&) noexcept = default;
    Snapshot& operator=(Snapshot other) noexcept {
        handle_.swap(other.handle_);
        return *this;
    }
    const dfield_scene* scene_handle() const noexcept { return dfield_snapshot_get_scene(handle_.get()); }
    dfield_snapshot* get() const noexcept { return handle_.get(); }

  private:
    detail::Handle<dfield_snapshot, dfield_snapshot_release> handle_;
};

// One thread edits; it may be queried while nobody does.
class Scene : public Queries<Scene> {
  public:
    explicit Scene(const Context& context) {
        dfield_scene* handle = nullptr;
        check(dfield_scene_create(context.get(), &handle));
        handle_.reset(handle);
    }
    dfield_instance add(const Field& field, const float* object_to_world) {
        dfield_instance instance = DFIELD_NO_INSTANCE;
        check(dfield_scene_add_instance(handle_.get(), field.get(), object_to_world, &instance));
        return instance;
    }
    void set_transform(dfield_instance instance, const float* object_to_world) {
        check(dfield_scene_set_transform(handle_.get(), instance, object_to_world));
    }
    void set_transforms(std::size_t count, const dfield_instance* instances, const float* object_to_world,
                        std::size_t stride = 0) {
        check(dfield_scene_set_transforms(handle_.get(), count, instances, object_to_world, stride));
    }
    void set_field(dfield_instance instance, const Field& field) {
        check(dfield_scene_set_field(handle_.get(), instance, field.get()));
    }
    void set_hidden(dfield_instance instance, bool hidden) {
        check(dfield_scene_set_hidden(handle_.get(), instance, hidden ? 1 : 0));
    }
    void remove(dfield_instance instance) { check(dfield_scene_remove_instance(handle_.get(), instance)); }
    void set_ground(const float* plane) { check(dfield_scene_set_ground(handle_.get(), plane)); }
    Snapshot commit() {
        dfield_snapshot* snapshot = nullptr;
        check(dfield_scene_commit(handle_.get(), &snapshot));
        return Snapshot(snapshot);
    }
    const dfield_scene* scene_handle() const noexcept { return handle_.get(); }
    dfield_scene* get() const noexcept { return handle_.get(); }

  private:
    detail::Handle<dfield_scene, dfield_scene_release> handle_;
};

// Receivers that stay from frame to frame. One thread at a time.
class ReceiverSet {
  public:
    // attached may be null, packed otherwise.
    ReceiverSet(const Context& context, const Ao& ao, const dfield_receivers& receivers,
                const dfield_instance* attached = nullptr) {
        dfield_receiver_set_desc desc{};
        desc.struct_size = sizeof desc;
        desc.ao = ao.get();
        desc.receivers = receivers;
        desc.attached = attached;
        dfield_receiver_set* handle = nullptr;
        check(dfield_receiver_set_create(context.get(), &desc, &handle));
        handle_.reset(handle);
    }
    dfield_update_stats update(const Snapshot& snapshot) {
        dfield_update_stats stats{};
        check(dfield_receiver_set_update(handle_.get(), snapshot.get(), &stats));
        return stats;
    }
    const float* visibility() const noexcept { return dfield_receiver_set_get_visibility(handle_.get()); }
    void outputs(const dfield_outputs& outputs, bool only_changed = false) const {
        check(dfield_receiver_set_get_outputs(handle_.get(), &outputs, only_changed ? 1 : 0));
    }
    dfield_receiver_set* get() const noexcept { return handle_.get(); }

  private:
    detail::Handle<dfield_receiver_set, dfield_receiver_set_release> handle_;
};

// Volumes: the C calls with exceptions. Arrays are the caller's, as in dfield/volume.h.
inline dfield_sweep_desc sweep_defaults() noexcept {
    dfield_sweep_desc desc;
    dfield_sweep_desc_init(&desc);
    return desc;
}
// All members null: nothing is wanted yet.
inline dfield_sweep_outputs no_sweep_outputs() noexcept {
    dfield_sweep_outputs outputs{};
    outputs.struct_size = sizeof outputs;
    return outputs;
}
inline dfield_sweep_times sweep_volume(const Context& context, const dfield_volume_samples& samples,
                                       const dfield_sweep_desc& desc, const dfield_sweep_outputs& outputs) {
    dfield_sweep_times times{};
    check(dfield_volume_sweep(context.get(), &samples, &desc, &outputs, &times));
    return times;
}
// A distance field at hand, in the caller's memory, and what can be asked of it at points.
class VolumeField {
  public:
    VolumeField(const Context& context, const dfield_volume_grid& grid, const float* distance) noexcept
        : context_(context.get()), grid_(grid), distance_(distance) {}
    void visibility_by_rays(const dfield_volume_points& points, std::uint32_t rays, std::uint64_t seed,
                            float* visibility) const {
        check(dfield_volume_visibility_by_rays(context_, &grid_, distance_, &points, rays, seed, visibility));
    }
    void gather_octants(const std::uint8_t* octants, const dfield_volume_points& points,
                        float* visibility) const {
        check(dfield_volume_gather_octants(context_, &grid_, distance_, octants, &points, visibility));
    }
    // Of any field on the grid; values and gradients may be null.
    void interpolate(const float* field, const dfield_volume_points& points, float* values,
                     float* gradients = nullptr) const {
        check(dfield_volume_interpolate(context_, &grid_, field, &points, values, gradients));
    }

  private:
    dfield_context* context_;
    dfield_volume_grid grid_;
    const float* distance_;
};

// Local ambient occlusion: the C calls with exceptions.
inline dfield_local_desc local_defaults() noexcept {
    dfield_local_desc desc;
    dfield_local_desc_init(&desc);
    return desc;
}
inline void local_ao_volume(const Context& context, const dfield_volume_samples& samples,
                            const dfield_opacity_desc& opacity, const dfield_local_desc& desc,
                            float* visibility) {
    check(dfield_volume_local_ao(context.get(), &samples, &opacity, &desc, visibility));
}

inline void local_ao_volume_clipped(const Context& context, const dfield_volume_samples& samples,
                                    const dfield_opacity_desc& opacity, const dfield_local_desc& desc,
                                    const dfield_clip* clips, std::size_t clip_count,
                                    std::uint32_t clip_samples, float* visibility) {
    check(dfield_volume_local_ao_clipped(context.get(), &samples, &opacity, &desc, clips, clip_count,
                                         clip_samples, visibility));
}

// A closed mesh to clip volumes with. Immutable.
inline dfield_clip_mesh_desc clip_mesh_defaults() noexcept {
    dfield_clip_mesh_desc desc;
    dfield_clip_mesh_desc_init(&desc);
    return desc;
}
class ClipMesh {
  public:
    ClipMesh(const Context& context, const dfield_clip_mesh_desc& desc) {
        dfield_clip_mesh* handle = nullptr;
        check(dfield_clip_mesh_create(context.get(), &desc, &handle));
        handle_.reset(handle);
    }
    dfield_clip_method method() const noexcept { return dfield_clip_mesh_get_method(handle_.get()); }
    std::uint32_t layers() const noexcept { return dfield_clip_mesh_get_layers(handle_.get()); }
    const dfield_clip_mesh* get() const noexcept { return handle_.get(); }

  private:
    detail::Handle<dfield_clip_mesh, dfield_clip_mesh_release> handle_;
};

// Contextual ambient occlusion from frame to frame. One thread at a time.
inline dfield_contextual_desc contextual_defaults() noexcept {
    dfield_contextual_desc desc;
    dfield_contextual_desc_init(&desc);
    return desc;
}
class Contextual {
  public:
    Contextual(const Context& context, const dfield_contextual_desc& desc) {
        dfield_contextual* handle = nullptr;
        check(dfield_contextual_create(context.get(), &desc, &handle));
        handle_.reset(handle);
    }
    std::uint32_t add(const dfield_clip& clip) {
        std::uint32_t id = 0;
        check(dfield_contextual_add_clip(handle_.get(), &clip, &id));
        return id;
    }
    void move(std::uint32_t id, const float mesh_to_world[16]) {
        check(dfield_contextual_move_clip(handle_.get(), id, mesh_to_world));
    }
    void remove(std::uint32_t id) { check(dfield_contextual_remove_clip(handle_.get(), id)); }
    void set_opacity(const dfield_opacity_desc& opacity) {
        check(dfield_contextual_set_opacity(handle_.get(), &opacity));
    }
    // desc may be null: until all is final.
    dfield_update_result update(const dfield_update_desc* desc = nullptr) {
        dfield_update_result result{};
        check(dfield_contextual_update(handle_.get(), desc, &result));
        return result;
    }
    const float* visibility() const noexcept { return dfield_contextual_get_visibility(handle_.get()); }
    const std::uint8_t* coverage() const noexcept { return dfield_contextual_get_coverage(handle_.get()); }
    dfield_contextual* get() const noexcept { return handle_.get(); }

  private:
    detail::Handle<dfield_contextual, dfield_contextual_release> handle_;
};

// Screen space: sample sets and memory that stays from frame to frame. One thread at a time.
inline dfield_screen_desc screen_defaults() noexcept {
    dfield_screen_desc desc;
    dfield_screen_desc_init(&desc);
    return desc;
}
// All members null and zero.
inline dfield_screen_buffers no_screen_buffers() noexcept {
    dfield_screen_buffers buffers{};
    buffers.struct_size = sizeof buffers;
    return buffers;
}
inline dfield_screen_outputs no_screen_outputs() noexcept {
    dfield_screen_outputs outputs{};
    outputs.struct_size = sizeof outputs;
    return outputs;
}
class Screen {
  public:
    explicit Screen(const Context& context, const dfield_screen_desc& desc = screen_defaults()) {
        dfield_screen* handle = nullptr;
        check(dfield_screen_create(context.get(), &desc, &handle));
        handle_.reset(handle);
    }
    void shade(const dfield_screen_buffers& buffers, const dfield_screen_outputs& outputs) {
        check(dfield_screen_shade(handle_.get(), &buffers, &outputs));
    }
    // pixels may be null: all; indirect may be null.
    void integral(const dfield_screen_buffers& buffers, const std::uint32_t* pixels, std::size_t count,
                  float* visibility, float* indirect = nullptr) {
        check(dfield_screen_integral(handle_.get(), &buffers, pixels, count, visibility, indirect));
    }
    dfield_screen* get() const noexcept { return handle_.get(); }

  private:
    detail::Handle<dfield_screen, dfield_screen_release> handle_;
};

}  // namespace dfield

#endif
