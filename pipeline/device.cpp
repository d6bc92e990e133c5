#include "pipeline/device.h"

#include "pipeline/draw.h"
#include "texunit/codec.h"
#include "texunit/mipmap.h"
#include "texunit/store.h"

#include <algorithm>

namespace gnomon {

namespace {

/// One texel's words in every texel of level 0.
template <class AnyCodec>
void fill(Texture& texture, const typename AnyCodec::Words& words, Workers& workers) {
    const SpilledTexels<AnyCodec> texel(words);
    const int width = texture.width(0);
    const std::size_t row_bytes = static_cast<std::size_t>(width) * AnyCodec::kBytes;
    constexpr int kRows = 64;
    workers.for_each(static_cast<std::size_t>((texture.height(0) + kRows - 1) / kRows), [&](std::size_t piece) {
        const int first = static_cast<int>(piece) * kRows;
        const std::byte* source = texture.row(0, first);
        for (int x = 0; x < width; ++x) texel.store_lane(texture.row(0, first) + x * AnyCodec::kBytes, 0);
        for (int y = first + 1; y < std::min(first + kRows, texture.height(0)); ++y)
            std::memcpy(texture.row(0, y), source, row_bytes);
    });
}

}  // namespace

Device::Device(Profile profile, int threads)
    : profile_(std::move(profile)), workers_(threads), scratch_(std::make_unique<DrawScratch>()) {}
Device::~Device() = default;

void Device::execute(const Command& command) {
    std::visit([this](const auto& c) { run(c); }, command);
    if (observer_) observer_(command);
}

BufferId Device::create_buffer(std::string_view label, std::span<const std::byte> data) {
    const auto id = static_cast<BufferId>(buffers_.size() + 1);
    execute(CreateBuffer{id, label, data});
    return id;
}

TextureId Device::create_texture(std::string_view label, const TextureDesc& desc) {
    const auto id = static_cast<TextureId>(textures_.size() + 1);
    execute(CreateTexture{id, label, desc});
    return id;
}

const Texture& Device::texture(TextureId id) const {
    const auto index = static_cast<std::size_t>(id);
    if (index == 0 || index > textures_.size()) fail("texture {}: no such texture; {} exist", index, textures_.size());
    return *textures_[index - 1];
}

Texture& Device::mutable_texture(TextureId id) {
    (void)texture(id);
    return *textures_[static_cast<std::size_t>(id) - 1];
}

const Buffer& Device::buffer(BufferId id) const {
    const auto index = static_cast<std::size_t>(id);
    if (index == 0 || index > buffers_.size()) fail("buffer {}: no such buffer; {} exist", index, buffers_.size());
    return *buffers_[index - 1];
}

void Device::run(const CreateBuffer& command) {
    if (static_cast<std::size_t>(command.id) != buffers_.size() + 1)
        fail("buffer {}: ids go up one by one; expected {}", static_cast<std::size_t>(command.id), buffers_.size() + 1);
    const std::size_t size = command.size == 0 ? command.data.size() : command.size;
    if (size < command.data.size() || size > kMaxBufferBytes)
        fail("buffer {} of {} bytes: expected {} (its data) to {}", static_cast<std::size_t>(command.id), size,
             command.data.size(), kMaxBufferBytes);
    auto buffer = std::make_unique<Buffer>(Buffer{std::string(command.label), {}});
    buffer->data.reserve(size);
    buffer->data.assign(command.data.begin(), command.data.end());
    buffer->data.resize(size);
    buffers_.push_back(std::move(buffer));
}

void Device::run(const CreateTexture& command) {
    if (static_cast<std::size_t>(command.id) != textures_.size() + 1)
        fail("texture {}: ids go up one by one; expected {}", static_cast<std::size_t>(command.id), textures_.size() + 1);
    textures_.push_back(std::make_unique<Texture>(command.desc));
}

void Device::run(const WriteTexture& command) {
    Texture& texture = mutable_texture(command.id);
    if (command.level < 0 || command.level >= texture.desc().levels)
        fail("texture {}: level {} written, expected 0 to {}", static_cast<std::size_t>(command.id), command.level,
             texture.desc().levels - 1);
    texture.set_level_bytes(command.level, command.data.data(), command.data.size());
}

void Device::run(const ClearColor& command) {
    Texture& texture = mutable_texture(command.id);
    if (texture.info().is_depth)
        fail("texture {}: cleared to a colour, but it is a depth texture", static_cast<std::size_t>(command.id));
    const DenormalScope denormals(profile_.flush_denormals);
    with_codec(texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        const Vec4<Float> color{Float(command.value.x), Float(command.value.y), Float(command.value.z), Float(command.value.w)};
        fill<AnyCodec>(texture, AnyCodec::encode(truncate<AnyCodec::kComponents>(color), profile_.float_narrowing), workers_);
    });
}

void Device::run(const ClearDepth& command) {
    Texture& texture = mutable_texture(command.id);
    if (!texture.info().is_depth)
        fail("texture {}: cleared to a depth, but its format is {}", static_cast<std::size_t>(command.id), texture.info().name);
    if (!(command.value >= 0.0f && command.value <= 1.0f))
        fail("texture {}: cleared to depth {}, expected 0 to 1", static_cast<std::size_t>(command.id), command.value);
    with_codec(texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        typename AnyCodec::Words words;
        words[0] = Int(depth_code_scalar(command.value, texture.info().type));
        fill<AnyCodec>(texture, words, workers_);
    });
}

void Device::run(const GenerateMips& command) { generate_mips(mutable_texture(command.id), profile_, workers_); }

