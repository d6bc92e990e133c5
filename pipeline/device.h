// The simulated GPU as a program sees it: resources and commands.
#pragma once

#include "pipeline/command.h"
#include "pipeline/program.h"
#include "pipeline/resources.h"
#include "pipeline/traffic.h"
#include "sim/parallel.h"
#include "sim/profile.h"

#include <atomic>
#include <functional>
#include <memory>
#include <vector>

namespace gnomon {

struct DrawScratch;  // draw.h

class Device {
public:
    /// `threads` = 0: as many as there are processors; up to kMaxThreads. The results do not depend on it. Throws Error for a
    /// profile or a number of threads that is out of range.
    explicit Device(Profile profile, int threads = 0);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    [[nodiscard]] const Profile& profile() const { return profile_; }
    [[nodiscard]] Workers& workers() { return workers_; }

    /// Does what the command says. Throws Error for anything out of range; the device is unchanged then.
    ///
    /// A few things only a functor's calls decide. They throw Error, too, but from the middle of the draw or dispatch, and what
    /// was written until then stays: a texture that the profile cannot filter sampled with a sampler that filters, where the
    /// constants leave open which sampler meets which texture; integers compared; codes loaded of a format that is not of
    /// unsigned integers; a cube texture sampled at 2D coordinates; an offset outside -8 to 7 or a gather of a component other
    /// than 0 to 3; a resource that is none of the constants and does not exist; more group-shared memory than there is; blocks
    /// of threads inside one another.
    void execute(const Command& command);
    /// Called with every command that executed; one that the device refused is not seen.
    void set_observer(std::function<void(const Command&)> observer) { observer_ = std::move(observer); }

    /// Shorthands that pick the next id.
    BufferId create_buffer(std::string_view label, std::span<const std::byte> data);
    BufferId create_zeroed_buffer(std::string_view label, std::size_t bytes);
    TextureId create_texture(std::string_view label, const TextureDesc& desc);

    /// Throws Error for an id that was never created.
    [[nodiscard]] const Texture& texture(TextureId id) const { return resources_.texture(id); }
    [[nodiscard]] const Buffer& buffer(BufferId id) const { return resources_.buffer(id); }

    /// Where `stop` becomes true, the draw under way ends at the next tile and execute() throws Stopped; targets are unfinished
    /// then.
    void set_stop(const std::atomic<bool>* stop) { stop_ = stop; }

    /// Counting is off until asked for. Counts add up over commands until taken.
    void enable_counters(bool enabled) { counting_ = enabled; }
    Counters take_counters() { return take_tally().counters; }
    Tally take_tally() { return std::exchange(tally_, {}); }
    /// The bytes of every resource that a tally names, textures first, in the order of creation.
    [[nodiscard]] std::vector<ResourceTraffic> traffic(const Tally& tally) const;

    /// Bytes that draws hold on to between calls, for reports: a bounded number of vertices, primitives and bins; nothing per
    /// pixel or sample. docs/architecture.md (Memory)
    [[nodiscard]] std::size_t scratch_bytes() const;
    /// Off until asked for, for it is slow: every access of a dispatch is checked against those of all its other threads, and
    /// execute() throws Error at the first two whose order would show in the result. What ran until then stays.
    void set_race_check(bool enabled) { checks_races_ = enabled; }

private:
    void run(const CreateBuffer& command);
    void run(const CreateTexture& command);
    void run(const WriteTexture& command);
    void run(const ClearColor& command);
    void run(const ClearDepth& command);
    void run(const ClearStencil& command);
    void run(const GenerateMips& command);
    void run(const Resolve& command);
    void run(const Draw& command);
    void count_fill(const TargetView& view, const Texture& texture, std::uint64_t bytes);
    void run(const WriteBuffer& command);
    void run(const Dispatch& command);

    Profile profile_;
    Workers workers_;
    Resources resources_;
    std::function<void(const Command&)> observer_;
    std::unique_ptr<DrawScratch> scratch_;
    const std::atomic<bool>* stop_ = nullptr;
    bool counting_ = false;
    Tally tally_;
    bool checks_races_ = false;
};

}  // namespace gnomon
