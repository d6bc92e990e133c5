#include "pipeline/validate.h"

#include "texunit/aniso.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace gnomon {

namespace {

bool is_float(const FormatInfo& format) {
    return format.type == ComponentType::Float16 || format.type == ComponentType::Float32 ||
           format.type == ComponentType::Float11;
}

std::size_t number(TextureId id) { return static_cast<std::size_t>(id); }

bool overlap(const TargetView& a, const TargetView& b) {
    return a.texture == b.texture && a.level == b.level && a.first_layer < b.first_layer + b.layers &&
           b.first_layer < a.first_layer + a.layers;
}

bool writes_stencil(const StencilFace& face) {
    return face.fail != StencilOp::Keep || face.depth_fail != StencilOp::Keep || face.pass != StencilOp::Keep;
}

/// Every enumeration in it, and in its parts, has one of its values.
template <class State>
bool has_valid_enums(const State& state) {
    bool valid = true;
    for_each_field(state, [&](std::string_view, const auto& value) {
        using Value = std::remove_cvref_t<decltype(value)>;
        if constexpr (HasFields<Value>) {
            valid = valid && has_valid_enums(value);
        } else if constexpr (std::is_enum_v<Value>) {
            valid = valid && is_valid(value);
        }
    });
    return valid;
}

/// The constants of a pixel functor that are textures with one sample per texel.
std::optional<TextureLevels> read_levels(const NamedConstant& constant) {
    if (const auto* id = std::get_if<TextureId>(&constant.value)) return TextureLevels(*id);
    if (const auto* levels = std::get_if<TextureLevels>(&constant.value)) return *levels;
    return std::nullopt;
}

/// "draw 'label': constant", for messages of calls of its functor.
std::string place_of(const PixelEnvironment& environment, TextureId id) {
    const Draw& draw = *environment.draw;
    for (const NamedConstant& constant : draw.program->pixel_constants(draw.pixel_constants)) {
        const std::optional<TextureLevels> levels = read_levels(constant);
        if (levels && levels->texture == id) return fmt::format("draw '{}': {}", draw.label, constant.name);
    }
    return fmt::format("draw '{}': texture {}", draw.label, number(id));
}

const FormatInfo& format_of(const PixelEnvironment& environment, TextureId id) {
    return environment.textures[number(id) - 1]->info();
}

[[noreturn]] void fail_unfiltered(const std::string& place, const FormatInfo& format, const Profile& profile) {
    fail(
        "{} holds {}, which profile {} does not filter, and is sampled with a filter: expected nearest for min, mag and mip, "
        "and no anisotropy",
        place, format.name, profile.name);
}

/// The checks of one draw, in the order of the pipeline.
class DrawResolver {
public:
    DrawResolver(const Draw& draw, Resources& resources, const Profile& profile, DrawContext& context)
        : draw_(draw),
          resources_(resources),
          profile_(profile),
          context_(context),
          what_(fmt::format("draw '{}'", draw.label)) {}

