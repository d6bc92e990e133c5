// Prints one line `name hash` for everything whose bytes must not depend on threads, SIMD width, instruction set or compiler.
// gnomon_fingerprint [THREADS]
#include "pipeline/parallel_primitives.h"
#include "scenes/procedural.h"
#include "sim/fixed.h"
#include "sim/half.h"
#include "sim/math.h"
#include "sim/parallel.h"
#include "techniques/frame.h"
#include "tests/determinism/fuzz_draws.h"
#include "texunit/mipmap.h"
#include "texunit/record.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <cstdlib>
#include <vector>

using namespace gnomon;

namespace {

void print_hash(const std::string& name, const void* data, std::size_t size) {
    const XXH128_hash_t hash = XXH3_128bits(data, size);
    fmt::print("{} {:016x}{:016x}\n", name, hash.high64, hash.low64);
}

/// One function over 2^20 floats, 4099 representable numbers apart.
template <class Function>
void fingerprint_function(const std::string& name, const Function& function) {
    std::vector<std::int32_t> results;
    for (std::uint32_t n = 0; n < 1u << 20; n += kLanes) {
        std::array<std::int32_t, kLanes> in;
        for (std::uint32_t i = 0; i < kLanes; ++i) in[i] = static_cast<std::int32_t>((n + i) * 4099u);
        const Float out = function(float_of_bits(Int::load(in.data())));
        // Which NaN an operation makes is the processor's choice.
        const auto bits = select(is_nan(out), Int(0x7fc00000), bits_of(out)).lanes();
        results.insert(results.end(), bits.begin(), bits.end());
    }
    print_hash(name, results.data(), results.size() * sizeof(std::int32_t));
}

void fingerprint_frame(const scenes::Scene& scene, std::string_view technique, const techniques::TechniqueRequest& request,
                       const std::string& profile, int threads) {
    Device device(load_profile(profile), threads);
    device.enable_counters(true);
    techniques::FrameDesc desc{.width = 317, .height = 203, .technique = techniques::find_technique(technique)};
    desc.settings = techniques::resolve_settings(desc.technique, request, device.profile());
    techniques::Frame frame(device, scene, desc);
    techniques::PassTimer timer(device);
    frame.render(timer);

    std::string set;
    for (const auto& [key, value] : request.set) set += fmt::format("/{}={}", key, value);
    if (request.cascades) set += fmt::format("/{} splits", *request.cascades);
    const std::string name =
        fmt::format("{}/{}/{}/{}/x{}/aniso{}{}/{}", scene.name, technique, name_of(desc.settings.format),
                    name_of(desc.settings.filter), desc.settings.map_samples, desc.settings.anisotropy, set, profile);
    std::vector<std::pair<std::string, TextureId>> parts{
        {"color", frame.color()}, {"visibility", frame.visibility()}, {"depth", frame.depth()}};
    const std::vector<TextureId> maps = frame.maps();
    for (std::size_t i = 0; i < maps.size(); ++i) parts.emplace_back(i == 0 ? "map" : fmt::format("map {}", i), maps[i]);
    for (const auto& [part, id] : parts) {
        const Texture& texture = device.texture(id);
        std::vector<std::byte> bytes;
        for (int level = 0; level < texture.desc().levels; ++level) {
            const auto more = texture.level_bytes(level);
            bytes.insert(bytes.end(), more.begin(), more.end());
        }
        print_hash(name + "/" + part, bytes.data(), bytes.size());
    }
    Counters total;
    for (const auto& record : timer.records()) total += record.counters;
    std::string counts;
    for_each_field(total, [&](std::string_view, std::uint64_t count) { counts += fmt::format(" {}", count); });
    fmt::print("{}/counters{}\n", name, counts);
}

/// Numbers that follow from a seed alone.
class Sequence {
public:
    explicit Sequence(std::uint32_t seed) : state_(seed) {}
    std::uint32_t next() {
        state_ = state_ * 1664525u + 1013904223u;
        return state_ ^ state_ >> 15;
    }
    /// Mostly near 0, now and then far away, tiny, infinite or not a number.
    double coordinate() {
        const std::uint32_t kind = next() % 16;
        const double unit = static_cast<double>(next()) * 0x1p-32;
        if (kind == 0) return static_cast<double>(std::bit_cast<float>(next()));
        return (unit - 0.5) * (kind < 8 ? 2.5 : kind < 14 ? 0.2 : 40.0);
    }

private:
    std::uint32_t state_;
};

/// Every format through one filter of one profile: raw codes, the profile's own mips, hostile coordinates and gradients.
void fingerprint_samples(const Profile& profile, std::string_view filter, const Sampler& sampler) {
    Sequence sequence(77);
    std::vector<double> results;
    for (const FormatInfo& format : kFormats) {
        const bool compares = filter == "compare";
        if (format.is_integer() && filter != "nearest") continue;
        Texture texture({.format = format.format, .width = 13, .height = 8, .levels = format.is_integer() ? 1 : 4});
        std::vector<std::byte> codes(13 * 8 * static_cast<std::size_t>(format.bytes_per_texel));
        for (std::byte& code : codes) code = static_cast<std::byte>(sequence.next());
        if (format.is_depth)
            for (std::size_t i = 3; i < codes.size(); i += 4)
                codes[i] = static_cast<std::byte>(format.format == Format::D32Float ? 0x3e : 0);
        texture.set_level_bytes(0, codes.data(), codes.size());
        Workers workers(1);
        if (!format.is_integer()) generate_mips(texture, profile, workers);
        std::vector<SampleRequest> requests;
        for (int i = 0; i < 512; ++i) {
            SampleRequest request;
            for (double& c : request.coordinate) c = sequence.coordinate();
            request.gradient.emplace();
            for (auto* vector : {&request.gradient->dx, &request.gradient->dy})
                for (double& c : *vector) c = sequence.coordinate();
            if (compares) request.reference = sequence.coordinate();
            requests.push_back(request);
        }
        for (const SampleResult& result : sample_all(texture, sampler, profile, requests)) {
            // Which NaN an operation makes is the processor's choice.
            const auto keep = [&](double x) { results.push_back(x == x ? x : 2e300); };
            keep(result.lod);
            for (const double c : result.color) keep(c);
        }
    }
    print_hash(fmt::format("sample/{}/{}", profile.name, filter), results.data(), results.size() * sizeof(double));
}

/// Every data-parallel primitive over floats and integers of several tiles.
void fingerprint_primitives(const std::string& profile, int threads) {
    Sequence sequence(5);
    constexpr int kCount = 30'001;
    std::vector<float> numbers(kCount);
    std::vector<std::uint32_t> words(kCount);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        words[i] = sequence.next();
        numbers[i] = static_cast<float>(words[i] >> 8) * 0x1p-20f - 8.0f;
    }
    Device device(load_profile(profile), threads);
    device.enable_counters(true);
    ParallelPrimitives primitives(device);
    const BufferId floats = device.create_buffer("floats", std::as_bytes(std::span(numbers)));
    const BufferId integers = device.create_buffer("integers", std::as_bytes(std::span(words)));
    const BufferId to = device.create_zeroed_buffer("to", kCount * 4);
    const auto print = [&](std::string_view what, BufferId id) {
        print_hash(fmt::format("primitive/{}/{}", profile, what), device.buffer(id).data.data(), device.buffer(id).data.size());
    };

