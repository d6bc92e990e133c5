#include "studies/result_files.h"

#include "studies/false_color.h"
#include "studies/image_io.h"
#include "studies/report.h"

#include <fstream>

namespace gnomon::studies {

namespace {

/// The visibility with nothing drawn as lit, and which pixels were drawn.
struct Drawn {
    FloatImage visibility;
    std::vector<float> alpha;
};

Drawn drawn(const FloatImage& visibility) {
    Drawn result{visibility, std::vector<float>(visibility.values.size(), 1.0f)};
    for (std::size_t i = 0; i < result.alpha.size(); ++i) {
        if (visibility.values[i] != techniques::Frame::kNoSurface) continue;
        result.visibility.values[i] = 1.0f;
        result.alpha[i] = 0.0f;
    }
    return result;
}

}  // namespace

void write_visibility(const std::filesystem::path& path, const FloatImage& visibility) {
    const Drawn machine = drawn(visibility);
    write_exr(path, machine.visibility, machine.alpha);
}

void write_text(const std::filesystem::path& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) fail("{}: the file cannot be written", path.string());
}

const std::vector<std::string>& result_file_names() {
    static const std::vector<std::string> names{"color.png",     "visibility.exr", "visibility.png",  "reference.exr",
                                                "reference.png", "difference.png", "derivatives.png", "report.json"};
    return names;
}

void write_result(const OutputFolder& folder, const RenderResult& result, const scenes::ReferenceImage* truth) {
    write_png(folder.file("color.png"), result.color);
    const Drawn machine = drawn(result.visibility);
    write_exr(folder.file("visibility.exr"), machine.visibility, machine.alpha);
    write_png(folder.file("visibility.png"), grey_image(machine.visibility));
    if (truth != nullptr) {
        const FloatImage reference{truth->width, truth->height, truth->visibility};
        write_exr(folder.file("reference.exr"), reference, truth->weight);
        write_png(folder.file("reference.png"), grey_image(reference));
        write_png(folder.file("difference.png"), difference_image(result.visibility, *truth));
    }
    if (!result.derivatives.empty())
        write_png(folder.file("derivatives.png"), derivative_image(result.derivatives, result.visibility));
    write_text(folder.file("report.json"), report_json(result));
}

}  // namespace gnomon::studies
