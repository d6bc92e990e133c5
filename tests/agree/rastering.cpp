// RasterPeer: checks, passes, and what is read back.
#include "tests/agree/rastering.h"

#include "sim/error.h"
#include "tests/agree/color_codes.h"
#include "tests/agree/raster_pipelines.h"
#include "tests/peer/result.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>

namespace gnomon::agree {
namespace {

constexpr int kMaxSize = 4096;               // of a target, within what every device allows. Vulkan 1.3 "Required Limits"
constexpr int kAtlasSize = 1024;             // of a coverage target, where the viewports are smaller
constexpr std::uint32_t kListedWidth = 256;  // of targets whose pixels are a list
constexpr std::uint32_t kLocalSize = 64;     // of fetch.comp
constexpr VkFormat kCoverageFormat = VK_FORMAT_R32_SFLOAT;
constexpr VkFormat kAttributeFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

static_assert(sizeof(ClipVertex) == 32 && sizeof(Color) == 16);  // as the shaders have them, std430

constexpr peer::ImageUse kFetched{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                  VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
constexpr peer::ImageUse kCopyTarget{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                                     VK_ACCESS_2_TRANSFER_WRITE_BIT};
constexpr peer::ImageUse kResolveSource{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_RESOLVE_BIT,
                                        VK_ACCESS_2_TRANSFER_READ_BIT};
constexpr peer::ImageUse kResolveTarget{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_RESOLVE_BIT,
                                        VK_ACCESS_2_TRANSFER_WRITE_BIT};

std::uint32_t u32(int value) { return static_cast<std::uint32_t>(value); }

VkFormat vk_format(DepthFormat format) {
    switch (format) {
        case DepthFormat::D16: return VK_FORMAT_D16_UNORM;
        case DepthFormat::D24: return VK_FORMAT_X8_D24_UNORM_PACK32;
        case DepthFormat::D32f: return VK_FORMAT_D32_SFLOAT;
    }
    fail("unknown depth format");
}

VkFormat vk_format(ColorFormat format) {
    switch (format) {
        case ColorFormat::Rgba8: return VK_FORMAT_R8G8B8A8_UNORM;
        case ColorFormat::Rgba16Unorm: return VK_FORMAT_R16G16B16A16_UNORM;
        case ColorFormat::Rgba16f: return VK_FORMAT_R16G16B16A16_SFLOAT;
        case ColorFormat::Rgba32f: return VK_FORMAT_R32G32B32A32_SFLOAT;
    }
    fail("unknown color format");
}

VkBlendFactor vk_factor(BlendFactor factor) {
    switch (factor) {
        case BlendFactor::Zero: return VK_BLEND_FACTOR_ZERO;
        case BlendFactor::One: return VK_BLEND_FACTOR_ONE;
        case BlendFactor::SourceColor: return VK_BLEND_FACTOR_SRC_COLOR;
        case BlendFactor::InverseSourceColor: return VK_BLEND_FACTOR_ONE_MINUS_SRC_COLOR;
        case BlendFactor::DestinationColor: return VK_BLEND_FACTOR_DST_COLOR;
        case BlendFactor::InverseDestinationColor: return VK_BLEND_FACTOR_ONE_MINUS_DST_COLOR;
        case BlendFactor::SourceAlpha: return VK_BLEND_FACTOR_SRC_ALPHA;
        case BlendFactor::InverseSourceAlpha: return VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
        case BlendFactor::DestinationAlpha: return VK_BLEND_FACTOR_DST_ALPHA;
        case BlendFactor::InverseDestinationAlpha: return VK_BLEND_FACTOR_ONE_MINUS_DST_ALPHA;
        case BlendFactor::ConstantColor: return VK_BLEND_FACTOR_CONSTANT_COLOR;
        case BlendFactor::InverseConstantColor: return VK_BLEND_FACTOR_ONE_MINUS_CONSTANT_COLOR;
        case BlendFactor::ConstantAlpha: return VK_BLEND_FACTOR_CONSTANT_ALPHA;
        case BlendFactor::InverseConstantAlpha: return VK_BLEND_FACTOR_ONE_MINUS_CONSTANT_ALPHA;
        case BlendFactor::SourceAlphaSaturate: return VK_BLEND_FACTOR_SRC_ALPHA_SATURATE;
    }
    fail("unknown blend factor");
}

VkBlendOp vk_operation(BlendOperation operation) {
    switch (operation) {
        case BlendOperation::Add: return VK_BLEND_OP_ADD;
        case BlendOperation::Subtract: return VK_BLEND_OP_SUBTRACT;
        case BlendOperation::ReverseSubtract: return VK_BLEND_OP_REVERSE_SUBTRACT;
        case BlendOperation::Min: return VK_BLEND_OP_MIN;
        case BlendOperation::Max: return VK_BLEND_OP_MAX;
    }
    fail("unknown blend operation");
}

VkPipelineColorBlendAttachmentState vk_blend(const BlendState& state) {
    return {
        .blendEnable = state.enabled ? VK_TRUE : VK_FALSE,
        .srcColorBlendFactor = vk_factor(state.color.source),
        .dstColorBlendFactor = vk_factor(state.color.destination),
        .colorBlendOp = vk_operation(state.color.operation),
        .srcAlphaBlendFactor = vk_factor(state.alpha.source),
        .dstAlphaBlendFactor = vk_factor(state.alpha.destination),
        .alphaBlendOp = vk_operation(state.alpha.operation),
        .colorWriteMask = 0,
    };
}

VkRenderingAttachmentInfo attachment(const peer::Image& image, VkAttachmentLoadOp load, VkClearValue clear) {
    VkRenderingAttachmentInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    info.imageView = image.level_0.get();
    info.imageLayout = peer::image_aspect(image.format) == VK_IMAGE_ASPECT_DEPTH_BIT ? VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL
                                                                                     : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    info.loadOp = load;
    info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    info.clearValue = clear;
    return info;
}

struct Attachments {
    const VkRenderingAttachmentInfo* color = nullptr;
    const VkRenderingAttachmentInfo* depth = nullptr;
};
void begin_rendering(VkCommandBuffer commands, VkExtent2D size, const Attachments& attachments) {
    VkRenderingInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
    info.renderArea.extent = size;
    info.layerCount = 1;
    info.colorAttachmentCount = attachments.color != nullptr ? 1 : 0;
    info.pColorAttachments = attachments.color;
    info.pDepthAttachment = attachments.depth;
    vkCmdBeginRendering(commands, &info);
}

// With a scissor that is `inset` pixels smaller on each side.
void set_viewport(VkCommandBuffer commands, const Viewport& viewport, int inset = 0) {
    const VkViewport mapped{static_cast<float>(viewport.x),
                            static_cast<float>(viewport.y),
                            static_cast<float>(viewport.width),
                            static_cast<float>(viewport.height),
                            0,
                            1};
    const VkRect2D scissor{{viewport.x + inset, viewport.y + inset},
                           {u32(viewport.width - 2 * inset), u32(viewport.height - 2 * inset)}};
    vkCmdSetViewport(commands, 0, 1, &mapped);
    vkCmdSetScissor(commands, 0, 1, &scissor);
}

Viewport whole(VkExtent2D size) { return {0, 0, static_cast<int>(size.width), static_cast<int>(size.height)}; }

void record_to_host(VkCommandBuffer commands) {
    VkMemoryBarrier2 barrier{};
    barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
    VkDependencyInfo dependency{};
    dependency.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands, &dependency);
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

VkExtent2D listed_size(std::size_t count) {
    const auto pixels = static_cast<std::uint32_t>(count);
    const std::uint32_t rows = (pixels + kListedWidth - 1) / kListedWidth;
    if (rows > u32(kMaxSize)) fail("{} pixels; expected at most {}", count, u32(kMaxSize) * kListedWidth);
    return {kListedWidth, rows};
}

}  // namespace

Viewport coverage_viewport(const CoverageOptions& options, std::size_t index) {
    const Atlas atlas(options);
    const auto cell = static_cast<int>(index % atlas.count());
    return {cell % atlas.columns * options.width, cell / atlas.columns * options.height, options.width, options.height};
}

struct RasterPeer::Machine {
    peer::Device device;
    RasterLayout layout;

