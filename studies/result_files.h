// The files of one result: pictures, exact images and the report. docs/report.md describes each.
#pragma once

#include "studies/experiment.h"
#include "studies/output_folder.h"

namespace gnomon::studies {

/// Every name that write_result may write, report.json last.
const std::vector<std::string>& result_file_names();

/// The visibility without loss: Y is 1 and A is 0 where nothing was drawn. Throws Error when the file cannot be written.
void write_visibility(const std::filesystem::path& path, const FloatImage& visibility);

/// A file of text, whatever was there. Throws Error when it cannot be written.
void write_text(const std::filesystem::path& path, const std::string& text);

/// Prepares the files in `folder`; commit them with result_file_names(). `truth` may be null. Throws Error.
void write_result(const OutputFolder& folder, const RenderResult& result, const scenes::ReferenceImage* truth);

}  // namespace gnomon::studies
