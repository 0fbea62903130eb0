#include "baker/import/gltf_accessor.hpp"

#include <algorithm>
#include <bit>

#include "baker/error.hpp"

namespace dfield {
namespace {

constexpr std::size_t kMaxUnbacked = std::size_t{1} << 24;  // zeros that a few bytes of JSON may ask for
constexpr std::size_t kMaxCount = std::size_t{1} << 31;

// Some bytes of a buffer as elements at a stride, known to lie inside.
struct Elements {
    const unsigned char* data = nullptr;
    std::size_t stride = 0, count = 0;
    const unsigned char* at(std::size_t i) const { return data + i * stride; }
};

class Reader {
  public:
    Reader(const GltfDocument& document, int accessor, const std::string& what)
        : document_(document), what_(what), accessor_(find(accessor)) {}

    const tinygltf::Accessor& accessor() const { return accessor_; }

    int components() const {
        return tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor_.type));
    }

    // value(i, component, bytes of that component) for every component, in the accessor's order, sparse ones
    // replaced.
    template<class Store>
    void for_each(Store store) const {
        const std::size_t size = component_size(accessor_.componentType);
        const auto n = static_cast<std::size_t>(components());
        if (accessor_.count > kMaxCount)
            fail("has " + std::to_string(accessor_.count) + " elements, more than 2^31");
        if (accessor_.bufferView >= 0) {
            const Elements elements =
                slice(accessor_.bufferView, accessor_.byteOffset, size * n, accessor_.count);
            for (std::size_t i = 0; i < elements.count; ++i)
                for (std::size_t c = 0; c < n; ++c) store(i, c, elements.at(i) + c * size);
        } else if (accessor_.count > kMaxUnbacked) {
            fail("has " + std::to_string(accessor_.count) + " elements without a buffer view");
        }
        if (accessor_.sparse.isSparse) replace_sparse(size, n, store);
    }

    std::uint32_t unsigned_at(const unsigned char* p, int type) const {
        switch (type) {
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                return p[0];
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
                return static_cast<std::uint32_t>(p[0] | p[1] << 8);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
                return std::uint32_t{p[0]} | std::uint32_t{p[1]} << 8 | std::uint32_t{p[2]} << 16 |
                       std::uint32_t{p[3]} << 24;
            default:
                fail("has indices that are not unsigned bytes, shorts or ints");
        }
    }

