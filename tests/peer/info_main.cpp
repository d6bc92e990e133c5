// gnomon_peer_info: the Vulkan devices here and what they say of their precision.
#include "sim/error.h"
#include "tests/peer/peer.h"

#include <fmt/format.h>

#include <cstdio>
#include <string_view>

namespace {

using gnomon::peer::PeerDevice;

std::string_view yes_no(bool value) { return value ? "yes" : "no"; }

void print(const PeerDevice& device) {
    const gnomon::peer::DeviceLimits& limits = device.limits;
    fmt::print("{}: {}\n", device.index, device.name);
    fmt::print("   driver                     {} {}\n", device.driver, device.driver_info);
    fmt::print("   kind                       {}, Vulkan {}\n", gnomon::peer::kind_name(device.kind), device.api_version);
    fmt::print("   subPixelPrecisionBits      {}\n", limits.sub_pixel_bits);
    fmt::print("   subTexelPrecisionBits      {}\n", limits.sub_texel_bits);
    fmt::print("   mipmapPrecisionBits        {}\n", limits.mipmap_bits);
    fmt::print("   maxSamplerAnisotropy       {}\n", limits.max_anisotropy);
    fmt::print("   linear filter rg32f        {}\n", yes_no(limits.filters_rg32f));
    fmt::print("   linear filter rg16f        {}\n", yes_no(limits.filters_rg16f));
    fmt::print("   linear filter d32f         {}\n", yes_no(limits.filters_d32f));
    fmt::print("   colour sample counts       {:#x}\n", limits.color_samples);
    fmt::print("   usable                     {}\n", device.unusable.empty() ? "yes" : "no: " + device.unusable);
}

}  // namespace

int main() {
    try {
        gnomon::peer::expose_drivers();
        const auto devices = gnomon::peer::list_devices();
        for (const PeerDevice& device : devices) print(device);
        if (devices.empty()) fmt::print("no Vulkan device\n");
        return 0;
    } catch (const gnomon::Error& error) {
        fmt::print(stderr, "gnomon_peer_info: {}\n", error.what());
        return 2;
    }
}