    Machine(const peer::PeerDevice& description, const peer::PeerOptions& options)
        : device(description, options), layout(device) {}

    [[nodiscard]] bool has_format(VkFormat format, int samples, VkFormatFeatureFlags features, VkImageUsageFlags usage) const {
        VkFormatProperties properties{};
        vkGetPhysicalDeviceFormatProperties(device.physical(), format, &properties);
        if ((properties.optimalTilingFeatures & features) != features) return false;
        VkImageFormatProperties image{};
        const VkResult result = vkGetPhysicalDeviceImageFormatProperties(device.physical(), format, VK_IMAGE_TYPE_2D,
                                                                         VK_IMAGE_TILING_OPTIMAL, usage, 0, &image);
        return result == VK_SUCCESS && (image.sampleCounts & u32(samples)) != 0;
    }

    // Draws into `target`, which ends up as `use`, within one pass that starts from `attachments`.
    struct Pass {
        const peer::Image& target;
        Attachments attachments;
        VkDescriptorSet set;
    };
    void record_pass(VkCommandBuffer commands, const Pass& pass, const std::function<void()>& draw) const {
        begin_rendering(commands, pass.target.size, pass.attachments);
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout.pipeline.get(), 0, 1, &pass.set, 0, nullptr);
        set_viewport(commands, whole(pass.target.size));
        draw();
        vkCmdEndRendering(commands);
    }

