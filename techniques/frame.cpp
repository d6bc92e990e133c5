#include "techniques/frame.h"

#include "sim/scalar_math.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>

namespace gnomon::techniques {

namespace {

/// The light's constants; an object's base colour comes in per draw.
Lighting make_lighting(const scenes::Light& light, const scenes::View& view) {
    Lighting lighting;
    lighting.light_color = light.color;
    lighting.light_direction = view.direction_ws;
    if (light.kind == scenes::LightKind::Directional) {
        lighting.light_position = glm::vec4(-view.direction_ws, 0.0f);
        return lighting;
    }
    // From full light inside 0.85 of the outer angle to none outside of it: for the eye; visibility knows nothing of the cone.
    lighting.light_position = glm::vec4(view.position_ws, 1.0f);
    const double outer = scalar::cos(static_cast<double>(light.outer_cone_rad));
    const double inner = scalar::cos(0.85 * static_cast<double>(light.outer_cone_rad));
    const double scale = 1.0 / (inner - outer);
    lighting.cone_scale = static_cast<float>(scale);
    lighting.cone_offset = static_cast<float>(-outer * scale);
    return lighting;
}

/// What normals are multiplied by: the cofactors of the transform, turned where it mirrors. Up to a positive factor the inverse
/// transpose, but defined for flattening transforms too.
glm::mat4 normal_matrix(const glm::mat4& world_from_object) {
    const glm::vec3 x(world_from_object[0]);
    const glm::vec3 y(world_from_object[1]);
    const glm::vec3 z(world_from_object[2]);
    const glm::mat3 cofactors(glm::cross(y, z), glm::cross(z, x), glm::cross(x, y));
    return glm::mat4(glm::dot(x, glm::cross(y, z)) < 0.0f ? -cofactors : cofactors);
}

}  // namespace

Frame::Frame(Device& device, const scenes::Scene& scene, const FrameDesc& desc)
    : device_(device),
      scene_light_(scene.light),
      aspect_(static_cast<float>(desc.width) / static_cast<float>(desc.height)),
      camera_(scenes::camera_view(scene.camera, aspect_)),
      light_(scenes::light_view(scene.light, scene.bounds())),
      scene_(upload_scene(device, scene)),
      passes_(desc.technique.make(device, desc.settings)) {
    color_ = device.create_texture("colour", {.format = Format::Rgba8Unorm, .width = desc.width, .height = desc.height});
    visibility_ = device.create_texture("visibility", {.format = Format::R32Float, .width = desc.width, .height = desc.height});
    depth_ = device.create_texture("depth", {.format = Format::D32Float, .width = desc.width, .height = desc.height});
}

void Frame::render_maps(PassTimer& timer) {
    const Texture& image = device_.texture(color_);
    passes_->render_maps(
        {.scene = scene_, .camera = camera_, .light = light_, .width = image.width(0), .height = image.height(0)}, timer);
}

void Frame::render(PassTimer& timer) {
    render_maps(timer);
    timer.pass("camera", [&] { draw_receivers(TextureId::None); });
}

void Frame::render_derivatives() {
    if (derivatives_ == TextureId::None) {
        const Texture& color = device_.texture(color_);
        derivatives_ = device_.create_texture("derivatives",
                                              {.format = Format::R32Uint, .width = color.width(0), .height = color.height(0)});
    }
    PassTimer timer(device_);
    render_maps(timer);
    device_.execute(ClearColor{derivatives_, glm::vec4(0.0f)});
    draw_receivers(derivatives_);
}

void Frame::draw_receivers(TextureId derivative_report) {
    device_.execute(ClearColor{color_, {0.35f, 0.42f, 0.5f, 1.0f}});
    device_.execute(ClearColor{visibility_, {kNoSurface, 0.0f, 0.0f, 0.0f}});
    device_.execute(ClearDepth{depth_, 1.0f});
    Lighting lighting = make_lighting(scene_light_, light_);
    for (const SceneDraw& object : scene_) {
        const ReceiverVertex vertex = receiver_vertex(object);
        lighting.base_color = object.base_color;
        Draw draw{.label = object.label,
                  .program = &passes_->receiver_program(),
                  .vertex_constants = constants_of(vertex),
                  .pixel_constants = passes_->receiver_constants(lighting),
                  .vertices = object.vertices,
                  .indices = object.indices,
                  .count = object.count,
                  .depth = depth_,
                  .derivative_report = derivative_report};
        draw.color[0] = color_;
        draw.color[1] = visibility_;
        device_.execute(draw);
    }
}

void Frame::draw_with(const Program& program, std::span<const std::byte> constants, std::span<const TargetView> targets,
                      TextureId derivative_report) {
    for (const TargetView& target : targets) device_.execute(ClearColor{target, glm::vec4(kNoSurface)});
    if (derivative_report != TextureId::None) device_.execute(ClearColor{derivative_report, glm::vec4(0.0f)});
    device_.execute(ClearDepth{depth_, 1.0f});
    for (const SceneDraw& object : scene_) {
        const ReceiverVertex vertex = receiver_vertex(object);
        Draw draw{.label = object.label,
                  .program = &program,
                  .vertex_constants = constants_of(vertex),
                  .pixel_constants = constants,
                  .vertices = object.vertices,
                  .indices = object.indices,
                  .count = object.count,
                  .depth = depth_,
                  .derivative_report = derivative_report};
        std::ranges::copy(targets, draw.color.begin());
        device_.execute(draw);
    }
}

ReceiverVertex Frame::receiver_vertex(const SceneDraw& object) const {
    return {.clip_from_object = camera_.clip_from_world() * object.world_from_object,
            .world_from_object = object.world_from_object,
            .normal_from_object = normal_matrix(object.world_from_object),
            .light = make_light_space(light_, object.world_from_object)};
}

void Frame::set_camera(const scenes::Camera& camera) { camera_ = scenes::camera_view(camera, aspect_); }

}  // namespace gnomon::techniques
