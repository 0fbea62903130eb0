#include <Iex.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/screen/gbuffer_formats.hpp"

namespace dfield {
namespace {

constexpr const char* kAttribute = "dfield";  // JSON: the camera and how depth is written

// A file in memory, so that its size is known before anything is believed.
class MemoryInput : public Imf::IStream {
  public:
    MemoryInput(const std::string& name, const std::vector<std::byte>& bytes)
        : IStream(name.c_str()), bytes_(bytes) {}

    bool read(char* target, int count) override {
        const auto n = static_cast<std::uint64_t>(std::max(count, 0));
        if (at_ > bytes_.size() || n > bytes_.size() - at_) throw Iex::InputExc("it ends too early");
        std::memcpy(target, bytes_.data() + at_, n);
        at_ += n;
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t at) override { at_ = at; }

  private:
    const std::vector<std::byte>& bytes_;
    std::uint64_t at_ = 0;
};

class MemoryOutput : public Imf::OStream {
  public:
    explicit MemoryOutput(const std::string& name) : OStream(name.c_str()) {}

    void write(const char* source, int count) override {
        const auto n = static_cast<std::size_t>(count);
        if (bytes.size() < at_ + n) bytes.resize(at_ + n);
        std::memcpy(bytes.data() + at_, source, n);
        at_ += n;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t at) override { at_ = static_cast<std::size_t>(at); }

    std::vector<std::byte> bytes;

  private:
    std::size_t at_ = 0;
};

// One buffer of the file: the names that its channels may have, the first being those that are written.
struct Layer {
    const char* what;
    std::vector<std::array<std::string, 3>> names;
};
const Layer kNormals{
    "normals",
    {{"N.X", "N.Y", "N.Z"}, {"normal.X", "normal.Y", "normal.Z"}, {"Normal.X", "Normal.Y", "Normal.Z"}}};
const Layer kAlbedo{"albedo", {{"albedo.R", "albedo.G", "albedo.B"}, {"Albedo.R", "Albedo.G", "Albedo.B"}}};
const Layer kRadiance{"radiance", {{"R", "G", "B"}, {"radiance.R", "radiance.G", "radiance.B"}}};
constexpr const char* kDepthNames[] = {"Z", "depth.Z", "Depth.Z", "depth.V"};

class ExrReader {
  public:
    ExrReader(std::string where, const std::vector<std::byte>& bytes)
        : where_(std::move(where)), stream_(where_, bytes), file_(stream_) {
        const Imath::Box2i& data = file_.header().dataWindow();
        if (data != file_.header().displayWindow())
            throw InputError(where_ + ": its data window is not its display window; save the whole picture");
        check_picture_size(where_, side(data.min.x, data.max.x), side(data.min.y, data.max.y), bytes.size());
        width_ = static_cast<std::uint32_t>(side(data.min.x, data.max.x));
        height_ = static_cast<std::uint32_t>(side(data.min.y, data.max.y));
    }

    GBuffer read(const ScreenCamera* lens) {
        GBuffer buffer;
        buffer.width = width_;
        buffer.height = height_;
        const auto* attribute = file_.header().findTypedAttribute<Imf::StringAttribute>(kAttribute);
        const nlohmann::json description =
            attribute ? parse_gbuffer_json(where_ + ": attribute dfield", attribute->value())
                      : nlohmann::json::object();
        buffer.camera = read_camera_json(where_, description, lens, width_, height_);
        const auto depth = std::find_if(std::begin(kDepthNames), std::end(kDepthNames),
                                        [&](const char* name) { return has(name); });
        if (depth == std::end(kDepthNames))
            throw InputError(where_ + ": has no channel Z, the depth along the view axis");
        buffer.depth.resize(buffer.pixels());
        insert(*depth, buffer.depth.data(), 1);
        insert(kNormals, buffer.normals);
        insert(kAlbedo, buffer.albedo);
        insert(kRadiance, buffer.radiance);
        file_.setFrameBuffer(frame_);
        file_.readPixels(file_.header().dataWindow().min.y, file_.header().dataWindow().max.y);
        if (depth_is_device(where_, description, buffer.camera))
            for (float& value : buffer.depth) value = depth_of_device(buffer.camera, value);
        return buffer;
    }

  private:
    static std::uint64_t side(int low, int high) {
        const std::int64_t size = std::int64_t{high} - low + 1;
        return size > 0 ? static_cast<std::uint64_t>(size) : 0;
    }
    bool has(const std::string& name) const { return file_.header().channels().findChannel(name) != nullptr; }

