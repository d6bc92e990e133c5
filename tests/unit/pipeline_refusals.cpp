// What a pixel functor may read and how, and values that are no choice at all: refused when the draw is built where the state
// shows it, from the call where only that does.
#include "pipeline/program.h"
#include "sim/error.h"
#include "tests/unit/pipeline_programs.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Position {
    template <class Real>
    struct Input {
        Vec4<Real> position;
        Real a, b;
    };
    template <class Real>
    using Varyings = NoVaryings<Real>;
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        return VertexOutput{v.in.position, NoVaryings<typename V::Real>{}};
    }
};

/// Coordinates on a picture of eight texels a side.
template <class F>
auto uv_of(const F& f) {
    using Real = typename F::Real;
    return Vec2<Real>{f.position.x * Real(0.125f), f.position.y * Real(0.125f)};
}

/// Reads `map` through the first sampler or the second.
struct TwoSamplers {
    TextureId map = TextureId::None;
    Sampler first{};
    Sampler second{};
    int use = 0;
    static constexpr auto fields() {
        using T = TwoSamplers;
        return std::tuple{Field{"map", &T::map}, Field{"first", &T::first}, Field{"second", &T::second}, Field{"use", &T::use}};
    }

    template <class F>
    auto operator()(const F& f) const {
        return f.sample(map, use == 0 ? first : second, uv_of(f));
    }
};

/// Integers that are loaded beside numbers that are filtered.
struct Indexed {
    TextureId index = TextureId::None;
    TextureId map = TextureId::None;
    Sampler sampler{};
    static constexpr auto fields() {
        using I = Indexed;
        return std::tuple{Field{"index", &I::index}, Field{"map", &I::map}, Field{"sampler", &I::sampler}};
    }

    template <class F>
    auto operator()(const F& f) const {
        const auto texel = f.sample(map, sampler, uv_of(f));
        const auto which = f.load(index, Int(0), Int(0)).x;
        return Vec4<typename F::Real>{texel.x + which, texel.y, texel.z, texel.w};
    }
};

enum class Call {
    Sample,
    Gradient,
    Level,
    Slice,
    SliceGradient,
    SliceLevel,
    Compare,
    CompareQuad,
    Gather,
    GatherCompare,
    Load,
    LoadCodes,
    Invented
};

