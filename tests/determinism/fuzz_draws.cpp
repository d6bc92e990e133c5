#include "tests/determinism/fuzz_draws.h"

#include "pipeline/device.h"
#include "pipeline/program.h"
#include "tests/oracle/random.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace gnomon::testing {

namespace {

using oracle::Random;

template <class Real>
struct FuzzInput {
    Vec4<Real> position;
    Real a, b, c, layer, viewport;
};

struct PlainVertex {
    template <class Real>
    using Input = FuzzInput<Real>;
    template <class Real>
    struct Varyings {
        Real a, b, c, d;
        static constexpr std::array interpolation{Interpolation::Perspective, Interpolation::Linear,
                                                  Interpolation::PerspectiveCentroid, Interpolation::Flat};
    };
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return VertexOutput{v.in.position, Varyings<Real>{v.in.a, v.in.b, v.in.c, Real(v.vertex_id)}};
    }
};

struct InstancedVertex : PlainVertex {
    template <class Real>
    struct Instance {
        Real x, y, layer;
    };
    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        const Vec4<Real> p{v.in.position.x + v.instance.x * v.in.position.w, v.in.position.y + v.instance.y * v.in.position.w,
                           v.in.position.z, v.in.position.w};
        return LayeredVertexOutput{p, Varyings<Real>{v.in.a, v.in.b, v.in.c, Real(v.instance_id)},
                                   truncate_to_int(v.in.layer + v.instance.layer), truncate_to_int(v.in.viewport)};
    }
};

/// One of everything a functor may say, by flags.
template <std::size_t kTargets, bool kDiscards, bool kWritesDepth, bool kWritesCoverage, bool kEarly, bool kSamples>
struct FuzzPixel {
    TextureId texture;
    Sampler sampler;
    static constexpr bool discards = kDiscards;
    static constexpr bool force_early = kEarly;
    static constexpr bool per_sample = kSamples;
    static constexpr auto fields() {
        return std::tuple{Field{"texture", &FuzzPixel::texture}, Field{"sampler", &FuzzPixel::sampler}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        if constexpr (kDiscards) f.discard(f.in.b > Real(0.75f));
        Vec4<Real> color{f.in.a, f.in.b, f.in.c, f.in.d};
        f.branch(f.in.a > Real(0.25f), [&] {
            const Vec4<Real> texel = f.sample(texture, sampler, Vec2<Real>{f.in.a, f.in.c});
            const Mask here = f.in.a > Real(0.25f);
            color.x = select(here, texel.x, color.x);
            color.w = select(here, texel.y, color.w);
        });
        std::array<Vec4<Real>, kTargets> colors;
        for (std::size_t i = 0; i < kTargets; ++i)
            colors[i] = i % 2 == 0 ? color : Vec4<Real>{f.position.z, f.ddx(f.in.a), f.ddy(f.in.b), f.position.w};
        if constexpr (kWritesDepth) {
            return DepthOutput{colors, f.position.z + f.in.b};
        } else if constexpr (kWritesCoverage) {
            return CoverageOutput{colors, f.coverage() & truncate_to_int(f.in.c * Real(16.0f))};
        } else {
            return colors;
        }
    }
};

using Constants = FuzzPixel<1, false, false, false, false, false>;

template <class Vertex>
std::vector<const Program*> programs_of() {
    static const std::array programs{make_program<Vertex>("fuzz.depth"),
                                     make_program<Vertex, FuzzPixel<1, false, false, false, false, false>>("fuzz.color"),
                                     make_program<Vertex, FuzzPixel<2, true, false, false, false, false>>("fuzz.discards"),
                                     make_program<Vertex, FuzzPixel<4, false, false, false, false, true>>("fuzz.samples"),
                                     make_program<Vertex, FuzzPixel<1, true, true, false, false, false>>("fuzz.depth-output"),
                                     make_program<Vertex, FuzzPixel<2, false, false, true, false, true>>("fuzz.coverage"),
                                     make_program<Vertex, FuzzPixel<4, true, false, false, true, false>>("fuzz.early")};
    std::vector<const Program*> list;
    for (const Program& program : programs) list.push_back(&program);
    return list;
}

float any_of(Random& random, std::initializer_list<float> values) {
    return *(values.begin() + random.integer(0, static_cast<int>(values.size()) - 1));
}
template <class E>
E any_enum(Random& random) {
    return kEnumNames<E>[static_cast<std::size_t>(random.integer(0, static_cast<int>(kEnumNames<E>.size()) - 1))].value;
}

/// Mostly near the screen; now and then far away, behind the viewer or no number.
float coordinate(Random& random) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    switch (random.integer(0, 40)) {
        case 0: return any_of(random, {kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN(), 1e30f, -1e30f, 3e38f});
        case 1: return random.any_float();
        case 2: return random.in(-3000.0f, 3000.0f);
        case 3: return any_of(random, {0.0f, -0.0f, 1.0f, -1.0f, 1e-30f, 1e-42f});
        default: return random.in(-1.3f, 1.3f);
    }
}

