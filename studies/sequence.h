// A moving camera: a sequence of frames, each measured against the truth of its own, and how steady shadows are over all of
// them. `gnomon render --frames`
#pragma once

#include "studies/experiment.h"
#include "studies/flicker.h"
#include "studies/output_folder.h"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gnomon::studies {

inline constexpr int kMaxFrames = 10000;  // names of files have four digits

struct SequenceRequest {
    RenderRequest render;       // of one technique
    int frames = 1;             // 1 to kMaxFrames
    std::string path = "walk";  // of the camera, by name (scenes/camera_path.h)
};

/// One frame as a row of the table.
struct SequenceRow {
    int frame = 0;                   // from 0
    double time = 0;                 // frame / frames
    std::optional<Metrics> metrics;  // none without truth, or when no pixel could be judged
    double map_ms = 0;               // every pass but the camera's: once, on this machine
    double camera_ms = 0;
    double truth_ms = 0;
    std::string visibility;  // xxh3-128 of the raw bytes
};

/// What a frame shows.
struct SequencePictures {
    ByteImage color;
    FloatImage visibility;  // techniques::Frame::kNoSurface where nothing was drawn
    std::optional<scenes::ReferenceImage> truth;
};

class Sequence {
public:
    /// Loads scene and profile and settles every choice. Throws Error as Experiment does, and for more than one technique, an
    /// unknown path, a number of frames out of range.
    explicit Sequence(const SequenceRequest& request);

    /// Renders and measures frame after frame. `on_frame` sees each as soon as it is there; when it throws, its frame does not
    /// count among rows(). Throws Error, and Stopped through `progress`. Once.
    void run(const Progress& progress, const std::function<void(const SequenceRow&, const SequencePictures&)>& on_frame);

    [[nodiscard]] const SequenceRequest& request() const { return request_; }
    [[nodiscard]] const PlannedRun& plan() const { return experiment_.runs().front(); }
    [[nodiscard]] const Profile& profile() const { return experiment_.profile(); }
    [[nodiscard]] std::span<const SequenceRow> rows() const { return rows_; }  // finished so far
    /// Over the frames so far; none without truth, or when no point could be judged in kLeastFrames of them.
    [[nodiscard]] std::optional<Flicker> flicker() const;

private:
    SequenceRow measure_frame(int index, techniques::Frame& frame, Device& device, const Progress& progress,
                              SequencePictures& pictures);
    /// Points of the first frame that are judged there.
    [[nodiscard]] std::vector<scenes::SurfacePoint> points(const scenes::View& camera, const SequencePictures& first) const;

    SequenceRequest request_;
    Experiment experiment_;
    std::vector<SequenceRow> rows_;
    std::optional<FlickerMeter> meter_;
};

/// The table in words: what is rendered and the heads of columns, a line per frame, flicker. Together sequence.txt.
std::string sequence_header(const Sequence& sequence);
std::string sequence_line(const SequenceRow& row);
std::string sequence_footer(const Sequence& sequence);

/// sequence.json: the same with everything it takes to repeat it.
std::string sequence_json(const Sequence& sequence);

/// The files of one frame, such as frames/0007_color.png; docs/report.md names them.
std::vector<std::string> frame_file_names(int frame);
/// Prepares them in `folder`. Throws Error, and leaves none of them then.
void write_frame(const OutputFolder& folder, int frame, const SequencePictures& pictures);

/// Prepares the table of the frames that are finished and commits it with their files; those that an earlier and longer
/// sequence left there go. Throws Error.
void commit_sequence(OutputFolder& folder, const Sequence& sequence);

/// Every file that a sequence may replace in a folder.
std::vector<std::string> sequence_file_names(const OutputFolder& folder, int frames);

}  // namespace gnomon::studies