/// One call, with the operands that the constants say.
struct OneCall {
    TextureId map = TextureId::None;
    Sampler sampler{};
    int call = 0;
    int component = 0;
    int offset_x = 0;
    int offset_y = 0;
    static constexpr auto fields() {
        using O = OneCall;
        return std::tuple{Field{"map", &O::map},           Field{"sampler", &O::sampler},
                          Field{"call", &O::call},         Field{"component", &O::component},
                          Field{"offset_x", &O::offset_x}, Field{"offset_y", &O::offset_y}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec2<Real> uv = uv_of(f);
        const glm::ivec2 offset{offset_x, offset_y};
        const Real half(0.5f);
        const Vec3<Real> slice{uv.x, uv.y, half};
        const auto all_of = [](const Real& x) { return Vec4<Real>{x, x, x, x}; };
        switch (static_cast<Call>(call)) {
            case Call::Sample: return f.sample(map, sampler, uv, {.offset = offset});
            case Call::Gradient: return f.sample_gradient(map, sampler, uv, {uv, uv}, {.offset = offset});
            case Call::Level: return f.sample_level(map, sampler, uv, half, {.offset = offset});
            case Call::Slice: return f.sample(map, sampler, slice, {.offset = offset});
            case Call::SliceGradient: return f.sample_gradient(map, sampler, slice, {uv, uv}, {.offset = offset});
            case Call::SliceLevel: return f.sample_level(map, sampler, slice, half, {.offset = offset});
            case Call::Compare: return all_of(f.sample_compare(map, sampler, uv, half));
            case Call::CompareQuad: return all_of(f.sample_compare_quad(map, sampler, uv, half));
            case Call::Gather: return f.gather(map, sampler, uv, component, offset);
            case Call::GatherCompare: return f.gather_compare(map, sampler, uv, half, offset);
            case Call::Load: return f.load(map, Int(1), Int(1));
            case Call::LoadCodes: return all_of(Real(f.load_codes(map, Int(1), Int(1)).x));
            case Call::Invented: return f.load(static_cast<TextureId>(4711), Int(1), Int(1));
        }
        return all_of(half);
    }
};

/// The mean of the samples of a texel.
struct Average {
    MultisampledTexture source;
    static constexpr auto fields() { return std::tuple{Field{"source", &Average::source}}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        Real sum(0.0f);
        for (int s = 0; s < f.samples(source); ++s)
            sum += f.load(source, truncate_to_int(f.position.x), truncate_to_int(f.position.y), s).x;
        const Real mean = sum * Real(1.0f / static_cast<float>(f.samples(source)));
        return Vec4<Real>{mean, mean, mean, mean};
    }
};

/// The largest of the four texels of the finer level.
struct Coarser {
    TextureLevels finer;
    static constexpr auto fields() { return std::tuple{Field{"finer", &Coarser::finer}}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Int x = truncate_to_int(f.position.x) * Int(2);
        const Int y = truncate_to_int(f.position.y) * Int(2);
        const auto at = [&](int i, int j) { return f.load(finer, x + Int(i), y + Int(j)).x; };
        const Real most = max(max(at(0, 0), at(1, 0)), max(at(0, 1), at(1, 1)));
        return Vec4<Real>{most, Real(static_cast<float>(f.size(finer).x)), most, most};
    }
};

template <class Pixel>
const Program& program_of() {
    static const Program program = make_program<Position, Pixel>("test.refusals");
    return program;
}

struct Bench {
    Device device;
    BufferId vertices;
    TextureId color;

