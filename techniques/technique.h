// What a shadow technique is to the rest: a name, its choices, and the passes it runs.
#pragma once

#include "pipeline/device.h"
#include "scenes/view.h"
#include "techniques/pass_timer.h"
#include "techniques/receiver.h"
#include "techniques/scene_resources.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gnomon::techniques {

/// How the shadow map is filtered.
enum class MapFilter { Nearest, Bilinear, Trilinear };

}  // namespace gnomon::techniques

namespace gnomon {
template <>
inline constexpr std::array kEnumNames<techniques::MapFilter>{EnumName{techniques::MapFilter::Nearest, "nearest"},
                                                              EnumName{techniques::MapFilter::Bilinear, "bilinear"},
                                                              EnumName{techniques::MapFilter::Trilinear, "trilinear"}};
}  // namespace gnomon

namespace gnomon::techniques {

/// What a user may choose; what is left open takes the technique's default.
struct TechniqueRequest {
    int map_size = 1024;  // texels per side, 1 to 16384
    std::optional<Format> format{};
    std::optional<MapFilter> filter{};
    std::optional<int> taps{};            // per axis
    std::optional<int> blur{};            // taps per axis of the pre-blur, odd; 1 is none
    std::optional<float> min_variance{};  // of linear depth in [0, 1]
    std::optional<int> depth_bias{};
    std::optional<float> slope_bias{};
};

/// The choices after defaults, all checked.
struct TechniqueSettings {
    int map_size = 1024;
    Format format = Format::D32Float;
    MapFilter filter = MapFilter::Nearest;
    int taps = 1;
    int blur = 1;
    float min_variance = 0.0f;
    int depth_bias = 0;  // rasteriser state of the light pass. D3D11.3 15.10
    float slope_bias = 0.0f;
};

/// The passes of one technique on one device. Created once, run every frame.
class ShadowPasses {
public:
    virtual ~ShadowPasses() = default;

    /// Light pass and whatever follows it until the map is ready to be sampled.
    virtual void render_map(std::span<const SceneDraw> scene, const scenes::View& light, PassTimer& timer) = 0;

    /// The program of the camera pass (a ReceiverVertex and the technique's pixel functor) and its pixel constants for an
    /// object. The span is valid until the next call.
    [[nodiscard]] virtual const Program& receiver_program() const = 0;
    virtual std::span<const std::byte> receiver_constants(const Lighting& lighting) = 0;

    /// The texture that receivers sample.
    [[nodiscard]] virtual TextureId map() const = 0;
};

struct Technique {
    std::string_view name;
    std::string_view summary;            // one line
    std::string_view source;             // paper and section
    std::span<const Format> formats;     // first is the default
    std::span<const MapFilter> filters;  // first is the default
    int default_taps = 1;                // 0: takes no --taps
    int max_taps = 0;
    int max_blur = 0;                   // 0: takes no --blur
    float default_min_variance = 0.0f;  // 0: takes no --min-variance
    int default_depth_bias = 0;
    float default_slope_bias = 0.0f;
    std::unique_ptr<ShadowPasses> (*make)(Device& device, const TechniqueSettings& settings) = nullptr;
};

/// All techniques, in the order of `gnomon list techniques`.
std::span<const Technique> all_techniques();

/// Throws Error that lists the names.
const Technique& find_technique(std::string_view name);

/// Fills in defaults; throws Error that names the option, the technique and what it takes.
TechniqueSettings resolve_settings(const Technique& technique, const TechniqueRequest& request);

/// Throws Error where the map is to be filtered and the profile does not filter its format: what the draw would say, before
/// anything is drawn.
void check_filter(const Profile& profile, const TechniqueSettings& settings);

}  // namespace gnomon::techniques
