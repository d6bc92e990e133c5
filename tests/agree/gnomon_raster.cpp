// GnomonRaster: draws through the device. Clip space has y up here, and y down in Vulkan.
#include "tests/agree/gnomon_raster.h"

#include "pipeline/program.h"
#include "sim/half.h"

#include <bit>
#include <cstring>

namespace gnomon::agree {
namespace {

struct Place {
    template <class Real>
    struct Input {
        Vec4<Real> position;
        Real viewport;
    };
    template <class Real>
    using Varyings = NoVaryings<Real>;
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return LayeredVertexOutput{v.in.position, NoVaryings<Real>{}, Int(0), truncate_to_int(v.in.viewport)};
    }
};

struct WriteOne {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F&) const {
        using Real = typename F::Real;
        return Vec4<Real>{Real(1.0f), Real(1.0f), Real(1.0f), Real(1.0f)};
    }
};

/// The texel of the pixel's own place.
struct Copy {
    TextureId source = TextureId::None;
    static constexpr auto fields() { return std::tuple{Field{"source", &Copy::source}}; }

    template <class F>
    auto operator()(const F& f) const {
        return f.load(source, truncate_to_int(f.position.x), truncate_to_int(f.position.y));
    }
};

/// A place and a colour that is carried one way or the other.
template <gnomon::Interpolation kHow>
struct Painted {
    template <class Real>
    struct Input {
        Vec4<Real> position;
        Vec4<Real> color;
    };
    template <class Real>
    struct Varyings {
        Vec4<Real> color;
        static constexpr std::array interpolation{kHow, kHow, kHow, kHow};
    };
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        return VertexOutput{v.in.position, Varyings<typename V::Real>{v.in.color}};
    }
};
struct WriteColor {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        return f.in.color;
    }
};
template <gnomon::Interpolation kHow>
const Program& painted_program() {
    static const Program kProgram =
        make_program<Painted<kHow>, WriteColor>(kHow == gnomon::Interpolation::Linear ? "agree.linear" : "agree.perspective");
    return kProgram;
}

constexpr Place kPlace;
constexpr WriteOne kWriteOne;
constexpr WriteColor kWriteColor;

const Program& coverage_program() {
    static const Program kProgram = make_program<Place, WriteOne>("agree.coverage");
    return kProgram;
}
const Program& depth_program() {
    static const Program kProgram = make_program<Place>("agree.depth");
    return kProgram;
}
const Program& copy_program() {
    static const Program kProgram = make_program<Place, Copy>("agree.copy");
    return kProgram;
}

void append(std::vector<float>& vertices, const ClipVertex& v, std::size_t viewport) {
    vertices.insert(vertices.end(), {v.clip[0], -v.clip[1], v.clip[2], v.clip[3], static_cast<float>(viewport)});
}

Draw draw_of(const Program& program, std::span<const std::byte> pixel_constants, BufferId vertices, std::size_t count) {
    return Draw{.label = "agree",
                .program = &program,
                .vertex_constants = constants_of(kPlace),
                .pixel_constants = pixel_constants,
                .vertices = vertices,
                .count = static_cast<std::uint32_t>(count),
                .raster = {},
                .depth_state = {},
                .viewport = {},
                .color = {}};
}

gnomon::Viewport viewport_of(const Viewport& v) {
    return {.x = static_cast<float>(v.x),
            .y = static_cast<float>(v.y),
            .width = static_cast<float>(v.width),
            .height = static_cast<float>(v.height)};
}

std::vector<CoveredPixel> covered_in(const Texture& target, const Viewport& viewport) {
    std::vector<CoveredPixel> pixels;
    for (int y = 0; y < viewport.height; ++y)
        for (int x = 0; x < viewport.width; ++x) {
            std::uint32_t mask = 0;
            for (int s = 0; s < target.desc().samples; ++s)
                if (target.row(0, viewport.y + y, 0, s)[viewport.x + x] != std::byte{0}) mask |= 1u << s;
            if (mask != 0) pixels.push_back({x, y, mask});
        }
    return pixels;
}

