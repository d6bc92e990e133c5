// A program: a vertex functor and a pixel functor under a registered name.
//
// The data members of the functors are the shader constants; they are plain structs with named fields (sim/fields.h).
#pragma once

#include "pipeline/command.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstring>
#include <string>
#include <variant>
#include <vector>

namespace gnomon {

struct DrawContext;  // draw.h

/// The value of one constant, for those who look from outside: recorders and debuggers.
using ConstantValue =
    std::variant<float, int, glm::vec2, glm::vec3, glm::vec4, glm::mat4, std::vector<float>, TextureId, Sampler, BufferId>;

struct NamedConstant {
    std::string name;  // members of nested structs as "outer.inner"
    ConstantValue value;
};

struct Program {
    std::string_view name;
    int vertex_floats = 0;                  // floats per vertex that the vertex functor reads
    int varyings = 0;                       // values that it hands to the pixel functor
    int targets = 0;                        // colour targets that the pixel functor writes
    std::size_t vertex_constants_size = 0;  // bytes
    std::size_t pixel_constants_size = 0;   // bytes; 0 for depth-only programs
    std::vector<NamedConstant> (*vertex_constants)(std::span<const std::byte>) = nullptr;
    std::vector<NamedConstant> (*pixel_constants)(std::span<const std::byte>) = nullptr;
    void (*run)(const DrawContext&) = nullptr;
};

/// The bytes of a functor, as a Draw carries them.
template <class Functor>
std::span<const std::byte> constants_of(const Functor& functor) {
    static_assert(std::is_trivially_copyable_v<Functor>);
    return std::as_bytes(std::span(&functor, 1));
}

/// The functor back from its bytes.
template <class Functor>
Functor functor_from(std::span<const std::byte> bytes) {
    GNOMON_CHECK_EQ(bytes.size(), sizeof(Functor));
    Functor functor;
    std::memcpy(static_cast<void*>(&functor), bytes.data(), sizeof(Functor));
    return functor;
}

namespace detail {

template <class Value>
void append_constant(std::vector<NamedConstant>& constants, const std::string& name, const Value& value) {
    constants.push_back({name, ConstantValue(value)});
}
template <std::size_t kCount>
void append_constant(std::vector<NamedConstant>& constants, const std::string& name, const std::array<float, kCount>& values) {
    constants.push_back({name, std::vector<float>(values.begin(), values.end())});
}
inline void append_constant(std::vector<NamedConstant>& constants, const std::string& name, const Sampler& sampler) {
    constants.push_back({name, sampler});
}
template <HasFields Struct>
void append_constant(std::vector<NamedConstant>& constants, const std::string& name, const Struct& nested) {
    for_each_field(nested, [&](std::string_view inner, const auto& value) {
        append_constant(constants, fmt::format("{}.{}", name, inner), value);
    });
}

}  // namespace detail

/// Every constant of a functor with its name.
template <class Functor>
std::vector<NamedConstant> named_constants(std::span<const std::byte> bytes) {
    std::vector<NamedConstant> constants;
    const Functor functor = functor_from<Functor>(bytes);
    for_each_field(functor, [&](std::string_view name, const auto& value) {
        detail::append_constant(constants, std::string(name), value);
    });
    return constants;
}

}  // namespace gnomon