class Stream {
public:
    Stream(const Profile& profile, std::uint64_t seed, const FuzzOptions& options)
        : random_(seed), options_(options), device_(profile, options.threads) {
        device_.enable_counters(true);
        make_targets();
        make_geometry();
    }

    FuzzResult run() {
        for (int i = 0; i < kDrawsPerStream; ++i) draw();
        FuzzResult result{.bytes = {}, .counters = device_.take_counters()};
        for (const TextureId id : targets_) append(device_.texture(id), result.bytes);
        return result;
    }

private:
    void make_targets() {
        const Profile& profile = device_.profile();
        samples_ = 1 << random_.integer(0, 4);
        while (samples_ > profile.max_samples) samples_ /= 2;
        if (random_.chance(3)) samples_ = 1;
        layers_ = random_.chance(3) ? random_.integer(2, 3) : 1;
        const int width = random_.integer(1, 150);
        const int height = random_.integer(1, 90);
        const auto create = [&](Format format) {
            const TextureDesc desc{.format = format,
                                   .width = width,
                                   .height = height,
                                   .kind = layers_ > 1 ? TextureKind::Array : TextureKind::Flat,
                                   .layers = layers_,
                                   .samples = samples_};
            targets_.push_back(device_.create_texture("target", desc));
        };
        const auto makes_sense = [&](const FormatInfo& info) {
            const bool is_float = info.type == ComponentType::Float16 || info.type == ComponentType::Float32 ||
                                  info.type == ComponentType::Float11;
            return !info.is_depth && (samples_ == 1 || profile.multisamples_float || !is_float);
        };
        while (targets_.size() < 4) {
            const FormatInfo& info =
                kFormats[static_cast<std::size_t>(random_.integer(0, static_cast<int>(kFormats.size()) - 1))];
            if (makes_sense(info)) create(info.format);
        }
        constexpr std::array kDepths{Format::D24UnormS8, Format::D32FloatS8, Format::D16, Format::D24, Format::D32Float};
        create(kDepths[static_cast<std::size_t>(random_.integer(0, 4))]);
        const float clear = any_of(random_, {1.0f, 1.0f, 0.0f, 0.5f});
        device_.execute(ClearDepth{TargetView(targets_.back(), 0, 0, layers_), clear});
        if (samples_ == 1 && layers_ == 1) {
            targets_.push_back(device_.create_texture("report", {.format = Format::R32Uint, .width = width, .height = height}));
            report_ = targets_.back();
        }

        texture_ = device_.create_texture("texture", {.width = 16, .height = 16, .levels = 5});
        std::vector<std::byte> texels(16 * 16 * 4);
        for (std::byte& byte : texels) byte = static_cast<std::byte>(random_.bits() & 255u);
        device_.execute(WriteTexture{texture_, 0, texels});
        device_.execute(GenerateMips{texture_});
    }

    void make_geometry() {
        std::vector<float> vertices;
        for (int i = 0; i < kVertices; ++i) {
            // Runs of clean vertices, so that most primitives are drawn.
            const bool clean = i / 30 % 3 != 0;
            for (int k = 0; k < 3; ++k) vertices.push_back(clean ? random_.in(-1.2f, 1.2f) : coordinate(random_));
            if (clean) vertices.back() = random_.unit();
            vertices.push_back(clean ? random_.in(0.5f, 2.0f) : random_.chance(2) ? 1.0f : coordinate(random_));
            for (int k = 0; k < 3; ++k) vertices.push_back(clean ? random_.in(-0.5f, 1.5f) : coordinate(random_));
            vertices.push_back(static_cast<float>(random_.integer(-1, 3)));
            vertices.push_back(static_cast<float>(random_.integer(-1, 16)));
        }
        vertices_ = device_.create_buffer("vertices", std::as_bytes(std::span(vertices)));
        std::vector<float> instances;
        for (int i = 0; i < kInstances; ++i) {
            instances.push_back(random_.in(-0.3f, 0.3f));
            instances.push_back(random_.in(-0.3f, 0.3f));
            instances.push_back(static_cast<float>(random_.integer(0, 2)));
        }
        instances_ = device_.create_buffer("instances", std::as_bytes(std::span(instances)));
        std::vector<std::uint16_t> short_indices;
        std::vector<std::uint32_t> long_indices;
        for (int i = 0; i < kIndices; ++i) {
            const bool restart = random_.chance(12);
            const auto index = static_cast<std::uint32_t>(random_.integer(0, kVertices - 8));
            short_indices.push_back(restart ? std::uint16_t{0xffff} : static_cast<std::uint16_t>(index));
            long_indices.push_back(restart ? 0xffffffffu : index);
        }
        short_indices_ = device_.create_buffer("short", std::as_bytes(std::span(short_indices)));
        long_indices_ = device_.create_buffer("long", std::as_bytes(std::span(long_indices)));
    }

