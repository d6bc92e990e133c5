// The technique that docs/new_technique.md writes: the page quotes this file to the letter (check_quotes.cmake).
#include "pipeline/program.h"
#include "scenes/procedural.h"
#include "techniques/common/depth_map.h"
#include "techniques/frame.h"

#include <catch2/catch.hpp>

#include <cstring>

using namespace gnomon;
using namespace gnomon::techniques;

namespace {

// Shadows whose edges fade over a range of depth: a comparison that is not a step.
template <class Real>
Real soft_comparison(const Real& stored, const Real& depth, const Real& softness) {
    return saturate((stored - depth) / softness + Real(1.0f));
}

struct SoftDepthReceiver {
    TextureId map = TextureId::None;
    Sampler sampler{.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest};
    float softness = 0.01f;  // projective depth

    static constexpr auto fields() {
        using R = SoftDepthReceiver;
        return std::tuple{Field{"map", &R::map}, Field{"sampler", &R::sampler}, Field{"softness", &R::softness}};
    }

    template <class F, class At, class Real = typename F::Real>
    Real visibility(const F& f, const At& at) const {
        const Real stored = sample_at(f, map, sampler, at, at.uv).x;
        return soft_comparison(stored, at.depth, Real(softness));
    }
};

constexpr std::array kFormats{Format::D32Float, Format::D16};
constexpr std::array kFilters{MapFilter::Nearest};

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    static const ReceiverPrograms programs =
        make_receiver_programs<SoftDepthReceiver>("soft-depth.receive", "soft-depth.receive-cascades");
    const SoftDepthReceiver receiver{.softness = settings.parameters.number("softness")};
    return make_depth_map_passes(device, settings, programs, receiver);
}

const Technique kSoftDepth{
    .name = "soft-depth",
    .summary = "one nearest texel, compared with a ramp instead of a step",
    .source = "docs/new_technique.md",
    .formats = kFormats,
    .filters = kFilters,
    .parameters = depth_map_parameters() + std::vector{number("softness", 0.01, 1e-6, 1, "depth over which a shadow fades in")},
    .default_slope_bias = 2.0f,
    .make = make};

}  // namespace

TEST_CASE("the technique of docs/new_technique.md draws", "[techniques][documentation]") {
    const scenes::Scene scene = scenes::procedural_scenes()[1].make();
    const auto mean_visibility = [&](const char* softness) {
        Device device(Profile{}, 2);
        const TechniqueRequest request{.map_size = 256, .set = {{"softness", softness}}};
        Frame frame(device, scene,
                    {.width = 160, .height = 120, .technique = kSoftDepth, .settings = resolve_settings(kSoftDepth, request)});
        PassTimer timer(device);
        frame.render(timer);
        const auto bytes = device.texture(frame.visibility()).level_bytes(0);
        std::vector<float> values(bytes.size() / sizeof(float));
        std::memcpy(values.data(), bytes.data(), bytes.size());
        double sum = 0;
        int pixels = 0;
        for (const float value : values) {
            if (value == Frame::kNoSurface) continue;
            REQUIRE((value >= 0.0f && value <= 1.0f));
            sum += static_cast<double>(value);
            ++pixels;
        }
        return sum / pixels;
    };
    const double hard = mean_visibility("1e-6");
    const double soft = mean_visibility("0.02");
    CHECK(hard > 0.5);
    CHECK(soft > hard);  // a ramp begins behind the occluder
    CHECK(soft < 1.0);
}
