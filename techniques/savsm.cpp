// Passes and parameters of summed-area variance shadow maps. [Lauritzen07] 8.5
#include "techniques/savsm.h"

#include "pipeline/program.h"

#include <algorithm>

namespace gnomon::techniques {

namespace {

constexpr std::array kFormats{Format::Rgba32Float, Format::Rg32Float, Format::Rg32Uint};
constexpr std::array kFilters{MapFilter::Nearest};

std::vector<Parameter> parameters() {
    return filtered_map_parameters() +
           std::vector{word("centre", DepthCentre::Half, "what depths are stored relative to: 1/2, or 0"),
                       number("min-width", 1, 1, 4096, "least side of the rectangle that is averaged, texels"),
                       number("min-variance", 1e-5, 0, 1, "least variance of depth, which is in [0, 1]")} +
           bleed_parameters() +
           std::vector{whole("split-bits", 0, 0, 23, "bits of rgba32f's coarse parts; 0: as many as add up exactly"),
                       whole("fraction-bits", 0, 0, 24,
                             "bits of rg32ui's fractions; 0: as many as never overflow, more limit the rectangle")};
}

/// The table that a user asks for.
TableDesc table_desc(const TechniqueSettings& settings) {
    return {.format = settings.format,
            .width = settings.map_size,
            .height = settings.map_size,
            .centred = settings.parameters.word<DepthCentre>("centre") == DepthCentre::Half,
            .split_bits = settings.parameters.whole("split-bits"),
            .fraction_bits = settings.parameters.whole("fraction-bits")};
}

/// Moments are rendered, resolved and blurred as floats, whatever the table is made of.
TechniqueSettings map_settings(TechniqueSettings settings) {
    settings.format = Format::Rg32Float;
    return settings;
}

SavsmReceiver make_receiver(const TechniqueSettings& settings, const SummedAreaTable& table) {
    const ParameterValues& chosen = settings.parameters;
    const TableDesc desc = table_desc(settings);
    const float most = largest_side(desc);
    return {.table = table.lookup(),
            .moments = {.centre = desc.centred ? 0.5f : 0.0f},
            .anisotropy = static_cast<float>(settings.anisotropy),
            .least_side = std::min(chosen.number("min-width"), most),
            .most_side = most,
            .min_variance = chosen.number("min-variance"),
            .bleed = bleed_reduction(chosen)};
}

/// The bits that "0" stands for; those of another table stay 0.
void settle(TechniqueSettings& settings) {
    const TableDesc desc = table_desc(settings);
    if (settings.format == Format::Rgba32Float && desc.split_bits == 0)
        settings.parameters.settle("split-bits", exact_split_bits(desc));
    if (settings.format == Format::Rg32Uint && desc.fraction_bits == 0)
        settings.parameters.settle("fraction-bits", exact_fraction_bits(desc));
}

class SavsmPasses final : public MapPasses<SavsmReceiver> {
public:
    SavsmPasses(Device& device, const TechniqueSettings& settings)
        : map_(device, map_settings(settings)),
          table_(device, table_desc(settings)),
          metric_(settings.parameters.word<DepthMetric>("depth")),
          receiver_(make_receiver(settings, table_)) {}

    void render(std::span<const SceneDraw> scene, const MapView& view, PassTimer& timer) override {
        static const CasterPrograms casters = make_caster_programs<CentredMoments>("savsm.cast", "savsm.cast-distance");
        receiver_.scale = make_depth_scale(metric_, view.light);
        EncodedLightPass<CentredMoments>{casters, receiver_.scale, receiver_.moments}.render(map_, scene, view, timer);
        map_.filter(view, timer);
        timer.pass("table", [&] { table_.build(map_.id()); });
    }
    [[nodiscard]] const SavsmReceiver& receiver() const override { return receiver_; }
    [[nodiscard]] std::vector<TextureId> maps() const override { return {table_.id()}; }

private:
    FilteredMap map_;
    SummedAreaTable table_;
    DepthMetric metric_;
    SavsmReceiver receiver_;
};

std::unique_ptr<ShadowPasses> make(Device& device, const TechniqueSettings& settings) {
    static const ReceiverPrograms programs = make_receiver_programs<SavsmReceiver>("savsm.receive", "savsm.receive-cascades");
    return make_shadow_passes<SavsmReceiver>(device, settings, programs, [&](const TechniqueSettings& of_map) {
        return std::make_unique<SavsmPasses>(device, of_map);
    });
}

}  // namespace

const Technique kSavsm{.name = "savsm",
                       .summary = "variance shadow maps over summed-area tables; rgba32f splits sums in two, rg32ui is exact",
                       .source = "[Lauritzen07] 8.5, [Crow84]",
                       .formats = kFormats,
                       .filters = kFilters,
                       .parameters = parameters(),
                       .default_anisotropy = 16,
                       .settle = settle,
                       .make = make};

}  // namespace gnomon::techniques