    std::vector<float> results;
    for (const CombineOp op : {CombineOp::Sum, CombineOp::Min, CombineOp::Max}) {
        results.push_back(primitives.reduce<float>(floats, kCount, op));
        results.push_back(static_cast<float>(primitives.reduce<std::int32_t>(integers, kCount, op)));
        primitives.inclusive_scan<float>(floats, to, kCount, op);
        print("inclusive-scan", to);
        primitives.exclusive_scan<std::uint32_t>(integers, to, kCount, op);
        print("exclusive-scan", to);
    }
    print_hash("primitive/" + profile + "/reduce", results.data(), results.size() * sizeof(float));
    primitives.radix_sort<float>(floats, integers, kCount);
    print("sorted-keys", floats);
    print("sorted-values", integers);
    fmt::print("primitive/{}/compacted {}\n", profile, primitives.compact(integers, floats, to, kCount));
    fmt::print("primitive/{}/unique {}\n", profile, primitives.unique(floats, to, kCount));
    print("unique", to);
    std::string counts;
    for_each_field(device.take_counters(), [&](std::string_view, std::uint64_t count) { counts += fmt::format(" {}", count); });
    fmt::print("primitive/{}/counters{}\n", profile, counts);
}

/// Random draws with random state, five streams to a line.
void fingerprint_fuzz(const std::string& profile, std::uint64_t streams, int threads) {
    constexpr std::uint64_t kPerLine = 5;
    for (std::uint64_t first = 0; first < streams; first += kPerLine) {
        std::vector<std::byte> bytes;
        Counters total;
        for (std::uint64_t seed = first; seed < first + kPerLine; ++seed) {
            const auto result = testing::run_fuzz_stream(load_profile(profile), seed, {.threads = threads});
            bytes.insert(bytes.end(), result.bytes.begin(), result.bytes.end());
            total += result.counters;
        }
        print_hash(fmt::format("fuzz/{}/{}", profile, first), bytes.data(), bytes.size());
        std::string counts;
        for_each_field(total, [&](std::string_view, std::uint64_t count) { counts += fmt::format(" {}", count); });
        fmt::print("fuzz/{}/{}/counters{}\n", profile, first, counts);
    }
}

