// SamplingPeer: checks, dispatches in pieces, timing.
#include "tests/agree/sampling.h"

#include "sim/error.h"
#include "tests/agree/kernels.h"

#include <algorithm>
#include <bit>
#include <chrono>

namespace gnomon::agree {
namespace {

// Points of one dispatch: 16,384 groups and 32 MiB, within what every device allows. Vulkan 1.3 table "Required Limits"
constexpr std::size_t kMaxPoints = std::size_t{1} << 20;
static_assert(SamplingPeer::kMaxTimedPoints <= kMaxPoints);

double run_ns(const Dispatch& dispatch) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    dispatch.run();
    return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

}  // namespace

std::size_t texel_bytes(TexelFormat format) { return format == TexelFormat::Rg32f ? 8 : 4; }

int level_size(int size, int level) { return std::max(1, size >> level); }

int full_levels(int width, int height) {
    return static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(width, height))));
}

std::vector<Point> as_quads(std::span<const Point> points) {
    std::vector<Point> quads;
    for (const Point& point : points)
        for (int corner = 0; corner < 4; ++corner) {
            Point moved = point;
            if ((corner & 1) != 0) moved.u += point.dudx, moved.v += point.dvdx;
            if ((corner & 2) != 0) moved.u += point.dudy, moved.v += point.dvdy;
            quads.push_back(moved);
        }
    return quads;
}

struct SamplingPeer::Machine {
    peer::Device device;
    Kernels kernels;

    Machine(const peer::PeerDevice& description, const peer::PeerOptions& options)
        : device(description, options), kernels(device) {}

    // The texture on the device, or an Error.
    Texture prepare(const Levels& texture, const SamplerState& sampler) const {
        check_levels(texture);
        check_sampler(sampler);
        const std::string reason = agree::unsupported_because(device, texture, sampler);
        if (!reason.empty()) fail("device '{}': {}", device.description().name, reason);
        return make_texture(device, texture, sampler);
    }
};

SamplingPeer::SamplingPeer(const peer::PeerDevice& device, const peer::PeerOptions& options)
    : machine_(std::make_unique<Machine>(device, options)) {}
SamplingPeer::~SamplingPeer() = default;
SamplingPeer::SamplingPeer(SamplingPeer&&) noexcept = default;
SamplingPeer& SamplingPeer::operator=(SamplingPeer&&) noexcept = default;

const peer::PeerDevice& SamplingPeer::description() const { return machine_->device.description(); }
bool SamplingPeer::validates() const { return machine_->device.instance().validates(); }
std::vector<std::string> SamplingPeer::validation_messages() const { return machine_->device.instance().messages(); }

std::string SamplingPeer::unsupported_because(const Levels& texture, const SamplerState& sampler) const {
    return agree::unsupported_because(machine_->device, texture, sampler);
}

bool SamplingPeer::supports(const Levels& texture, const SamplerState& sampler) const {
    return unsupported_because(texture, sampler).empty();
}

std::vector<Sample> SamplingPeer::sample(const Levels& texture, const SamplerState& sampler, Instruction instruction,
                                         std::span<const Point> points) {
    const Texture prepared = machine_->prepare(texture, sampler);
    const Kernel kernel = sampling_kernel(instruction, sampler.compare != Compare::None);
    const VkPipeline pipeline = machine_->kernels.pipeline(kernel, Purpose::Samples);
    std::vector<Sample> samples;
    while (!points.empty()) {
        const std::span<const Point> piece = points.first(std::min(points.size(), kMaxPoints));
        const Dispatch dispatch(machine_->kernels, pipeline, prepared, piece);
        dispatch.run();
        const std::vector<Sample> of_piece = dispatch.samples();
        samples.insert(samples.end(), of_piece.begin(), of_piece.end());
        points = points.subspan(piece.size());
    }
    return samples;
}

SampleTiming SamplingPeer::time_samples(const Levels& texture, const SamplerState& sampler, Instruction instruction,
                                        std::span<const Point> points, int repeats) {
    if (points.empty() || points.size() > kMaxTimedPoints)
        fail("{} points to time; expected 1 to {}", points.size(), kMaxTimedPoints);
    if (repeats < 1) fail("{} repeats; expected at least one", repeats);
    const Texture prepared = machine_->prepare(texture, sampler);
    const Kernel kernel = sampling_kernel(instruction, sampler.compare != Compare::None);
    Kernels& kernels = machine_->kernels;
    const Dispatch sampling(kernels, kernels.pipeline(kernel, Purpose::Timed), prepared, points);
    const Dispatch reading(kernels, kernels.pipeline(Kernel::Read, Purpose::Timed), prepared, points);

    // Drivers compile at the first run.
    sampling.run();
    reading.run();
    SampleTiming timing;
    std::vector<double> differences_ns;
    for (int i = 0; i < repeats; ++i) {
        timing.sampling_ns.push_back(run_ns(sampling));
        timing.reading_ns.push_back(run_ns(reading));
        differences_ns.push_back(timing.sampling_ns.back() - timing.reading_ns.back());
    }
    timing.ns_per_sample = median(std::move(differences_ns)) / static_cast<double>(points.size());
    return timing;
}

double SamplingPeer::nanoseconds_per_sample(const Levels& texture, const SamplerState& sampler, Instruction instruction,
                                            std::span<const Point> points, int repeats) {
    return time_samples(texture, sampler, instruction, points, repeats).ns_per_sample;
}

}  // namespace gnomon::agree
