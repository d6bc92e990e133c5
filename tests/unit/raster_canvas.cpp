#include "tests/unit/raster_canvas.h"

#include <fmt/format.h>

#include <bit>

namespace gnomon::testing {

Canvas::Canvas(const Program& program, const Profile& profile, const CanvasDesc& desc)
    : device_(profile, desc.threads), program_(program), desc_(desc) {
    const auto texture = [&](Format format) {
        return device_.create_texture("canvas", {.format = format,
                                                 .width = desc.width,
                                                 .height = desc.height,
                                                 .kind = desc.layers > 1 ? TextureKind::Array : TextureKind::Flat,
                                                 .layers = desc.layers,
                                                 .samples = desc.samples});
    };
    for (int i = 0; i < program.targets(); ++i)
        color_.push_back(texture(program.targets() == 1 ? Format::R32Float : Format::Rgba32Float));
    if (desc.depth) depth_ = texture(*desc.depth);
    clear();
}

void Canvas::clear(float color) {
    for (const TextureId id : color_) device_.execute(ClearColor{{id, 0, 0, desc_.layers}, glm::vec4(color)});
    if (!desc_.depth) return;
    device_.execute(ClearDepth{{depth_, 0, 0, desc_.layers}, 1.0f});
}

Draw Canvas::draw_of(const std::vector<RasterVertex>& vertices) {
    const auto bytes = std::as_bytes(std::span(vertices));
    if (bytes.size() > capacity_) {
        capacity_ = bytes.size();
        vertices_ = device_.create_zeroed_buffer("vertices", capacity_);
    }
    if (!bytes.empty()) device_.execute(WriteBuffer{.id = vertices_, .data = bytes});
    Draw draw{.label = "test",
              .program = &program_,
              .vertex_constants = raster_vertex_constants(program_),
              .pixel_constants = raster_pixel_constants(program_),
              .vertices = vertices_,
              .count = static_cast<std::uint32_t>(vertices.size())};
    draw.depth_state.test = false;
    for (std::size_t i = 0; i < color_.size(); ++i) draw.color[i] = {color_[i], 0, 0, desc_.layers};
    if (desc_.depth) draw.depth = {depth_, 0, 0, desc_.layers};
    return draw;
}

float Canvas::value(std::size_t target, int component, const SampleAt& at) const {
    const Texture& texture = device_.texture(color_[target]);
    const int components = texture.info().bytes_per_texel / 4;
    const auto* row = reinterpret_cast<const float*>(texture.row(0, at.y, at.layer, at.sample));
    return row[at.x * components + component];
}

std::uint32_t Canvas::depth_code(const SampleAt& at) const {
    const auto* row = reinterpret_cast<const std::uint32_t*>(device_.texture(depth_).row(0, at.y, at.layer, at.sample));
    return row[at.x];
}

oracle::Masks Canvas::masks(float mark, int layer) const {
    oracle::Masks masks(rect());
    const Texture& texture = device_.texture(color_[0]);
    const int components = texture.info().bytes_per_texel / 4;
    for (int s = 0; s < desc_.samples; ++s)
        for (int y = 0; y < desc_.height; ++y) {
            const auto* row = reinterpret_cast<const float*>(texture.row(0, y, layer, s));
            for (int x = 0; x < desc_.width; ++x)
                if (row[x * components] == mark) masks.at(x, y) |= 1u << s;
        }
    return masks;
}

RasterVertex vertex_at(const oracle::Point& wanted, const oracle::PixelRect& viewport, float a, float layer) {
    return {.clip = {oracle::ndc_of(wanted.x, viewport.left, viewport.right - viewport.left),
                     -oracle::ndc_of(wanted.y, viewport.top, viewport.bottom - viewport.top), 0.5f, 1.0f},
            .a = a,
            .layer = layer};
}
RasterVertex vertex_of(const oracle::PlacedVertex& placed, float a, float layer) {
    return {.clip = placed.clip, .a = a, .layer = layer};
}

std::string difference(const oracle::Masks& expected, const oracle::Masks& drawn) {
    if (expected == drawn) return {};
    const oracle::PixelRect& rect = expected.rect();
    for (int y = rect.top; y < rect.bottom; ++y)
        for (int x = rect.left; x < rect.right; ++x)
            if (expected.at(x, y) != drawn.at(x, y))
                return fmt::format("pixel ({}, {}): samples {:#x}, expected {:#x}", x, y, drawn.at(x, y), expected.at(x, y));
    return "rectangles of different sizes";
}

std::string describe(const oracle::Point& p) { return fmt::format("({}, {})/256", p.x, p.y); }
std::string describe(const oracle::SnappedTriangle& t) {
    return fmt::format("{} {} {}", describe(t[0]), describe(t[1]), describe(t[2]));
}

}  // namespace gnomon::testing
