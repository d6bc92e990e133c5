#include "tests/unit/output_programs.h"

#include "pipeline/program.h"
#include "tests/oracle/output_merger.h"

#include <type_traits>

namespace gnomon::testing {

namespace {

struct PassThrough {
    template <class Real>
    struct Input {
        Vec4<Real> position;
        Real a, b;
    };
    template <class Real>
    struct Varyings {
        Real a, b;
    };
    static constexpr auto fields() { return std::tuple{}; }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return VertexOutput{v.in.position, Varyings<Real>{v.in.a, v.in.b}};
    }
};

struct ChooseLayer : PassThrough {
    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        return LayeredVertexOutput{v.in.position, Varyings<Real>{v.in.a, v.in.b}, truncate_to_int(v.in.a),
                                   truncate_to_int(v.in.b)};
    }
};

struct MoveByInstance : PassThrough {
    template <class Real>
    struct Instance {
        Real x, y;
    };
    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        const Vec4<Real>& p = v.in.position;
        return VertexOutput{Vec4<Real>{p.x + v.instance.x, p.y + v.instance.y, p.z, p.w}, Varyings<Real>{v.in.a, v.in.b}};
    }
};

template <std::size_t kTargets, unsigned kFeatures>
struct FromImages {
    TextureId colors;
    TextureId control;
    static constexpr bool discards = (kFeatures & kDiscards) != 0;
    static constexpr bool force_early = (kFeatures & kEarly) != 0;
    static constexpr bool per_sample = (kFeatures & kPerSample) != 0;
    static constexpr auto fields() {
        return std::tuple{Field{"colors", &FromImages::colors}, Field{"control", &FromImages::control}};
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Int x = truncate_to_int(f.position.x);
        const Int y = truncate_to_int(f.position.y);
        std::array<Vec4<Real>, kTargets> result;
        for (std::size_t i = 0; i < kTargets; ++i)
            result[i] = f.load(colors, x, y, {.layer = f.sample_index() * static_cast<int>(kTargets) + static_cast<int>(i)});
        if constexpr ((kFeatures & (kDiscards | kDepth | kCoverage)) == 0) {
            return result;
        } else {
            const Vec4<Real> how = f.load(control, x, y, {.layer = f.sample_index()});
            if constexpr (discards) f.discard(how.x > Real(0.0f));
            if constexpr ((kFeatures & kDepth) != 0) {
                return DepthOutput{result, how.y};
            } else if constexpr ((kFeatures & kCoverage) != 0) {
                return CoverageOutput{result, truncate_to_int(how.z)};
            } else {
                return result;
            }
        }
    }
};

struct WriteSystemValues {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        return Vec4<Real>{f.in.a, f.in.b, Real(Int(static_cast<int>(f.layer()))), Real(Int(static_cast<int>(f.viewport())))};
    }
};

static_assert(sizeof(FromImages<1, 0>) == sizeof(ImageConstants));

template <std::size_t kTargets, unsigned kFeatures>
const Program& program_of() {
    static const std::string name = fmt::format("test.images.{}.{}", kTargets, kFeatures);
    static const Program program = make_program<PassThrough, FromImages<kTargets, kFeatures>>(name);
    return program;
}

template <unsigned... kFeatures>
const Program& one_target(unsigned features) {
    const Program* found = nullptr;
    ((found = features == kFeatures ? &program_of<1, kFeatures>() : found), ...);
    if (found == nullptr) fail("no test program with the features {}", features);
    return *found;
}

}  // namespace

const Program& image_program(int targets, unsigned features) {
    if (targets == 2 && features == 0) return program_of<2, 0>();
    if (targets == 8 && features == 0) return program_of<8, 0>();
    GNOMON_CHECK_EQ(targets, 1);
    return one_target < 0, kDiscards, kDepth, kCoverage, kDiscards | kDepth, kEarly, kDiscards | kEarly, kDepth | kEarly,
           kCoverage | kEarly, kPerSample, kDiscards | kPerSample, kDepth | kPerSample, kCoverage | kPerSample > (features);
}
const Program& layered_program() {
    static const Program program = make_program<ChooseLayer, WriteSystemValues>("test.layered");
    return program;
}
const Program& layered_depth_program() {
    static const Program program = make_program<ChooseLayer>("test.layered-depth");
    return program;
}

const Program& per_instance_program() {
    static const Program program = make_program<MoveByInstance>("test.instanced");
    return program;
}

TextureId Canvas::target(Format format, int layers) {
    return device.create_texture("target", {.format = format,
                                            .width = width,
                                            .height = height,
                                            .kind = layers > 1 ? TextureKind::Array : TextureKind::Flat,
                                            .layers = layers,
                                            .samples = samples});
}

TextureId Canvas::image(const Image& texels) {
    const int slices = static_cast<int>(texels.size() / pixels());
    const TextureId id = device.create_texture(
        "image",
        {.format = Format::Rgba32Float, .width = width, .height = height, .kind = TextureKind::Array, .layers = slices});
    for (int i = 0; i < slices; ++i)
        device.execute(
            WriteTexture{id, 0, std::as_bytes(std::span(texels).subspan(static_cast<std::size_t>(i) * pixels(), pixels())), i});
    return id;
}

std::vector<TestVertex> Canvas::corners(const Box& box, float z, float a, float b) const {
    const auto at = [&](float x, float y) {
        return TestVertex{
            2.0f * x / static_cast<float>(width) - 1.0f, 1.0f - 2.0f * y / static_cast<float>(height), z, 1.0f, a, b};
    };
    return {at(box.x0, box.y0), at(box.x1, box.y0), at(box.x0, box.y1),
            at(box.x1, box.y0), at(box.x1, box.y1), at(box.x0, box.y1)};
}

Draw Canvas::rectangle(const Program& program, const Box& box, float z, const ImageConstants& images) {
    Draw draw = make_draw(program, upload(device, corners(box, z)), 0, 6);
    if (program.pixel_constants_size != 0) {
        // Spans of earlier draws must stay where they are.
        GNOMON_CHECK(constants.size() < constants.capacity());
        constants.push_back(images);
        draw.pixel_constants = constants_of(constants.back());
    }
    return draw;
}

std::uint32_t Canvas::code(TextureId id, std::size_t pixel, int c, int layer, int sample) const {
    const Texture& texture = device.texture(id);
    const auto x = static_cast<std::ptrdiff_t>(pixel % static_cast<std::size_t>(width));
    const auto y = static_cast<int>(pixel / static_cast<std::size_t>(width));
    return oracle::stored_code(texture.desc().format, texture.row(0, y, layer, sample) + x * texture.info().bytes_per_texel, c);
}

int Canvas::stencil(TextureId id, std::size_t pixel, int layer, int sample) const {
    const auto x = static_cast<std::ptrdiff_t>(pixel % static_cast<std::size_t>(width));
    return device.texture(id).stencil_row(0, static_cast<int>(pixel / static_cast<std::size_t>(width)), layer, sample)[x];
}

}  // namespace gnomon::testing
