// A program: a vertex functor and a pixel functor under a registered name.
//
// The data members of the functors are the shader constants; they are plain structs with named fields (sim/fields.h).
#pragma once

#include "pipeline/command.h"
#include "pipeline/pixel_stage.h"
#include "pipeline/vertex_stage.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstring>
#include <string>
#include <variant>
#include <vector>

namespace gnomon {

/// The value of one constant, for those who look from outside: recorders and debuggers.
using ConstantValue = std::variant<float, int, glm::vec2, glm::vec3, glm::vec4, glm::mat4, std::vector<float>, TextureId,
                                   TextureLevels, MultisampledTexture, Sampler, BufferId>;

struct NamedConstant {
    std::string name;  // members of nested structs as "outer.inner", of arrays of structs as "outer.0.inner"
    ConstantValue value;
};

/// One per arithmetic.
template <template <class> class Function>
struct PerArithmetic {
    Function<Float> fp32 = nullptr;
    Function<Double> fp64 = nullptr;

    template <class Real>
    [[nodiscard]] Function<Real> get() const {
        if constexpr (std::is_same_v<Real, Float>) {
            return fp32;
        } else {
            return fp64;
        }
    }
};

template <class Real>
using ShadeVertices = void (*)(const void* functor, const VertexFetch&, Workers&, bool flush_denormals,
                               VertexBlock<typename Real::Scalar>&);

struct Program {
    std::string_view name;
    int vertex_floats = 0;                  // floats per vertex that the vertex functor reads
    int instance_floats = 0;                // and per instance
    int varyings = 0;                       // values that it hands to the pixel functor
    bool layered = false;                   // its vertices choose array slice and viewport
    std::vector<std::uint8_t> linear;       // [varying]: linear on the screen; empty: none is
    PixelTraits pixel;                      // no targets and nothing else for depth-only programs
    std::size_t vertex_constants_size = 0;  // bytes
    std::size_t pixel_constants_size = 0;   // bytes; 0 for depth-only programs
    std::vector<NamedConstant> (*vertex_constants)(std::span<const std::byte>) = nullptr;
    std::vector<NamedConstant> (*pixel_constants)(std::span<const std::byte>) = nullptr;
    PerArithmetic<ShadeVertices> shade_vertices;
    PerArithmetic<ShadeWave> shade_wave;  // null for depth-only programs

    [[nodiscard]] int targets() const { return pixel.targets; }
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
    static_assert(names_every_member<Struct>(), "fields() of a struct among the constants leaves out a data member");
    for_each_field(nested, [&](std::string_view inner, const auto& value) {
        append_constant(constants, fmt::format("{}.{}", name, inner), value);
    });
}
template <HasFields Struct, std::size_t kCount>
void append_constant(std::vector<NamedConstant>& constants, const std::string& name,
                     const std::array<Struct, kCount>& structs) {
    for (std::size_t i = 0; i < kCount; ++i) append_constant(constants, fmt::format("{}.{}", name, i), structs[i]);
}

}  // namespace detail

/// Every constant of a functor with its name.
template <class Functor>
std::vector<NamedConstant> named_constants(std::span<const std::byte> bytes) {
    static_assert(names_every_member<Functor>(), "fields() of a functor leaves out a data member");
    std::vector<NamedConstant> constants;
    const Functor functor = functor_from<Functor>(bytes);
    for_each_field(functor, [&](std::string_view name, const auto& value) {
        detail::append_constant(constants, std::string(name), value);
    });
    return constants;
}

/// The program made of two functors. Call it in the .cpp of the technique, so that both are compiled there once.
template <class VertexFunctor, class PixelFunctor = NoPixelFunctor>
Program make_program(std::string_view name) {
    using Input = typename VertexFunctor::template Input<Float>;
    using InstanceInput = typename InstanceInputOf<VertexFunctor, Float>::type;
    using Varyings = typename VertexFunctor::template Varyings<Float>;
    using Result =
        decltype(std::declval<const VertexFunctor&>()(std::declval<const VertexContext<Float, Input, InstanceInput>&>()));
    constexpr std::size_t kVaryings = kRealCount<Varyings, Float>;
    const auto shade_vertices_of = []<class Real>(std::type_identity<Real>) -> ShadeVertices<Real> {
        return [](const void* functor, const VertexFetch& fetch, Workers& workers, bool flush_denormals,
                  VertexBlock<typename Real::Scalar>& out) {
            shade_vertices<Real>(*static_cast<const VertexFunctor*>(functor), fetch, workers, flush_denormals, out);
        };
    };
    Program program{
        .name = name,
        .vertex_floats = static_cast<int>(kRealCount<Input, Float>),
        .instance_floats = static_cast<int>(kRealCount<InstanceInput, Float>),
        .varyings = static_cast<int>(kVaryings),
        .layered = kIsLayered<Result>,
        .linear = {},
        .pixel = pixel_traits<VertexFunctor, PixelFunctor>(),
        .vertex_constants_size = sizeof(VertexFunctor),
        .pixel_constants_size = 0,
        .vertex_constants = &named_constants<VertexFunctor>,
        .pixel_constants = nullptr,
        .shade_vertices = {shade_vertices_of(std::type_identity<Float>{}), shade_vertices_of(std::type_identity<Double>{})},
        .shade_wave = {}};
    if constexpr (kVaryings > 0 && any_interpolation<Varyings, Float>(is_linear))
        for (std::size_t i = 0; i < kVaryings; ++i)
            program.linear.push_back(static_cast<std::uint8_t>(is_linear(interpolation_of<Varyings>(i))));
    if constexpr (!std::is_same_v<PixelFunctor, NoPixelFunctor>) {
        program.pixel_constants_size = sizeof(PixelFunctor);
        program.pixel_constants = &named_constants<PixelFunctor>;
        program.shade_wave = {&shade_wave<Float, VertexFunctor, PixelFunctor>,
                              &shade_wave<Double, VertexFunctor, PixelFunctor>};
    }
    return program;
}

}  // namespace gnomon
