#include "studies/image_io.h"

#include "sim/error.h"

#include <OpenImageIO/imageio.h>

namespace gnomon::studies {

namespace {

/// What OpenImageIO says, as one line.
std::string first_line(std::string message) {
    message.resize(std::min(message.find('\n'), message.size()));
    return message.empty() ? "the file cannot be written" : message;
}

void write(const std::filesystem::path& path, const OIIO::ImageSpec& spec, const void* pixels) {
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(path.string());
    if (!output) fail("{}: {}", path.string(), first_line(OIIO::geterror()));
    if (!output->open(path.string(), spec) || !output->write_image(spec.format, pixels) || !output->close())
        fail("{}: {}", path.string(), first_line(output->geterror()));
}

}  // namespace

void write_png(const std::filesystem::path& path, const ByteImage& image) {
    OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    write(path, spec, image.values.data());
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
    write(path, spec, pixels.data());
}

}  // namespace gnomon::studies
