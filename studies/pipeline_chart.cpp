#include "studies/pipeline_chart.h"

#include "pipeline/derivatives.h"
#include "pipeline/device.h"
#include "scenes/view.h"
#include "sim/scalar_math.h"
#include "studies/experiment.h"
#include "studies/false_color.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace gnomon::studies {

namespace {

constexpr float kPi = 3.14159265f;
constexpr int kCoarseSide = 32;  // pixels of the panels that show single pixels; each is drawn as a square of 6 x 6

/// Position and colour; scenes' meshes, whose second half is a normal, show their normals.
struct ChartVertex {
    glm::vec3 position;
    glm::vec3 color;
};
static_assert(sizeof(ChartVertex) == sizeof(scenes::Vertex));

struct ChartVertexFunctor {
    glm::mat4 clip_from_object{1.0f};
    float color_scale = 1.0f;
    float color_offset = 0.0f;

    template <class Real>
    struct Input {
        Vec3<Real> position;
        Vec3<Real> color;
    };
    template <class Real>
    struct Varyings {
        Vec3<Real> color;
    };
    static constexpr auto fields() {
        using C = ChartVertexFunctor;
        return std::tuple{Field{"clip_from_object", &C::clip_from_object}, Field{"color_scale", &C::color_scale},
                          Field{"color_offset", &C::color_offset}};
    }

    template <class V>
    auto operator()(const V& v) const {
        using Real = typename V::Real;
        const Vec3<Real> offset = splat<Real>(glm::vec3(color_offset));
        return VertexOutput{transform_point(clip_from_object, v.in.position),
                            Varyings<Real>{v.in.color * Real(color_scale) + offset}};
    }
};

struct ChartPaint {
    float alpha = 1.0f;

    static constexpr auto fields() { return std::tuple{Field{"alpha", &ChartPaint::alpha}}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        return Vec4<Real>{f.in.color.x, f.in.color.y, f.in.color.z, Real(alpha)};
    }
};

/// Takes derivatives of a colour around a hole that it discards, and inside a branch: every bad cause there is.
struct ChartDerivatives {
    static constexpr bool discards = true;
    static constexpr auto fields() { return std::tuple{}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec3<Real> c = f.in.color;
        const Real dx = c.x - Real(0.35f);
        const Real dy = c.y - Real(0.35f);
        f.discard(dx * dx + dy * dy < Real(0.02f));
        Real slope = f.ddx(c.x);
        const Mask right = c.x > Real(0.643f);
        f.branch(right, [&] { slope = select(right, f.ddy(c.y), slope); });
        return Vec4<Real>{slope, slope, slope, Real(1.0f)};
    }
};

const Program& paint_program() {
    static const Program program = make_program<ChartVertexFunctor, ChartPaint>("chart.paint");
    return program;
}
const Program& derivatives_program() {
    static const Program program = make_program<ChartVertexFunctor, ChartDerivatives>("chart.derivatives");
    return program;
}
const Program& depth_program() {
    static const Program program = make_program<ChartVertexFunctor>("chart.depth");
    return program;
}

/// One panel's targets and the draws into them.
class Panel {
public:
    Panel(Device& device, int side, int samples = 1, bool has_depth = false) : device_(device), side_(side) {
        const auto make = [&](const char* label, Format format, int count) {
            return device.create_texture(label, {.format = format, .width = side, .height = side, .samples = count});
        };
        picture_ = make("picture", Format::Rgba8Unorm, 1);
        color_ = samples == 1 ? picture_ : make("samples", Format::Rgba8Unorm, samples);
        device.execute(ClearColor{color_, {1.0f, 1.0f, 1.0f, 1.0f}});
        if (!has_depth) return;
        depth_ = make("depth", Format::D24UnormS8, samples);
        device.execute(ClearDepth{depth_, 1.0f});
        device.execute(ClearStencil{depth_, 0});
    }

    /// Draws vertices; `draw` has the state.
    void draw(const std::vector<ChartVertex>& vertices, const ChartVertexFunctor& vertex, const ChartPaint& paint, Draw draw) {
        draw.program = draw.program == nullptr ? &paint_program() : draw.program;
        draw.vertex_constants = constants_of(vertex);
        if (draw.program == &paint_program()) draw.pixel_constants = constants_of(paint);
        const ChartDerivatives derivatives;
        if (draw.program == &derivatives_program()) draw.pixel_constants = constants_of(derivatives);
        draw.vertices = device_.create_buffer("vertices", std::as_bytes(std::span(vertices)));
        draw.count = static_cast<std::uint32_t>(vertices.size());
        if (draw.program->targets() > 0) draw.color[0] = color_;
        draw.depth = depth_;
        device_.execute(draw);
    }

