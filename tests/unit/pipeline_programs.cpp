#include "tests/unit/pipeline_programs.h"

#include "pipeline/program.h"

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

struct WriteId {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        return Vec4<Real>{f.in.a, Real(0.0f), Real(0.0f), Real(1.0f)};
    }
};

struct Inspect {
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const auto a = f.in.a;
        return std::array<Vec4<Real>, 3>{f.position, Vec4<Real>{a, f.in.b, f.ddx(a), f.ddy(a)},
                                         Vec4<Real>{f.ddx_fine(a), f.ddy_fine(a), Real(0.0f), Real(1.0f)}};
    }
};

}  // namespace

const Program& id_program() {
    static const Program program = make_program<PassThrough, WriteId>("test.id");
    return program;
}
const Program& inspect_program() {
    static const Program program = make_program<PassThrough, Inspect>("test.inspect");
    return program;
}
const Program& depth_only_program() {
    static const Program program = make_program<PassThrough>("test.depth");
    return program;
}

std::span<const std::byte> vertex_constants() {
    static const PassThrough functor;
    return constants_of(functor);
}
std::span<const std::byte> pixel_constants(const Program& program) {
    static const WriteId id;
    static const Inspect inspect;
    if (program.pixel_constants_size == 0) return {};
    return program.targets() == 1 ? constants_of(id) : constants_of(inspect);
}

Draw make_draw(const Program& program, BufferId vertices, std::uint32_t first, std::uint32_t count) {
    return Draw{.label = "test",
                .program = &program,
                .vertex_constants = vertex_constants(),
                .pixel_constants = pixel_constants(program),
                .vertices = vertices,
                .first = first,
                .count = count,
                .raster = {},
                .depth_state = {},
                .viewport = {},
                .color = {}};
}

BufferId upload(Device& device, const std::vector<TestVertex>& vertices) {
    return device.create_buffer("vertices", std::as_bytes(std::span(vertices)));
}

std::vector<float> floats_of(const Texture& texture) {
    const auto bytes = texture.level_bytes(0);
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}
std::vector<std::uint32_t> codes_of(const Texture& texture) {
    const auto bytes = texture.level_bytes(0);
    std::vector<std::uint32_t> values(bytes.size() / sizeof(std::uint32_t));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

}  // namespace gnomon::testing
