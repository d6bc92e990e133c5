#include "bench/gnomon_pass.h"

#include <chrono>

namespace gnomon::bench {

namespace {

template <class Real>
struct RawInput {
    Vec3<Real> position;
    Vec2<Real> uv;
};

struct DepthVertex {
    template <class Real>
    using Input = RawInput<Real>;
    template <class Real>
    using Varyings = NoVaryings<Real>;

    glm::mat4 clip_from_mesh{1.0f};

    static constexpr auto fields() { return std::tuple{Field{"clip_from_mesh", &DepthVertex::clip_from_mesh}}; }

    template <class V>
    auto operator()(const V& v) const {
        return VertexOutput{transform_point(clip_from_mesh, v.in.position), NoVaryings<typename V::Real>{}};
    }
};

struct UvVertex {
    template <class Real>
    using Input = RawInput<Real>;
    template <class Real>
    using Varyings = Vec2<Real>;

    glm::mat4 clip_from_mesh{1.0f};

    static constexpr auto fields() { return std::tuple{Field{"clip_from_mesh", &UvVertex::clip_from_mesh}}; }

    template <class V>
    auto operator()(const V& v) const {
        return VertexOutput{transform_point(clip_from_mesh, v.in.position), v.in.uv};
    }
};

struct PlainPixel {
    int unused = 0;  // a functor without constants has no fields to name

    static constexpr auto fields() { return std::tuple{Field{"unused", &PlainPixel::unused}}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        return Vec4<Real>{f.in.x, f.in.y, Real(0.5f), Real(1.0f)};
    }
};

struct TexturedPixel {
    TextureId texture = TextureId::None;
    Sampler sampler{};

    static constexpr auto fields() {
        return std::tuple{Field{"texture", &TexturedPixel::texture}, Field{"sampler", &TexturedPixel::sampler}};
    }

    template <class F>
    auto operator()(const F& f) const {
        return f.sample(texture, sampler, f.in);
    }
};

const Program& program_of(peer::RawShading shading) {
    static const Program depth = make_program<DepthVertex>("bench.depth");
    static const Program plain = make_program<UvVertex, PlainPixel>("bench.plain");
    static const Program textured = make_program<UvVertex, TexturedPixel>("bench.textured");
    switch (shading) {
        case peer::RawShading::DepthOnly: return depth;
        case peer::RawShading::Plain: return plain;
        case peer::RawShading::Bilinear:
        case peer::RawShading::Trilinear: return textured;
    }
    __builtin_unreachable();
}

}  // namespace

GnomonPass::GnomonPass(const peer::RawPass& pass, const Profile& profile, int threads)
    : pass_(pass), device_(std::make_unique<Device>(profile, threads)) {
    vertices_ = device_->create_buffer("vertices", std::as_bytes(std::span(pass.mesh.vertices)));
    indices_ = device_->create_buffer("indices", std::as_bytes(std::span(pass.mesh.indices)));
    const auto target = [&](std::string_view label, Format format, int samples) {
        return device_->create_texture(label,
                                       {.format = format, .width = pass.width, .height = pass.height, .samples = samples});
    };
    depth_ = target("depth", Format::D32Float, pass.samples);
    if (pass.shading == peer::RawShading::DepthOnly) return;
    color_ = target("color", Format::Rgba8Unorm, pass.samples);
    if (pass.samples > 1) resolved_ = target("resolved", Format::Rgba8Unorm, 1);
    if (pass.shading == peer::RawShading::Plain) return;
    const int levels = full_level_count(peer::kRawTextureSize, peer::kRawTextureSize);
    texture_ = device_->create_texture(
        "texture",
        {.format = Format::Rgba8Unorm, .width = peer::kRawTextureSize, .height = peer::kRawTextureSize, .levels = levels});
    for (int level = 0; level < levels; ++level) {
        const auto texels = peer::raw_texels(level);
        device_->execute(WriteTexture{.id = texture_, .level = level, .data = std::as_bytes(std::span(texels))});
    }
}

void GnomonPass::run() {
    const bool has_color = color_ != TextureId::None;
    device_->execute(ClearDepth{depth_, 1.0f});
    if (has_color) device_->execute(ClearColor{color_, glm::vec4(0.0f)});
    const DepthVertex depth_vertex{.clip_from_mesh = pass_.mesh.clip_from_mesh};
    const UvVertex uv_vertex{.clip_from_mesh = pass_.mesh.clip_from_mesh};
    const PlainPixel plain;
    const TexturedPixel textured{
        .texture = texture_,
        .sampler = {.mip = pass_.shading == peer::RawShading::Trilinear ? MipFilter::Linear : MipFilter::Base,
                    .address_u = AddressMode::Wrap,
                    .address_v = AddressMode::Wrap}};
    Draw draw{.label = "raw",
              .program = &program_of(pass_.shading),
              .vertex_constants = has_color ? constants_of(uv_vertex) : constants_of(depth_vertex),
              .vertices = vertices_,
              .indices = indices_,
              .count = static_cast<std::uint32_t>(pass_.mesh.indices.size()),
              .depth = depth_};
    if (has_color) {
        draw.pixel_constants = texture_ == TextureId::None ? constants_of(plain) : constants_of(textured);
        draw.color[0] = color_;
    }
    device_->execute(draw);
    if (resolved_ != TextureId::None) device_->execute(Resolve{color_, resolved_});
}

double GnomonPass::time_once() {
    const auto begin = std::chrono::steady_clock::now();
    run();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

peer::RawImage GnomonPass::render() {
    run();
    TextureId shown = color_;
    if (pass_.shading == peer::RawShading::DepthOnly) shown = depth_;
    if (resolved_ != TextureId::None) shown = resolved_;
    return peer::raw_image(pass_, device_->texture(shown).level_bytes(0));
}

}  // namespace gnomon::bench
