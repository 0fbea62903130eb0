#include "baker/cli/screen_runner.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "baker/cli/screen_options.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/error.hpp"

namespace dfield::cli {
namespace {

using ScreenHandle = detail::Handle<dfield_screen, dfield_screen_release>;

// What the runtime refuses is the input's fault, or the flags'.
void check_screen(dfield_status status) {
    if (status == DFIELD_OK) return;
    if (status == DFIELD_OUT_OF_MEMORY) throw std::bad_alloc();
    throw InputError(dfield_error_message());
}

ScreenHandle make_screen(const Context& context, const dfield_screen_desc& desc) {
    dfield_screen* handle = nullptr;
    check_screen(dfield_screen_create(context.get(), &desc, &handle));
    return ScreenHandle(handle);
}

dfield_screen_plane plane_of(const std::vector<glm::vec3>& values) {
    return {values.empty() ? nullptr : &values.front().x, 0, 0};
}

dfield_screen_target target_of(std::vector<glm::vec3>& values) {
    return {values.empty() ? nullptr : &values.front().x, 0, 0};
}

void check_interrupted() {
    if (interrupted) throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
}

double rms(double sum, std::size_t count) {
    return count > 0 ? 255 * std::sqrt(sum / static_cast<double>(count)) : 0;
}

}  // namespace

ScreenRunner::ScreenRunner(const ScreenSubject& subject, int threads, const ReferenceOptions& reference,
                           dfield_simd simd)
    : subject_(subject),
      threads_(threads),
      rays_(reference.rays),
      context_(threads, simd),
      buffer_(subject.buffer),
      pixels_(surface_pixels(buffer_, reference.pixels)) {
    std::vector<glm::vec3> normals(buffer_.pixels(), glm::vec3(0));
    const dfield_screen_buffers buffers = view();
    const dfield_screen_target target = target_of(normals);
    check_screen(dfield_screen_normals(context().get(), &buffers, &target));
    buffer_.normals = std::move(normals);
}

dfield_screen_buffers ScreenRunner::view() const {
    const ScreenCamera& camera = buffer_.camera;
    dfield_screen_buffers buffers{};
    buffers.struct_size = sizeof buffers;
    buffers.width = buffer_.width;
    buffers.height = buffer_.height;
    buffers.camera = {camera.orthographic ? DFIELD_PROJECTION_ORTHOGRAPHIC : DFIELD_PROJECTION_PERSPECTIVE,
                      camera.half_width,
                      camera.half_height,
                      camera.offset.x,
                      camera.offset.y,
                      camera.near,
                      camera.far};
    buffers.depth_encoding = DFIELD_DEPTH_DISTANCE;
    buffers.depth = {buffer_.depth.data(), 0, 0};
    // The subject's own: where it has none, deriving them is part of a frame.
    buffers.normals = plane_of(subject_.buffer.normals);
    buffers.radiance = plane_of(buffer_.radiance);
    buffers.albedo = plane_of(buffer_.albedo);
    return buffers;
}

ScreenShading ScreenRunner::shade(const dfield_screen_desc& desc, bool indirect, int repetitions) const {
    const ScreenHandle screen = make_screen(context(), desc);
    const dfield_screen_buffers buffers = view();
    ScreenShading result;
    result.visibility.resize(buffer_.pixels());
    if (indirect) result.indirect.resize(buffer_.pixels()), result.reflected.resize(buffer_.pixels());
    dfield_screen_outputs timed{}, all{};
    timed.struct_size = all.struct_size = sizeof all;
    all.visibility = {result.visibility.data(), 0, 0};
    all.indirect = target_of(result.indirect);
    all.reflected = target_of(result.reflected);
    if (indirect)
        timed.reflected = all.reflected;
    else
        timed.visibility = all.visibility;
    result.ms = std::numeric_limits<double>::infinity();
    for (int i = 0; i < repetitions; ++i) {
        check_interrupted();
        const auto start = std::chrono::steady_clock::now();
        check_screen(dfield_screen_shade(screen.get(), &buffers, &timed));
        const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
        result.ms = std::min(result.ms, taken.count());
    }
    if (indirect) check_screen(dfield_screen_shade(screen.get(), &buffers, &all));
    return result;
}

std::vector<float> ScreenRunner::integral(const dfield_screen_desc& desc,
                                          std::vector<glm::vec3>* indirect) const {
    const ScreenHandle screen = make_screen(context(), desc);
    const dfield_screen_buffers buffers = view();
    std::vector<float> values(pixels_.size());
    if (indirect) indirect->resize(pixels_.size());
    constexpr std::size_t kPixels = 1024;  // thousands of lookups each: a fraction of a second
    for (std::size_t first = 0; first < pixels_.size(); first += kPixels) {
        check_interrupted();
        check_screen(dfield_screen_integral(screen.get(), &buffers, pixels_.data() + first,
                                            std::min(kPixels, pixels_.size() - first), values.data() + first,
                                            indirect ? &(*indirect)[first].x : nullptr));
    }
    return values;
}

RayReference ScreenRunner::trace(std::span<const std::uint32_t> pixels, std::uint32_t rays,
                                 const dfield_screen_desc& desc, bool indirect, bool unbounded) const {
    RayReferenceOptions options;
    options.measure = measure_of(desc);
    options.rays = rays;
    options.indirect = indirect;
    options.unbounded = unbounded;
    options.threads = threads_;
    options.cancel = &interrupted;
    return trace_reference(*subject_.lit, buffer_, pixels, options);
}

RayReference ScreenRunner::by_rays(const dfield_screen_desc& desc, bool indirect, bool unbounded) const {
    return subject_.lit ? trace(pixels_, rays_, desc, indirect, unbounded) : RayReference{};
}

std::vector<float> ScreenRunner::picture_by_rays(const dfield_screen_desc& desc, std::uint32_t rays,
                                                 bool unbounded) const {
    const std::vector<std::uint32_t> all = surface_pixels(buffer_, buffer_.pixels());
    const RayReference reference = trace(all, rays, desc, false, unbounded);
    std::vector<float> picture(buffer_.pixels(), 1.0f);
    for (std::size_t i = 0; i < all.size(); ++i)
        picture[all[i]] = (unbounded ? reference.sky : reference.visibility)[i];
    return picture;
}

double rms_grey(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += (double{a[i]} - double{b[i]}) * (double{a[i]} - double{b[i]});
    return rms(sum, a.size());
}

double rms_grey(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const glm::dvec3 difference = glm::dvec3(a[i]) - glm::dvec3(b[i]);
        sum += glm::dot(difference, difference);
    }
    return rms(sum, 3 * a.size());
}

double mpixels_per_s(const GBuffer& buffer, double ms) {
    return static_cast<double>(buffer.pixels()) / ms / 1e3;
}

}  // namespace dfield::cli
