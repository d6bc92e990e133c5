// RasterPeer: blending and resolve.
#include "sim/error.h"
#include "tests/agree/color_codes.h"
#include "tests/agree/raster_machine.h"

namespace gnomon::agree {
namespace {

constexpr std::uint32_t kListedWidth = 256;  // of targets whose pixels are a list

constexpr peer::ImageUse kCopyTarget{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                                     VK_ACCESS_2_TRANSFER_WRITE_BIT};
constexpr peer::ImageUse kResolveSource{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_RESOLVE_BIT,
                                        VK_ACCESS_2_TRANSFER_READ_BIT};
constexpr peer::ImageUse kResolveTarget{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_RESOLVE_BIT,
                                        VK_ACCESS_2_TRANSFER_WRITE_BIT};

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

VkExtent2D listed_size(std::size_t count) {
    const auto pixels = static_cast<std::uint32_t>(count);
    const std::uint32_t rows = (pixels + kListedWidth - 1) / kListedWidth;
    if (rows > u32(kMaxSize)) fail("{} pixels; expected at most {}", count, u32(kMaxSize) * kListedWidth);
    return {kListedWidth, rows};
}

}  // namespace

bool RasterPeer::supports(ColorFormat format) const {
    return machine_->has_format(vk_format(format), 4, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT,
                                VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
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
