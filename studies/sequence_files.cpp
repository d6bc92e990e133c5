// What a sequence leaves behind: pictures of every frame and one table, as text and as JSON.
#include "studies/configuration.h"
#include "studies/false_color.h"
#include "studies/image_io.h"
#include "studies/report.h"
#include "studies/result_files.h"
#include "studies/sequence.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace gnomon::studies {

namespace {

using traces::Json;

constexpr std::string_view kFolder = "frames";
constexpr std::array<std::string_view, 3> kPictures{"color.png", "visibility.exr", "difference.png"};

std::string name_of_picture(int frame, std::string_view picture) { return fmt::format("{}/{:04}_{}", kFolder, frame, picture); }

/// The number of the frame whose file a sequence calls so; none for other names.
std::optional<int> frame_of(const std::string& name) {
    const std::size_t digits = kFolder.size() + 1;
    if (name.size() < digits + 5) return std::nullopt;
    int frame = 0;
    for (const char digit : name.substr(digits, 4)) {
        if (digit < '0' || digit > '9') return std::nullopt;
        frame = 10 * frame + (digit - '0');
    }
    const bool is_own = std::ranges::any_of(kPictures, [&](auto picture) { return name == name_of_picture(frame, picture); });
    return is_own ? std::optional(frame) : std::nullopt;
}

Json row_json(const SequenceRow& row) {
    Json json;
    json["frame"] = row.frame;
    json["time"] = row.time;
    json["metrics"] = row.metrics ? fields_json(*row.metrics) : Json();
    json["visibility"] = row.visibility;
    json["timings_ms"] = {{"map", row.map_ms}, {"camera", row.camera_ms}, {"reference", row.truth_ms}};
    return json;
}

Json flicker_json(const std::optional<Flicker>& flicker) {
    if (!flicker) return {};
    return {{"points", flicker->points},
            {"pairs", flicker->pairs},
            {"visibility", fields_json(flicker->visibility)},
            {"truth", fields_json(flicker->truth)},
            {"error", fields_json(flicker->error)}};
}

}  // namespace

std::string sequence_header(const Sequence& sequence) {
    const RenderRequest& request = sequence.request().render;
    std::string text =
        fmt::format("scene       {}{}, path {}, {} frame{}\ntechnique   {}\nimage       {}x{}, profile {}\n", request.scene,
                    request.file_options.ground ? " on a ground plane" : "", sequence.request().path, sequence.request().frames,
                    sequence.request().frames == 1 ? "" : "s",
                    settings_text(std::string(sequence.plan().technique.name), sequence.plan().settings), request.width,
                    request.height, sequence.profile().name);
    text += fmt::format("\n{:>5} {:>8} {:>9} {:>9} {:>9} {:>9} {:>10} {:>10}\n", "frame", "time", "rmse", "leak", "acne", "p99",
                        "map ms", "camera ms");
    return text;
}

std::string sequence_line(const SequenceRow& row) {
    const auto text = [&](double Metrics::* metric) {
        return row.metrics ? fmt::format("{:.5f}", *row.metrics.*metric) : std::string("-");
    };
    return fmt::format("{:>5} {:>8.4f} {:>9} {:>9} {:>9} {:>9} {:>10.2f} {:>10.2f}\n", row.frame, row.time,
                       text(&Metrics::rmse), text(&Metrics::leak), text(&Metrics::acne), text(&Metrics::p99), row.map_ms,
                       row.camera_ms);
}

std::string sequence_footer(const Sequence& sequence) {
    if (sequence.request().render.truth == Truth::None) return {};
    const std::optional<Flicker> flicker = sequence.flicker();
    if (!flicker) return fmt::format("\nflicker     no point was judged in {} frames\n", kLeastFrames);
    std::string text = fmt::format("\nflicker     {} points\n{:<12}{:>9} {:>9} {:>9} {:>9} {:>14}\n", grouped(flicker->points),
                                   "", "mean", "p95", "p99", "worst", "frame to frame");
    const auto add = [&](std::string_view name, const Unsteadiness& u) {
        fmt::format_to(std::back_inserter(text), "{:<12}{:>9.5f} {:>9.5f} {:>9.5f} {:>9.5f} {:>14.5f}\n", name, u.mean, u.p95,
                       u.p99, u.worst, u.change);
    };
    add("visibility", flicker->visibility);
    add("truth", flicker->truth);
    add("error", flicker->error);
    return text;
}

std::string sequence_json(const Sequence& sequence) {
    RenderRequest request = sequence.request().render;
    request.technique = sequence.plan().technique.name;
    Json json;
    json["gnomon"] = version();
    json["configuration"] = configuration_json(request, sequence.plan().settings, sequence.profile());
    json["frames"] = sequence.request().frames;
    json["path"] = sequence.request().path;
    json["flicker"] = flicker_json(sequence.flicker());
    json["rows"] = Json::array();
    for (const SequenceRow& row : sequence.rows()) json["rows"].push_back(row_json(row));
    return file_text(json);
}

std::vector<std::string> frame_file_names(int frame) {
    std::vector<std::string> names;
    names.reserve(kPictures.size());
    for (const std::string_view picture : kPictures) names.push_back(name_of_picture(frame, picture));
    return names;
}

void write_frame(const OutputFolder& folder, int frame, const SequencePictures& pictures) {
    const std::vector<std::string> names = frame_file_names(frame);
    try {
        write_png(folder.file(names[0]), pictures.color);
        write_visibility(folder.file(names[1]), pictures.visibility);
        if (pictures.truth) write_png(folder.file(names[2]), difference_image(pictures.visibility, *pictures.truth));
    } catch (...) {  // what was finished will be committed without it
        std::error_code ignored;
        for (const std::string& name : names) std::filesystem::remove(folder.file(name), ignored);
        throw;
    }
}

std::vector<std::string> sequence_file_names(const OutputFolder& folder, int frames) {
    std::vector<std::string> names;
    for (int frame = 0; frame < frames; ++frame) std::ranges::copy(frame_file_names(frame), std::back_inserter(names));
    for (const std::string& name : folder.files_in(std::string(kFolder)))
        if (frame_of(name).value_or(0) >= frames) names.push_back(name);
    names.insert(names.end(), {"sequence.txt", "sequence.json"});
    return names;
}

void commit_sequence(OutputFolder& folder, const Sequence& sequence) {
    std::string text = sequence_header(sequence);
    for (const SequenceRow& row : sequence.rows()) text += sequence_line(row);
    text += sequence_footer(sequence);
    write_text(folder.file("sequence.txt"), text);
    write_text(folder.file("sequence.json"), sequence_json(sequence));
    folder.commit(sequence_file_names(folder, static_cast<int>(sequence.rows().size())));
}

}  // namespace gnomon::studies