    float number_at(const unsigned char* p) const {
        const bool unit = accessor_.normalized;
        switch (accessor_.componentType) {
            case TINYGLTF_COMPONENT_TYPE_FLOAT:
                return std::bit_cast<float>(unsigned_at(p, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT));
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                return unit ? static_cast<float>(p[0]) / 255.0f : p[0];
            case TINYGLTF_COMPONENT_TYPE_BYTE: {
                const auto value = static_cast<float>(static_cast<std::int8_t>(p[0]));
                return unit ? std::max(value / 127.0f, -1.0f) : value;
            }
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
                const auto value = static_cast<float>(p[0] | p[1] << 8);
                return unit ? value / 65535.0f : value;
            }
            case TINYGLTF_COMPONENT_TYPE_SHORT: {
                const auto value = static_cast<float>(static_cast<std::int16_t>(p[0] | p[1] << 8));
                return unit ? std::max(value / 32767.0f, -1.0f) : value;
            }
            default:
                fail("has components that are neither floats nor bytes nor shorts");
        }
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(document_.file + ": " + what_ + ": the accessor " + message);
    }

  private:
    const tinygltf::Accessor& find(int index) const {
        if (index < 0 || static_cast<std::size_t>(index) >= document_.model.accessors.size())
            throw InputError(document_.file + ": " + what_ + ": there is no accessor " +
                             std::to_string(index));
        return document_.model.accessors[static_cast<std::size_t>(index)];
    }

    std::size_t component_size(int type) const {
        const std::int32_t size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type));
        if (size <= 0) fail("has an unknown component type " + std::to_string(type));
        return static_cast<std::size_t>(size);
    }

    Elements slice(int view_index, std::size_t offset, std::size_t element, std::size_t count) const {
        if (view_index < 0 || static_cast<std::size_t>(view_index) >= document_.model.bufferViews.size())
            fail("uses buffer view " + std::to_string(view_index) + ", which does not exist");
        const tinygltf::BufferView& view = document_.model.bufferViews[static_cast<std::size_t>(view_index)];
        if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= document_.model.buffers.size())
            fail("uses buffer " + std::to_string(view.buffer) + ", which does not exist");
        const std::vector<unsigned char>& data =
            document_.model.buffers[static_cast<std::size_t>(view.buffer)].data;
        if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
            fail("uses a buffer view that reaches beyond its buffer of " + std::to_string(data.size()) +
                 " bytes");
        const std::size_t stride = view.byteStride != 0 ? view.byteStride : element;
        if (stride < element) fail("has elements larger than the stride of its buffer view");
        // offset + (count - 1) * stride + element <= byteLength, without overflow
        const bool fits = count == 0 || (offset <= view.byteLength && element <= view.byteLength - offset &&
                                         count - 1 <= (view.byteLength - offset - element) / stride);
        if (!fits)
            fail("needs " + std::to_string(count) + " elements, which reach beyond its buffer view of " +
                 std::to_string(view.byteLength) + " bytes");
        return {data.data() + view.byteOffset + offset, stride, count};
    }

    template<class Store>
    void replace_sparse(std::size_t size, std::size_t n, Store store) const {
        const auto& sparse = accessor_.sparse;
        if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
            fail("has a negative number in its sparse part");
        const auto count = static_cast<std::size_t>(sparse.count);
        const std::size_t index_size = component_size(sparse.indices.componentType);
        const Elements indices =
            slice(sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), index_size,
                  count);
        const Elements values = slice(sparse.values.bufferView,
                                      static_cast<std::size_t>(sparse.values.byteOffset), size * n, count);
        for (std::size_t k = 0; k < count; ++k) {
            const std::uint32_t i = unsigned_at(indices.at(k), sparse.indices.componentType);
            if (i >= accessor_.count) fail("has a sparse index " + std::to_string(i) + " beyond its count");
            for (std::size_t c = 0; c < n; ++c) store(i, c, values.at(k) + c * size);
        }
    }

    const GltfDocument& document_;
    const std::string& what_;
    const tinygltf::Accessor& accessor_;
};

}  // namespace

std::vector<float> read_accessor(const GltfDocument& document, int accessor, int components,
                                 const std::string& what) {
    const Reader reader(document, accessor, what);
    if (reader.components() != components)
        reader.fail("should have " + std::to_string(components) + " components");
    std::vector<float> numbers;
    const auto n = static_cast<std::size_t>(components);
    // The first element comes when the count has been held against the buffer: no memory is taken before.
    reader.for_each([&](std::size_t i, std::size_t c, const unsigned char* bytes) {
        if (numbers.empty()) numbers.resize(reader.accessor().count * n);
        numbers[i * n + c] = reader.number_at(bytes);
    });
    numbers.resize(reader.accessor().count * n);
    return numbers;
}

std::vector<std::uint32_t> read_index_accessor(const GltfDocument& document, int accessor,
                                               const std::string& what) {
    const Reader reader(document, accessor, what);
    if (reader.components() != 1) reader.fail("should be SCALAR");
    std::vector<std::uint32_t> indices;
    reader.for_each([&](std::size_t i, std::size_t, const unsigned char* bytes) {
        if (indices.empty()) indices.resize(reader.accessor().count);
        indices[i] = reader.unsigned_at(bytes, reader.accessor().componentType);
    });
    indices.resize(reader.accessor().count);
    return indices;
}

int accessor_components(const GltfDocument& document, int accessor, const std::string& what) {
    return Reader(document, accessor, what).components();
}

std::size_t accessor_count(const GltfDocument& document, int accessor, const std::string& what) {
    return Reader(document, accessor, what).accessor().count;
}

}  // namespace dfield