    [[nodiscard]] TargetView view(TextureId id) const { return TargetView(id, 0, 0, layers_); }

    void draw() {
        const bool instanced = layers_ > 1 || random_.chance(3);
        const auto programs = instanced ? programs_of<InstancedVertex>() : programs_of<PlainVertex>();
        const Program& program = *programs[static_cast<std::size_t>(random_.integer(0, static_cast<int>(programs.size()) - 1))];
        Draw draw{.label = "fuzz", .program = &program};
        const PlainVertex vertex;
        Constants constants{.texture = texture_, .sampler = {.mip = MipFilter::Linear}};
        constants.sampler.address_u = any_enum<AddressMode>(random_);
        constants.sampler.max_anisotropy = random_.chance(4) ? 4 : 1;
        draw.vertex_constants = constants_of(vertex);
        if (program.pixel_constants_size != 0) draw.pixel_constants = constants_of(constants);

        draw.topology = any_enum<Topology>(random_);
        draw.vertices = vertices_;
        if (random_.chance(2)) {
            draw.index_type = any_enum<IndexType>(random_);
            draw.indices = draw.index_type == IndexType::Uint16 ? short_indices_ : long_indices_;
            draw.primitive_restart = true;
            draw.base_vertex = random_.integer(0, 7);
            draw.first = static_cast<std::uint32_t>(random_.integer(0, 40));
            draw.count = static_cast<std::uint32_t>(random_.integer(0, kIndices - 40));
        } else {
            draw.first = static_cast<std::uint32_t>(random_.integer(0, 40));
            draw.count = static_cast<std::uint32_t>(random_.integer(0, kVertices - 40));
        }
        if (instanced) {
            draw.instances = instances_;
            draw.first_instance = static_cast<std::uint32_t>(random_.integer(0, 2));
            draw.instance_count = static_cast<std::uint32_t>(random_.integer(1, 3));
        }

        choose_raster(draw.raster);
        draw.depth_state = {.test = !random_.chance(6), .write = !random_.chance(4), .compare = CompareOp::Less};
        if (!random_.chance(2)) draw.depth_state.compare = any_enum<CompareOp>(random_);
        if (random_.chance(2)) choose_stencil(draw.stencil);
        choose_output(draw, program);
        if (!random_.chance(5)) draw.depth = view(targets_[4]);
        if (options_.idle_stencil && !draw.stencil.test) {
            draw.stencil = {};
            draw.stencil.test = true;
        }
        if (report_ != TextureId::None && program.targets() > 0 && random_.chance(3)) draw.derivative_report = report_;

        std::vector<Viewport> viewports;
        std::vector<ScissorRect> scissors;
        choose_viewports(instanced, viewports, scissors);
        draw.viewports = viewports;
        draw.scissors = scissors;
        if (draw.depth.texture == TextureId::None && program.targets() == 0) draw.depth = view(targets_[4]);
        device_.execute(draw);
    }

    void choose_raster(RasterState& raster) {
        raster.fill = random_.chance(5) ? FillMode::Wireframe : FillMode::Solid;
        raster.cull = random_.chance(3) ? any_enum<CullMode>(random_) : CullMode::None;
        raster.front_counter_clockwise = random_.chance(2);
        raster.provoking = any_enum<ProvokingVertex>(random_);
        raster.lines = any_enum<LineMode>(random_);
        raster.depth_clip = !random_.chance(3);
        if (random_.chance(3)) {
            raster.depth_bias = random_.integer(-2000, 2000);
            raster.slope_scaled_depth_bias = random_.in(-3.0f, 3.0f);
            raster.depth_bias_clamp = any_of(random_, {0.0f, 0.01f, -0.01f});
        }
    }

    void choose_stencil(StencilState& stencil) {
        stencil.test = true;
        stencil.reference = random_.integer(0, 255);
        stencil.read_mask = random_.integer(0, 255);
        stencil.write_mask = random_.integer(0, 255);
        for (StencilFace* face : {&stencil.front, &stencil.back}) {
            face->compare = random_.chance(2) ? CompareOp::Always : any_enum<CompareOp>(random_);
            face->fail = any_enum<StencilOp>(random_);
            face->depth_fail = any_enum<StencilOp>(random_);
            face->pass = any_enum<StencilOp>(random_);
        }
    }