    /// The picture, each pixel as a square so that the panel is kPanelSide wide.
    ByteImage image() {
        if (color_ != picture_) device_.execute(Resolve{color_, picture_});
        return enlarged(color_image(device_.texture(picture_)));
    }
    [[nodiscard]] TextureId picture() const { return picture_; }
    [[nodiscard]] ByteImage enlarged(const ByteImage& small) const {
        ByteImage image{.width = kPanelSide, .height = kPanelSide, .channels = 3, .values = {}};
        const int scale = kPanelSide / side_;
        for (int y = 0; y < kPanelSide; ++y)
            for (int x = 0; x < kPanelSide; ++x)
                for (int c = 0; c < 3; ++c)
                    image.values.push_back(small.values[static_cast<std::size_t>((y / scale * side_ + x / scale) * 3 + c)]);
        return image;
    }

private:
    Device& device_;
    int side_;
    TextureId picture_ = TextureId::None;
    TextureId color_ = TextureId::None;
    TextureId depth_ = TextureId::None;
};

glm::vec3 on_circle(float angle, float radius) {
    const auto a = static_cast<double>(angle);
    return {radius * static_cast<float>(scalar::cos(a)), radius * static_cast<float>(scalar::sin(a)), 0.5f};
}

constexpr glm::vec3 kInk{0.12f, 0.16f, 0.3f};
constexpr glm::vec3 kRust{0.8f, 0.3f, 0.12f};

/// Narrow blades around the middle.
std::vector<ChartVertex> blades() {
    std::vector<ChartVertex> vertices;
    constexpr int kBlades = 11;
    for (int i = 0; i < kBlades; ++i) {
        const float at = 2.0f * kPi * (static_cast<float>(i) + 0.3f) / kBlades;
        const glm::vec3 color = i % 2 == 0 ? kInk : kRust;
        vertices.push_back({on_circle(at + 1.5f, 0.12f), color});
        vertices.push_back({on_circle(at, 0.95f), color});
        vertices.push_back({on_circle(at - 0.22f, 0.9f), color});
    }
    return vertices;
}

/// The same rays as lines.
std::vector<ChartVertex> rays() {
    std::vector<ChartVertex> vertices;
    constexpr int kRays = 14;
    for (int i = 0; i < kRays; ++i) {
        const float at = 2.0f * kPi * (static_cast<float>(i) + 0.2f) / kRays;
        const glm::vec3 color = i % 2 == 0 ? kInk : kRust;
        vertices.push_back({on_circle(at, 0.15f), color});
        vertices.push_back({on_circle(at, 0.95f), color});
    }
    return vertices;
}

std::vector<ChartVertex> disc(const glm::vec3& center, float radius, const glm::vec3& color) {
    std::vector<ChartVertex> vertices;
    constexpr int kSides = 48;
    for (int i = 0; i < kSides; ++i) {
        const auto rim = [&](int k) {
            const glm::vec3 at = on_circle(2.0f * kPi * static_cast<float>(k) / kSides, radius);
            return ChartVertex{{center.x + at.x, center.y + at.y, 0.5f}, color};
        };
        vertices.insert(vertices.end(), {{{center.x, center.y, 0.5f}, color}, rim(i), rim((i + 1) % kSides)});
    }
    return vertices;
}

ByteImage wireframe_panel(Device& device) {
    Panel panel(device, kPanelSide, 1, true);
    const scenes::Scene scene = find_scene("car", {});
    const glm::mat4 clip_from_world = scenes::camera_view(scene.camera, 1.0f).clip_from_world();
    for (const scenes::Instance& instance : scene.instances) {
        const scenes::Mesh& mesh = scene.meshes[instance.mesh];
        std::vector<ChartVertex> corners;
        corners.reserve(mesh.indices.size());
        for (const std::uint32_t index : mesh.indices)
            corners.push_back({mesh.vertices[index].position, mesh.vertices[index].normal});
        const ChartVertexFunctor vertex{
            .clip_from_object = clip_from_world * instance.world_from_object, .color_scale = 0.4f, .color_offset = 0.4f};
        // Depth first, behind by a bias, so that only the lines in front are seen.
        panel.draw(corners, vertex, {},
                   {.program = &depth_program(), .raster = {.depth_bias = 64, .slope_scaled_depth_bias = 2.0f}});
        panel.draw(corners, vertex, {},
                   {.raster = {.fill = FillMode::Wireframe, .cull = CullMode::Back},
                    .depth_state = {.compare = CompareOp::LessEqual}});
    }
    return panel.image();
}

/// An upright box, counter-clockwise from outside; each face lit for itself.
struct Box {
    glm::vec3 low, high;