    void push(VkCommandBuffer commands, const RasterConstants& constants) const {
        vkCmdPushConstants(commands, layout.pipeline.get(), VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT, 0,
                           sizeof(constants), &constants);
    }

    // Every sample of an image that was used as `last`.
    [[nodiscard]] std::vector<std::byte> fetch(const peer::Image& image, peer::ImageUse last, FetchKind kind,
                                               int samples) const {
        const std::uint32_t pixels = image.size.width * image.size.height;
        const std::size_t bytes = std::size_t{pixels} * (kind == FetchKind::Masks ? 4 : 16 * u32(samples));
        const peer::Buffer fetched = peer::readback_buffer(device, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        const RasterSet set = make_raster_set(device, layout, {.output = fetched.buffer.get(), .image = image.level_0.get()});
        const peer::OwnedPipeline pipeline = make_fetch_pipeline(device, layout, kind, samples);
        device.run(device.record([&](VkCommandBuffer commands) {
            peer::record_transitions(commands, {{image, last, kFetched}});
            vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.get());
            vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout.pipeline.get(), 0, 1, &set.set, 0,
                                    nullptr);
            push(commands, {image.size.width, pixels});
            vkCmdDispatch(commands, (pixels + kLocalSize - 1) / kLocalSize, 1, 1);
            record_to_host(commands);
        }));
        return peer::read_buffer(device, fetched);
    }
};

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

