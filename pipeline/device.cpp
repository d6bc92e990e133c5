#include "pipeline/device.h"

#include "pipeline/depth.h"
#include "pipeline/resolve.h"
#include "pipeline/validate.h"
#include "texunit/codec.h"
#include "texunit/mipmap.h"
#include "texunit/store.h"

#include <algorithm>
#include <unordered_map>

namespace gnomon {

namespace {

std::size_t number(TextureId id) { return static_cast<std::size_t>(id); }

/// Texels of one layer's level.
std::uint64_t texels(const Texture& texture, int level) {
    return static_cast<std::uint64_t>(texture.width(level)) * static_cast<std::uint64_t>(texture.height(level));
}

/// Throws Error for a texel that is no depth of the format, whose codes are 32-bit words here; of binary32 those from 0 to 1.
void check_depth_codes(const Texture& texture, const WriteTexture& command) {
    std::uint32_t largest = 0x3f800000u;
    if (texture.info().type == ComponentType::Depth16) largest = 0xffffu;
    if (texture.info().type == ComponentType::Depth24) largest = 0xffffffu;
    const auto width = static_cast<std::size_t>(texture.width(command.level));
    for (std::size_t i = 0; i < command.data.size() / sizeof(std::uint32_t); ++i) {
        std::uint32_t code = 0;
        std::memcpy(&code, command.data.data() + i * sizeof(code), sizeof(code));
        if (code > largest)
            fail("texture {}: texel ({}, {}) written with the code {:#x}, which is no depth of {}: expected 0 to {:#x}",
                 number(command.id), i % width, i / width, code, texture.info().name, largest);
    }
}

/// Calls row(y) with pieces of [0, height) in parallel.
template <class Rows>
void for_row_pieces(int height, Workers& workers, const Rows& rows) {
    constexpr int kRows = 64;
    workers.for_each(static_cast<std::size_t>((height + kRows - 1) / kRows), [&](std::size_t piece) {
        const int first = static_cast<int>(piece) * kRows;
        rows(first, std::min(first + kRows, height));
    });
}

/// One texel's words in every sample of the view.
template <class AnyCodec>
void fill(Texture& texture, const TargetView& view, const typename AnyCodec::Words& words, Workers& workers) {
    const SpilledTexels<AnyCodec> texel(words);
    const int width = texture.width(view.level);
    const std::size_t row_bytes = static_cast<std::size_t>(width) * AnyCodec::kBytes;
    for (int layer = view.first_layer; layer < view.first_layer + view.layers; ++layer) {
        for (int s = 0; s < texture.desc().samples; ++s) {
            for_row_pieces(texture.height(view.level), workers, [&](int first, int end) {
                std::byte* source = texture.row(view.level, first, layer, s);
                for (int x = 0; x < width; ++x) texel.store_lane(source + x * AnyCodec::kBytes, 0);
                for (int y = first + 1; y < end; ++y) std::memcpy(texture.row(view.level, y, layer, s), source, row_bytes);
            });
        }
    }
}

}  // namespace

Device::Device(Profile profile, int threads)
    : profile_(std::move(profile)), workers_(threads), scratch_(std::make_unique<DrawScratch>()) {
    check_profile(profile_, fmt::format("profile '{}'", profile_.name));
}
Device::~Device() = default;

void Device::execute(const Command& command) {
    std::visit([this](const auto& c) { run(c); }, command);
    if (observer_) observer_(command);
}

BufferId Device::create_buffer(std::string_view label, std::span<const std::byte> data) {
    const auto id = static_cast<BufferId>(resources_.buffers() + 1);
    execute(CreateBuffer{id, label, data});
    return id;
}

TextureId Device::create_texture(std::string_view label, const TextureDesc& desc) {
    const auto id = static_cast<TextureId>(resources_.textures() + 1);
    execute(CreateTexture{id, label, desc});
    return id;
}

std::vector<ResourceTraffic> Device::traffic(const Tally& tally) const {
    std::vector<ResourceTraffic> list;
    std::unordered_map<std::string, int> seen;
    const auto add = [&](const std::string& label, const Bytes& bytes) {
        const int copy = ++seen[label];
        if (bytes != Bytes{}) list.push_back({copy == 1 ? label : fmt::format("{} {}", label, copy), bytes});
    };
    for (std::size_t i = 1; i <= resources_.textures(); ++i) {
        const auto id = static_cast<TextureId>(i);
        add(resources_.label(id), tally.of(id));
    }
    for (std::size_t i = 1; i <= resources_.buffers(); ++i) {
        const auto id = static_cast<BufferId>(i);
        add(resources_.buffer(id).label, tally.of(id));
    }
    return list;
}

std::size_t Device::scratch_bytes() const { return scratch_->bytes(); }

void Device::run(const CreateBuffer& command) {
    const std::size_t size = command.size == 0 ? command.data.size() : command.size;
    if (size < command.data.size() || size > kMaxBufferBytes)
        fail("buffer {} of {} bytes: expected {} (its data) to {}", static_cast<std::size_t>(command.id), size,
             command.data.size(), kMaxBufferBytes);
    Buffer buffer{std::string(command.label), {}};
    buffer.data.reserve(size);
    buffer.data.assign(command.data.begin(), command.data.end());
    buffer.data.resize(size);
    resources_.add(command.id, std::move(buffer));
}

void Device::run(const CreateTexture& command) {
    check_texture(command.desc, profile_);
    resources_.add(command.id, command.label, command.desc);
}

void Device::run(const WriteTexture& command) {
    Texture& texture = resources_.texture(command.id);
    const auto check = [&](const char* what, int value, int count) {
        if (value < 0 || value >= count)
            fail("texture {}: {} {} written, expected 0 to {}", number(command.id), what, value, count - 1);
    };
    check("level", command.level, texture.desc().levels);
    check("layer", command.layer, texture.desc().layers);
    check("sample", command.sample, texture.desc().samples);
    if (texture.info().is_depth) check_depth_codes(texture, command);
    texture.set_level_bytes(command.level, command.data.data(), command.data.size(), command.layer, command.sample);
}

void Device::run(const ClearColor& command) {
    Texture& texture = resolve_view(command.target, resources_, "clear");
    if (texture.info().is_depth)
        fail("texture {}: cleared to a colour, but it is a depth texture", number(command.target.texture));
    const DenormalScope denormals(profile_.flush_denormals);
    with_codec(texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        const Vec4<Float> color{Float(command.value.x), Float(command.value.y), Float(command.value.z), Float(command.value.w)};
        fill<AnyCodec>(texture, command.target,
                       AnyCodec::encode(truncate<AnyCodec::kComponents>(color), profile_.float_narrowing), workers_);
    });
    count_fill(command.target, texture, texel_bytes(texture.info()));
}

