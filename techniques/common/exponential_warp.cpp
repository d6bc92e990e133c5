// Limits of exponents by format. [Lauritzen08] 4.2
#include "techniques/common/exponential_warp.h"

#include "sim/scalar_math.h"
#include "sim/warn.h"

#include <limits>

namespace gnomon::techniques {

double largest_of(const FormatInfo& format) {
    GNOMON_CHECK(format.type == ComponentType::Float16 || format.type == ComponentType::Float32);
    return format.type == ComponentType::Float16 ? 65504.0 : static_cast<double>(std::numeric_limits<float>::max());
}

double exponent_limit(const FormatInfo& format, int power, int samples) {
    const int summands = format.type == ComponentType::Float32 ? samples : 1;  // fp32 holds the sums of smaller formats
    return scalar::log(largest_of(format) / summands) / power - 1e-4;
}

Parameter clamp_parameter() { return word("clamp", Switch::On, "hold exponents at what the format can store"); }

void settle_exponent(TechniqueSettings& settings, std::string_view name, int power) {
    ParameterValues& parameters = settings.parameters;
    const FormatInfo& format = format_info(settings.format);
    const auto wanted = static_cast<double>(parameters.number(name));
    const double limit = exponent_limit(format, power, settings.map_samples);
    const bool clamps = parameters.word<Switch>("clamp") == Switch::On;
    if (wanted <= limit) return;
    if (parameters.is_set(name))
        warn_once(fmt::format("{}={:g}: {} holds up to {:.4f}{}", name, wanted, format.name, limit,
                              clamps ? "; that is taken" : "; larger values saturate or become infinite"));
    if (clamps) parameters.settle(name, limit);
}

ExponentialWarp positive_warp(float c) {
    return {.exponent2 = static_cast<float>(static_cast<double>(c) * scalar::kLog2E), .sign = 1.0f};
}
ExponentialWarp negative_warp(float c) {
    return {.exponent2 = static_cast<float>(static_cast<double>(c) * scalar::kLog2E), .sign = -1.0f};
}

}  // namespace gnomon::techniques