Format format_of(DepthFormat format) {
    switch (format) {
        case DepthFormat::D16: return Format::D16;
        case DepthFormat::D24: return Format::D24;
        case DepthFormat::D32f: return Format::D32Float;
    }
    __builtin_unreachable();
}
Format format_of(ColorFormat format) {
    switch (format) {
        case ColorFormat::Rgba8: return Format::Rgba8Unorm;
        case ColorFormat::Rgba16Unorm: return Format::Rgba16Unorm;
        case ColorFormat::Rgba16f: return Format::Rgba16Float;
        case ColorFormat::Rgba32f: return Format::Rgba32Float;
    }
    __builtin_unreachable();
}

gnomon::BlendFactor factor_of(BlendFactor factor) {
    using F = gnomon::BlendFactor;
    switch (factor) {
        case BlendFactor::Zero: return F::Zero;
        case BlendFactor::One: return F::One;
        case BlendFactor::SourceColor: return F::SrcColor;
        case BlendFactor::InverseSourceColor: return F::InvSrcColor;
        case BlendFactor::DestinationColor: return F::DstColor;
        case BlendFactor::InverseDestinationColor: return F::InvDstColor;
        case BlendFactor::SourceAlpha: return F::SrcAlpha;
        case BlendFactor::InverseSourceAlpha: return F::InvSrcAlpha;
        case BlendFactor::DestinationAlpha: return F::DstAlpha;
        case BlendFactor::InverseDestinationAlpha: return F::InvDstAlpha;
        case BlendFactor::ConstantColor:
        case BlendFactor::ConstantAlpha: return F::Constant;
        case BlendFactor::InverseConstantColor:
        case BlendFactor::InverseConstantAlpha: return F::InvConstant;
        case BlendFactor::SourceAlphaSaturate: return F::SrcAlphaSaturate;
    }
    __builtin_unreachable();
}

gnomon::BlendState blend_of(const BlendState& state) {
    return {.enable = state.enabled,
            .src = factor_of(state.color.source),
            .dst = factor_of(state.color.destination),
            .op = static_cast<BlendOp>(state.color.operation),
            .src_alpha = factor_of(state.alpha.source),
            .dst_alpha = factor_of(state.alpha.destination),
            .op_alpha = static_cast<BlendOp>(state.alpha.operation)};
}

constexpr int kRow = 256;  // pixels of a row of cases

TextureDesc texture_for(Format format, std::size_t cases, int samples) {
    return {.format = format, .width = kRow, .height = static_cast<int>((cases + kRow - 1) / kRow), .samples = samples};
}

std::size_t channel_bytes(ColorFormat format) {
    return format == ColorFormat::Rgba8 ? 1 : format == ColorFormat::Rgba32f ? 4 : 2;
}

/// Texels as they are stored, with rows filled up.
std::vector<std::byte> packed(ColorFormat format, std::span<const Codes> texels) {
    const std::size_t size = channel_bytes(format);
    std::vector<std::byte> bytes((texels.size() + kRow - 1) / kRow * kRow * 4 * size);
    for (std::size_t i = 0; i < texels.size(); ++i)
        for (std::size_t c = 0; c < 4; ++c) std::memcpy(&bytes[(4 * i + c) * size], &texels[i][c], size);
    return bytes;
}
std::vector<Codes> unpacked(ColorFormat format, const Texture& texture, std::size_t count) {
    const std::size_t size = channel_bytes(format);
    const std::vector<std::byte> bytes = texture.level_bytes(0);
    std::vector<Codes> texels(count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 4; ++c) std::memcpy(&texels[i][c], &bytes[(4 * i + c) * size], size);
    return texels;
}

std::uint32_t float_bits(ColorFormat format, std::uint32_t code) {
    switch (format) {
        case ColorFormat::Rgba8: return std::bit_cast<std::uint32_t>(static_cast<float>(code) / 255.0f);
        case ColorFormat::Rgba16Unorm: return std::bit_cast<std::uint32_t>(static_cast<float>(code) / 65535.0f);
        case ColorFormat::Rgba16f: return std::bit_cast<std::uint32_t>(float_from_half(Half{static_cast<std::uint16_t>(code)}));
        case ColorFormat::Rgba32f: return code;
    }
    __builtin_unreachable();
}