void Device::run(const ClearDepth& command) {
    Texture& texture = resolve_view(command.target, resources_, "clear");
    if (!texture.info().is_depth)
        fail("texture {}: cleared to a depth, but its format is {}", number(command.target.texture), texture.info().name);
    if (!(command.value >= 0.0f && command.value <= 1.0f))
        fail("texture {}: cleared to depth {}, expected 0 to 1", number(command.target.texture), command.value);
    with_codec(texture.desc().format, [&]<class AnyCodec>(AnyCodec) {
        typename AnyCodec::Words words;
        words[0] = depth_code(Float(command.value), DepthRange<float>{}, texture.info().type, profile_.depth_rounding);
        fill<AnyCodec>(texture, command.target, words, workers_);
    });
    count_fill(command.target, texture, texel_bytes(texture.info()));
}

void Device::run(const ClearStencil& command) {
    Texture& texture = resolve_view(command.target, resources_, "clear");
    if (!texture.info().has_stencil)
        fail("texture {}: its stencil cleared, but its format is {}", number(command.target.texture), texture.info().name);
    if (command.value < 0 || command.value > 255)
        fail("texture {}: cleared to stencil {}, expected 0 to 255", number(command.target.texture), command.value);
    const TargetView& view = command.target;
    for (int layer = view.first_layer; layer < view.first_layer + view.layers; ++layer)
        for (int s = 0; s < texture.desc().samples; ++s)
            for (int y = 0; y < texture.height(view.level); ++y)
                std::memset(texture.stencil_row(view.level, y, layer, s), command.value,
                            static_cast<std::size_t>(texture.width(view.level)));
    count_fill(view, texture, 1);
}

void Device::count_fill(const TargetView& view, const Texture& texture, std::uint64_t bytes) {
    if (!counting_) return;
    const auto planes = static_cast<std::uint64_t>(view.layers) * static_cast<std::uint64_t>(texture.desc().samples);
    tally_.write(view.texture, texels(texture, view.level) * planes * bytes);
}

void Device::run(const GenerateMips& command) {
    Texture& texture = resources_.texture(command.id, "mips");
    if (texture.info().is_depth || texture.info().is_integer())
        fail("mips: texture {} holds {}, which is not filtered", number(command.id), texture.info().name);
    generate_mips(texture, profile_, workers_);
    if (!counting_) return;
    const auto bytes = texel_bytes(texture.info()) * static_cast<std::uint64_t>(texture.desc().layers);
    for (int level = 1; level < texture.desc().levels; ++level) {
        tally_.read(command.id, texels(texture, level - 1) * bytes);
        tally_.write(command.id, texels(texture, level) * bytes);
    }
}

void Device::run(const Resolve& command) {
    const TargetView& from = command.source;
    const TargetView& to = command.destination;
    const Texture& source = resolve_view(from, resources_, "resolve");
    Texture& destination = resolve_view(to, resources_, "resolve");
    const FormatInfo& format = source.info();
    if (source.desc().samples == 1) fail("resolve: texture {} has one sample, expected several", number(from.texture));
    if (destination.desc().samples != 1)
        fail("resolve: texture {} has {} samples, expected one", number(to.texture), destination.desc().samples);
    if (format.format != destination.info().format)
        fail("resolve: from {} to {}, expected one format", format.name, destination.info().name);
    if (format.is_depth || format.is_integer()) fail("resolve: {} has no mean; a shader can load its samples", format.name);
    if (source.width(0) != destination.width(to.level) || source.height(0) != destination.height(to.level))
        fail("resolve: from {}x{} to {}x{} pixels, expected one size", source.width(0), source.height(0),
             destination.width(to.level), destination.height(to.level));
    if (from.layers != 1 || to.layers != 1) fail("resolve: {} layers to {}, expected one at a time", from.layers, to.layers);
    resolve_samples(source, destination, {from.first_layer, to.level, to.first_layer}, profile_, workers_);
    if (!counting_) return;
    const std::uint64_t pixels = texels(source, 0);
    const std::uint64_t samples = pixels * static_cast<std::uint64_t>(source.desc().samples);
    tally_.counters.samples_resolved += samples;
    tally_.read(from.texture, samples * texel_bytes(format));
    tally_.write(to.texture, pixels * texel_bytes(format));
}

void Device::run(const Draw& draw) {
    DrawContext context;
    if (!resolve_draw(draw, resources_, profile_, context)) return;
    run_draw(context, {.profile = profile_,
                       .workers = workers_,
                       .scratch = *scratch_,
                       .tally = counting_ ? &tally_ : nullptr,
                       .stop = stop_});
}

}  // namespace gnomon
