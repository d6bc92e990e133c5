// Frames of a moving camera, one after the other, on one device.
#include "studies/sequence.h"

#include "scenes/camera_path.h"
#include "sim/error.h"
#include "traces/hash.h"

#include <chrono>

namespace gnomon::studies {

namespace {

/// Throws Error for what no sequence can be rendered with.
const SequenceRequest& checked(const SequenceRequest& request) {
    if (request.frames < 1 || request.frames > kMaxFrames)
        fail("--frames {}: expected a whole number from 1 to {}", request.frames, kMaxFrames);
    if (request.render.technique == "all") fail("--frames: a sequence is of one technique, not of all of them");
    (void)scenes::find_camera_path(request.path);
    return request;
}

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

Sequence::Sequence(const SequenceRequest& request) : request_(checked(request)), experiment_(request.render) {}

void Sequence::run(const Progress& progress, const std::function<void(const SequenceRow&, const SequencePictures&)>& on_frame) {
    GNOMON_CHECK(rows_.empty());

    // Every command and every tile of a draw is a chance to stop.
    Device device(profile(), request_.render.threads);
    device.set_stop(progress.stop);
    const auto all = static_cast<std::size_t>(request_.frames);
    device.set_observer([&](const Command&) { progress.step("rendering frames", rows_.size(), all); });
    techniques::Frame frame(device, experiment_.scene(),
                            {.width = request_.render.width,
                             .height = request_.render.height,
                             .technique = plan().technique,
                             .settings = plan().settings});

    // One frame that nobody sees warms the caches.
    techniques::PassTimer unseen(device);
    frame.render(unseen);

    const scenes::CameraPath& path = scenes::find_camera_path(request_.path);
    const scenes::Bounds bounds = experiment_.scene().bounds();
    for (int i = 0; i < request_.frames; ++i) {
        frame.set_camera(path.at(experiment_.scene().camera, bounds, static_cast<double>(i) / request_.frames));
        SequencePictures pictures;
        const SequenceRow row = measure_frame(i, frame, device, progress, pictures);
        on_frame(row, pictures);

        // A frame that is stopped before here is none.
        if (pictures.truth) {
            const FloatImage depth = float_image(device.texture(frame.depth()));
            if (!meter_) meter_.emplace(points(frame.camera(), pictures));
            meter_->add({frame.camera(), depth, pictures.visibility, *pictures.truth});
        }
        rows_.push_back(row);
    }
}

SequenceRow Sequence::measure_frame(int index, techniques::Frame& frame, Device& device, const Progress& progress,
                                    SequencePictures& pictures) {
    techniques::PassTimer timer(device);
    frame.render(timer);
    SequenceRow row;
    row.frame = index;
    row.time = static_cast<double>(index) / request_.frames;
    for (const techniques::PassRecord& pass : timer.records())
        (pass.name == "camera" ? row.camera_ms : row.map_ms) += pass.milliseconds;
    row.visibility = traces::xxh3_128_hex(device.texture(frame.visibility()).level_bytes(0));
    pictures.color = color_image(device.texture(frame.color()));
    pictures.visibility = float_image(device.texture(frame.visibility()));
    if (request_.render.truth == Truth::None) return row;

    // The bar of progress shows frames, not the tiles of a truth.
    const auto begin = std::chrono::steady_clock::now();
    pictures.truth = experiment_.trace(frame.camera(), {.report = {}, .stop = progress.stop});
    row.truth_ms = milliseconds_since(begin);
    row.metrics = measure_judged(pictures.visibility, *pictures.truth);
    return row;
}

std::vector<scenes::SurfacePoint> Sequence::points(const scenes::View& camera, const SequencePictures& first) const {
    const int width = first.visibility.width;
    std::vector<glm::ivec2> judged;
    for (const glm::ivec2& pixel : grid_pixels(width, first.visibility.height)) {
        const auto i = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(pixel.x);
        if (is_judged(first.visibility, *first.truth, i)) judged.push_back(pixel);
    }
    std::vector<scenes::SurfacePoint> points;
    for (const auto& point : scenes::trace_points(experiment_.scene(), camera, width, first.visibility.height, judged))
        if (point) points.push_back(*point);
    return points;
}

std::optional<Flicker> Sequence::flicker() const {
    if (!meter_) return std::nullopt;
    const Flicker flicker = meter_->result();
    if (flicker.points == 0) return std::nullopt;
    return flicker;
}

}  // namespace gnomon::studies