void Device::run(const Draw& draw) {
    // Program and constants.
    if (draw.program == nullptr) fail("draw '{}': no program", draw.label);
    const Program& program = *draw.program;
    if (draw.vertex_constants.size() != program.vertex_constants_size ||
        draw.pixel_constants.size() != program.pixel_constants_size)
        fail("draw '{}': {} and {} bytes of constants, program {} expects {} and {}", draw.label, draw.vertex_constants.size(),
             draw.pixel_constants.size(), program.name, program.vertex_constants_size, program.pixel_constants_size);
    const auto targets = std::span(draw.color).first(static_cast<std::size_t>(program.targets));
    const auto is_target = [&](TextureId id) { return id == draw.depth || std::ranges::find(targets, id) != targets.end(); };
    if (program.pixel_constants != nullptr) {
        for (const NamedConstant& constant : program.pixel_constants(draw.pixel_constants)) {
            const auto* id = std::get_if<TextureId>(&constant.value);
            if (id == nullptr) continue;
            (void)texture(*id);
            if (is_target(*id)) fail("draw '{}': {} is sampled and written by the same draw", draw.label, constant.name);
        }
    }

    // Vertices and indices.
    const Buffer& vertex_buffer = buffer(draw.vertices);
    const std::span<const float> floats(reinterpret_cast<const float*>(vertex_buffer.data.data()),
                                        vertex_buffer.data.size() / sizeof(float));
    const std::size_t available = floats.size() / static_cast<std::size_t>(program.vertex_floats);
    if (draw.count % 3 != 0) fail("draw '{}': {} corners, expected a multiple of 3", draw.label, draw.count);
    if (draw.count == 0) return;
    PrimitiveSource source{.indices = {}, .first = draw.first, .count = draw.count, .base = 0};
    std::uint32_t lowest = draw.first;
    std::uint64_t highest = std::uint64_t{draw.first} + draw.count - 1;
    if (draw.indices != BufferId::None) {
        const Buffer& index_buffer = buffer(draw.indices);
        source.indices = {reinterpret_cast<const std::uint32_t*>(index_buffer.data.data()),
                          index_buffer.data.size() / sizeof(std::uint32_t)};
        if (highest >= source.indices.size())
            fail("draw '{}': indices {} to {}, but the buffer holds {}", draw.label, draw.first, highest,
                 source.indices.size());
        const auto [low, high] = std::ranges::minmax(source.indices.subspan(draw.first, draw.count));
        lowest = low;
        highest = high;
    }
    if (highest >= available)
        fail("draw '{}': vertex {} used, but the buffer holds {} of {} floats", draw.label, highest, available,
             program.vertex_floats);
    source.base = lowest;

    // Targets, all of one size.
    std::array<Texture*, kMaxTargets> color{};
    const Texture* sized = nullptr;
    const auto check_size = [&](const Texture& target) {
        if (sized != nullptr && (sized->width(0) != target.width(0) || sized->height(0) != target.height(0)))
            fail("draw '{}': targets of {}x{} and {}x{} pixels, expected one size", draw.label, sized->width(0),
                 sized->height(0), target.width(0), target.height(0));
        sized = &target;
    };
    for (std::size_t i = 0; i < static_cast<std::size_t>(program.targets); ++i) {
        color[i] = &mutable_texture(draw.color[i]);
        if (color[i]->info().is_depth) fail("draw '{}': colour target {} has a depth format", draw.label, i);
        if (std::ranges::count(targets, targets[i]) > 1) fail("draw '{}': colour target {} is bound twice", draw.label, i);
        check_size(*color[i]);
    }
    Texture* depth = nullptr;
    if (draw.depth != TextureId::None) {
        depth = &mutable_texture(draw.depth);
        if (!depth->info().is_depth) fail("draw '{}': depth target has the format {}", draw.label, depth->info().name);
        check_size(*depth);
    }
    if (sized == nullptr) fail("draw '{}': no target at all", draw.label);
    Viewport area = draw.viewport;
    if (area.width == 0) area = {0, 0, sized->width(0), sized->height(0)};
    if (area.x < 0 || area.y < 0 || area.width < 1 || area.height < 1 || area.x > sized->width(0) - area.width ||
        area.y > sized->height(0) - area.height)
        fail("draw '{}': viewport of {}x{} pixels at ({}, {}), expected inside {}x{}", draw.label, area.width, area.height,
             area.x, area.y, sized->width(0), sized->height(0));
    const PixelRect viewport{area.x, area.y, area.x + area.width, area.y + area.height};

    const DrawContext context{
        .draw = draw,
        .profile = profile_,
        .workers = workers_,
        .scratch = *scratch_,
        .vertices = floats,
        .source = source,
        .vertex_count = static_cast<std::uint32_t>(highest) - lowest + 1,
        .setup = {.raster = draw.raster,
                  .viewport = viewport,
                  .subpixel_bits = profile_.raster_subpixel_bits,
                  .depth_type = depth != nullptr ? depth->info().type : ComponentType::Depth24},
        .tiles = {.viewport = viewport,
                  .depth_texture = depth,
                  .depth_state = draw.depth_state,
                  .color = std::span(color).first(static_cast<std::size_t>(program.targets)),
                  .textures = textures_,
                  .profile = &profile_},
        .tiles_x = (sized->width(0) + kTileSize - 1) / kTileSize,
        .tiles_y = (sized->height(0) + kTileSize - 1) / kTileSize,
        .counters = counting_ ? &counters_ : nullptr,
        .stop = stop_,
    };
    program.run(context);
}

}  // namespace gnomon