    void choose_output(Draw& draw, const Program& program) {
        const Profile& profile = device_.profile();
        OutputState& output = draw.output;
        if (random_.chance(4)) output.sample_mask = random_.bits();
        output.alpha_to_coverage = random_.chance(4);
        for (int c = 0; c < 4; ++c) output.blend_constant[c] = random_.in(-0.5f, 1.5f);
        const bool dual = program.targets() == 2 && random_.chance(2);
        for (std::size_t i = 0; i < static_cast<std::size_t>(program.targets()); ++i) {
            if (i > 0 && (dual || random_.chance(5))) continue;
            draw.color[i] = view(targets_[i]);
            const FormatInfo& info = device_.texture(targets_[i]).info();
            const bool blends =
                !info.is_integer() && (info.type != ComponentType::Float32 || profile.blends_float32) &&
                ((info.type != ComponentType::Float16 && info.type != ComponentType::Float11) || profile.blends_float16);
            BlendState& state = output.blend[i];
            if (random_.chance(4)) state.write_mask = random_.integer(0, 15);
            if (!blends || random_.chance(2)) continue;
            state.enable = true;
            const auto factor = [&] {
                const int last = static_cast<int>(dual ? BlendFactor::InvSrc1Alpha : BlendFactor::InvConstant);
                return static_cast<BlendFactor>(random_.integer(0, last));
            };
            state.src = factor();
            state.dst = factor();
            state.src_alpha = factor();
            state.dst_alpha = factor();
            state.op = static_cast<BlendOp>(random_.integer(0, dual ? 2 : 4));
            state.op_alpha = static_cast<BlendOp>(random_.integer(0, dual ? 2 : 4));
        }
        if (program.targets() > 0 && draw.color[0].texture == TextureId::None) draw.color[0] = view(targets_[0]);
    }

    void choose_viewports(bool several, std::vector<Viewport>& viewports, std::vector<ScissorRect>& scissors) {
        const Texture& target = device_.texture(targets_[0]);
        const int count = several ? random_.integer(1, kMaxViewports) : 1;
        const bool scissor = random_.chance(3);
        for (int i = 0; i < count; ++i) {
            Viewport viewport;
            if (!random_.chance(3)) {
                viewport = {.x = random_.in(-20.0f, 60.0f), .y = random_.in(-20.0f, 40.0f)};
                viewport.width = random_.chance(6) ? random_.in(0.01f, 30000.0f) : random_.in(1.0f, 150.0f);
                viewport.height = random_.in(0.5f, 100.0f);
                if (random_.chance(2)) {
                    viewport.x = static_cast<float>(random_.integer(-4, 50));
                    viewport.width = static_cast<float>(random_.integer(1, 128));
                }
            }
            if (random_.chance(3)) {
                viewport.min_depth = random_.in(0.0f, 0.5f);
                viewport.max_depth = random_.in(0.5f, 1.0f);
            }
            viewports.push_back(viewport);
            if (!scissor) continue;
            ScissorRect rect;
            rect.x0 = random_.integer(-10, target.width(0));
            rect.y0 = random_.integer(-10, target.height(0));
            rect.x1 = random_.chance(8) ? std::numeric_limits<int>::max() : random_.integer(-5, 200);
            rect.y1 = random_.integer(-5, 200);
            scissors.push_back(rect);
        }
    }

    static void append(const Texture& texture, std::vector<std::byte>& bytes) {
        for (int layer = 0; layer < texture.desc().layers; ++layer)
            for (int s = 0; s < texture.desc().samples; ++s) {
                const auto level = texture.level_bytes(0, layer, s);
                bytes.insert(bytes.end(), level.begin(), level.end());
                if (!texture.info().has_stencil) continue;
                for (const std::uint8_t value : texture.stencil_bytes(0, layer, s)) bytes.push_back(std::byte{value});
            }
    }

    static constexpr int kVertices = 120;
    static constexpr int kInstances = 5;
    static constexpr int kIndices = 160;

    Random random_;
    FuzzOptions options_;
    Device device_;
    int samples_ = 1;
    int layers_ = 1;
    std::vector<TextureId> targets_;  // four of colour, one of depth, perhaps the report
    TextureId report_ = TextureId::None;
    TextureId texture_ = TextureId::None;
    BufferId vertices_{}, instances_{}, short_indices_{}, long_indices_{};
};

}  // namespace

FuzzResult run_fuzz_stream(const Profile& profile, std::uint64_t seed, const FuzzOptions& options) {
    return Stream(profile, seed, options).run();
}

}  // namespace gnomon::testing
