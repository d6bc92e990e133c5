#include "scenes/gltf_accessor.h"

#include "sim/error.h"

#include <tiny_gltf.h>

#include <cstring>
#include <limits>
#include <string_view>

namespace gnomon::scenes {

namespace {

/// More elements than any scene this machine could hold; keeps hostile counts from asking for the memory.
constexpr std::size_t kMaxElements = std::size_t{1} << 28;

/// Bytes of a buffer that a view and an accessor select.
struct Elements {
    const unsigned char* data = nullptr;  // null: all zeros
    std::size_t stride = 0;               // bytes from one element to the next
    std::size_t count = 0;
};

/// Elements of `element_size` bytes at `offset` into a buffer view.
Elements elements_of(const tinygltf::Model& model, int view_index, std::size_t offset, std::size_t count,
                     std::size_t element_size, const std::string& where) {
    if (view_index < 0 || static_cast<std::size_t>(view_index) >= model.bufferViews.size())
        fail("{}: bufferView {}, expected 0 to {}", where, view_index,
             static_cast<std::ptrdiff_t>(model.bufferViews.size()) - 1);
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(view_index)];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size())
        fail("{}: bufferViews[{}]: buffer {}, expected 0 to {}", where, view_index, view.buffer,
             static_cast<std::ptrdiff_t>(model.buffers.size()) - 1);
    const auto& bytes = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
        fail("{}: bufferViews[{}]: {} bytes at {}, but buffer {} holds {}", where, view_index, view.byteLength, view.byteOffset,
             view.buffer, bytes.size());
    const std::size_t stride = view.byteStride == 0 ? element_size : view.byteStride;
    if (stride < element_size || stride > 252)
        fail("{}: bufferViews[{}]: stride {}, expected {} to 252", where, view_index, stride, element_size);
    const std::size_t available = offset <= view.byteLength ? view.byteLength - offset : 0;
    const bool fits = count == 0 || (available >= element_size && (count - 1) <= (available - element_size) / stride);
    if (!fits)
        fail("{}: {} elements of {} bytes at {}, but bufferViews[{}] holds {} bytes", where, count, element_size, offset,
             view_index, view.byteLength);
    return {bytes.data() + view.byteOffset + offset, stride, count};
}

const tinygltf::Accessor& checked_accessor(const tinygltf::Model& model, int index, const std::string& file) {
    if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size())
        fail("{}: accessor {}, expected 0 to {}", file, index, static_cast<std::ptrdiff_t>(model.accessors.size()) - 1);
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    if (accessor.count < 1 || accessor.count > kMaxElements)
        fail("{}: accessors[{}]: count {}, expected 1 to {}", file, index, accessor.count, kMaxElements);
    return accessor;
}

/// Index `i` of 1, 2 or 4 unsigned bytes, little endian as glTF stores them.
std::uint32_t index_at(const Elements& elements, std::size_t i, int component_type) {
    const unsigned char* p = elements.data + i * elements.stride;
    switch (component_type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return p[0];
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return static_cast<std::uint32_t>(p[0] | p[1] << 8);
        default: {
            std::uint32_t value = 0;
            std::memcpy(&value, p, 4);
            return value;
        }
    }
}

std::size_t index_size(int component_type, const std::string& where) {
    switch (component_type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return 1;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return 4;
        default: fail("{}: component type {}, expected unsigned 8, 16 or 32 bit", where, component_type);
    }
}

/// The elements of an accessor in one piece, its sparse substitutions applied.
std::vector<unsigned char> read_elements(const tinygltf::Model& model, int index, std::size_t element_size,
                                         const std::string& file) {
    const tinygltf::Accessor& accessor = checked_accessor(model, index, file);
    const std::string where = fmt::format("{}: accessors[{}]", file, index);
    std::vector<unsigned char> packed(accessor.count * element_size, 0);
    if (accessor.bufferView >= 0) {
        const Elements elements =
            elements_of(model, accessor.bufferView, accessor.byteOffset, accessor.count, element_size, where);
        for (std::size_t i = 0; i < accessor.count; ++i)
            std::memcpy(packed.data() + i * element_size, elements.data + i * elements.stride, element_size);
    } else if (!accessor.sparse.isSparse) {
        fail("{}: neither a bufferView nor sparse data", where);
    }
    if (!accessor.sparse.isSparse) return packed;

    // glTF 2.0 section 3.6.2.3
    const auto& sparse = accessor.sparse;
    const std::string sparse_where = where + ".sparse";
    if (sparse.count < 1 || static_cast<std::size_t>(sparse.count) > accessor.count)
        fail("{}: count {}, expected 1 to {}", sparse_where, sparse.count, accessor.count);
    if (sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0) fail("{}: negative byteOffset", sparse_where);
    const auto count = static_cast<std::size_t>(sparse.count);
    const Elements places =
        elements_of(model, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), count,
                    index_size(sparse.indices.componentType, sparse_where + ".indices"), sparse_where);
    const Elements values = elements_of(model, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
                                        count, element_size, sparse_where);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t place = index_at(places, i, sparse.indices.componentType);
        if (place >= accessor.count) fail("{}: index {}, expected 0 to {}", sparse_where, place, accessor.count - 1);
        std::memcpy(packed.data() + place * element_size, values.data + i * values.stride, element_size);
    }
    return packed;
}

}  // namespace

std::vector<float> read_floats(const tinygltf::Model& model, int accessor, int components, const std::string& file) {
    const tinygltf::Accessor& description = checked_accessor(model, accessor, file);
    if (description.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
        fail("{}: accessors[{}]: component type {}, expected float ({})", file, accessor, description.componentType,
             TINYGLTF_COMPONENT_TYPE_FLOAT);
    if (tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(description.type)) != components)
        fail("{}: accessors[{}]: type {}, expected {} components", file, accessor, description.type, components);
    const auto bytes = read_elements(model, accessor, static_cast<std::size_t>(components) * sizeof(float), file);
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

std::vector<std::uint32_t> read_indices(const tinygltf::Model& model, int accessor, const std::string& file) {
    const tinygltf::Accessor& description = checked_accessor(model, accessor, file);
    const std::string where = fmt::format("{}: accessors[{}]", file, accessor);
    if (description.type != TINYGLTF_TYPE_SCALAR) fail("{}: type {}, expected scalar indices", where, description.type);
    const std::size_t size = index_size(description.componentType, where);
    const auto bytes = read_elements(model, accessor, size, file);
    const Elements elements{bytes.data(), size, description.count};
    std::vector<std::uint32_t> indices(description.count);
    for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = index_at(elements, i, description.componentType);
    return indices;
}

}  // namespace gnomon::scenes
