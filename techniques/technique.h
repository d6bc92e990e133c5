// What a shadow technique is to the rest: a name, its choices, and the passes it runs.
#pragma once

#include "pipeline/device.h"
#include "scenes/view.h"
#include "techniques/common/cascades.h"
#include "techniques/common/parameters.h"
#include "techniques/common/pass_timer.h"
#include "techniques/common/receiver.h"
#include "techniques/common/scene_resources.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gnomon::techniques {

/// How the shadow map is filtered.
enum class MapFilter {
    Nearest,
    Bilinear,
    Trilinear,
    ShaderBilinear,  // bilinear, by the shader from four texels: for formats that the texture unit does not filter
};

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::MapFilter>{
    EnumName{techniques::MapFilter::Nearest, "nearest"}, EnumName{techniques::MapFilter::Bilinear, "bilinear"},
    EnumName{techniques::MapFilter::Trilinear, "trilinear"},
    EnumName{techniques::MapFilter::ShaderBilinear, "shader-bilinear"}};
}  // namespace gnomon

namespace gnomon::techniques {

/// What a user may choose; what is left open takes the technique's default.
struct TechniqueRequest {
    int map_size = 1024;  // texels per side, 1 to 16384
    int map_samples = 1;  // per texel of the light pass
    std::optional<Format> format{};
    std::optional<MapFilter> filter{};
    std::optional<int> anisotropy{};  // 1 to 16
    std::optional<int> cascades{};    // maps, one per split of the view frustum; 0: one map of all that the light sees
    std::optional<int> depth_bias{};
    std::optional<float> slope_bias{};
    ParameterTexts set{};
};

/// The choices after defaults, all checked.
struct TechniqueSettings {
    int map_size = 1024;
    int map_samples = 1;
    Format format = Format::D32Float;
    MapFilter filter = MapFilter::Nearest;
    int anisotropy = 1;  // limit of the ratio of a filter's axes
    int cascades = 0;    // 0: one map of all that the light sees
    int depth_bias = 0;  // rasteriser state of the light pass. D3D11.3 15.10
    float slope_bias = 0.0f;
    ParameterValues parameters{};

    /// The rasteriser of the light pass.
    [[nodiscard]] RasterState light_raster() const { return {.depth_bias = depth_bias, .slope_scaled_depth_bias = slope_bias}; }
};

/// What a frame shows, as passes see it.
struct FrameView {
    std::span<const SceneDraw> scene;
    const scenes::View& camera;
    const scenes::View& light;
    int width;  // of the image, pixels
    int height;
};

/// The passes of one technique on one device. Created once, run every frame.
class ShadowPasses {
public:
    virtual ~ShadowPasses() = default;

    /// Light pass and whatever follows it until the maps are ready to be sampled.
    virtual void render_maps(const FrameView& frame, PassTimer& timer) = 0;

    /// The program of the camera pass (a ReceiverVertex and the technique's pixel functor) and its pixel constants for an
    /// object. The span is valid until the next call.
    [[nodiscard]] virtual const Program& receiver_program() const = 0;
    virtual std::span<const std::byte> receiver_constants(const Lighting& lighting) = 0;

    /// The textures that receivers sample, those of one cascade after those of another.
    [[nodiscard]] virtual std::vector<TextureId> maps() const = 0;
    /// Splits and windows of the last render_maps(); null where there is one map.
    [[nodiscard]] virtual const Cascades* cascades() const = 0;
};

struct Technique {
    std::string_view name;
    std::string_view summary;            // one line
    std::string_view source;             // paper and section
    std::span<const Format> formats;     // first is the default
    std::span<const MapFilter> filters;  // first is the default
    std::vector<Parameter> parameters{};
    int default_anisotropy = 1;
    int default_cascades = 0;
    int default_depth_bias = 0;
    float default_slope_bias = 0.0f;
    /// What a parameter comes to once everything else is known, as limits of the format and values that stand for "by format";
    /// reports show what it leaves. Throws Error for parameters that do not go together. Null: nothing.
    void (*settle)(TechniqueSettings& settings) = nullptr;
    std::unique_ptr<ShadowPasses> (*make)(Device& device, const TechniqueSettings& settings) = nullptr;
};

/// Texels per side of every map: one, or one per cascade.
std::vector<int> map_sizes(const TechniqueSettings& settings);

/// The parameters that every technique takes beside its own where it has cascades.
const std::vector<Parameter>& cascade_parameters();

/// All techniques, in the order of `gnomon list techniques`.
std::span<const Technique> all_techniques();

/// Throws Error that lists the names.
const Technique& find_technique(std::string_view name);

/// Fills in defaults for a machine; throws Error that names the option, the technique and what it takes. Where no filter is
/// asked for and the profile does not filter the format, the first filter that it can do is taken, with a warning.
TechniqueSettings resolve_settings(const Technique& technique, const TechniqueRequest& request,
                                   const Profile& profile = Profile{});

/// Bytes per texel of level 0 of what receivers sample: all components of all textures and slices of a technique, over the
/// texels of its maps.
double storage_per_texel(const Device& device, std::span<const TextureId> maps, const TechniqueSettings& settings);
/// The same of a technique that is on no device yet.
double storage_per_texel(const Technique& technique, const TechniqueSettings& settings);

}  // namespace gnomon::techniques
