// RasterPeer: coverage, depth and attributes of triangles.
#include "tests/agree/rastering.h"

#include "sim/error.h"
#include "tests/agree/raster_machine.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace gnomon::agree {
namespace {

constexpr int kAtlasSize = 1024;  // of a coverage target, where the viewports are smaller
constexpr VkFormat kCoverageFormat = VK_FORMAT_R32_SFLOAT;
constexpr VkFormat kAttributeFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

static_assert(sizeof(ClipVertex) == 32 && sizeof(Color) == 16);  // as the shaders have them, std430

VkFormat vk_format(DepthFormat format) {
    switch (format) {
        case DepthFormat::D16: return VK_FORMAT_D16_UNORM;
        case DepthFormat::D24: return VK_FORMAT_X8_D24_UNORM_PACK32;
        case DepthFormat::D32f: return VK_FORMAT_D32_SFLOAT;
    }
    fail("unknown depth format");
}

template <class T>
std::vector<T> values_of(std::span<const std::byte> bytes) {
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

void check_size(int width, int height) {
    if (width < 1 || height < 1 || width > kMaxSize || height > kMaxSize)
        fail("{} x {} pixels; expected 1 x 1 to {} x {}", width, height, kMaxSize, kMaxSize);
}

void check_samples(int samples) {
    if (samples != 1 && samples != 4) fail("{} samples; expected 1 or 4", samples);
}

// Viewports along each side of a coverage target.
struct Atlas {
    int columns;
    int rows;

    explicit Atlas(const CoverageOptions& options)
        : columns(std::max(1, kAtlasSize / options.width)), rows(std::max(1, kAtlasSize / options.height)) {}

    [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
};

// The pixels of a viewport in a target of masks.
std::vector<CoveredPixel> covered_in(const Viewport& viewport, std::span<const std::uint32_t> masks, std::uint32_t row_length) {
    std::vector<CoveredPixel> pixels;
    for (int y = 0; y < viewport.height; ++y)
        for (int x = 0; x < viewport.width; ++x) {
            const std::uint32_t mask = masks[std::size_t{u32(viewport.y + y)} * row_length + u32(viewport.x + x)];
            if (mask != 0) pixels.push_back({x, y, mask});
        }
    return pixels;
}

}  // namespace

Viewport coverage_viewport(const CoverageOptions& options, std::size_t index) {
    const Atlas atlas(options);
    const auto cell = static_cast<int>(index % atlas.count());
    return {cell % atlas.columns * options.width, cell / atlas.columns * options.height, options.width, options.height};
}

RasterPeer::RasterPeer(const peer::PeerDevice& device, const peer::PeerOptions& options)
    : machine_(std::make_unique<Machine>(device, options)) {}
RasterPeer::~RasterPeer() = default;
RasterPeer::RasterPeer(RasterPeer&&) noexcept = default;
RasterPeer& RasterPeer::operator=(RasterPeer&&) noexcept = default;

const peer::PeerDevice& RasterPeer::description() const { return machine_->device.description(); }
bool RasterPeer::validates() const { return machine_->device.instance().validates(); }
std::vector<std::string> RasterPeer::validation_messages() const { return machine_->device.instance().messages(); }

bool RasterPeer::supports(DepthFormat format, int samples) const {
    check_samples(samples);
    if (format == DepthFormat::D24 && samples > 1) return false;
    return machine_->has_format(vk_format(format), samples,
                                VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT,
                                VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT);
}

std::vector<TriangleCoverage> RasterPeer::coverage(const CoverageOptions& options, std::span<const ClipTriangle> triangles) {
    check_size(options.width, options.height);
    check_samples(options.samples);
    if (options.inset < 0 || 2 * options.inset > std::min(options.width, options.height))
        fail("a scissor {} pixels inside of {} x {}", options.inset, options.width, options.height);
    const Machine& machine = *machine_;
    const peer::Device& device = machine.device;
    const Atlas atlas(options);
    const peer::Image target =
        peer::make_image(device, {.format = kCoverageFormat,
                                  .size = {u32(atlas.columns * options.width), u32(atlas.rows * options.height)},
                                  .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                                  .samples = static_cast<VkSampleCountFlagBits>(options.samples)});
    const peer::OwnedPipeline pipeline = make_raster_pipeline(
        device, machine.layout, {.source = FragmentSource::One, .color = kCoverageFormat, .samples = options.samples});
    const VkRenderingAttachmentInfo color = attachment(target, VK_ATTACHMENT_LOAD_OP_CLEAR, {});

    std::vector<TriangleCoverage> covered;
    while (!triangles.empty()) {
        const std::span<const ClipTriangle> batch = triangles.first(std::min(triangles.size(), atlas.count()));
        const peer::Buffer vertices = peer::host_buffer(device, std::as_bytes(batch), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        const RasterSet set = make_raster_set(device, machine.layout, {.input = vertices.buffer.get()});
        device.run(device.record([&](VkCommandBuffer commands) {
            peer::record_transitions(commands, {{target, peer::kDiscarded, peer::kColorTarget}});
            machine.record_pass(commands, {target, {&color, nullptr}, set.set}, [&] {
                vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
                for (std::uint32_t i = 0; i < batch.size(); ++i) {
                    set_viewport(commands, coverage_viewport(options, i), options.inset);
                    vkCmdDraw(commands, 3, 1, 3 * i, 0);
                }
            });
        }));
        const std::vector<std::byte> fetched = machine.fetch(target, peer::kColorTarget, FetchKind::Masks, options.samples);
        const auto masks = values_of<std::uint32_t>(fetched);
        for (std::size_t i = 0; i < batch.size(); ++i) {
            const Viewport viewport = coverage_viewport(options, i);
            covered.push_back({viewport, covered_in(viewport, masks, target.size.width)});
        }
        triangles = triangles.subspan(batch.size());
    }
    return covered;
}

std::vector<std::uint32_t> RasterPeer::depth(const DepthDraw& draw) {
    check_size(draw.width, draw.height);
    if (!supports(draw.format, draw.samples))
        fail("device '{}' has no such depth format with {} samples", description().name, draw.samples);
    if (draw.vertices.empty() || draw.indices.empty() || draw.indices.size() % 3 != 0)
        fail("{} vertices and {} indices are no triangles", draw.vertices.size(), draw.indices.size());
    for (const std::uint32_t index : draw.indices)
        if (index >= draw.vertices.size()) fail("index {} of {} vertices", index, draw.vertices.size());

    const Machine& machine = *machine_;
    const peer::Device& device = machine.device;
    const bool is_fetched = draw.samples > 1;
    const VkFormat format = vk_format(draw.format);
    const VkImageUsageFlags read = is_fetched ? VK_IMAGE_USAGE_SAMPLED_BIT : VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const peer::Image target = peer::make_image(device, {.format = format,
                                                         .size = {u32(draw.width), u32(draw.height)},
                                                         .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | read,
                                                         .samples = static_cast<VkSampleCountFlagBits>(draw.samples)});
    const peer::OwnedPipeline pipeline = make_raster_pipeline(device, machine.layout,
                                                              {.source = FragmentSource::None,
                                                               .depth = format,
                                                               .samples = draw.samples,
                                                               .depth_bias_constant = draw.bias_constant,
                                                               .depth_bias_slope = draw.bias_slope});
    const peer::Buffer vertices =
        peer::host_buffer(device, std::as_bytes(std::span(draw.vertices)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const peer::Buffer indices =
        peer::host_buffer(device, std::as_bytes(std::span(draw.indices)), VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    const RasterSet set = make_raster_set(device, machine.layout, {.input = vertices.buffer.get()});
    VkClearValue far{};
    far.depthStencil.depth = 1;
    const VkRenderingAttachmentInfo depth = attachment(target, VK_ATTACHMENT_LOAD_OP_CLEAR, far);
    device.run(device.record([&](VkCommandBuffer commands) {
        peer::record_transitions(commands, {{target, peer::kDiscarded, peer::kDepthTarget}});
        machine.record_pass(commands, {target, {nullptr, &depth}, set.set}, [&] {
            vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
            vkCmdBindIndexBuffer(commands, indices.buffer.get(), 0, VK_INDEX_TYPE_UINT32);
            vkCmdDrawIndexed(commands, static_cast<std::uint32_t>(draw.indices.size()), 1, 0, 0, 0);
        });
    }));

    std::vector<std::uint32_t> codes;
    if (is_fetched) {
        const std::vector<std::byte> fetched = machine.fetch(target, peer::kDepthTarget, FetchKind::Values, draw.samples);
        for (const Color& value : values_of<Color>(fetched))
            codes.push_back(draw.format == DepthFormat::D32f ? std::bit_cast<std::uint32_t>(value[0])
                                                             : static_cast<std::uint32_t>(std::lround(value[0] * 65535.0f)));
        return codes;
    }
    const std::vector<std::byte> texels = peer::read_image(device, target, peer::kDepthTarget);
    if (draw.format == DepthFormat::D16) {
        const auto narrow = values_of<std::uint16_t>(texels);
        return {narrow.begin(), narrow.end()};
    }
    codes = values_of<std::uint32_t>(texels);
    // The upper byte of d24 is undefined.
    if (draw.format == DepthFormat::D24)
        for (std::uint32_t& code : codes) code &= 0xffffffu;
    return codes;
}

std::vector<Color> RasterPeer::attributes(const ClipTriangle& triangle, int width, int height, Interpolation interpolation) {
    check_size(width, height);
    const Machine& machine = *machine_;
    const peer::Device& device = machine.device;
    const peer::Image target =
        peer::make_image(device, {.format = kAttributeFormat,
                                  .size = {u32(width), u32(height)},
                                  .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    const bool is_linear = interpolation == Interpolation::Linear;
    const peer::OwnedPipeline pipeline = make_raster_pipeline(
        device, machine.layout,
        {.source = is_linear ? FragmentSource::Linear : FragmentSource::Perspective, .color = kAttributeFormat});
    const peer::Buffer vertices =
        peer::host_buffer(device, std::as_bytes(std::span(triangle)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const RasterSet set = make_raster_set(device, machine.layout, {.input = vertices.buffer.get()});
    const VkRenderingAttachmentInfo color = attachment(target, VK_ATTACHMENT_LOAD_OP_CLEAR, {});
    device.run(device.record([&](VkCommandBuffer commands) {
        peer::record_transitions(commands, {{target, peer::kDiscarded, peer::kColorTarget}});
        machine.record_pass(commands, {target, {&color, nullptr}, set.set}, [&] {
            vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
            vkCmdDraw(commands, 3, 1, 0, 0);
        });
    }));
    return values_of<Color>(peer::read_image(device, target, peer::kColorTarget));
}

}  // namespace gnomon::agree