    [[nodiscard]] glm::vec3 corner(unsigned i) const {
        return {(i & 1u) != 0 ? high.x : low.x, (i & 2u) != 0 ? high.y : low.y, (i & 4u) != 0 ? high.z : low.z};
    }
};
constexpr std::array<std::array<unsigned, 4>, 6> kBoxFaces{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
constexpr std::array<glm::vec3, 6> kBoxNormals{{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

void add_quad(std::vector<ChartVertex>& to, const std::array<glm::vec3, 4>& at, const glm::vec3& color) {
    for (const std::size_t i : {0u, 1u, 2u, 0u, 2u, 3u}) to.push_back({at[i], color});
}

/// What the light reaches of a box: the faces towards it, those away moved along it, and walls where the two kinds meet.
void add_shadow_volume(std::vector<ChartVertex>& to, const Box& box, const glm::vec3& light_direction) {
    const auto lit = [&](std::size_t face) { return glm::dot(kBoxNormals[face], light_direction) < 0.0f; };
    const auto far = [&](const glm::vec3& p) { return p + light_direction * 8.0f; };
    for (std::size_t face = 0; face < 6; ++face) {
        std::array<glm::vec3, 4> at;
        for (std::size_t i = 0; i < 4; ++i) at[i] = box.corner(kBoxFaces[face][i]);
        if (lit(face)) {
            add_quad(to, at, kInk);
        } else {
            add_quad(to, {far(at[0]), far(at[1]), far(at[2]), far(at[3])}, kInk);
            continue;
        }
        for (std::size_t i = 0; i < 4; ++i) {
            const unsigned a = kBoxFaces[face][i];
            const unsigned b = kBoxFaces[face][(i + 1) % 4];
            for (std::size_t other = 0; other < 6; ++other) {
                const auto& o = kBoxFaces[other];
                bool shares = false;
                for (std::size_t k = 0; k < 4; ++k) shares = shares || (o[k] == b && o[(k + 1) % 4] == a);
                if (!shares || lit(other)) continue;
                add_quad(to, {box.corner(b), box.corner(a), far(box.corner(a)), far(box.corner(b))}, kInk);
            }
        }
    }
}

/// Depth-fail shadow volumes: ambient light, the volumes into the stencil of what lies behind their faces, then the light
/// where front and back faces cancel.
ByteImage shadow_volume_panel(Device& device) {
    Panel panel(device, kPanelSide, 4, true);
    const glm::vec3 light = glm::vec3(0.55f, -0.75f, -0.35f);
    const std::array<Box, 3> boxes{{{{-0.9f, 0.0f, -0.3f}, {-0.5f, 1.1f, 0.1f}},
                                    {{-0.1f, 0.0f, -0.9f}, {0.5f, 0.5f, -0.3f}},
                                    {{0.1f, 0.9f, 0.2f}, {0.5f, 1.2f, 0.6f}}}};
    scenes::Camera camera{.world_from_camera = scenes::looking_at({2.2, 2.8, 3.6}, {0.1, 0.3, -0.1}), .yfov_rad = 0.7f};
    const ChartVertexFunctor vertex{.clip_from_object = scenes::camera_view(camera, 1.0f).clip_from_world()};

    std::vector<ChartVertex> ambient;
    std::vector<ChartVertex> lit;
    const auto add = [&](const std::array<glm::vec3, 4>& at, const glm::vec3& normal, const glm::vec3& color) {
        add_quad(ambient, at, color * 0.3f);
        add_quad(lit, at, color * (0.3f + 0.7f * std::max(0.0f, -glm::dot(normal, light))));
    };
    add({{{-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}}}, {0, 1, 0}, {0.9f, 0.88f, 0.8f});
    std::vector<ChartVertex> volumes;
    for (const Box& box : boxes) {
        for (std::size_t face = 0; face < 6; ++face) {
            std::array<glm::vec3, 4> at;
            for (std::size_t i = 0; i < 4; ++i) at[i] = box.corner(kBoxFaces[face][i]);
            add(at, kBoxNormals[face], {0.85f, 0.45f, 0.25f});
        }
        add_shadow_volume(volumes, box, light);
    }
    panel.draw(ambient, vertex, {}, {});
    panel.draw(
        volumes, vertex, {},
        {.program = &depth_program(),
         .raster = {.depth_clip = false},
         .depth_state = {.write = false},
         .stencil = {
             .test = true, .front = {.depth_fail = StencilOp::Decrement}, .back = {.depth_fail = StencilOp::Increment}}});
    panel.draw(lit, vertex, {},
               {.depth_state = {.write = false, .compare = CompareOp::Equal},
                .stencil = {.test = true, .front = {.compare = CompareOp::Equal}, .back = {.compare = CompareOp::Equal}}});
    return panel.image();
}

ByteImage blending_panel(Device& device) {
    Panel panel(device, kPanelSide, 4);
    Draw draw;
    draw.output.blend[0] = {.enable = true, .src = BlendFactor::SrcAlpha, .dst = BlendFactor::InvSrcAlpha};
    constexpr std::array<glm::vec3, 3> kColors{{{0.9f, 0.1f, 0.1f}, {0.1f, 0.7f, 0.2f}, {0.1f, 0.25f, 0.9f}}};
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::vec3 center = on_circle(kPi / 2.0f + 2.0f * kPi * static_cast<float>(i) / 3.0f, 0.35f);
        panel.draw(disc(center, 0.55f, kColors[i]), {}, {.alpha = 0.5f}, draw);
    }
    return panel.image();
}

ByteImage derivatives_panel(Device& device) {
    Panel panel(device, kCoarseSide);
    const TextureId report =
        device.create_texture("report", {.format = Format::R32Uint, .width = kCoarseSide, .height = kCoarseSide});
    // Two triangles whose colour is their place on the target.
    const auto corner = [](float x, float y) { return ChartVertex{{x, y, 0.5f}, {x * 0.5f + 0.5f, 0.5f - y * 0.5f, 0.0f}}; };
    const std::vector<ChartVertex> vertices{corner(-0.93f, 0.93f),  corner(0.93f, 0.75f), corner(-0.75f, -0.93f),
                                            corner(-0.75f, -0.93f), corner(0.93f, 0.75f), corner(0.8f, -0.8f)};
    panel.draw(vertices, {}, {}, {.program = &derivatives_program(), .derivative_report = report});

    const Texture& causes = device.texture(report);
    const Texture& drawn = device.texture(panel.picture());
    ByteImage small{.width = kCoarseSide, .height = kCoarseSide, .channels = 3, .values = {}};
    for (int y = 0; y < kCoarseSide; ++y) {
        for (int x = 0; x < kCoarseSide; ++x) {
            std::uint32_t cause = 0;
            std::uint32_t picture = 0;
            std::memcpy(&cause, causes.row(0, y) + x * 4, 4);
            std::memcpy(&picture, drawn.row(0, y) + x * 4, 4);
            const Rgb& color = picture == 0xffffffffu ? kNotJudged : kDerivativeColors[cause & 7u];
            small.values.insert(small.values.end(), color.begin(), color.end());
        }
    }
    return panel.enlarged(small);
}

}  // namespace

ByteImage pipeline_chart(const Profile& profile, int threads) {
    Device device(profile, threads);
    const auto coarse = [&](const std::vector<ChartVertex>& vertices, int samples, const Draw& state) {
        Panel panel(device, kCoarseSide, samples);
        panel.draw(vertices, {}, {}, state);
        return panel.image();
    };
    const Draw lines{.topology = Topology::LineList};
    const Draw wide{.topology = Topology::LineList, .raster = {.lines = LineMode::Quadrilateral}};
    const std::array<ByteImage, std::size_t{kPanelColumns * kPanelRows}> panels{
        coarse(blades(), 1, {}), coarse(blades(), 4, {}),     coarse(rays(), 1, lines), coarse(rays(), 4, wide),
        wireframe_panel(device), shadow_volume_panel(device), blending_panel(device),   derivatives_panel(device)};

    constexpr int kStep = kPanelSide + kPanelMargin;
    ByteImage chart{.width = kPanelColumns * kStep + kPanelMargin,
                    .height = kPanelRows * kStep + kPanelMargin,
                    .channels = 3,
                    .values = {}};
    chart.values.assign(static_cast<std::size_t>(chart.width * chart.height * 3), 60);
    for (int i = 0; i < kPanelColumns * kPanelRows; ++i) {
        const int left = kPanelMargin + i % kPanelColumns * kStep;
        const int top = kPanelMargin + i / kPanelColumns * kStep;
        const ByteImage& panel = panels[static_cast<std::size_t>(i)];
        for (int y = 0; y < kPanelSide; ++y)
            std::memcpy(&chart.values[static_cast<std::size_t>(((top + y) * chart.width + left) * 3)],
                        &panel.values[static_cast<std::size_t>(y * kPanelSide * 3)], kPanelSide * 3);
    }
    return chart;
}

}  // namespace gnomon::studies