BufferId whole_target(Device& device) {
    std::vector<float> vertices;
    for (const auto& [x, y] : {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {-1.0f, 1.0f}, {1.0f, 1.0f}})
        append(vertices, {.clip = {x, y, 0.5f, 1}}, 0);
    return device.create_buffer("whole target", std::as_bytes(std::span(vertices)));
}

}  // namespace

std::vector<TriangleCoverage> GnomonRaster::coverage(const CoverageOptions& options, std::span<const ClipTriangle> triangles) {
    // As many viewports as do not lie on each other, up to the target's size.
    std::size_t batch = 1;
    int width = options.width;
    int height = options.height;
    while (batch < triangles.size() && coverage_viewport(options, batch) != coverage_viewport(options, 0)) {
        const Viewport v = coverage_viewport(options, batch++);
        width = std::max(width, v.x + v.width);
        height = std::max(height, v.y + v.height);
    }
    const TextureId target = device_.create_texture(
        "coverage", {.format = Format::R8Unorm, .width = width, .height = height, .samples = options.samples});

    std::vector<float> vertices;
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (const ClipVertex& v : triangles[i]) append(vertices, v, i % batch % kMaxViewports);
    const BufferId buffer = device_.create_buffer("triangles", std::as_bytes(std::span(vertices)));

    std::vector<TriangleCoverage> covered;
    while (covered.size() < triangles.size()) {
        const std::size_t first = covered.size();
        const std::size_t end = std::min(first + batch, triangles.size());
        device_.execute(ClearColor{target, {}});
        for (std::size_t i = first; i < end; i += kMaxViewports) {
            const std::size_t count = std::min<std::size_t>(kMaxViewports, end - i);
            std::vector<gnomon::Viewport> viewports;
            std::vector<ScissorRect> scissors;
            for (std::size_t k = i; k < i + count; ++k) {
                const Viewport v = coverage_viewport(options, k);
                viewports.push_back(viewport_of(v));
                scissors.push_back(
                    {v.x + options.inset, v.y + options.inset, v.x + v.width - options.inset, v.y + v.height - options.inset});
            }
            Draw draw = draw_of(coverage_program(), constants_of(kWriteOne), buffer, 3 * count);
            draw.first = static_cast<std::uint32_t>(3 * i);
            draw.viewports = viewports;
            draw.scissors = scissors;
            draw.color[0] = target;
            device_.execute(draw);
        }
        for (std::size_t i = first; i < end; ++i) {
            const Viewport v = coverage_viewport(options, i);
            covered.push_back({v, covered_in(device_.texture(target), v)});
        }
    }
    return covered;
}

std::vector<std::uint32_t> GnomonRaster::depth(const DepthDraw& given) {
    const TextureId target = device_.create_texture(
        "depth", {.format = format_of(given.format), .width = given.width, .height = given.height, .samples = given.samples});
    std::vector<float> vertices;
    for (const ClipVertex& v : given.vertices) append(vertices, v, 0);
    Draw draw = draw_of(depth_program(), {}, device_.create_buffer("vertices", std::as_bytes(std::span(vertices))),
                        given.indices.size());
    draw.indices = device_.create_buffer("indices", std::as_bytes(std::span(given.indices)));
    draw.raster.depth_bias = static_cast<int>(given.bias_constant);
    draw.raster.slope_scaled_depth_bias = given.bias_slope;
    draw.depth = target;
    device_.execute(ClearDepth{target, 1.0f});
    device_.execute(draw);
    std::vector<std::uint32_t> codes;
    const Texture& texture = device_.texture(target);
    for (int y = 0; y < given.height; ++y)
        for (int x = 0; x < given.width; ++x)
            for (int s = 0; s < given.samples; ++s)
                std::memcpy(&codes.emplace_back(), texture.row(0, y, 0, s) + std::ptrdiff_t{4} * x, 4);
    return codes;
}