bool RasterPeer::supports(ColorFormat format) const {
    return machine_->has_format(vk_format(format), 4, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT,
                                VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
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

std::vector<Codes> RasterPeer::blend(ColorFormat format, const BlendState& state, std::span<const BlendCase> cases) {
    if (!supports(format)) fail("device '{}' cannot blend this format", description().name);
    if (cases.empty()) return {};
    const Machine& machine = *machine_;
    const peer::Device& device = machine.device;
    const VkExtent2D size = listed_size(cases.size());
    std::vector<Color> sources(std::size_t{size.width} * size.height);
    std::vector<Codes> destinations(sources.size());
    for (std::size_t i = 0; i < cases.size(); ++i) {
        sources[i] = cases[i].source;
        destinations[i] = cases[i].destination;
    }

    const peer::Image target = peer::make_image(
        device,
        {.format = vk_format(format),
         .size = size,
         .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    const peer::OwnedPipeline pipeline = make_raster_pipeline(device, machine.layout,
                                                              {.source = FragmentSource::Listed,
                                                               .color = vk_format(format),
                                                               .blend = vk_blend(state),
                                                               .blend_constant = state.constant});
    const std::vector<std::byte> texels = texels_from_codes(format, destinations);
    const peer::Buffer upload = peer::host_buffer(device, texels, VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    const peer::Buffer listed =
        peer::host_buffer(device, std::as_bytes(std::span(sources)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const RasterSet set = make_raster_set(device, machine.layout, {.input = listed.buffer.get()});
    const VkRenderingAttachmentInfo color = attachment(target, VK_ATTACHMENT_LOAD_OP_LOAD, {});
    device.run(device.record([&](VkCommandBuffer commands) {
        peer::record_transitions(commands, {{target, peer::kDiscarded, kCopyTarget}});
        VkBufferImageCopy copy{};
        copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        copy.imageExtent = {size.width, size.height, 1};
        vkCmdCopyBufferToImage(commands, upload.buffer.get(), target.image.get(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                               &copy);
        peer::record_transitions(commands, {{target, kCopyTarget, peer::kColorTarget}});
        machine.record_pass(commands, {target, {&color, nullptr}, set.set}, [&] {
            vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
            machine.push(commands, {size.width, 0});
            vkCmdDraw(commands, 3, 1, 0, 0);
        });
    }));
    std::vector<Codes> blended = codes_from_texels(format, peer::read_image(device, target, peer::kColorTarget));
    blended.resize(cases.size());
    return blended;
}

std::vector<Codes> RasterPeer::resolve(ColorFormat format, std::span<const SampleCodes> pixels, ResolveBy by) {
    if (!supports(format)) fail("device '{}' cannot resolve this format", description().name);
    if (pixels.empty()) return {};
    const Machine& machine = *machine_;
    const peer::Device& device = machine.device;
    const VkExtent2D size = listed_size(pixels.size());
    const std::size_t pixel_count = std::size_t{size.width} * size.height;

    // Sample after sample, each a list of all pixels.
    std::vector<Color> colors(4 * pixel_count);
    for (std::size_t s = 0; s < 4; ++s)
        for (std::size_t i = 0; i < pixels.size(); ++i) colors[s * pixel_count + i] = color_from_codes(format, pixels[i][s]);

    const VkImageUsageFlags usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const peer::Image sampled =
        peer::make_image(device, {.format = vk_format(format), .size = size, .usage = usage, .samples = VK_SAMPLE_COUNT_4_BIT});
    const peer::Image resolved =
        peer::make_image(device, {.format = vk_format(format), .size = size, .usage = usage | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    std::array<peer::OwnedPipeline, 4> pipelines;
    for (std::uint32_t s = 0; s < 4; ++s)
        pipelines[s] = make_raster_pipeline(
            device, machine.layout,
            {.source = FragmentSource::Listed, .color = vk_format(format), .samples = 4, .sample_mask = 1u << s});
    const peer::Buffer listed = peer::host_buffer(device, std::as_bytes(std::span(colors)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const RasterSet set = make_raster_set(device, machine.layout, {.input = listed.buffer.get()});
    VkRenderingAttachmentInfo color = attachment(sampled, VK_ATTACHMENT_LOAD_OP_CLEAR, {});
    if (by == ResolveBy::Attachment) {
        color.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
        color.resolveImageView = resolved.level_0.get();
        color.resolveImageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    }
    device.run(device.record([&](VkCommandBuffer commands) {
        peer::record_transitions(
            commands, {{sampled, peer::kDiscarded, peer::kColorTarget}, {resolved, peer::kDiscarded, peer::kColorTarget}});
        machine.record_pass(commands, {sampled, {&color, nullptr}, set.set}, [&] {
            for (std::uint32_t s = 0; s < 4; ++s) {
                vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines[s].get());
                machine.push(commands, {size.width, s * static_cast<std::uint32_t>(pixel_count)});
                vkCmdDraw(commands, 3, 1, 0, 0);
            }
        });
        if (by == ResolveBy::Attachment) return;
        peer::record_transitions(
            commands, {{sampled, peer::kColorTarget, kResolveSource}, {resolved, peer::kColorTarget, kResolveTarget}});
        VkImageResolve region{};
        region.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        region.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        region.extent = {size.width, size.height, 1};
        vkCmdResolveImage(commands, sampled.image.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, resolved.image.get(),
                          VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    }));
    const peer::ImageUse last = by == ResolveBy::Attachment ? peer::kColorTarget : kResolveTarget;
    std::vector<Codes> codes = codes_from_texels(format, peer::read_image(device, resolved, last));
    codes.resize(pixels.size());
    return codes;
}

}  // namespace gnomon::agree
