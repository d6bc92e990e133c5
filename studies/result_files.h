// The files of one result: pictures, exact images and the report. docs/report.md describes each.
#pragma once

#include "studies/experiment.h"
#include "studies/output_folder.h"

namespace gnomon::studies {

/// Every name that write_result may write, report.json last.
const std::vector<std::string>& result_file_names();

/// Prepares the files in `folder`; commit them with result_file_names(). `truth` may be null. Throws Error.
void write_result(const OutputFolder& folder, const RenderResult& result, const scenes::ReferenceImage* truth);

}  // namespace gnomon::studies