    // `stride` floats from pixel to pixel.
    void insert(const std::string& name, float* target, std::size_t stride) {
        const Imf::Channel& channel = file_.header().channels()[name];
        if (channel.xSampling != 1 || channel.ySampling != 1)
            throw InputError(where_ + ": channel " + name + " is subsampled; save it at full size");
        const Imath::V2i first = file_.header().dataWindow().min;
        frame_.insert(name, Imf::Slice::Make(Imf::FLOAT, target, first, width_, height_,
                                             stride * sizeof(float), stride * sizeof(float) * width_));
    }

    void insert(const Layer& layer, std::vector<glm::vec3>& target) {
        for (const auto& names : layer.names) {
            const auto there =
                std::count_if(names.begin(), names.end(), [&](const std::string& name) { return has(name); });
            if (there == 0) continue;
            if (there < 3)
                throw InputError(where_ + ": has some of the channels " + names[0] + ", " + names[1] + ", " +
                                 names[2] + " (" + layer.what + "), but not all");
            target.resize(std::size_t{width_} * height_);
            for (int c = 0; c < 3; ++c) insert(names[static_cast<std::size_t>(c)], &target[0][c], 3);
            return;
        }
    }

    std::string where_;
    MemoryInput stream_;
    Imf::InputFile file_;
    Imf::FrameBuffer frame_;
    std::uint32_t width_ = 0, height_ = 0;
};

// OpenEXR takes the memory that an attribute claims before it looks whether the file has as much.
void check_attributes(const std::string& where, const std::vector<std::byte>& bytes) {
    std::size_t at = 8;  // after the magic number and the version, whose bit 12 says: several headers
    const bool parts = bytes.size() > at && (bytes[5] & std::byte{0x10}) != std::byte{0};
    const auto skip_name = [&] {
        while (at < bytes.size() && bytes[at] != std::byte{0}) ++at;
        ++at;
    };
    const auto in_header = [&] { return at < bytes.size() && bytes[at] != std::byte{0}; };
    do {
        while (in_header()) {
            skip_name();
            skip_name();  // the type's
            std::uint32_t size = 0;
            if (at + sizeof size > bytes.size()) return;  // OpenEXR says so
            for (std::size_t i = 0; i < sizeof size; ++i)
                size |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
            at += sizeof size;
            if (size > bytes.size() - at)
                throw InputError(where + ": an attribute claims " + std::to_string(size) +
                                 " bytes, more than are left; it is cut off or broken");
            at += size;
        }
        ++at;
    } while (parts && in_header());
}

}  // namespace

GBuffer read_exr_gbuffer(const std::filesystem::path& path, const ScreenCamera* lens) {
    const std::vector<std::byte> bytes = read_file(path);
    check_attributes(path.string(), bytes);
    try {
        Imf::Header::setMaxImageSize(static_cast<int>(kMaxScreenSide), static_cast<int>(kMaxScreenSide));
        Imf::Header::setMaxTileSize(static_cast<int>(kMaxScreenSide), static_cast<int>(kMaxScreenSide));
        return ExrReader(path.string(), bytes).read(lens);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {  // Iex::BaseExc and what the standard library throws inside
        throw InputError(path.string() + ": not a readable OpenEXR picture: " + error.what());
    }
}

void write_exr_gbuffer(const std::filesystem::path& path, const GBuffer& buffer) {
    check_output(path);
    const nlohmann::json description = {{"camera", camera_json(buffer.camera)},
                                        {"depth", {{"encoding", "linear"}}}};
    MemoryOutput stream(path.string());
    try {
        Imf::Header header(static_cast<int>(buffer.width), static_cast<int>(buffer.height));
        header.compression() = Imf::ZIP_COMPRESSION;
        header.insert(kAttribute, Imf::StringAttribute(description.dump()));
        Imf::FrameBuffer frame;
        const auto insert = [&](const std::string& name, const float* source, std::size_t stride) {
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
            frame.insert(name,
                         Imf::Slice::Make(Imf::FLOAT, source, Imath::V2i(0), buffer.width, buffer.height,
                                          stride * sizeof(float), stride * sizeof(float) * buffer.width));
        };
        const auto insert_layer = [&](const Layer& layer, const std::vector<glm::vec3>& source) {
            for (int c = 0; c < 3 && !source.empty(); ++c)
                insert(layer.names[0][static_cast<std::size_t>(c)], &source[0][c], 3);
        };
        insert(kDepthNames[0], buffer.depth.data(), 1);
        insert_layer(kNormals, buffer.normals);
        insert_layer(kAlbedo, buffer.albedo);
        insert_layer(kRadiance, buffer.radiance);
        Imf::OutputFile file(stream, header);
        file.setFrameBuffer(frame);
        file.writePixels(static_cast<int>(buffer.height));
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw OutputError(path.string() + ": cannot be packed as OpenEXR: " + error.what());
    }
    write_file_atomic(path, stream.bytes);
}

}  // namespace dfield