std::vector<Color> GnomonRaster::attributes(const ClipTriangle& triangle, int width, int height, Interpolation interpolation) {
    const TextureId target =
        device_.create_texture("attributes", {.format = Format::Rgba32Float, .width = width, .height = height});
    std::vector<float> vertices;
    for (const ClipVertex& v : triangle) {
        vertices.insert(vertices.end(), {v.clip[0], -v.clip[1], v.clip[2], v.clip[3]});
        vertices.insert(vertices.end(), v.color.begin(), v.color.end());
    }
    const BufferId buffer = device_.create_buffer("triangle", std::as_bytes(std::span(vertices)));
    device_.execute(ClearColor{target, {}});
    using How = gnomon::Interpolation;
    const Program& program =
        interpolation == Interpolation::Linear ? painted_program<How::Linear>() : painted_program<How::Perspective>();
    Draw draw = draw_of(program, constants_of(kWriteColor), buffer, 3);
    draw.depth_state.test = false;
    draw.color[0] = target;
    device_.execute(draw);
    const auto bytes = device_.texture(target).level_bytes(0);
    std::vector<Color> colors(bytes.size() / sizeof(Color));
    std::memcpy(colors.data(), bytes.data(), bytes.size());
    return colors;
}

std::vector<Codes> GnomonRaster::blend(ColorFormat format, const BlendState& state, std::span<const BlendCase> cases) {
    std::vector<Codes> sources;
    std::vector<Codes> destinations;
    for (const BlendCase& one : cases) {
        sources.push_back(std::bit_cast<Codes>(one.source));
        destinations.push_back(one.destination);
    }
    const TextureId source = device_.create_texture("sources", texture_for(Format::Rgba32Float, cases.size(), 1));
    const TextureId target = device_.create_texture("blended", texture_for(format_of(format), cases.size(), 1));
    device_.execute(WriteTexture{.id = source, .data = packed(ColorFormat::Rgba32f, sources)});
    device_.execute(WriteTexture{.id = target, .data = packed(format, destinations)});
    const Copy copy{source};
    Draw draw = draw_of(copy_program(), constants_of(copy), whole_target(device_), 4);
    draw.topology = Topology::TriangleStrip;
    draw.color[0] = target;
    draw.output.blend[0] = blend_of(state);
    draw.output.blend_constant = {state.constant[0], state.constant[1], state.constant[2], state.constant[3]};
    device_.execute(draw);
    return unpacked(format, device_.texture(target), cases.size());
}

std::vector<Codes> GnomonRaster::resolve(ColorFormat format, std::span<const SampleCodes> pixels) {
    // Written by fragments, as a program does it.
    const TextureId samples = device_.create_texture("samples", texture_for(format_of(format), pixels.size(), 4));
    const TextureId resolved = device_.create_texture("resolved", texture_for(format_of(format), pixels.size(), 1));
    const BufferId vertices = whole_target(device_);
    for (std::size_t s = 0; s < 4; ++s) {
        std::vector<Codes> values;
        for (const SampleCodes& pixel : pixels) {
            Codes& value = values.emplace_back(pixel[s]);
            for (std::uint32_t& code : value) code = float_bits(format, code);
        }
        const TextureId source = device_.create_texture("values", texture_for(Format::Rgba32Float, pixels.size(), 1));
        device_.execute(WriteTexture{.id = source, .data = packed(ColorFormat::Rgba32f, values)});
        const Copy copy{source};
        Draw draw = draw_of(copy_program(), constants_of(copy), vertices, 4);
        draw.topology = Topology::TriangleStrip;
        draw.color[0] = samples;
        draw.output.sample_mask = 1u << s;
        device_.execute(draw);
    }
    device_.execute(gnomon::Resolve{.source = samples, .destination = resolved});
    return unpacked(format, device_.texture(resolved), pixels.size());
}

}  // namespace gnomon::agree
