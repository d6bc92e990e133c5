#include "traces/json_values.h"

#include <bit>
#include <charconv>
#include <cmath>

namespace gnomon::traces {

namespace {

template <int kCount, class Vector>
Json array_of(const Vector& vector) {
    Json json = Json::array();
    for (int i = 0; i < kCount; ++i) json.push_back(json_of(vector[i]));
    return json;
}

}  // namespace

Json json_of(float value) {
    if (std::isnan(value)) return fmt::format("nan:{:08x}", std::bit_cast<std::uint32_t>(value));
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    // The double next to the shortest decimal of the float prints as that same decimal.
    const std::string shortest = fmt::format("{}", value);
    double widened = 0;
    std::from_chars(shortest.data(), shortest.data() + shortest.size(), widened);
    return widened;
}

Json json_of(const glm::vec2& value) { return array_of<2>(value); }
Json json_of(const glm::vec3& value) { return array_of<3>(value); }
Json json_of(const glm::vec4& value) { return array_of<4>(value); }
Json json_of(const glm::mat4& value) { return array_of<4>(value); }

Json json_of(const ConstantValue& value) {
    struct Visitor {
        Json operator()(TextureId id) const { return {{"texture", static_cast<std::uint32_t>(id)}}; }
        Json operator()(const TextureLevels& v) const {
            return {{"texture", static_cast<std::uint32_t>(v.texture)}, {"first_level", v.first_level}, {"levels", v.levels}};
        }
        Json operator()(const MultisampledTexture& v) const { return {{"texture", static_cast<std::uint32_t>(v.texture)}}; }
        Json operator()(BufferId id) const { return {{"buffer", static_cast<std::uint32_t>(id)}}; }
        Json operator()(const std::vector<float>& values) const {
            Json json = Json::array();
            for (const float v : values) json.push_back(json_of(v));
            return json;
        }
        Json operator()(float v) const { return json_of(v); }
        Json operator()(int v) const { return v; }
        Json operator()(const glm::vec2& v) const { return json_of(v); }
        Json operator()(const glm::vec3& v) const { return json_of(v); }
        Json operator()(const glm::vec4& v) const { return json_of(v); }
        Json operator()(const glm::mat4& v) const { return json_of(v); }
        Json operator()(const Sampler& v) const { return json_of(v); }
    };
    return std::visit(Visitor{}, value);
}

std::string to_line(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace gnomon::traces
