#include "studies/image_io.h"

#include "sim/error.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>

namespace gnomon::studies {

namespace {

/// What OpenImageIO says, as one line.
std::string first_line(std::string message) {
    message.resize(std::min(message.find('\n'), message.size()));
    return message.empty() ? "the file cannot be written" : message;
}

/// `format` by name: files are written beside their place, under names that end in anything.
void write(const std::filesystem::path& path, const char* format, const OIIO::ImageSpec& spec, const void* pixels) {
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(format);
    if (!output) fail("{}: {}", path.string(), first_line(OIIO::geterror()));
    if (!output->open(path.string(), spec) || !output->write_image(spec.format, pixels) || !output->close())
        fail("{}: {}", path.string(), first_line(output->geterror()));
}

}  // namespace

void write_png(const std::filesystem::path& path, const ByteImage& image) {
    OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    write(path, "png", spec, image.values.data());
}

void write_exr(const std::filesystem::path& path, const FloatImage& y, std::span<const float> a) {
    GNOMON_CHECK_EQ(y.values.size(), a.size());
    std::vector<float> pixels;
    pixels.reserve(2 * a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        pixels.push_back(y.values[i]);
        pixels.push_back(a[i]);
    }
    OIIO::ImageSpec spec(y.width, y.height, 2, OIIO::TypeDesc::FLOAT);
    spec.channelnames = {"Y", "A"};
    spec.alpha_channel = 1;
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "1970:01:01 00:00:00");  // OpenImageIO fills in the present time otherwise
    write(path, "openexr", spec, pixels.data());
}

ColorImage read_image(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) fail("{}: not a file that can be read", path.string());
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path.string());
    if (!input) fail("{}: not an image: {}", path.string(), first_line(OIIO::geterror()));
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.width < 1 || spec.width > kMaxTextureSize || spec.height < 1 || spec.height > kMaxTextureSize)
        fail("{}: {}x{} pixels, expected 1 to {} each way", path.string(), spec.width, spec.height, kMaxTextureSize);
    if (spec.depth > 1) fail("{}: an image of {} slices, expected one", path.string(), spec.depth);
    if (spec.nchannels < 1 || spec.nchannels > 64) fail("{}: {} channels, expected 1 to 64", path.string(), spec.nchannels);

    const auto channels = static_cast<std::size_t>(spec.nchannels);
    ColorImage image{spec.width, spec.height, {}};
    const std::size_t pixels = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
    std::vector<float> values(pixels * channels);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()))
        fail("{}: {}", path.string(), first_line(input->geterror()));
    image.values.assign(pixels, glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < std::min<std::size_t>(channels, 4); ++c)
            image.values[i][static_cast<int>(c)] = values[i * channels + c];
    return image;
}

}  // namespace gnomon::studies
