// The raw passes of tests/peer/raw_pass.h on Gnomon.
#pragma once

#include "pipeline/device.h"
#include "tests/peer/raw_pass.h"

#include <memory>

namespace gnomon::bench {

/// One pass on a device of its own, ready to run again and again.
class GnomonPass {
public:
    GnomonPass(const peer::RawPass& pass, const Profile& profile, int threads);

    double time_once();  // ms
    peer::RawImage render();
    [[nodiscard]] std::size_t scratch_bytes() const { return device_->scratch_bytes(); }

private:
    void run();

    peer::RawPass pass_;
    std::unique_ptr<Device> device_;
    BufferId vertices_ = BufferId::None;
    BufferId indices_ = BufferId::None;
    TextureId depth_ = TextureId::None;
    TextureId color_ = TextureId::None;
    TextureId resolved_ = TextureId::None;
    TextureId texture_ = TextureId::None;
};

}  // namespace gnomon::bench