    explicit Bench(const char* profile = "d3d11") : device(load_profile(profile), 1) {
        vertices = upload(device, {{-1, 1, 0.5f, 1, 5, 0}, {3, 1, 0.5f, 1, 5, 0}, {-1, -3, 0.5f, 1, 5, 0}});
        color = create(Format::R32Float);
        device.execute(ClearColor{color, glm::vec4(2.0f)});
    }
    TextureId create(Format format, int samples = 1, TextureKind kind = TextureKind::Flat, int levels = 1) {
        return device.create_texture("texture", {.format = format,
                                                 .width = 8,
                                                 .height = 8,
                                                 .levels = levels,
                                                 .kind = kind,
                                                 .layers = kind == TextureKind::Cube ? 6 : 1,
                                                 .samples = samples});
    }
    template <class Pixel>
    Draw draw_of(const Pixel& pixel) const {
        static const Position position;
        Draw draw{.label = "shadows",
                  .program = &program_of<Pixel>(),
                  .vertex_constants = constants_of(position),
                  .pixel_constants = constants_of(pixel),
                  .vertices = vertices,
                  .count = 3};
        draw.color[0] = color;
        return draw;
    }
    /// What execute() says; "" where it does what it is told.
    std::string message_of(const Command& command) {
        try {
            device.execute(command);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    }
    template <class Pixel>
    std::string draw(const Pixel& pixel) {
        return message_of(draw_of(pixel));
    }
    /// Nothing was drawn since the clear.
    [[nodiscard]] bool untouched() const { return floats_of(device.texture(color)) == std::vector<float>(64, 2.0f); }
};

bool mentions(const std::string& message, std::initializer_list<std::string_view> words) {
    for (const std::string_view word : words) {
        if (message.find(word) != std::string::npos) continue;
        UNSCOPED_INFO("message: '" << message << "' lacks '" << word << "'");
        return false;
    }
    return message.find('\n') == std::string::npos;
}

constexpr Sampler kNearest{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest};
constexpr Sampler kLinear{};

/// Every way in which a sampler filters.
std::vector<Sampler> filtering_samplers() {
    std::vector<Sampler> samplers(4, kNearest);
    samplers[0].min = TexelFilter::Linear;
    samplers[1].mag = TexelFilter::Linear;
    samplers[2].mip = MipFilter::Linear;
    samplers[3].max_anisotropy = 2;
    return samplers;
}

}  // namespace

TEST_CASE("a format that the profile does not filter meets only samplers that do not filter", "[errors][19.1.4]") {
    Bench nv40("nv40");
    for (const Format format : {Format::R32Float, Format::Rg32Float, Format::Rgba32Float, Format::R32Uint}) {
        const TextureId map = nv40.create(format);
        for (const Sampler& sampler : filtering_samplers()) {
            CHECK(mentions(nv40.draw(OneCall{.map = map, .sampler = sampler}),
                           {"draw 'shadows': map", format_info(format).name, "nv40", "nearest"}));
            // Slices and comparisons are no way round.
            for (const Call way : {Call::Slice, Call::SliceGradient, Call::SliceLevel, Call::Compare, Call::CompareQuad})
                CHECK(mentions(nv40.draw(OneCall{.map = map, .sampler = sampler, .call = static_cast<int>(way)}),
                               {"draw 'shadows': map", "nv40"}));
        }
        CHECK(nv40.untouched());
        CHECK(nv40.draw(OneCall{.map = map, .sampler = kNearest}) == "");
        nv40.device.execute(ClearColor{nv40.color, glm::vec4(2.0f)});
    }
    // What it filters, and what others filter.
    for (const Format format : {Format::Rg16Float, Format::Rg16Unorm, Format::D32Float})
        CHECK(nv40.draw(OneCall{.map = nv40.create(format), .sampler = kLinear}) == "");
    Bench d3d11;
    CHECK(d3d11.draw(OneCall{.map = d3d11.create(Format::Rg32Float), .sampler = kLinear}) == "");
    CHECK(mentions(d3d11.draw(OneCall{.map = d3d11.create(Format::R32Uint), .sampler = kLinear}), {"r32ui", "d3d11"}));
}

TEST_CASE("where the constants leave the pair open, the call decides", "[errors][19.1.4]") {
    Bench b("nv40");
    const TextureId map = b.create(Format::R32Float);
    CHECK(b.draw(TwoSamplers{.map = map, .first = kNearest, .second = kLinear, .use = 0}) == "");
    CHECK(mentions(b.draw(TwoSamplers{.map = map, .first = kNearest, .second = kLinear, .use = 1}),
                   {"draw 'shadows': map holds r32f", "nv40", "nearest"}));
    // Integers that are loaded meet no sampler.
    const TextureId index = b.create(Format::R32Uint);
    const TextureId filtered = b.create(Format::Rgba8Unorm);
    CHECK(b.draw(Indexed{.index = index, .map = filtered, .sampler = kLinear}) == "");
    CHECK(mentions(b.draw(Indexed{.index = filtered, .map = index, .sampler = kLinear}),
                   {"draw 'shadows': map holds r32ui", "nv40"}));
}

TEST_CASE("calls that no texture unit has are refused with the constant's name", "[errors][22.4.2][22.4.15]") {
    Bench b;
    const TextureId map = b.create(Format::Rgba8Unorm);
    const auto call = [&](Call which, OneCall operands) {
        operands.call = static_cast<int>(which);
        if (operands.map == TextureId::None) operands.map = map;
        operands.sampler = kNearest;
        return b.draw(operands);
    };
    for (const int component : {-1, 4, 9, 1 << 30})
        CHECK(mentions(call(Call::Gather, {.component = component}),
                       {"draw 'shadows': map", fmt::format("{}", component), "0 to 3"}));
    for (const int component : {0, 3}) CHECK(call(Call::Gather, {.component = component}) == "");
    for (const Call which : {Call::Sample, Call::Gradient, Call::Level, Call::Slice, Call::SliceGradient, Call::SliceLevel,
                             Call::Gather, Call::GatherCompare}) {
        for (const int offset : {-9, 8, std::numeric_limits<int>::min()}) {
            CHECK(mentions(call(which, {.offset_x = offset}),
                           {"draw 'shadows': map", fmt::format("({}, 0)", offset), "-8 to 7"}));
            CHECK(mentions(call(which, {.offset_y = offset}),
                           {"draw 'shadows': map", fmt::format("(0, {})", offset), "-8 to 7"}));
        }
        CHECK(call(which, {.offset_x = -8, .offset_y = 7}) == "");
    }
    const TextureId cube = b.create(Format::Rgba8Unorm, 1, TextureKind::Cube);
    for (const Call which : {Call::Sample, Call::Gradient, Call::Level, Call::Slice, Call::SliceGradient, Call::SliceLevel,
                             Call::Compare, Call::CompareQuad, Call::Gather, Call::GatherCompare})
        CHECK(call(which, {.map = cube}) ==
              "draw 'shadows': map is a cube texture, sampled at 2D coordinates: its faces can only be loaded from");
    CHECK(call(Call::Load, {.map = cube}) == "");  // of a face
    const TextureId integers = b.create(Format::R32Uint);
    for (const Call which : {Call::Compare, Call::CompareQuad, Call::GatherCompare})
        CHECK(call(which, {.map = integers}) == "draw 'shadows': map holds r32ui: integers are not compared");
    CHECK(call(Call::LoadCodes, {.map = integers}) == "");
    for (const Format format : {Format::Rgba8Unorm, Format::R32Float, Format::D16})
        CHECK(call(Call::LoadCodes, {.map = b.create(format)}) ==
              fmt::format("draw 'shadows': map holds {}, and its codes are loaded: expected a format of unsigned integers",
                          name_of(format)));
    CHECK(mentions(call(Call::Invented, {}), {"draw 'shadows'", "4711", "does not exist"}));
}

TEST_CASE("several samples per texel are read through a constant of their own", "[errors][22.4.7]") {
    Bench b;
    for (const int samples : {2, 4, 8, 16}) {
        const TextureId several = b.create(Format::R32Float, samples);
        CHECK(mentions(b.draw(OneCall{.map = several, .sampler = kNearest}),
                       {"draw 'shadows': map", fmt::format("{} samples", samples), "expected one"}));
        CHECK(b.untouched());
    }
    // One that takes several takes one, too.
    for (const int samples : {1, 4}) {
        const TextureId source = b.create(Format::R32Float, samples);
        b.device.execute(ClearColor{source, glm::vec4(0.25f)});
        CHECK(b.draw(Average{{source}}) == "");
        for (const float mean : floats_of(b.device.texture(b.color))) CHECK(mean == 0.25f);
    }
    Draw itself = b.draw_of(Average{});
    const Average reads_target{{b.color}};
    itself.pixel_constants = constants_of(reads_target);
    CHECK(mentions(b.message_of(itself), {"draw 'shadows': source", "sampled and written"}));
}

TEST_CASE("a draw may read levels that it does not write", "[errors][5.2][17.13]") {
    Bench b;
    const TextureId chain = b.create(Format::Rgba32Float, 1, TextureKind::Flat, 4);
    b.device.execute(ClearColor{chain, glm::vec4(3.0f)});
    const auto reduce = [&](const TextureLevels& finer, int to) {
        const Coarser pixel{finer};
        Draw draw = b.draw_of(pixel);
        draw.color[0] = TargetView(chain, to);
        return b.message_of(draw);
    };
    for (int level = 1; level < 4; ++level) CHECK(reduce({chain, level - 1, 1}, level) == "");
    for (int level = 1; level < 4; ++level) {
        const auto bytes = b.device.texture(chain).level_bytes(level);
        std::array<float, 2> texel{};
        std::memcpy(texel.data(), bytes.data(), sizeof(texel));
        CHECK(texel[0] == 3.0f);
        CHECK(texel[1] == static_cast<float>(16 >> level));  // the width that the functor saw
    }
    CHECK(reduce({chain, 2, 2}, 1) == "");
    CHECK(reduce({chain, 2, 0}, 1) == "");
    for (const TextureLevels& both : {TextureLevels(chain), TextureLevels(chain, 0, 2), TextureLevels(chain, 1, 1),
                                      TextureLevels(chain, 1), TextureLevels(chain, 0, 4)})
        CHECK(mentions(reduce(both, 1), {"draw 'shadows': finer", "sampled and written"}));
    for (const TextureLevels& none :
         {TextureLevels(chain, 4, 1), TextureLevels(chain, -1, 1), TextureLevels(chain, 0, 5), TextureLevels(chain, 3, 2),
          TextureLevels(chain, 0, -1), TextureLevels(chain, 3, std::numeric_limits<int>::max())})
        CHECK(mentions(reduce(none, 1), {"draw 'shadows': finer", "has 4"}));
}

TEST_CASE("errors say which draw, which slot and which constant", "[errors]") {
    Bench b;
    const TextureId map = b.create(Format::Rgba8Unorm);
    const auto missing = static_cast<TextureId>(44);
    CHECK(mentions(b.draw(OneCall{}), {"draw 'shadows': map: names no texture"}));
    CHECK(mentions(b.draw(OneCall{.map = missing}), {"draw 'shadows': map: texture 44: no such texture", "exist"}));
    const OneCall pixel{.map = map};
    const auto with = [&](const auto& change) {
        Draw draw = b.draw_of(pixel);
        change(draw);
        return b.message_of(draw);
    };
    CHECK(mentions(with([&](Draw& d) { d.color[0] = missing; }),
                   {"draw 'shadows': colour target 0: texture 44: no such texture"}));
    CHECK(mentions(with([&](Draw& d) { d.depth = missing; }), {"draw 'shadows': depth target: texture 44: no such texture"}));
    CHECK(mentions(with([&](Draw& d) { d.derivative_report = missing; }),
                   {"draw 'shadows': derivative report: texture 44: no such texture"}));
    CHECK(mentions(with([](Draw& d) { d.vertices = static_cast<BufferId>(9); }),
                   {"draw 'shadows': vertices: buffer 9: no such buffer"}));
    CHECK(mentions(with([](Draw& d) { d.vertices = BufferId::None; }), {"draw 'shadows': vertices: names no buffer"}));
    CHECK(mentions(with([](Draw& d) { d.indices = static_cast<BufferId>(9); }),
                   {"draw 'shadows': indices: buffer 9: no such buffer"}));
    CHECK(mentions(b.message_of(ClearColor{missing, {}}), {"clear: texture 44"}));
    CHECK(mentions(b.message_of(Resolve{map, missing}), {"resolve: texture 44"}));
    CHECK(b.untouched());
}

TEST_CASE("values that no enumeration has are refused by name", "[errors]") {
    Bench b;
    const OneCall pixel{.map = b.create(Format::Rgba8Unorm)};
    const auto refuses = [&](const auto& change, std::string_view field) {
        for (const int value : {-1, 17, 99, std::numeric_limits<int>::max()}) {
            Draw draw = b.draw_of(pixel);
            change(draw, value);
            CHECK(mentions(b.message_of(draw), {"draw 'shadows'", field, fmt::format("{}", value), "is not one of"}));
        }
    };
    const auto set = [](auto& choice, int value) { choice = static_cast<std::remove_reference_t<decltype(choice)>>(value); };
    refuses([&](Draw& d, int v) { set(d.topology, v); }, "topology");
    refuses([&](Draw& d, int v) { set(d.index_type, v); }, "index_type");
    refuses([&](Draw& d, int v) { set(d.raster.fill, v); }, "raster.fill");
    refuses([&](Draw& d, int v) { set(d.raster.cull, v); }, "raster.cull");
    refuses([&](Draw& d, int v) { set(d.raster.provoking, v); }, "raster.provoking");
    refuses([&](Draw& d, int v) { set(d.raster.lines, v); }, "raster.lines");
    refuses([&](Draw& d, int v) { set(d.depth_state.compare, v); }, "depth_state.compare");
    refuses([&](Draw& d, int v) { set(d.stencil.front.compare, v); }, "stencil.front.compare");
    refuses([&](Draw& d, int v) { set(d.stencil.back.depth_fail, v); }, "stencil.back.depth_fail");
    refuses([&](Draw& d, int v) { set(d.output.blend[0].src, v); }, "blend[0].src");
    refuses([&](Draw& d, int v) { set(d.output.blend[0].op_alpha, v); }, "blend[0].op_alpha");
    refuses([&](Draw& d, int v) { set(d.output.blend[7].dst, v); }, "blend[7].dst");

    const auto refuses_sampler = [&](const auto& change, std::string_view field) {
        for (const int value : {-1, 17, 99}) {
            OneCall with = pixel;
            change(with.sampler, value);
            CHECK(mentions(b.draw(with), {"draw 'shadows': sampler", field, fmt::format("{}", value)}));
        }
    };
    refuses_sampler([&](Sampler& s, int v) { set(s.min, v); }, "min");
    refuses_sampler([&](Sampler& s, int v) { set(s.mag, v); }, "mag");
    refuses_sampler([&](Sampler& s, int v) { set(s.mip, v); }, "mip");
    refuses_sampler([&](Sampler& s, int v) { set(s.address_u, v); }, "address_u");
    refuses_sampler([&](Sampler& s, int v) { set(s.address_v, v); }, "address_v");
    refuses_sampler([&](Sampler& s, int v) { set(s.reduction, v); }, "reduction");
    refuses_sampler([&](Sampler& s, int v) { set(s.compare, v); }, "compare");
    refuses_sampler([](Sampler& s, int v) { s.max_anisotropy = v; }, "max_anisotropy");
    CHECK(b.untouched());

    CHECK(mentions(b.message_of(CreateTexture{static_cast<TextureId>(3), "bad", {.format = static_cast<Format>(99)}}),
                   {"format", "99", "is not one of"}));
    CHECK(mentions(b.message_of(CreateTexture{static_cast<TextureId>(3), "bad", {.kind = static_cast<TextureKind>(3)}}),
                   {"kind", "3", "is not one of"}));
}

TEST_CASE("numbers without a meaning are refused", "[errors][15.10][7.18.3]") {
    Bench b;
    const OneCall pixel{.map = b.create(Format::Rgba8Unorm)};
    const auto with = [&](float slope, float clamp) {
        Draw draw = b.draw_of(pixel);
        draw.raster.slope_scaled_depth_bias = slope;
        draw.raster.depth_bias_clamp = clamp;
        return b.message_of(draw);
    };
    for (const float slope : {kNan, kInfinity, -kInfinity})
        CHECK(mentions(with(slope, 0.0f), {"draw 'shadows'", "slope-scaled"}));
    CHECK(mentions(with(0.0f, kNan), {"draw 'shadows'", "clamp nan"}));
    const auto sampler = [&](const auto& change) {
        OneCall changed = pixel;
        change(changed.sampler);
        return b.draw(changed);
    };
    for (const int limit : {0, 17, 99})
        CHECK(mentions(sampler([&](Sampler& s) { s.max_anisotropy = limit; }), {"draw 'shadows': sampler", "1 to 16"}));
    for (const float bias : {kNan, -16.5f, 16.0f})
        CHECK(mentions(sampler([&](Sampler& s) { s.lod_bias = bias; }), {"draw 'shadows': sampler", "-16 to 15.99"}));
    CHECK(mentions(sampler([](Sampler& s) { s.min_lod = kNan; }), {"draw 'shadows': sampler", "nan"}));
    CHECK(mentions(sampler([](Sampler& s) { s.max_lod = kNan; }), {"draw 'shadows': sampler", "nan"}));
    CHECK(b.untouched());
    CHECK(with(-2.5f, kInfinity) == "");
    CHECK(sampler([](Sampler& s) { s.max_anisotropy = 16, s.lod_bias = -16.0f, s.max_lod = kInfinity; }) == "");
}

TEST_CASE("mips of depth are not made, and texels that are no depth not written", "[errors]") {
    Bench b;
    for (const Format format : {Format::D16, Format::D24, Format::D32Float, Format::D24UnormS8, Format::D32FloatS8}) {
        const TextureId depth = b.create(format, 1, TextureKind::Flat, 2);
        CHECK(mentions(b.message_of(GenerateMips{depth}), {"mips", format_info(format).name, "not filtered"}));
        const auto write = [&](std::uint32_t code) {
            std::vector<std::uint32_t> codes(64);
            codes[19] = code;
            return b.message_of(WriteTexture{depth, 0, std::as_bytes(std::span(codes))});
        };
        const bool is_float = format_info(format).type == ComponentType::Depth32;
        const std::uint32_t largest = is_float                                             ? 0x3f800000u
                                      : format_info(format).type == ComponentType::Depth16 ? 0xffffu
                                                                                           : 0xffffffu;
        CHECK(write(largest) == "");
        const auto before = b.device.texture(depth).level_bytes(0);
        for (const std::uint32_t code : {largest + 1, 0x7f800000u, 0x7fc00000u, 0x80000000u, 0xbf800000u, 0xffffffffu})
            CHECK(mentions(write(code), {"(3, 2)", format_info(format).name, "expected 0 to"}));
        CHECK(b.device.texture(depth).level_bytes(0) == before);
    }
    CHECK(mentions(b.message_of(GenerateMips{b.create(Format::R32Uint)}), {"mips", "r32ui"}));
}

TEST_CASE("a device refuses profiles that no file could give it, and numbers of threads", "[errors][profile]") {
    const auto message_of = [](const auto& change, int threads = 1) -> std::string {
        Profile profile = load_profile("d3d11");
        profile.name = "mine";
        change(profile);
        try {
            const Device device(profile, threads);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    const auto nothing = [](Profile&) {};
    CHECK(mentions(message_of([](Profile& p) { p.raster_subpixel_bits = 12; }),
                   {"profile 'mine': raster_subpixel_bits", "12", "1 to 8"}));
    CHECK(mentions(message_of([](Profile& p) { p.raster_subpixel_bits = kExactBits; }), {"raster_subpixel_bits", "-1"}));
    CHECK(mentions(message_of([](Profile& p) { p.texel_fraction_bits = 0; }), {"texel_fraction_bits"}));
    CHECK(mentions(message_of([](Profile& p) { p.lod_fraction_bits = -2; }), {"lod_fraction_bits"}));
    CHECK(mentions(message_of([](Profile& p) { p.max_targets = 9; }), {"max_targets"}));
    CHECK(mentions(message_of([](Profile& p) { p.depth_bias_steps = 0; }), {"depth_bias_steps"}));
    for (const int samples : {0, 3, 6, 12, 32})
        CHECK(mentions(message_of([&](Profile& p) { p.max_samples = samples; }), {"max_samples", "1, 2, 4, 8 or 16"}));
    CHECK(mentions(message_of([](Profile& p) { p.sample_positions_4[2] = {16, 0}; }),
                   {"sample_positions_4", "(16, 0)", "0 to 15"}));
    CHECK(mentions(message_of([](Profile& p) { p.sample_positions_16[0] = {3, -1}; }), {"sample_positions_16", "(3, -1)"}));
    CHECK(mentions(message_of([](Profile& p) { p.lod_rule = static_cast<LodRule>(3); }), {"lod_rule", "3", "is not one of"}));
    for (const int threads : {-1, -5, 257, 100000})
        CHECK(mentions(message_of(nothing, threads), {fmt::format("{} threads", threads), "256"}));
    CHECK(message_of(nothing, 0) == "");
    CHECK(message_of([](Profile& p) { p.lod_fraction_bits = p.texel_fraction_bits = kExactBits; }) == "");
    for (const Profile& preset : profile_presets()) CHECK_NOTHROW(Device(preset, 1));
    // Programmable positions may coincide.
    CHECK(message_of([](Profile& p) { p.sample_positions_4.fill({8, 8}); }) == "");
}
