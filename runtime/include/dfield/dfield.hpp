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
    dfield_ao* get() const noexcept { return handle_.get(); }

  private:
    detail::Handle<dfield_ao, dfield_ao_release> handle_;
};

class Scene {
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
    void remove(dfield_instance instance) { check(dfield_scene_remove_instance(handle_.get(), instance)); }
    void set_ground(const float* plane) { check(dfield_scene_set_ground(handle_.get(), plane)); }

    void trace(const dfield_rays& rays, const dfield_hits& hits) const {
        check(dfield_scene_trace(handle_.get(), &rays, &hits));
    }
    void occluded(const dfield_rays& rays, std::uint8_t* result) const {
        check(dfield_scene_occluded(handle_.get(), &rays, result));
    }
    void visibility(const Ao& ao, const dfield_receivers& receivers, float* result,
                    std::size_t stride = 0) const {
        check(dfield_scene_visibility(handle_.get(), ao.get(), &receivers, result, stride));
    }
    void visibility_mask(const Ao& ao, const dfield_receivers& receivers, std::uint32_t* masks,
                         std::size_t stride = 0) const {
        check(dfield_scene_visibility_mask(handle_.get(), ao.get(), &receivers, masks, stride));
    }
    dfield_scene* get() const noexcept { return handle_.get(); }

  private:
    detail::Handle<dfield_scene, dfield_scene_release> handle_;
};

}  // namespace dfield

#endif