/// Every format and filter of a technique, every word of its parameters, a blur, several samples, probes along the footprint,
/// double arithmetic and drivers.
void fingerprint_choices(const scenes::Scene& scene, const techniques::Technique& technique, int threads) {
    const auto frame = [&](techniques::TechniqueRequest request, const std::string& profile) {
        request.map_size = 190;
        fingerprint_frame(scene, technique.name, request, profile, threads);
    };
    for (const Format format : technique.formats)
        for (const techniques::MapFilter filter : technique.filters) frame({.format = format, .filter = filter}, "d3d11");
    for (const techniques::Parameter& parameter : technique.parameters) {
        if (parameter.name == "blur") frame({.set = {{"blur", "5"}}}, "d3d11");
        for (std::size_t word = 0; word < parameter.words.size(); ++word)
            if (static_cast<double>(word) != parameter.standard)
                frame({.set = {{std::string(parameter.name), std::string(parameter.words[word])}}}, "d3d11");
    }
    frame({.map_samples = 4}, "d3d11");
    frame({.anisotropy = 16}, "d3d11");
    for (const char* profile : {"ideal", "llvmpipe", "swiftshader", "nv40"}) frame({}, profile);
}

}  // namespace

/// Several maps: every cure, every way to place splits and windows, and every technique.
void fingerprint_splits(const scenes::Scene& scene, int threads) {
    const auto add = [&](std::string_view technique, int cascades, const techniques::ParameterTexts& set, const char* profile) {
        fingerprint_frame(scene, technique, {.map_size = 101, .cascades = cascades, .set = set}, profile, threads);
    };
    for (const auto& cure : kEnumNames<techniques::SeamCure>)
        for (const char* profile : {"d3d11", "g80", "ideal"}) add("psvsm", 8, {{"cure", std::string(cure.name)}}, profile);
    for (int cascades = 1; cascades <= 7; ++cascades) add("psvsm", cascades, {{"blur", "3"}, {"fade", "0.2"}}, "d3d11");
    for (const char* placement : {"minmax", "histogram"})
        for (const char* profile : {"d3d11", "ideal"}) add("psvsm", 4, {{"splits", placement}}, profile);
    add("psvsm", 4, {{"snap", "on"}, {"blur", "3"}}, "d3d11");
    add("pssm", 3, {{"size-ratio", "1.5"}, {"reach", "20"}}, "d3d11");
    for (const techniques::Technique& technique : techniques::all_techniques())
        add(technique.name, 3, {{"cure", "explicit-gradients"}}, "d3d11");
}

int main(int argc, char** argv) {
    const int threads = argc > 1 ? std::atoi(argv[1]) : 0;
    fingerprint_function("exp2", [](Float x) { return exp2(x); });
    fingerprint_function("log2", [](Float x) { return log2(x); });
    fingerprint_function("rcp", [](Float x) { return rcp(x); });
    fingerprint_function("rsqrt", [](Float x) { return rsqrt(x); });

    fingerprint_function("floor", [](Float x) { return floor(x); });
    fingerprint_function("round", [](Float x) { return round(x); });
    fingerprint_function("half", [](Float x) { return float_from_half_bits(half_bits_from_float(x, Narrowing::NearestEven)); });
    fingerprint_function("unorm24", [](Float x) { return Float(unorm_from_float(x, 24)); });

    for (const Profile& profile : profile_presets()) {
        const auto wrap = AddressMode::Wrap;
        const auto mirror = AddressMode::Mirror;
        fingerprint_samples(profile, "nearest",
                            {.min = TexelFilter::Nearest, .mag = TexelFilter::Nearest, .mip = MipFilter::Nearest});
        fingerprint_samples(profile, "bilinear", {.address_u = wrap, .address_v = AddressMode::Border});
        fingerprint_samples(profile, "trilinear", {.mip = MipFilter::Linear, .address_u = mirror, .address_v = wrap});
        fingerprint_samples(profile, "anisotropic",
                            {.mip = MipFilter::Linear, .address_u = wrap, .address_v = mirror, .max_anisotropy = 16});
        fingerprint_samples(profile, "compare", {.mip = MipFilter::Linear, .address_u = AddressMode::MirrorOnce});
    }

    for (const char* profile : {"d3d11", "ideal"}) fingerprint_primitives(profile, threads);
    static_assert(50 * testing::kDrawsPerStream >= 500);
    fingerprint_fuzz("d3d11", 50, threads);
    fingerprint_fuzz("ideal", 10, threads);

    for (const scenes::ProceduralScene& source : scenes::procedural_scenes()) {
        const scenes::Scene scene = source.make();
        if (source.name == "fence" || source.name == "car") fingerprint_splits(scene, threads);
        for (const techniques::Technique& technique : techniques::all_techniques()) {
            fingerprint_frame(scene, technique.name, {.map_size = 251}, "d3d11", threads);
            if (source.name == "car") fingerprint_choices(scene, technique, threads);
        }
    }
    return 0;
}