    bool resolve() {
        context_.draw = &draw_;
        resolve_program();
        check_states();
        resolve_targets();
        resolve_blending();
        resolve_constants();
        resolve_viewports();
        const bool draws = resolve_vertices();
        fill_states();
        return draws;
    }

private:
    template <class... Args>
    [[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) const {
        fail("{}: {}", what_, fmt::format(format, std::forward<Args>(args)...));
    }

    void resolve_program() {
        if (draw_.program == nullptr) refuse("no program");
        program_ = draw_.program;
        if (draw_.vertex_constants.size() != program_->vertex_constants_size ||
            draw_.pixel_constants.size() != program_->pixel_constants_size)
            refuse("{} and {} bytes of constants, program {} expects {} and {}", draw_.vertex_constants.size(),
                   draw_.pixel_constants.size(), program_->name, program_->vertex_constants_size,
                   program_->pixel_constants_size);
        if (program_->targets() > profile_.max_targets)
            refuse("program {} writes {} targets, profile {} has {}", program_->name, program_->targets(), profile_.name,
                   profile_.max_targets);
        const auto copy = [](std::span<const std::byte> bytes, std::vector<std::max_align_t>& to) {
            to.resize((bytes.size() + sizeof(std::max_align_t) - 1) / sizeof(std::max_align_t));
            if (!bytes.empty()) std::memcpy(to.data(), bytes.data(), bytes.size());
        };
        copy(draw_.vertex_constants, context_.vertex_functor);
        copy(draw_.pixel_constants, context_.pixel_functor);
    }

    template <class State>
    void check_enums(const State& state, const std::string& name) const {
        for_each_field(state, [&](std::string_view field, const auto& value) {
            using Value = std::remove_cvref_t<decltype(value)>;
            if constexpr (HasFields<Value>) {
                check_enums(value, fmt::format("{}.{}", name, field));
            } else if constexpr (std::is_enum_v<Value>) {
                check_enum(value, fmt::format("{}: {}.{}", what_, name, field));
            }
        });
    }

    /// Choices that are none, and numbers without a meaning.
    void check_states() const {
        const auto valid = [](const auto& state) { return has_valid_enums(state); };
        if (!is_valid(draw_.topology) || !is_valid(draw_.index_type) || !valid(draw_.raster) || !valid(draw_.depth_state) ||
            !valid(draw_.stencil) || !std::ranges::all_of(draw_.output.blend, valid)) {
            check_enum(draw_.topology, what_ + ": topology");
            check_enum(draw_.index_type, what_ + ": index_type");
            check_enums(draw_.raster, "raster");
            check_enums(draw_.depth_state, "depth_state");
            check_enums(draw_.stencil, "stencil");
            for (std::size_t i = 0; i < draw_.output.blend.size(); ++i)
                check_enums(draw_.output.blend[i], fmt::format("blend[{}]", i));
        }
        if (!std::isfinite(draw_.raster.slope_scaled_depth_bias) || std::isnan(draw_.raster.depth_bias_clamp))
            refuse("slope-scaled depth bias {} and clamp {}, expected a finite number and a number",
                   draw_.raster.slope_scaled_depth_bias, draw_.raster.depth_bias_clamp);
    }

    /// All of one size, layer count and sample count. D3D11.3 17.14, 17.16
    void resolve_targets() {
        for (std::size_t i = 0; i < static_cast<std::size_t>(program_->targets()); ++i) {
            const TargetView& view = draw_.color[i];
            context_.color.emplace_back();
            if (view.texture == TextureId::None) continue;
            Texture& texture = resolve_view(view, resources_, fmt::format("{}: colour target {}", what_, i));
            if (texture.info().is_depth) refuse("colour target {} has a depth format", i);
            for (std::size_t k = 0; k < i; ++k)
                if (overlap(view, draw_.color[k])) refuse("colour target {} is bound twice", i);
            check_alike(texture, view);
            context_.color.back() = ColorTarget(texture, view, draw_.output.blend[i]);
        }
        if (draw_.depth.texture != TextureId::None) {
            depth_ = &resolve_view(draw_.depth, resources_, fmt::format("{}: depth target", what_));
            if (!depth_->info().is_depth) refuse("depth target has the format {}", depth_->info().name);
            check_alike(*depth_, draw_.depth);
        }
        if (draw_.derivative_report != TextureId::None) {
            report_ = &resources_.texture(draw_.derivative_report, what_ + ": derivative report");
            const TextureDesc& desc = report_->desc();
            if (desc.format != Format::R32Uint || desc.samples != 1 || desc.kind != TextureKind::Flat)
                refuse("derivative report in {} with {} samples, expected flat r32ui with one", report_->info().name,
                       desc.samples);
            for (std::size_t i = 0; i < context_.color.size(); ++i)
                if (context_.color[i].texture == report_) refuse("derivative report is colour target {} as well", i);
            if (sized_ != nullptr && (report_->width(0) != width_ || report_->height(0) != height_))
                refuse("derivative report of {}x{} pixels, expected {}x{} as the targets", report_->width(0),
                       report_->height(0), width_, height_);
        }
        if (sized_ == nullptr) refuse("no target at all");
        const bool stencil_in_range =
            std::min({draw_.stencil.reference, draw_.stencil.read_mask, draw_.stencil.write_mask}) >= 0 &&
            std::max({draw_.stencil.reference, draw_.stencil.read_mask, draw_.stencil.write_mask}) <= 255;
        if (!stencil_in_range) refuse("stencil reference or masks outside 0 to 255");
    }

    void check_alike(const Texture& texture, const TargetView& view) {
        const int width = texture.width(view.level);
        const int height = texture.height(view.level);
        if (sized_ != nullptr) {
            if (width != width_ || height != height_)
                refuse("targets of {}x{} and {}x{} pixels, expected one size", width_, height_, width, height);
            if (texture.desc().samples != sized_->desc().samples)
                refuse("targets with {} and {} samples, expected one count", sized_->desc().samples, texture.desc().samples);
            if (view.layers != layers_) refuse("targets of {} and {} layers, expected one count", layers_, view.layers);
        }
        sized_ = &texture;
        width_ = width;
        height_ = height;
        layers_ = view.layers;
    }

    /// D3D11.3 17.5, 17.6, 19.1.4
    void resolve_blending() {
        for (std::size_t i = 0; i < context_.color.size(); ++i) {
            const BlendState& state = draw_.output.blend[i];
            if (state.write_mask < 0 || state.write_mask > 15)
                refuse("write mask {} of target {}, expected 0 to 15", state.write_mask, i);
            if (context_.color[i].texture == nullptr || !state.enable) continue;
            const FormatInfo& format = context_.color[i].texture->info();
            const bool half = format.type == ComponentType::Float16 || format.type == ComponentType::Float11;
            if (format.is_integer()) refuse("target {} is blended, but {} holds integers", i, format.name);
            if ((half && !profile_.blends_float16) || (format.type == ComponentType::Float32 && !profile_.blends_float32))
                refuse("target {} is blended, which profile {} cannot do in {}", i, profile_.name, format.name);
            if (!uses_second_color(state)) continue;
            const auto bound =
                std::ranges::count_if(context_.color, [](const ColorTarget& target) { return target.texture != nullptr; });
            const auto plain = [](BlendOp op) { return op != BlendOp::Min && op != BlendOp::Max; };
            if (i != 0 || bound != 1 || program_->targets() < 2)
                refuse("target {} blends with a second colour: expected target 0 alone and a program that writes two colours",
                       i);
            if (!plain(state.op) || !plain(state.op_alpha))
                refuse("target {} blends with a second colour: expected add, subtract or reverse-subtract", i);
        }
    }

    /// What a shader reads is there, can be read in that way, and is not written.
    void resolve_constants() const {
        if (program_->pixel_constants == nullptr) return;
        const std::vector<NamedConstant> constants = program_->pixel_constants(draw_.pixel_constants);
        for (const NamedConstant& constant : constants) {
            const std::string what = what_ + ": " + constant.name;
            if (const std::optional<TextureLevels> levels = read_levels(constant)) check_levels(what, *levels);
            if (const auto* several = std::get_if<MultisampledTexture>(&constant.value)) {
                (void)resources_.texture(several->texture, what);
                check_unwritten(what, several->texture, 0, 1);
            }
            if (const auto* sampler = std::get_if<Sampler>(&constant.value)) check_sampler(*sampler, what);
        }
        check_filtering(constants);
    }

    void check_levels(const std::string& what, const TextureLevels& view) const {
        const TextureDesc& desc = resources_.texture(view.texture, what).desc();
        if (desc.samples != 1)
            fail("{} has {} samples per texel, expected one: functors read several through a MultisampledTexture", what,
                 desc.samples);
        if (view.first_level < 0 || view.first_level >= desc.levels || view.levels < 0 ||
            view.levels > desc.levels - view.first_level)
            fail("{} is {} levels from level {}, but the texture has {}", what, view.levels, view.first_level, desc.levels);
        check_unwritten(what, view.texture, view.first_level, view.levels == 0 ? desc.levels - view.first_level : view.levels);
    }

    /// D3D11.3 17.13: a depth target that the draw leaves alone may be read, and so may levels other than those it writes.
    void check_unwritten(const std::string& what, TextureId id, int first_level, int levels) const {
        const bool stores_depth = draw_.depth_state.test && draw_.depth_state.write;
        const bool stores_stencil =
            draw_.stencil.test && (writes_stencil(draw_.stencil.front) || writes_stencil(draw_.stencil.back));
        const auto reads = [&](const TargetView& view) {
            return view.texture == id && view.level >= first_level && view.level < first_level + levels;
        };
        bool written = reads(draw_.derivative_report) || (reads(draw_.depth) && (stores_depth || stores_stencil));
        for (const ColorTarget& target : context_.color) written = written || (target.texture != nullptr && reads(target.view));
        if (written) fail("{} is sampled and written by the same draw", what);
    }

    /// Which sampler meets which texture only the calls show; but where every sampler filters and no texture can be filtered,
    /// none is right. D3D11.3 19.1.4
    void check_filtering(const std::vector<NamedConstant>& constants) const {
        const NamedConstant* unfiltered = nullptr;
        bool samples = false;
        for (const NamedConstant& constant : constants) {
            if (const auto* sampler = std::get_if<Sampler>(&constant.value)) {
                if (!sampler->filters()) return;
                samples = true;
            }
            const std::optional<TextureLevels> levels = read_levels(constant);
            if (!levels) continue;
            if (filters_format(resources_.texture(levels->texture).info(), profile_)) return;
            unfiltered = &constant;
        }
        if (samples && unfiltered != nullptr)
            fail_unfiltered(what_ + ": " + unfiltered->name, resources_.texture(read_levels(*unfiltered)->texture).info(),
                            profile_);
    }

    /// D3D11.3 15.6.1, 15.7
    void resolve_viewports() {
        const std::span<const Viewport> given = draw_.viewports.empty() ? std::span(&draw_.viewport, 1) : draw_.viewports;
        if (given.size() > std::size_t{kMaxViewports}) refuse("{} viewports, expected 1 to {}", given.size(), kMaxViewports);
        if (!draw_.scissors.empty() && draw_.scissors.size() != given.size())
            refuse("{} scissor rectangles for {} viewports, expected one each", draw_.scissors.size(), given.size());
        for (std::size_t i = 0; i < given.size(); ++i) {
            const Viewport& v = given[i];
            const auto in_range = [](float x) { return x >= -32768.0f && x <= 32767.0f; };
            const bool whole = v.width == 0.0f && v.height == 0.0f && v.x == 0.0f && v.y == 0.0f;
            const bool placed = v.width > 0.0f && v.height > 0.0f && in_range(v.x) && in_range(v.y) &&
                                in_range(v.x + v.width) && in_range(v.y + v.height);
            if (!whole && !placed)
                refuse("viewport of {}x{} pixels at ({}, {}), expected a size above 0 between -32768 and 32767", v.width,
                       v.height, v.x, v.y);
            if (!(v.min_depth >= 0.0f && v.min_depth <= v.max_depth && v.max_depth <= 1.0f))
                refuse("depth range {} to {} of viewport {}, expected 0 <= from <= to <= 1", v.min_depth, v.max_depth, i);
            const ScissorRect* scissor = draw_.scissors.empty() ? nullptr : &draw_.scissors[i];
            context_.viewports.push_back(make_viewport_transform(v, scissor, width_, height_, profile_.clipping));
        }
    }

    std::span<const float> floats_of(BufferId id, std::string_view name) const {
        const Buffer& buffer = resources_.buffer(id, fmt::format("{}: {}", what_, name));
        return {reinterpret_cast<const float*>(buffer.data.data()), buffer.data.size() / sizeof(float)};
    }

    /// Every vertex and instance that the draw asks for is there.
    bool resolve_vertices() {
        context_.vertices = floats_of(draw_.vertices, "vertices");
        if (program_->instance_floats > 0) {
            context_.instances = floats_of(draw_.instances, "instances");
            const std::uint64_t available = context_.instances.size() / static_cast<std::size_t>(program_->instance_floats);
            const std::uint64_t wanted = std::uint64_t{draw_.first_instance} + draw_.instance_count;
            if (wanted > available)
                refuse("instances up to {} used, but the buffer holds {} of {} floats", wanted, available,
                       program_->instance_floats);
        } else if (draw_.instances != BufferId::None) {
            refuse("a buffer of instances, but program {} reads none", program_->name);
        }
        if (draw_.count == 0 || draw_.instance_count == 0) return false;

        std::uint64_t lowest = draw_.first;
        std::uint64_t highest = std::uint64_t{draw_.first} + draw_.count - 1;
        if (draw_.indices != BufferId::None) {
            context_.indices = resources_.buffer(draw_.indices, what_ + ": indices").data;
            const VertexNumbers numbers(context_.indices, draw_.index_type, draw_.first, draw_.count);
            const std::size_t held = context_.indices.size() / numbers.bytes_each();
            if (highest >= held) refuse("indices {} to {}, but the buffer holds {}", draw_.first, highest, held);
            context_.index_range = numbers.range(0, draw_.count, draw_.primitive_restart);
            if (context_.index_range.empty()) return false;  // nothing but restarts
            lowest = context_.index_range.lowest;
            highest = context_.index_range.highest;
        } else if (draw_.base_vertex != 0) {
            refuse("base vertex {} without indices", draw_.base_vertex);
        }
        const std::uint64_t available = context_.vertices.size() / static_cast<std::size_t>(program_->vertex_floats);
        const auto first = static_cast<std::int64_t>(lowest) + draw_.base_vertex;
        const auto last = static_cast<std::int64_t>(highest) + draw_.base_vertex;
        if (first < 0 || last >= static_cast<std::int64_t>(available))
            refuse("vertex {} used, but the buffer holds {} of {} floats", first < 0 ? first : last, available,
                   program_->vertex_floats);
        return true;
    }

    /// When depth is tested. D3D11.3 16.12.1, 16.12.2
    DepthOrder depth_order() const {
        const PixelTraits& pixel = program_->pixel;
        const bool masks = pixel.discards || pixel.writes_coverage || (draw_.output.alpha_to_coverage && pixel.targets > 0);
        if (pixel.force_early || !(masks || pixel.writes_depth)) return DepthOrder::Early;
        return pixel.writes_depth || draw_.stencil.test ? DepthOrder::Late : DepthOrder::EarlyTest;
    }

    void fill_states() {
        const SamplePattern pattern = sample_pattern(profile_, sized_->desc().samples);
        const SamplePattern depth_pattern = profile_.mirrors_sample_depth ? mirrored(pattern) : pattern;
        const PixelRect extent = sample_extent(pattern);
        context_.setup = {.raster = draw_.raster,
                          .viewports = context_.viewports,
                          .layers = layers_,
                          .samples = pattern.count,
                          .subpixel_bits = profile_.raster_subpixel_bits,
                          .viewport_arithmetic = profile_.viewport_arithmetic,
                          .clipping = profile_.clipping,
                          .winding_area = profile_.winding_area,
                          .plane_equations = profile_.plane_equations,
                          .depth_type = depth_ != nullptr ? depth_->info().type : ComponentType::Depth24,
                          .bias_place = profile_.depth_bias_place,
                          .bias_steps = profile_.depth_bias_steps,
                          .bias_arithmetic = profile_.depth_bias_arithmetic,
                          .sample_extent = extent};
        const bool tests = depth_ != nullptr && (draw_.depth_state.test || (draw_.stencil.test && depth_->info().has_stencil));
        context_.tiles = {.program = program_,
                          .pixel_functor = context_.pixel_functor.data(),
                          .order = depth_order(),
                          .depth_texture = tests ? depth_ : nullptr,
                          .depth_view = draw_.depth,
                          .depth = draw_.depth_state,
                          .stencil = draw_.stencil,
                          .color = context_.color,
                          .output = draw_.output,
                          .viewports = context_.viewports,
                          .pattern = pattern,
                          .depth_pattern = depth_pattern,
                          .depth_extent = sample_extent(depth_pattern),
                          .plane_equations = profile_.plane_equations,
                          .depth_rounding = profile_.depth_rounding,
                          .layers = layers_,
                          .width = width_,
                          .height = height_,
                          .derivative_report = report_,
                          .environment = {.textures = resources_.table(),
                                          .profile = &profile_,
                                          .reports_derivatives = report_ != nullptr,
                                          .draw = &draw_}};
        context_.tiles_x = (width_ + kTileSize - 1) / kTileSize;
        context_.tiles_y = (height_ + kTileSize - 1) / kTileSize;
    }

    const Draw& draw_;
    Resources& resources_;
    const Profile& profile_;
    DrawContext& context_;
    std::string what_;
    const Program* program_ = nullptr;
    const Texture* sized_ = nullptr;  // the first target
    Texture* depth_ = nullptr;
    Texture* report_ = nullptr;
    int width_ = 0;
    int height_ = 0;
    int layers_ = 1;
};

}  // namespace

bool resolve_draw(const Draw& draw, Resources& resources, const Profile& profile, DrawContext& context) {
    return DrawResolver(draw, resources, profile, context).resolve();
}

Texture& resolve_view(const TargetView& view, Resources& resources, const std::string& what) {
    Texture& texture = resources.texture(view.texture, what);
    const TextureDesc& desc = texture.desc();
    if (view.level < 0 || view.level >= desc.levels)
        fail("{}: level {} of texture {}, expected 0 to {}", what, view.level, number(view.texture), desc.levels - 1);
    if (view.first_layer < 0 || view.layers < 1 || view.first_layer > desc.layers - view.layers)
        fail("{}: layers {} to {} of texture {}, expected some of 0 to {}", what, view.first_layer,
             std::int64_t{view.first_layer} + view.layers - 1, number(view.texture), desc.layers - 1);
    return texture;
}

void refuse_missing(const PixelEnvironment& environment, TextureId id) {
    fail("draw '{}': the functor uses texture {}, which does not exist", environment.draw->label, number(id));
}
void refuse_cube(const PixelEnvironment& environment, TextureId id) {
    fail("{} is a cube texture, sampled at 2D coordinates: its faces can only be loaded from", place_of(environment, id));
}
void refuse_filter(const PixelEnvironment& environment, TextureId id) {
    fail_unfiltered(place_of(environment, id), format_of(environment, id), *environment.profile);
}
void refuse_comparison(const PixelEnvironment& environment, TextureId id) {
    fail("{} holds {}: integers are not compared", place_of(environment, id), format_of(environment, id).name);
}
void refuse_codes(const PixelEnvironment& environment, TextureId id) {
    fail("{} holds {}, and its codes are loaded: expected a format of unsigned integers", place_of(environment, id),
         format_of(environment, id).name);
}
void refuse_offset(const PixelEnvironment& environment, TextureId id, const glm::ivec2& offset) {
    fail("{} is read with the offset ({}, {}), expected -8 to 7", place_of(environment, id), offset.x, offset.y);
}
void refuse_component(const PixelEnvironment& environment, TextureId id, int component) {
    fail("{}: component {} gathered, expected 0 to 3", place_of(environment, id), component);
}

void check_texture(const TextureDesc& desc, const Profile& profile) {
    check_enum(desc.format, "format of a texture");
    if (desc.samples > profile.max_samples)
        fail("texture with {} samples per texel: profile {} has at most {}", desc.samples, profile.name, profile.max_samples);
    const FormatInfo& format = format_info(desc.format);
    if (desc.samples > 1 && is_float(format) && !profile.multisamples_float)
        fail("texture with {} samples per texel in {}: profile {} has no multisampling of floats", desc.samples, format.name,
             profile.name);
}

}  // namespace gnomon
